//! Size of the lining of a wall, before any ghost of it is made.

use std::f64::consts::PI;

use super::{Shape, Side, polygon};

/// Area (m²) or volume (m³) of the ghosts `depth` (m) behind the surface of a shape, about; a bound of it for `Union` and
/// `Difference`.
pub(crate) fn lining_measure(shape: &Shape, side: Side, depth: f64, dimension: usize) -> f64 {
    let other = if side == Side::Outside { Side::Inside } else { Side::Outside };
    let sum =
        |parts: &[Shape], side| parts.iter().map(|part| lining_measure(part, side, depth, dimension)).sum::<f64>();
    match shape {
        Shape::Union(parts) => sum(parts, side),
        Shape::Difference { of, minus } => lining_measure(of, side, depth, dimension) + sum(minus, other),
        _ if side == Side::Outside => grown(shape, depth, dimension) - grown(shape, 0.0, dimension),
        _ => grown(shape, 0.0, dimension) - grown(shape, -depth, dimension),
    }
}

/// Area or volume of a shape of which each face has been moved outwards by `by` (m), about.
fn grown(shape: &Shape, by: f64, dimension: usize) -> f64 {
    let length = |length: f64| (length + 2.0 * by).max(0.0);
    let radius = |radius: f64| (radius + by).max(0.0);
    // A + p by + 4 by², as of a square; moved inwards by 2 A/p nothing is left of it.
    let section = |corners: &[super::Point]| {
        let (area, perimeter) = (polygon::signed_area(corners).abs(), polygon::perimeter(corners));
        let by = by.max(-2.0 * area / perimeter);
        (area + perimeter * by + 4.0 * by * by).max(0.0)
    };
    match shape {
        Shape::Box { min, max } => {
            let lengths = (max.position() - min.position()).to_array();
            lengths[..dimension].iter().map(|side| length(*side)).product()
        }
        Shape::Polygon(corners) => section(corners),
        Shape::Circle { radius: r, .. } => PI * radius(*r).powi(2),
        Shape::Cylinder { radius: r, length: l, .. } => PI * radius(*r).powi(2) * length(*l),
        Shape::Sphere { radius: r, .. } => 4.0 / 3.0 * PI * radius(*r).powi(3),
        Shape::Prism { polygon, z: (from, to) } => section(polygon) * length(to - from),
        Shape::Union(_) | Shape::Difference { .. } => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ghost_layers, test_support};
    use super::*;

    #[test]
    fn a_lining_is_as_large_as_its_ghosts() {
        let shapes = [
            (2, "Box(min: (0, 0), max: (2, 1))"),
            (2, "Circle(center: (0, 0), radius: 1)"),
            (3, "Box(min: (0, 0, 0), max: (2, 1, 1))"),
            (3, "Sphere(center: (0, 0, 0), radius: 1)"),
            (3, "Cylinder(center: (0, 0, 0), axis: X, radius: 1, length: 2)"),
            (3, "Prism(polygon: [(0, 0), (2, 0), (0, 1)], z: (0, 2))"),
        ];
        let read = |text: &str| ron::from_str::<Shape>(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let tank = (2, Shape::Polygon(test_support::corners(&test_support::SLOPE_TANK)));
        let bow = read("Difference(of: Box(min: (0, 0), max: (2, 1)), minus: [Circle(center: (1, 0), radius: 0.5)])");
        let told_to_made = |shape: &Shape, side, dimension: usize| {
            let spacing: f64 = 0.04;
            let ghosts = ghost_layers(shape, side, 4, spacing, dimension, None).len();
            lining_measure(shape, side, 4.0 * spacing, dimension) / (ghosts as f64 * spacing.powi(dimension as i32))
        };
        let shapes = shapes.map(|(dimension, text)| (dimension, read(text)));
        for side in [Side::Outside, Side::Inside] {
            for (dimension, shape) in shapes.iter().chain([&tank]) {
                let ratio = told_to_made(shape, side, *dimension);
                assert!((ratio - 1.0).abs() < 0.12, "{shape:?}, {side:?}: told {ratio} times what is made");
            }
            let ratio = told_to_made(&bow, side, 2);
            assert!(ratio > 1.0 && ratio < 2.0, "{side:?}: a bound is {ratio} times what is made");
        }
    }
}
