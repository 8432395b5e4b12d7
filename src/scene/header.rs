//! The head of a scene: dimension, resolution, gravity, time, periodic sides, kernel.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::geometry::{Point, coordinates};
use super::schema::{check_ranges, describe};
use super::{Document, Invalid, SceneFacts};
use crate::error::UserError;
use crate::kernels::KernelRegistry;
use crate::neighbours::PeriodicSides;
use crate::physics::Gravity;

/// Resolution of the run.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// 2 or 3.
    pub dimension: usize,
    /// Initial distance dp (m) of particles.
    pub spacing: f64,
    /// Smoothing length h (m).
    pub smoothing_length: f64,
}

impl Resolution {
    /// Volume dp^d (m³; m² in 2D) of a particle at rest.
    #[must_use]
    pub fn particle_volume(&self) -> f64 {
        self.spacing.powi(self.dimension as i32)
    }
}

/// Name, file and end of the scene.
#[derive(Resource, Debug, Clone, PartialEq)]
pub struct SceneInfo {
    /// File name as given.
    pub file: String,
    /// Title of the scene.
    pub title: String,
    /// End time (s).
    pub end_time: f64,
    /// Name of the kernel.
    pub kernel: String,
}

/// Fields at the top of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Header {
    /// What the scene shows, in a line.
    #[schemars(default)]
    pub title: String,
    /// 2 (the plane z = 0; masses and forces are per metre of length) or 3.
    #[schemars(range(min = 2, max = 3), extend("unit" = "1"))]
    pub dimension: usize,
    /// Initial distance dp (m) of particles.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub spacing: f64,
    /// Smoothing length in units of the spacing, h/dp.
    #[schemars(default = "default_smoothing_ratio", range(min = 0.8, max = 3.0), extend("unit" = "1"))]
    pub smoothing_ratio: f64,
    /// Gravity g (m/s²).
    #[schemars(extend("unit" = "m/s²"))]
    pub gravity: Point,
    /// End of the run (s).
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0))]
    pub end_time: f64,
    /// Periodic sides.
    #[schemars(default, extend("derived" = "no sides"))]
    pub periodic: Periodic,
}

const fn default_smoothing_ratio() -> f64 {
    1.2
}

/// Axes along which the scene repeats itself: the coordinates (m) of the two sides that are one and the same.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Periodic {
    /// Sides x = from and x = to.
    #[schemars(extend("unit" = "m", "derived" = "no sides"))]
    pub x: Option<(f64, f64)>,
    /// Sides y = from and y = to.
    #[schemars(extend("unit" = "m", "derived" = "no sides"))]
    pub y: Option<(f64, f64)>,
    /// Sides z = from and z = to.
    #[schemars(extend("unit" = "m", "derived" = "no sides"))]
    pub z: Option<(f64, f64)>,
}

impl Header {
    /// Names of the fields.
    pub const FIELDS: [&str; 8] =
        ["title", "dimension", "spacing", "smoothing_ratio", "gravity", "end_time", "periodic", "kernel"];

    /// Reads and checks the head of a scene.
    pub(super) fn read(document: &Document) -> Result<Self, UserError> {
        let header = Self {
            title: optional(document, "title", String::new())?,
            dimension: required(document, "dimension", "2 or 3")?,
            spacing: required(document, "spacing", "the initial distance of particles (m)")?,
            smoothing_ratio: optional(document, "smoothing_ratio", default_smoothing_ratio())?,
            gravity: required(document, "gravity", "(x, y) or (x, y, z) in m/s²")?,
            end_time: required(document, "end_time", "the end of the run (s)")?,
            periodic: optional(document, "periodic", Periodic::default())?,
        };
        header.check().map_err(|invalid| document.invalid(&invalid))?;
        Ok(header)
    }

    fn check(&self) -> Result<(), Invalid> {
        if !(2..=3).contains(&self.dimension) {
            return Err(Invalid::new("dimension", format!("must be 2 or 3, got {}", self.dimension)));
        }
        check_ranges(describe::<Self>, self)?;
        coordinates(self.gravity, self.dimension).map_err(|invalid| invalid.under("gravity"))?;
        let axes = [("x", self.periodic.x), ("y", self.periodic.y), ("z", self.periodic.z)];
        for (axis, sides) in axes {
            let Some((from, to)) = sides else { continue };
            let path = format!("periodic.{axis}");
            if axis == "z" && self.dimension == 2 {
                return Err(Invalid::new(path, "a scene of dimension 2 has no z axis"));
            }
            if from >= to {
                return Err(Invalid::new(
                    path,
                    format!("the first side must lie below the second, got {from} and {to} m"),
                ));
            }
        }
        Ok(())
    }
}

/// Reads a field that every scene has; `what` it is stands in the complaint that it is missing.
fn required<T: DeserializeOwned>(document: &Document, field: &str, what: &str) -> Result<T, UserError> {
    if document.node(field).is_none() {
        return Err(document.invalid(&Invalid::new("", format!("the field `{field}` is missing: {what}"))));
    }
    document.read(field)
}

fn optional<T: DeserializeOwned>(document: &Document, field: &str, default: T) -> Result<T, UserError> {
    if document.node(field).is_none() { Ok(default) } else { document.read(field) }
}

/// The kernel that a scene takes if it names none.
pub(super) const DEFAULT_KERNEL: &str = "QuinticSpline";

/// Puts the head of a scene into resources.
pub(super) fn load_header(document: &Document, header: Header, world: &mut World) -> Result<(), UserError> {
    world.get_resource_or_init::<SceneFacts>().note(document, "", &header);
    let resolution = Resolution {
        dimension: header.dimension,
        spacing: header.spacing,
        smoothing_length: header.smoothing_ratio * header.spacing,
    };
    let kernel_name = load_kernel(document, world, &resolution)?;
    let periodic = header.periodic;
    world.insert_resource(resolution);
    world.insert_resource(Gravity { full: header.gravity.position(), now: header.gravity.position() });
    world.insert_resource(PeriodicSides([periodic.x, periodic.y, periodic.z]));
    world.insert_resource(SceneInfo {
        file: document.file().to_owned(),
        title: header.title,
        end_time: header.end_time,
        kernel: kernel_name,
    });
    Ok(())
}

fn load_kernel(document: &Document, world: &mut World, resolution: &Resolution) -> Result<String, UserError> {
    let registry = world.resource::<KernelRegistry>();
    let name = match document.node("kernel") {
        Some(node) => {
            let named = document.named(node)?;
            let known: Vec<&str> = registry.names().collect();
            if !known.contains(&named.name) {
                return Err(document.unknown_name_error(named.span, "kernel", named.name, &known));
            }
            named.name.to_owned()
        }
        None => DEFAULT_KERNEL.to_owned(),
    };
    let kernel = registry.scaled(&name, resolution.smoothing_length, resolution.dimension);
    let Some(kernel) = kernel else {
        return Err(document.invalid(&Invalid::new("kernel", format!("no kernel `{name}` is registered"))));
    };
    let facts = (String::from("kernel"), name.clone());
    world.insert_resource(kernel);
    let mut noted = world.get_resource_or_init::<SceneFacts>();
    if document.node("kernel").is_none() {
        noted.defaults.push(facts.clone());
    }
    noted.parameters.push(facts);
    Ok(name)
}
