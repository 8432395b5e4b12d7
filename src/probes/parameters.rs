//! Parameters that several probes share.

use bevy_ecs::prelude::*;
use glam::DVec3;

use crate::phases::phase_named;
use crate::physics::Gravity;
use crate::scene::geometry::{Point, coordinates};
use crate::scene::{Invalid, Resolution};

/// Position (m) of the field `name`.
pub(super) fn place(world: &World, name: &str, point: Point) -> Result<DVec3, Invalid> {
    coordinates(point, world.resource::<Resolution>().dimension).map_err(|invalid| invalid.under(name))?;
    Ok(point.position())
}

/// Unit vector of the field `direction`.
pub(super) fn direction(world: &World, point: Point) -> Result<DVec3, Invalid> {
    place(world, "direction", point)?
        .try_normalize()
        .ok_or_else(|| Invalid::new("direction", "must not be the null vector"))
}

/// Index of the phase that the field `phase` names.
pub(super) fn phase(world: &mut World, name: &str) -> Result<u32, Invalid> {
    phase_named(world, "phase", name).map(|(phase, _)| phase.index)
}

/// Unit vector against gravity.
pub(super) fn up(world: &World) -> Result<DVec3, Invalid> {
    let against = -world.resource::<Gravity>().full;
    against.try_normalize().ok_or_else(|| Invalid::new("", "a height needs a gravity that is not zero"))
}
