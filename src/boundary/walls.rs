//! Walls of a scene: layers of ghost particles, as deep as the kernel reaches.

use bevy_ecs::prelude::*;
use glam::DVec3;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::body::{Body, BodyShape, spawn_body};
use super::overlap::EarlierWalls;
use super::{Motion, Structure};
use crate::kernels::SmoothingKernel;
use crate::neighbours::PeriodicSides;
use crate::number::plain;
use crate::particles::{Slip, Wall};
use crate::scene::geometry::{Shape, Side, ghost_layers};
use crate::scene::{Invalid, Resolution, SceneSection, SectionError, limit_memory, limit_particles};

/// Section `walls`: bodies of ghost particles, by name. Where walls overlap, the first has the ghosts, and its slip holds; walls
/// that move differently must not overlap at the start.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct WallsSection(IndexMap<String, WallSpec>);

/// A wall of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WallSpec {
    /// Surface of the wall (m).
    #[schemars(extend("unit" = "m"))]
    pub shape: Shape,
    /// On which side of the surface the fluid is.
    #[serde(default)]
    pub fluid: FluidSide,
    /// Whether the fluid sticks to the wall.
    #[serde(default)]
    pub slip: Slip,
    /// Where the wall is left out: an open top, a door (m).
    #[serde(default)]
    #[schemars(extend("unit" = "m", "derived" = "nothing"))]
    pub cut: Option<Shape>,
    /// How the wall moves.
    #[serde(default)]
    pub motion: Motion,
}

/// Side of a wall's surface on which the fluid is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum FluidSide {
    /// Inside the shape: the wall is a container.
    #[default]
    Inside,
    /// Outside the shape: the wall is an obstacle.
    Outside,
}

impl WallSpec {
    /// The side of the surface on which its ghosts are.
    fn side(&self) -> Side {
        if self.fluid == FluidSide::Inside { Side::Outside } else { Side::Inside }
    }
}

impl WallsSection {
    /// The shapes that are lined, and on which side.
    pub(crate) fn shapes(self) -> Vec<(Shape, Side)> {
        self.0.into_values().map(|wall| (wall.shape.clone(), wall.side())).collect()
    }
}

impl SceneSection for WallsSection {
    const NAME: &'static str = "walls";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn check(&self, world: &World) -> Result<(), Invalid> {
        let dimension = world.resource::<Resolution>().dimension;
        for (name, wall) in &self.0 {
            wall.shape.check(dimension).map_err(|invalid| invalid.under("shape").under(name))?;
            if let Some(cut) = &wall.cut {
                cut.check(dimension).map_err(|invalid| invalid.under("cut").under(name))?;
            }
            wall.motion.check(dimension).map_err(|invalid| invalid.under("motion").under(name))?;
            if wall.motion.turns() && world.resource::<PeriodicSides>().any() {
                return Err(Invalid::new(format!("{name}.motion"), "a body cannot turn between periodic sides"));
            }
            limit_particles(wall.shape.bounds(), world.resource::<Resolution>())
                .map_err(|invalid| invalid.under("shape").under(name))?;
        }
        Ok(())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        limit_memory(world)?;
        let resolution = *world.resource::<Resolution>();
        let periodic = *world.resource::<PeriodicSides>();
        let layers = ghost_layer_count(world.resource::<SmoothingKernel>(), &resolution);
        let mut earlier = EarlierWalls::new(&resolution, layers, periodic);
        for (index, (name, wall)) in self.0.into_iter().enumerate() {
            let side = wall.side();
            let ghosts =
                ghost_layers(&wall.shape, side, layers, resolution.spacing, resolution.dimension, wall.cut.as_ref());
            // Beyond a periodic side a container's own images continue it, and so do those of an obstacle that reaches right
            // across; the rest of an obstacle comes in again at the other side.
            let continued = |x: DVec3| {
                let there = periodic.wrap(x);
                // On the side itself, to rounding, a ghost is where it should be.
                side == Side::Outside || there.distance(x) > 0.5 * resolution.spacing && wall.shape.contains(there)
            };
            let mut ghosts: Vec<_> = ghosts.into_iter().filter(|x| periodic.contains(*x) || !continued(*x)).collect();
            if ghosts.is_empty() {
                let message = format!("no ghost particle fits at a spacing of {} m", plain(resolution.spacing));
                return Err(Invalid::new(format!("{name}.shape"), message).into());
            }
            let left_out = earlier.leave_out(&mut ghosts, &wall.motion, wall.slip).map_err(|other| {
                let message =
                    format!("overlaps the wall `{other}`, which moves otherwise: `cut` one of them where the other is");
                Invalid::new(format!("{name}.shape"), message)
            })?;
            let shape = BodyShape { shape: wall.shape, solid_inside: wall.fluid == FluidSide::Outside, cut: wall.cut };
            earlier.add(&name, &shape, &wall.motion, wall.slip, &ghosts);
            let body = Body { name, index: index as u32 };
            let volume = resolution.particle_volume();
            let particles = ghosts.into_iter().map(|x| (x, volume));
            let entity = spawn_body::<Wall>(world, body, shape, wall.motion, wall.slip, particles);
            if let Some(left_out) = left_out {
                world.entity_mut(entity).insert(left_out);
            }
        }
        Ok(())
    }
}

/// Layers of ghosts of a wall: as deep as the kernel reaches.
pub(crate) fn ghost_layer_count(kernel: &SmoothingKernel, resolution: &Resolution) -> usize {
    (kernel.0.radius() / resolution.spacing).ceil() as usize
}

/// Shape of every wall and structure: where no fluid goes. Name, shape, and whether it is a structure.
pub(crate) fn body_shapes(world: &mut World) -> Vec<(String, BodyShape, bool)> {
    let mut bodies = world.query::<(&Body, &BodyShape, Has<Structure>)>();
    let mut found: Vec<_> = bodies.iter(world).collect();
    found.sort_by_key(|(body, _, is_structure)| (*is_structure, body.index));
    found.into_iter().map(|(body, shape, is_structure)| (body.name.clone(), shape.clone(), is_structure)).collect()
}
