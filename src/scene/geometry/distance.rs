//! Where a shape is: containment, signed distance, bounds and size.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::{Point, Shape, polygon};

impl Shape {
    /// Whether a position (metres) lies in the shape; its boundary belongs to it.
    #[must_use]
    pub fn contains(&self, position: DVec3) -> bool {
        self.signed_distance(position) <= 0.0
    }

    /// Distance in metres from a position (metres) to the shape's boundary, negative inside.
    ///
    /// Plane shapes ignore z. The value is exact for every shape but two: `Union` takes the least distance of its
    /// parts, which is exact outside and may be too small in magnitude inside; `Difference` takes the largest of the
    /// cut shape's distance and the negated distances of the cutting ones, which may be too small in magnitude
    /// anywhere. The sign is right off the boundaries of the parts.
    #[must_use]
    pub fn signed_distance(&self, position: DVec3) -> f64 {
        match self {
            Self::Box { min, max } => distance_to_box(*min, *max, position),
            Self::Polygon(corners) => polygon::signed_distance(corners, position.truncate()),
            Self::Circle { center, radius } => position.truncate().distance(center.xy()) - radius,
            Self::Cylinder { center, axis, radius, length } => {
                let (along, from_axis) = axis.along_and_radius(position - center.position());
                distance_to_extrusion(from_axis - radius, along.abs() - 0.5 * length)
            }
            Self::Sphere { center, radius } => position.distance(center.position()) - radius,
            Self::Prism { polygon, z: (from, to) } => {
                let across = polygon::signed_distance(polygon, position.truncate());
                distance_to_extrusion(across, (from - position.z).max(position.z - to))
            }
            Self::Union(shapes) => {
                shapes.iter().map(|shape| shape.signed_distance(position)).fold(f64::INFINITY, f64::min)
            }
            Self::Difference { of, minus } => {
                minus.iter().map(|shape| -shape.signed_distance(position)).fold(of.signed_distance(position), f64::max)
            }
        }
    }

    /// Smallest and largest coordinates in metres; z is 0 for plane shapes. A `Difference` has the bounds of the
    /// shape that is cut.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        match self {
            Self::Box { min, max } => (min.position(), max.position()),
            Self::Polygon(corners) => plane_bounds(corners, (0.0, 0.0)),
            Self::Circle { center, radius } => around(center.position(), DVec3::new(*radius, *radius, 0.0)),
            Self::Cylinder { center, axis, radius, length } => {
                around(center.position(), axis.compose([*radius, *radius], 0.5 * length))
            }
            Self::Sphere { center, radius } => around(center.position(), DVec3::splat(*radius)),
            Self::Prism { polygon, z } => plane_bounds(polygon, *z),
            Self::Union(shapes) => shapes
                .iter()
                .map(Self::bounds)
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), (part_low, part_high)| {
                    (low.min(part_low), high.max(part_high))
                }),
            Self::Difference { of, minus: _ } => of.bounds(),
        }
    }

    /// Exact area in m² for `dimension` 2 or exact volume in m³ for `dimension` 3.
    ///
    /// `None` for `Union` and `Difference`, whose size has no closed form here, and for a shape of the other dimension.
    #[must_use]
    pub fn measure(&self, dimension: usize) -> Option<f64> {
        match (self, dimension) {
            (Self::Box { min, max }, 2) => Some((max.xy() - min.xy()).element_product()),
            (Self::Box { min, max }, 3) => Some((max.position() - min.position()).element_product()),
            (Self::Polygon(corners), 2) => Some(polygon::signed_area(corners).abs()),
            (Self::Circle { radius, .. }, 2) => Some(PI * radius * radius),
            (Self::Cylinder { radius, length, .. }, 3) => Some(PI * radius * radius * length),
            (Self::Sphere { radius, .. }, 3) => Some(4.0 / 3.0 * PI * radius.powi(3)),
            (Self::Prism { polygon, z: (from, to) }, 3) => Some(polygon::signed_area(polygon).abs() * (to - from)),
            _ => None,
        }
    }
}

fn distance_to_box(min: Point, max: Point, position: DVec3) -> f64 {
    let beyond = (min.position() - position).max(position - max.position());
    // A box of the plane reaches through all z.
    let beyond = if min.dimension() == 2 { beyond.truncate().extend(f64::NEG_INFINITY) } else { beyond };
    beyond.max_element().min(0.0) + beyond.max(DVec3::ZERO).length()
}

/// Distance to a plane shape drawn out along its normal, from the distances `across` and `along` that normal.
fn distance_to_extrusion(across: f64, along: f64) -> f64 {
    across.max(along).min(0.0) + across.max(0.0).hypot(along.max(0.0))
}

fn around(center: DVec3, reach: DVec3) -> (DVec3, DVec3) {
    (center - reach, center + reach)
}

fn plane_bounds(corners: &[Point], (from, to): (f64, f64)) -> (DVec3, DVec3) {
    let low = corners.iter().fold(DVec2::INFINITY, |low, corner| low.min(corner.xy()));
    let high = corners.iter().fold(DVec2::NEG_INFINITY, |high, corner| high.max(corner.xy()));
    (low.extend(from), high.extend(to))
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use super::super::test_support::{Dice, L_SHAPE, corners};
    use super::*;

    fn solids() -> Vec<Shape> {
        let center = Point::space(0.1, -0.2, 0.3);
        vec![
            Shape::Box { min: Point::space(-0.5, -0.4, -0.3), max: Point::space(0.7, 0.6, 0.5) },
            Shape::Cylinder { center, axis: Axis::X, radius: 0.5, length: 1.2 },
            Shape::Cylinder { center, axis: Axis::Y, radius: 0.4, length: 0.6 },
            Shape::Sphere { center, radius: 0.6 },
            Shape::Prism { polygon: corners(&[(-0.5, -0.5), (0.6, -0.4), (0.1, 0.1), (0.0, 0.7)]), z: (-0.2, 0.6) },
        ]
    }

    /// Share of random points of a cube that the shape contains, as a volume.
    fn sampled_volume(shape: &Shape, dice: &mut Dice) -> f64 {
        let (low, high) = shape.bounds();
        let count = 40_000;
        let inside = (0..count)
            .filter(|_| {
                let (x, y) = (dice.between(low.x, high.x), dice.between(low.y, high.y));
                shape.contains(DVec3::new(x, y, dice.between(low.z, high.z)))
            })
            .count();
        (high - low).element_product() * inside as f64 / f64::from(count)
    }

    #[test]
    fn measure_agrees_with_random_sampling() {
        let mut dice = Dice::new(3);
        for shape in solids() {
            let (sampled, exact) = (sampled_volume(&shape, &mut dice), shape.measure(3));
            assert!(exact.is_some_and(|exact| (sampled / exact - 1.0).abs() < 0.03), "{shape:?}: {sampled} {exact:?}");
            assert_eq!(shape.measure(2).is_some(), matches!(shape, Shape::Box { .. }));
        }
    }

    /// An exact distance has a gradient of length 1, and stepping down it by the distance ends on the boundary.
    #[test]
    fn following_the_gradient_by_the_distance_reaches_the_boundary() {
        let mut dice = Dice::new(5);
        for shape in solids() {
            for _ in 0..300 {
                let position = DVec3::new(dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), dice.between(-1.0, 1.0));
                let slope = |step: DVec3| {
                    (shape.signed_distance(position + step) - shape.signed_distance(position - step)) / 2e-6
                };
                let gradient = DVec3::new(slope(1e-6 * DVec3::X), slope(1e-6 * DVec3::Y), slope(1e-6 * DVec3::Z));
                let foot = position - shape.signed_distance(position) * gradient;
                assert!((gradient.length() - 1.0).abs() < 1e-4, "{shape:?} {position} {gradient}");
                assert!(shape.signed_distance(foot).abs() < 1e-4, "{shape:?} {position}");
            }
        }
    }

    #[test]
    fn plane_shapes_ignore_z() {
        let shape = Shape::Box { min: Point::plane(0.0, 0.0), max: Point::plane(1.0, 0.5) };
        assert!((shape.signed_distance(DVec3::new(0.5, 0.2, 9.0)) + 0.2).abs() < 1e-15);
        assert!((shape.signed_distance(DVec3::new(4.0, 4.5, 9.0)) - 5.0).abs() < 1e-15);
        let circle = Shape::Circle { center: Point::plane(1.0, 1.0), radius: 2.0 };
        assert!((circle.signed_distance(DVec3::new(4.0, 5.0, 1.0)) - 3.0).abs() < 1e-15);
        assert!(circle.measure(2).is_some_and(|area| (area - 12.566_370_614_359_172).abs() < 1e-12));
    }

    #[test]
    fn combined_shapes_contain_what_logic_says() {
        let block = Shape::Box { min: Point::plane(0.0, 0.0), max: Point::plane(2.0, 2.0) };
        let disc = Shape::Circle { center: Point::plane(2.0, 2.0), radius: 1.0 };
        let outline = Shape::Polygon(corners(&L_SHAPE));
        let union = Shape::Union(vec![outline.clone(), disc.clone()]);
        let difference = Shape::Difference { of: Box::new(block.clone()), minus: vec![disc.clone(), outline.clone()] };
        let mut dice = Dice::new(9);
        for _ in 0..1000 {
            let position = DVec3::new(dice.between(-0.5, 3.5), dice.between(-0.5, 3.5), 0.0);
            let (in_disc, in_outline) = (disc.contains(position), outline.contains(position));
            assert_eq!(union.contains(position), in_disc || in_outline);
            assert_eq!(difference.contains(position), block.contains(position) && !in_disc && !in_outline);
        }
        assert_eq!(union.bounds(), (DVec3::ZERO, DVec3::new(3.0, 3.0, 0.0)));
        assert_eq!(difference.bounds(), block.bounds());
        assert_eq!((union.measure(2), difference.measure(2)), (None, None));
    }
}
