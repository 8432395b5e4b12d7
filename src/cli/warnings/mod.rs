//! What is probably not meant in a scene that can be run.

mod bodies;
mod filling;
mod speeds;
mod surroundings;
mod times;

use bevy_ecs::prelude::*;

pub(super) use bodies::{left_out, these};

use crate::error::UserError;
use crate::scene::{Invalid, SceneDocument};

/// Warnings about the scene of a world at its start, each with its place.
pub(super) fn warnings(world: &mut World) -> Vec<UserError> {
    let found: [Vec<Invalid>; 12] = [
        filling::off_lattice(world),
        filling::periods_off_lattice(world),
        filling::thin_fluids(world),
        filling::unused_phases(world),
        surroundings::gaps(world),
        surroundings::background_pressure(world),
        bodies::buried_structures(world),
        bodies::overlapping_walls(world),
        bodies::thin_structures(world),
        speeds::fast_starts(world),
        speeds::constant_viscosities(world),
        times::endless_settling(world),
    ];
    let document = &world.resource::<SceneDocument>().0;
    found.iter().flatten().map(|invalid| document.invalid(invalid)).collect()
}

/// Warnings as they are shown.
pub(super) fn text(warnings: &[UserError], colour: bool) -> String {
    warnings.iter().map(|warning| warning.render_warning(colour)).collect()
}
