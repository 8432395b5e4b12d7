//! Structures of a scene: bodies filled with solid particles, whose load is reported.

use bevy_ecs::prelude::*;
use glam::DVec3;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::body::{Body, BodyShape, spawn_body};
use super::{Motion, Structure, body_shapes};
use crate::neighbours::PeriodicSides;
use crate::number::{plain, short};
use crate::particles::{Slip, Solid};
use crate::scene::geometry::{Point, Shape, coordinates, solid_particles};
use crate::scene::{Invalid, NOTHING_LEFT, Resolution, SceneFacts, SceneSection, SectionError, limit_particles};

/// Section `structures`: bodies that report force and moment, by name. Structures must not overlap.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct StructuresSection(IndexMap<String, StructureSpec>);

/// A structure of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StructureSpec {
    /// Shape of the body (m).
    #[schemars(extend("unit" = "m"))]
    pub shape: Shape,
    /// Whether the fluid sticks to it.
    #[serde(default)]
    pub slip: Slip,
    /// How it moves.
    #[serde(default)]
    pub motion: Motion,
    /// In 2D, the out-of-plane length (m) by which force and moment per metre are multiplied.
    #[serde(default)]
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0, "derived" = "forces per metre"))]
    pub length: Option<f64>,
    /// Point (m) about which the moment is taken, fixed in space; `None` for the centroid of the body at rest.
    #[serde(default)]
    #[schemars(extend("unit" = "m", "derived" = "the centroid of the body at rest"))]
    pub moment_about: Option<Point>,
}

/// Particles of a structure deeper (in spacings) in another one are a mistake in the scene.
const OVERLAP: f64 = 0.25;

impl StructuresSection {
    /// The shapes that are filled.
    pub(crate) fn shapes(self) -> Vec<Shape> {
        self.0.into_values().map(|structure| structure.shape).collect()
    }
}

impl SceneSection for StructuresSection {
    const NAME: &'static str = "structures";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn check(&self, world: &World) -> Result<(), Invalid> {
        let dimension = world.resource::<Resolution>().dimension;
        for (name, structure) in &self.0 {
            structure.shape.check(dimension).map_err(|invalid| invalid.under("shape").under(name))?;
            structure.motion.check(dimension).map_err(|invalid| invalid.under("motion").under(name))?;
            if structure.motion.turns() && world.resource::<PeriodicSides>().any() {
                return Err(Invalid::new(format!("{name}.motion"), "a body cannot turn between periodic sides"));
            }
            limit_particles(structure.shape.bounds(), world.resource::<Resolution>())
                .map_err(|invalid| invalid.under("shape").under(name))?;
            if let Some(point) = structure.moment_about {
                coordinates(point, dimension).map_err(|invalid| invalid.under("moment_about").under(name))?;
            }
            match structure.length {
                Some(_) if dimension == 3 => {
                    return Err(Invalid::new(format!("{name}.length"), "a length is for scenes of dimension 2"));
                }
                Some(length) if length <= 0.0 => {
                    let message = format!("must be greater than 0, got {length} m");
                    return Err(Invalid::new(format!("{name}.length"), message));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let resolution = *world.resource::<Resolution>();
        let walls = body_shapes(world);
        let mut earlier: Vec<(String, BodyShape)> = Vec::new();
        for (index, (name, spec)) in self.0.into_iter().enumerate() {
            let particles = solid_particles(&spec.shape, resolution.spacing, resolution.dimension);
            if particles.is_empty() && matches!(spec.shape, Shape::Difference { .. }) {
                return Err(Invalid::new(format!("{name}.shape"), NOTHING_LEFT).into());
            }
            let (low, high) = spec.shape.bounds();
            let across = (high - low).to_array()[..resolution.dimension].iter().copied().fold(f64::INFINITY, f64::min);
            if particles.len() < 2 || across < resolution.spacing {
                let (across, spacing) = (short(across), plain(resolution.spacing));
                let message = format!("is {across} m thin, less than a particle at a spacing of {spacing} m");
                return Err(Invalid::new(format!("{name}.shape"), message).into());
            }
            let volume: f64 = particles.iter().map(|particle| particle.volume).sum();
            let centroid = particles.iter().map(|particle| particle.position * particle.volume).sum::<DVec3>() / volume;
            if spec.moment_about.is_none() {
                let path = format!("{}.{name}.moment_about", Self::NAME);
                let [x, y, z] = centroid.to_array();
                world.resource_mut::<SceneFacts>().resolve(&path, format!("({x}, {y}, {z}) m, the centroid"));
            }
            let structure = Structure {
                length: spec.length.unwrap_or(1.0),
                moment_about: spec.moment_about.map_or(centroid, Point::position),
                volume,
                displaced: 0.0,
            };
            let body = Body { name, index: index as u32 };
            let shape = BodyShape { shape: spec.shape, solid_inside: true, cut: None };
            let deep = |other: &BodyShape| {
                let sides = world.resource::<PeriodicSides>();
                let depth = |x| -other.clearance_through(sides, x);
                particles.iter().any(|particle| depth(particle.position) > OVERLAP * resolution.spacing)
            };
            if let Some((other, _)) = earlier.iter().find(|(_, other)| deep(other)) {
                let path = format!("{}.shape", body.name);
                return Err(Invalid::new(path, format!("overlaps the structure `{other}`")).into());
            }
            let buried = |wall: &BodyShape| {
                let sides = world.resource::<PeriodicSides>();
                particles.iter().all(|particle| wall.clearance_through(sides, particle.position) < 0.0)
            };
            if let Some((wall, ..)) = walls.iter().find(|(_, wall, _)| buried(wall)) {
                let path = format!("{}.shape", body.name);
                return Err(Invalid::new(path, format!("lies in the wall `{wall}`, where no fluid reaches it")).into());
            }
            earlier.push((body.name.clone(), shape.clone()));
            let particles = particles.into_iter().map(|particle| (particle.position, particle.volume));
            let entity = spawn_body::<Solid>(world, body, shape, spec.motion, spec.slip, particles);
            world.entity_mut(entity).insert(structure);
        }
        Ok(())
    }
}
