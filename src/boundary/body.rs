//! What walls and structures have in common.

use bevy_ecs::prelude::*;
use glam::DVec3;

use super::{InverseMotion, Motion};
use crate::neighbours::PeriodicSides;
use crate::particles::{BodyIndex, Position, RestPosition, Slip, Volume};
use crate::scene::geometry::Shape;

/// A wall or a structure, made of particles.
#[derive(Component, Debug, Clone, PartialEq)]
pub struct Body {
    /// Name in the scene.
    pub name: String,
    /// Index in the order of the scene, as in [`BodyIndex`]; walls and structures are counted apart.
    pub index: u32,
}

/// Where a body is: fluid does not fill it.
#[derive(Component, Debug, Clone, PartialEq)]
pub struct BodyShape {
    /// The shape.
    pub shape: Shape,
    /// Whether the body is what lies inside the shape (an obstacle, a structure) or outside (a container).
    pub solid_inside: bool,
    /// Part of the surface that is open.
    pub cut: Option<Shape>,
}

impl BodyShape {
    /// Distance (m) of a position from the body: negative in it, infinite behind an opening.
    #[must_use]
    pub fn clearance(&self, position: DVec3) -> f64 {
        if self.cut.as_ref().is_some_and(|cut| cut.contains(position)) {
            return f64::INFINITY;
        }
        let distance = self.shape.signed_distance(position);
        if self.solid_inside { distance } else { -distance }
    }

    /// The same through periodic sides: the least over the images of an obstacle or structure.
    #[must_use]
    pub fn clearance_through(&self, sides: &PeriodicSides, position: DVec3) -> f64 {
        let own = self.clearance(position);
        if !self.solid_inside || !sides.any() {
            return own;
        }
        sides.images_of(position).map(|image| self.clearance(image)).fold(own, f64::min)
    }

    /// The same from the body where it has moved to; `moved` is the way back, nothing for a body at rest.
    #[must_use]
    pub fn clearance_moved(&self, sides: &PeriodicSides, moved: Option<&InverseMotion>, position: DVec3) -> f64 {
        let at_rest = moved.map_or(position, |moved| sides.wrap(moved.rest_of(position)));
        self.clearance_through(sides, at_rest)
    }
}

/// Spawns a body and its particles, each marked with `M`.
pub(super) fn spawn_body<M: Component + Default>(
    world: &mut World,
    body: Body,
    shape: BodyShape,
    motion: Motion,
    slip: Slip,
    particles: impl IntoIterator<Item = (DVec3, f64)>,
) -> Entity {
    let index = BodyIndex(body.index);
    let bundles: Vec<_> = particles
        .into_iter()
        .map(|(x, volume)| (M::default(), index, slip, Position(x), RestPosition(x), Volume(volume)))
        .collect();
    world.spawn_batch(bundles);
    world.spawn((body, shape, motion)).id()
}
