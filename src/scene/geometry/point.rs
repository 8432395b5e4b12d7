//! Coordinates as a scene writes them: `(x, y)` or `(x, y, z)`.

use std::borrow::Cow;
use std::fmt;

use glam::{DVec2, DVec3};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserialize, Deserializer, SeqAccess, Visitor};
use serde::ser::{Serialize, SerializeTuple, Serializer};

/// A position of a scene in metres, written `(x, y)` or `(x, y, z)`.
///
/// It remembers how many numbers were written, so that the checks can complain about `(x, y)` in a three-dimensional
/// scene and about `(x, y, z)` in a two-dimensional one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    position: DVec3,
    dimension: usize,
}

impl Point {
    /// The point `(x, y)` of the plane z = 0, coordinates in metres.
    #[must_use]
    pub const fn plane(x: f64, y: f64) -> Self {
        Self { position: DVec3::new(x, y, 0.0), dimension: 2 }
    }

    /// The point `(x, y, z)`, coordinates in metres.
    #[must_use]
    pub const fn space(x: f64, y: f64, z: f64) -> Self {
        Self { position: DVec3::new(x, y, z), dimension: 3 }
    }

    /// The position in metres; z = 0 if only two numbers were written.
    #[must_use]
    pub const fn position(self) -> DVec3 {
        self.position
    }

    /// How many numbers were written: 2 or 3.
    #[must_use]
    pub const fn dimension(self) -> usize {
        self.dimension
    }

    /// The coordinates x and y in metres.
    pub(super) fn xy(self) -> DVec2 {
        self.position.truncate()
    }
}

impl Serialize for Point {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.dimension)?;
        for number in self.position.to_array().iter().take(self.dimension) {
            tuple.serialize_element(number)?;
        }
        tuple.end()
    }
}

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple(3, Coordinates)
    }
}

/// A list of 2 or 3 numbers; the unit stands beside each field of this type.
impl JsonSchema for Point {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "vector".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({"title": "vector", "type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 3})
    }
}

/// Reads the two or three numbers of a [`Point`].
struct Coordinates;

impl<'de> Visitor<'de> for Coordinates {
    type Value = Point;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("2 or 3 numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut numbers: A) -> Result<Point, A::Error> {
        let mut given = [0.0; 3];
        let mut count = 0;
        while let Some(number) = numbers.next_element::<f64>()? {
            if let Some(slot) = given.get_mut(count) {
                *slot = number;
            }
            count += 1;
        }
        match count {
            2 => Ok(Point::plane(given[0], given[1])),
            3 => Ok(Point::space(given[0], given[1], given[2])),
            _ => Err(de::Error::custom(format_args!("expected 2 or 3 numbers, found {count}"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_and_three_numbers_are_told_apart() {
        assert_eq!(ron::from_str("(1.0, -2)"), Ok(Point::plane(1.0, -2.0)));
        assert_eq!(ron::from_str("(1.0, 2.0, 3.5)"), Ok(Point::space(1.0, 2.0, 3.5)));
    }

    #[test]
    fn other_counts_are_refused_in_words() {
        for text in ["(1.0)", "(1.0, 2.0, 3.0, 4.0)", "()"] {
            let complaint = ron::from_str::<Point>(text).map_err(|error| error.to_string());
            assert!(complaint.as_ref().is_err_and(|text| text.contains("2 or 3 numbers")), "{text}: {complaint:?}");
        }
    }
}
