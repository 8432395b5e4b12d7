//! Plane polygons given by their corners: area, distance and self-intersection. Lengths in metres.

use glam::DVec2;

use super::Point;

/// The sides of a closed polygon as (start, end), in the order of the corners.
pub(super) fn sides(corners: &[Point]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    let ends = corners.iter().cycle().skip(1);
    corners.iter().zip(ends).map(|(start, end)| (start.xy(), end.xy()))
}

/// Area in m², positive if the corners run anticlockwise.
pub(super) fn signed_area(corners: &[Point]) -> f64 {
    // Relative to the first corner: far from the origin the plain shoelace formula would lose digits.
    let base = corners.first().map_or(DVec2::ZERO, |corner| corner.xy());
    0.5 * sides(corners).map(|(start, end)| (start - base).perp_dot(end - base)).sum::<f64>()
}

/// Length of the boundary in metres.
pub(super) fn perimeter(corners: &[Point]) -> f64 {
    sides(corners).map(|(start, end)| start.distance(end)).sum()
}

/// Distance of a point from the boundary in metres, negative inside.
pub(super) fn signed_distance(corners: &[Point], point: DVec2) -> f64 {
    let mut nearest_squared = f64::INFINITY;
    let mut inside = false;
    for (start, end) in sides(corners) {
        nearest_squared = nearest_squared.min(squared_distance_to_side(start, end, point));
        // A ray towards +x crosses the boundary an odd number of times exactly when it starts inside.
        if (start.y > point.y) != (end.y > point.y) {
            let crossing = start.x + (point.y - start.y) / (end.y - start.y) * (end.x - start.x);
            inside ^= point.x < crossing;
        }
    }
    let distance = nearest_squared.sqrt();
    if inside { -distance } else { distance }
}

fn squared_distance_to_side(start: DVec2, end: DVec2, point: DVec2) -> f64 {
    let side = end - start;
    let length_squared = side.length_squared();
    let fraction =
        if length_squared > 0.0 { ((point - start).dot(side) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    point.distance_squared(start + fraction * side)
}

/// The first pair of sides (numbered by their starting corners) that cross, touch or fold back onto each other.
pub(super) fn self_intersection(corners: &[Point]) -> Option<(usize, usize)> {
    let all: Vec<_> = sides(corners).collect();
    let count = all.len();
    for (first, &(a, b)) in all.iter().enumerate() {
        for (second, &(c, d)) in all.iter().enumerate().skip(first + 1) {
            let meets = if second == first + 1 {
                folds_back(a, b, d)
            } else if first == 0 && second + 1 == count {
                folds_back(c, d, b)
            } else {
                touch(a, b, c, d)
            };
            if meets {
                return Some((first, second));
            }
        }
    }
    None
}

/// Whether the line from `a` over `b` to `c` turns back onto itself at `b`.
fn folds_back(a: DVec2, b: DVec2, c: DVec2) -> bool {
    let (arriving, leaving) = (b - a, c - b);
    let scale = arriving.length() * leaving.length();
    arriving.dot(leaving) < 0.0 && arriving.perp_dot(leaving).abs() <= 1e-9 * scale
}

/// Whether the segments a–b and c–d have a point in common.
fn touch(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side_of = |from: DVec2, to: DVec2, point: DVec2| (to - from).perp_dot(point - from);
    let (c_side, d_side) = (side_of(a, b, c), side_of(a, b, d));
    let (a_side, b_side) = (side_of(c, d, a), side_of(c, d, b));
    if c_side * d_side < 0.0 && a_side * b_side < 0.0 {
        return true;
    }
    let within =
        |from: DVec2, to: DVec2, point: DVec2| point.cmpge(from.min(to)).all() && point.cmple(from.max(to)).all();
    (c_side == 0.0 && within(a, b, c))
        || (d_side == 0.0 && within(a, b, d))
        || (a_side == 0.0 && within(c, d, a))
        || (b_side == 0.0 && within(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{Dice, L_SHAPE, SLOPE_TANK, corners};
    use super::*;

    #[test]
    fn distance_agrees_with_densely_sampled_boundary() {
        for outline in [SLOPE_TANK.as_slice(), L_SHAPE.as_slice()] {
            let polygon = corners(outline);
            let samples: Vec<DVec2> =
                sides(&polygon).flat_map(|(a, b)| (0..4000).map(move |i| a.lerp(b, f64::from(i) / 4000.0))).collect();
            let mut dice = Dice::new(7);
            for _ in 0..200 {
                let point = DVec2::new(dice.between(-1.0, 5.0), dice.between(-1.0, 3.0));
                let sampled = samples.iter().map(|sample| sample.distance(point)).fold(f64::INFINITY, f64::min);
                let distance = signed_distance(&polygon, point).abs();
                // Samples lie at most 1 mm apart, so the nearest one is less than 0.5 mm off along the side.
                assert!(distance <= sampled + 1e-12 && sampled <= distance.hypot(5.1e-4) + 1e-12, "{point}");
            }
        }
    }

    #[test]
    fn sign_agrees_with_the_winding_angle() {
        let polygon = corners(&SLOPE_TANK);
        let mut dice = Dice::new(11);
        for _ in 0..500 {
            let point = DVec2::new(dice.between(-0.5, 4.5), dice.between(-0.5, 2.5));
            let turned: f64 = sides(&polygon).map(|(a, b)| (a - point).angle_to(b - point)).sum();
            assert_eq!(turned.abs() > 3.0, signed_distance(&polygon, point) < 0.0, "{point}");
        }
    }

    #[test]
    fn area_has_the_sign_of_the_rotation() {
        // The tank is 4 m x 2 m less the block under the berm: 1 m x 1.5 m and half of 1.5 m x 1.5 m.
        let mut tank = corners(&SLOPE_TANK);
        assert!((signed_area(&tank) - 5.375).abs() < 1e-12);
        tank.reverse();
        assert!((signed_area(&tank) + 5.375).abs() < 1e-12);
    }

    #[test]
    fn crossing_touching_and_folded_outlines_are_found() {
        let meets = |outline: &[(f64, f64)]| self_intersection(&corners(outline));
        assert_eq!(meets(&SLOPE_TANK), None);
        assert_eq!(meets(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]), Some((0, 2)));
        assert_eq!(meets(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 0.0), (0.0, 1.0)]), Some((0, 2)));
        assert_eq!(meets(&[(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 1.0)]), Some((0, 1)));
    }
}
