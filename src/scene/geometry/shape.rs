//! The shapes that a scene can name.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Point;

/// A region of the scene: an area of the plane z = 0 in 2D, a volume in 3D. Lengths and coordinates are in metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Shape {
    /// A rectangle (2D) or a cuboid (3D) with sides along the axes: `Box(min: (0, 0), max: (0.4, 0.2))`.
    Box {
        /// Corner with the smallest coordinates, in metres.
        #[schemars(extend("unit" = "m"))]
        min: Point,
        /// Corner with the largest coordinates, in metres.
        #[schemars(extend("unit" = "m"))]
        max: Point,
    },
    /// The region of the plane within a closed line through the corners, in either sense of rotation; 2D only.
    #[schemars(extend("unit" = "m"))]
    Polygon(Vec<Point>),
    /// A disc; 2D only.
    Circle {
        /// Centre, in metres.
        #[schemars(extend("unit" = "m"))]
        center: Point,
        /// Radius in metres.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
        radius: f64,
    },
    /// A circular cylinder along one of the axes; 3D only.
    Cylinder {
        /// Middle of the cylinder's axis, in metres.
        #[schemars(extend("unit" = "m"))]
        center: Point,
        /// Direction of the cylinder's axis.
        axis: Axis,
        /// Radius in metres.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
        radius: f64,
        /// Length along the axis in metres.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
        length: f64,
    },
    /// A ball; 3D only.
    Sphere {
        /// Centre, in metres.
        #[schemars(extend("unit" = "m"))]
        center: Point,
        /// Radius in metres.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
        radius: f64,
    },
    /// A polygon of the xy plane drawn out along z; 3D only.
    Prism {
        /// Corners `(x, y)` of the cross-section, in metres, in either sense of rotation.
        #[schemars(extend("unit" = "m"))]
        polygon: Vec<Point>,
        /// Lower and upper end along z, in metres.
        #[schemars(extend("unit" = "m"))]
        z: (f64, f64),
    },
    /// Everything that lies in at least one of the shapes.
    Union(Vec<Self>),
    /// What is left of a shape when others are cut out of it.
    Difference {
        /// The shape that is cut.
        of: Box<Self>,
        /// The shapes that are cut out.
        minus: Vec<Self>,
    },
}

/// One of the three coordinate axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Axis {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
}

impl Axis {
    /// Index of the component along it.
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }

    /// The vector with components `across` in the plane normal to this axis and `along` it; right-handed.
    pub(super) fn compose(self, across: [f64; 2], along: f64) -> DVec3 {
        let [u, v] = across;
        match self {
            Self::X => DVec3::new(along, u, v),
            Self::Y => DVec3::new(v, along, u),
            Self::Z => DVec3::new(u, v, along),
        }
    }

    /// Component along this axis and length of the rest of a vector.
    pub(super) fn along_and_radius(self, vector: DVec3) -> (f64, f64) {
        match self {
            Self::X => (vector.x, vector.y.hypot(vector.z)),
            Self::Y => (vector.y, vector.z.hypot(vector.x)),
            Self::Z => (vector.z, vector.x.hypot(vector.y)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ron::extensions::Extensions;

    fn read(text: &str) -> Result<Shape, String> {
        let extensions = Extensions::UNWRAP_VARIANT_NEWTYPES | Extensions::IMPLICIT_SOME;
        let options = ron::Options::default().with_default_extension(extensions);
        options.from_str(text).map_err(|error| error.to_string())
    }

    const WRITTEN: [&str; 8] = [
        "Box(min: (0.0, 0.0), max: (0.4, 0.2))",
        "Polygon([(0, 0), (1, 0), (0.5, 2.0)])",
        "Circle(center: (0.1, 0.2), radius: 0.05)",
        "Cylinder(center: (0, 0, 1), axis: Z, radius: 0.5, length: 2)",
        "Sphere(center: (0, 0, 1), radius: 0.5)",
        "Prism(polygon: [(0, 0), (1, 0), (0.5, 2.0)], z: (-0.5, 0.5))",
        "Union([Circle(center: (0, 0), radius: 1), Box(min: (0, 0), max: (1, 1))])",
        "Difference(of: Box(min: (0, 0), max: (1, 1)), minus: [Circle(center: (0, 0), radius: 0.2)])",
    ];

    #[test]
    fn every_shape_survives_a_round_trip() -> Result<(), Box<dyn std::error::Error>> {
        for text in WRITTEN {
            let shape = read(text)?;
            let written = ron::to_string(&shape)?;
            assert_eq!(read(&written), Ok(shape.clone()), "{written}");
            assert_eq!(ron::from_str(&written), Ok(shape), "{written}");
        }
        Ok(())
    }

    #[test]
    fn values_land_where_they_belong() {
        let rectangle = Shape::Box { min: Point::plane(0.0, 0.0), max: Point::plane(0.4, 0.2) };
        assert_eq!(read(WRITTEN[0]), Ok(rectangle));
        let cylinder = Shape::Cylinder { center: Point::space(0.0, 0.0, 1.0), axis: Axis::Z, radius: 0.5, length: 2.0 };
        assert_eq!(read(WRITTEN[3]), Ok(cylinder));
    }

    #[test]
    fn unknown_fields_are_refused() {
        assert!(read("Circle(center: (0, 0), radius: 1, colour: 2)").is_err());
        assert!(read("Box(min: (0, 0), max: (1, 1), size: 2)").is_err());
    }

    #[test]
    fn axis_composes_what_it_splits() {
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            assert_eq!(axis.along_and_radius(axis.compose([3.0, 4.0], 7.0)), (7.0, 5.0));
        }
    }
}
