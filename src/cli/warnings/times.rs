//! What takes longer than the run.

use bevy_ecs::prelude::*;

use crate::app::end_time;
use crate::number::short;
use crate::physics::Settling;
use crate::scene::{Invalid, SceneSection};

/// Fluids that are still settling when the run ends.
pub(super) fn endless_settling(world: &mut World) -> Vec<Invalid> {
    let end = end_time(world);
    let (until, what) = match *world.resource::<Settling>() {
        Settling::Damping { until, .. } => (until, "velocities are damped"),
        Settling::GravityRamp { until } => (until, "gravity grows"),
        Settling::Off => return Vec::new(),
    };
    let message = format!("{what} until {} s, but the run ends at {} s", short(until), short(end));
    if until > end { vec![Invalid::new(format!("{}.until", Settling::NAME), message)] } else { Vec::new() }
}
