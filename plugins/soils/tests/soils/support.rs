//! Small scenes with the soils in them.

use bevy_app::{App, PluginGroup};
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{PaperPlugins, open};
use storegga::clock::Clock;
use storegga::neighbours::Neighbours;
use storegga::particles::{Fluid, Position, Velocity};
use storegga::scene::Document;
use storegga::schedule::Step;
use storegga_soils::SoilsPlugin;

/// The scene `text` at its start.
pub fn app(text: &str) -> App {
    let document = Document::parse("test.ron", text).unwrap_or_else(|error| panic!("{}", error.render(false)));
    open(PaperPlugins.build().add(SoilsPlugin), document).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// Gives every fluid particle the velocity `velocity(x)` and finds what follows from it, without letting time pass.
pub fn set_velocity(world: &mut World, velocity: impl Fn(DVec3) -> DVec3) {
    for (x, mut v) in world.query_filtered::<(&Position, &mut Velocity), With<Fluid>>().iter_mut(world) {
        v.0 = velocity(x.0);
    }
    world.resource_mut::<Neighbours>().invalidate();
    world.resource_mut::<Clock>().time_step = 0.0;
    world.run_schedule(Step);
}
