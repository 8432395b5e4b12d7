//! Filling a shape with the centres of a lattice.

use glam::DVec3;

use super::Shape;

/// Number of a lattice cell along x, y and z; cell `i` reaches from `origin + i·spacing` to
/// `origin + (i + 1)·spacing`. The last entry is 0 in 2D.
pub type LatticeIndex = [i64; 3];

/// The centre of one lattice cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatticePoint {
    /// Which cell it is: equal for equal places, so overlapping fillings with one origin share indices.
    pub index: LatticeIndex,
    /// Centre `origin + (index + ½)·spacing` in metres; z = 0 in 2D.
    pub position: DVec3,
}

/// The lattice centres `origin + (i + ½)·spacing` that lie in `shape` at least `clearance` away from its boundary.
///
/// `dimension` is 2 or 3, `spacing`, `origin` and `clearance` are in metres. A clearance of some 1e-6 spacings leaves
/// out the centres exactly on a slanted boundary whatever the rounding; a negative one takes in a margin outside. In a
/// `Union` the clearance also applies to the seam between parts that abut.
///
/// The order is that of the indices: x slowest, then y, in 3D z fastest; so in either dimension the columns along the
/// last axis are contiguous and run upwards.
#[must_use]
pub fn lattice(shape: &Shape, dimension: usize, spacing: f64, origin: DVec3, clearance: f64) -> Vec<LatticePoint> {
    let (low, high) = shape.bounds();
    let margin = DVec3::splat((-clearance).max(0.0));
    let first = (low - margin - origin) / spacing;
    let last = (high + margin - origin) / spacing;
    let cells = |axis: usize| cells_between(first[axis], last[axis]);
    let mut points = Vec::new();
    for i in cells(0) {
        for j in cells(1) {
            for k in if dimension == 2 { 0..=0 } else { cells(2) } {
                let index = [i, j, k];
                let mut position = origin + (DVec3::new(i as f64, j as f64, k as f64) + 0.5) * spacing;
                if dimension == 2 {
                    position.z = 0.0;
                }
                if shape.signed_distance(position) <= -clearance {
                    points.push(LatticePoint { index, position });
                }
            }
        }
    }
    points
}

/// Cells whose centres lie between two places, both in cells from the origin, give or take rounding.
fn cells_between(first: f64, last: f64) -> std::ops::RangeInclusive<i64> {
    let rounding = 1e-6;
    ((first - 0.5 - rounding).ceil() as i64)..=((last - 0.5 + rounding).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::super::Point;
    use super::*;

    #[test]
    fn box_is_filled_cell_by_cell() {
        let shape = Shape::Box { min: Point::plane(-0.2, 0.1), max: Point::plane(0.4, 0.6) };
        let points = lattice(&shape, 2, 0.1, DVec3::ZERO, 1e-7);
        let expected: Vec<LatticeIndex> = (-2..4).flat_map(|i| (1..6).map(move |j| [i, j, 0])).collect();
        assert_eq!(points.iter().map(|point| point.index).collect::<Vec<_>>(), expected);
        for LatticePoint { index: [i, j, _], position } in points {
            let centre = DVec3::new(i as f64 * 0.1 + 0.05, j as f64 * 0.1 + 0.05, 0.0);
            assert!(position.distance(centre) < 1e-15);
        }
    }

    #[test]
    fn origin_shifts_the_lattice_and_z_runs_fastest() {
        let shape = Shape::Box { min: Point::space(0.03, 0.0, 0.0), max: Point::space(0.13, 0.1, 0.2) };
        let points = lattice(&shape, 3, 0.05, DVec3::new(0.03, 0.0, 0.0), 1e-9);
        assert_eq!(points.len(), 2 * 2 * 4);
        assert!(points.windows(2).all(|pair| pair[0].index < pair[1].index));
        assert_eq!(points[1].index, [0, 0, 1]);
        assert!(points[0].position.distance(DVec3::new(0.055, 0.025, 0.025)) < 1e-15);
    }

    #[test]
    fn centres_on_a_slanted_boundary_follow_the_clearance() {
        // The hypotenuse x + y = 1 runs through the centres of the cells (i, 9 - i).
        let triangle = Shape::Polygon(vec![Point::plane(0.0, 0.0), Point::plane(1.0, 0.0), Point::plane(0.0, 1.0)]);
        assert_eq!(lattice(&triangle, 2, 0.1, DVec3::ZERO, 1e-9).len(), 45);
        assert_eq!(lattice(&triangle, 2, 0.1, DVec3::ZERO, -1e-9).len(), 55);
    }

    #[test]
    fn negative_clearance_reaches_outside() {
        let shape = Shape::Box { min: Point::plane(0.0, 0.0), max: Point::plane(0.1, 0.1) };
        // One cell inside, four beside it at half a cell and four over the corners at 0.707 cells.
        assert_eq!(lattice(&shape, 2, 0.1, DVec3::ZERO, -0.051).len(), 5);
        assert_eq!(lattice(&shape, 2, 0.1, DVec3::ZERO, -0.071).len(), 9);
    }
}
