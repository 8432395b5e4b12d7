//! Which shapes make sense in a scene of a given dimension.

use super::{Axis, Point, Shape, polygon};
use crate::scene::invalid::Invalid;

impl Shape {
    /// Checks that this shape makes sense in a scene of `dimension` 2 or 3. One read from a file must pass before the other
    /// methods mean anything.
    ///
    /// # Errors
    ///
    /// Names the first value that does not: sizes that are not positive, crossed polygons, shapes or coordinates of
    /// the other dimension. The path leads from this shape to the value (`minus.0.radius`; list entries by number).
    pub fn check(&self, dimension: usize) -> Result<(), Invalid> {
        match self {
            Self::Box { min, max } => check_box(*min, *max, dimension),
            Self::Polygon(corners) => {
                belongs_to(2, dimension, "Polygon", "Prism")?;
                check_polygon(corners)
            }
            Self::Circle { center, radius } => {
                belongs_to(2, dimension, "Circle", "Sphere or Cylinder")?;
                coordinates(*center, dimension).map_err(|found| found.under("center"))?;
                positive("radius", *radius)
            }
            Self::Cylinder { center, axis: _, radius, length } => {
                belongs_to(3, dimension, "Cylinder", "Circle or Box")?;
                coordinates(*center, dimension).map_err(|found| found.under("center"))?;
                positive("radius", *radius)?;
                positive("length", *length)
            }
            Self::Sphere { center, radius } => {
                belongs_to(3, dimension, "Sphere", "Circle")?;
                coordinates(*center, dimension).map_err(|found| found.under("center"))?;
                positive("radius", *radius)
            }
            Self::Prism { polygon, z } => {
                belongs_to(3, dimension, "Prism", "Polygon")?;
                check_polygon(polygon).map_err(|found| found.under("polygon"))?;
                check_ends(*z)
            }
            Self::Union(shapes) => check_all(shapes, dimension, "Union"),
            Self::Difference { of, minus } => {
                of.check(dimension).map_err(|found| found.under("of"))?;
                check_all(minus, dimension, "minus").map_err(|found| found.under("minus"))
            }
        }
    }
}

fn belongs_to(own: usize, scene: usize, name: &str, instead: &str) -> Result<(), Invalid> {
    if own == scene {
        return Ok(());
    }
    Err(Invalid::new("", format!("{name} is a {own}D shape, but the scene is {scene}D; expected {instead}")))
}

/// Refuses coordinates, of a place or of any other vector, that are not as many as the scene has dimensions.
///
/// # Errors
/// Another number of coordinates than `dimension`, 2 or 3.
pub fn coordinates(point: Point, dimension: usize) -> Result<(), Invalid> {
    let expected = if dimension == 2 { "2 numbers (x, y)" } else { "3 numbers (x, y, z)" };
    if point.dimension() != dimension {
        return Err(Invalid::new("", format!("found {} numbers, expected {expected}", point.dimension())));
    }
    if !point.position().is_finite() {
        return Err(Invalid::new("", format!("found {}, expected {expected} that are finite", point.position())));
    }
    Ok(())
}

/// Refuses an axis that a scene of `dimension` 2 or 3 does not have.
///
/// # Errors
/// The axis z in a scene of dimension 2.
pub fn axis_exists(axis: Axis, dimension: usize) -> Result<(), Invalid> {
    if axis.index() < dimension {
        return Ok(());
    }
    Err(Invalid::new("", format!("a scene of dimension {dimension} has no z axis")))
}

fn positive(name: &str, value: f64) -> Result<(), Invalid> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Invalid::new(name, format!("found {value} m, expected a positive length in metres")))
}

fn check_box(min: Point, max: Point, dimension: usize) -> Result<(), Invalid> {
    coordinates(min, dimension).map_err(|found| found.under("min"))?;
    coordinates(max, dimension).map_err(|found| found.under("max"))?;
    let (low, high) = (min.position().to_array(), max.position().to_array());
    for (name, (low, high)) in ["x", "y", "z"].iter().zip(low.iter().zip(high)).take(dimension) {
        if high <= *low {
            let message = format!("{name} = {high} m, expected more than the {low} m of min");
            return Err(Invalid::new("max", message));
        }
    }
    Ok(())
}

fn check_polygon(corners: &[Point]) -> Result<(), Invalid> {
    if corners.len() < 3 {
        return Err(Invalid::new("", format!("found {} corners, expected at least 3", corners.len())));
    }
    for (number, corner) in corners.iter().enumerate() {
        coordinates(*corner, 2).map_err(|found| found.under(&number.to_string()))?;
    }
    if let Some(number) = polygon::sides(corners).position(|(start, end)| start == end) {
        return Err(Invalid::new(number.to_string(), "the next corner is the same point; expected each corner once"));
    }
    let perimeter = polygon::perimeter(corners);
    if polygon::signed_area(corners).abs() <= 1e-12 * perimeter * perimeter {
        return Err(Invalid::new("", "the polygon has no area; expected corners that are not all on one line"));
    }
    if let Some((first, second)) = polygon::self_intersection(corners) {
        let message =
            format!("the side from corner {second} meets the side from corner {first}; expected a simple polygon");
        return Err(Invalid::new(second.to_string(), message));
    }
    Ok(())
}

fn check_ends((from, to): (f64, f64)) -> Result<(), Invalid> {
    if from.is_finite() && to.is_finite() && from < to {
        return Ok(());
    }
    Err(Invalid::new("z", format!("found ({from}, {to}) in metres, expected the lower end first, then the upper one")))
}

fn check_all(shapes: &[Shape], dimension: usize, name: &str) -> Result<(), Invalid> {
    if shapes.is_empty() {
        return Err(Invalid::new("", format!("{name} is an empty list, expected at least one shape")));
    }
    for (number, shape) in shapes.iter().enumerate() {
        shape.check(dimension).map_err(|found| found.under(&number.to_string()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{L_SHAPE, SLOPE_TANK, corners};
    use super::*;

    fn path(text: &str, dimension: usize) -> Result<String, String> {
        let shape: Shape = ron::from_str(text).map_err(|error| error.to_string())?;
        Ok(shape.check(dimension).map_or_else(|found| found.path, |()| "fine".to_owned()))
    }

    #[test]
    fn sound_shapes_pass() {
        assert_eq!(Shape::Polygon(corners(&SLOPE_TANK)).check(2), Ok(()));
        assert_eq!(Shape::Polygon(corners(&L_SHAPE)).check(2), Ok(()));
        for text in [
            "Box(min: (0, 0, 0), max: (1, 1, 1))",
            "Cylinder(center: (0, 0, 0), axis: X, radius: 1, length: 1)",
            "Sphere(center: (0, 0, 0), radius: 1)",
            "Prism(polygon: [(0, 0), (1, 0), (0, 1)], z: (0, 1))",
            "Difference(of: Sphere(center: (0, 0, 0), radius: 1), minus: [Box(min: (0, 0, 0), max: (1, 1, 1))])",
        ] {
            assert_eq!(path(text, 3).as_deref(), Ok("fine"), "{text}");
        }
    }

    #[test]
    fn complaints_name_the_value() {
        for (text, expected) in [
            ("Box(min: (0, 0), max: (1, 0))", "max"),
            ("Box(min: (0, 0, 0), max: (1, 1))", "min"),
            ("Box(min: (0, NaN), max: (1, 1))", "min"),
            ("Circle(center: (0, 0, 0), radius: 1)", "center"),
            ("Circle(center: (0, 0), radius: inf)", "radius"),
            ("Polygon([(0, 0), (1, 0)])", ""),
            ("Polygon([(0, 0), (1, 0), (2, 0)])", ""),
            ("Polygon([(0, 0), (1, 0), (1, 0), (0, 1)])", "1"),
            ("Polygon([(0, 0), (1, 0, 0), (1, 0), (0, 1)])", "1"),
            ("Polygon([(0, 0), (3, 1), (3, 0), (0, 2)])", "2"),
            ("Sphere(center: (0, 0, 0), radius: 1)", ""),
            ("Union([])", ""),
            ("Union([Circle(center: (0, 0), radius: 1), Circle(center: (0, 0), radius: 0)])", "1.radius"),
            (
                "Difference(of: Box(min: (0, 0), max: (1, 1)), minus: [Circle(center: (0, 0), radius: -1)])",
                "minus.0.radius",
            ),
            ("Difference(of: Box(min: (0, 0), max: (-1, 1)), minus: [Circle(center: (0, 0), radius: 1)])", "of.max"),
        ] {
            assert_eq!(path(text, 2).as_deref(), Ok(expected), "{text}");
        }
    }

    #[test]
    fn vectors_of_any_unit_are_counted_in_the_same_words() {
        let found = coordinates(Point::plane(0.0, -9.81), 3).map_err(|found| found.message);
        assert_eq!(found, Err("found 2 numbers, expected 3 numbers (x, y, z)".to_owned()));
    }

    #[test]
    fn complaints_in_space_name_the_value() {
        for (text, expected) in [
            ("Circle(center: (0, 0), radius: 1)", ""),
            ("Polygon([(0, 0), (1, 0), (0, 1)])", ""),
            ("Box(min: (0, 0), max: (1, 1))", "min"),
            ("Box(min: (0, 0, 0), max: (1, 1, 0))", "max"),
            ("Cylinder(center: (0, 0, 0), axis: X, radius: 1, length: 0)", "length"),
            ("Prism(polygon: [(0, 0), (1, 0), (0, 1)], z: (1, 0))", "z"),
            ("Prism(polygon: [(0, 0), (1, 0), (0, 1, 0)], z: (0, 1))", "polygon.2"),
        ] {
            assert_eq!(path(text, 3).as_deref(), Ok(expected), "{text}");
        }
    }
}
