//! Small scenes with the plugin, and ways to look into them.

use bevy_app::{App, PluginGroup};
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{End, PaperPlugins, StopFlag, open, run};
use storegga::clock::Clock;
use storegga::error::UserError;
use storegga::neighbours::Neighbours;
use storegga::particles::{Density, Fluid, Mass, ParticleId, Position, ReferenceDensity, Velocity};
use storegga::physics::EquationOfState;
use storegga::scene::{Document, Resolution};
use storegga::schedule::Step;
use storegga_flow::FlowPlugin;

fn opened(file: &str, text: &str) -> Result<App, UserError> {
    open(PaperPlugins.build().add(FlowPlugin), Document::parse(file, text)?)
}

/// The scene `text`, in the file called `file`, at its start.
pub fn app_in(file: &str, text: &str) -> App {
    opened(file, text).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// The scene `text` at its start.
pub fn app(text: &str) -> App {
    app_in("test.ron", text)
}

/// What is said of the scene `text` in the file called `file`.
pub fn refusal(file: &str, text: &str) -> String {
    match opened(file, text) {
        Ok(_) => panic!("the scene was accepted:\n{text}"),
        Err(error) => error.render(false),
    }
}

/// Runs up to `time` (s).
pub fn run_until(world: &mut World, time: f64) {
    assert_eq!(run(world, time, &StopFlag::default(), |_| {}), End::Done);
}

/// Recomputes everything that depends on positions and velocities, without letting time pass.
pub fn evaluate(world: &mut World) {
    world.resource_mut::<Neighbours>().invalidate();
    world.resource_mut::<Clock>().time_step = 0.0;
    world.run_schedule(Step);
}

/// Position (m) and velocity (m/s) of every fluid particle, in the order of their identities.
pub fn motion(world: &mut World) -> Vec<(DVec3, DVec3)> {
    let mut fluid = world.query_filtered::<(&ParticleId, &Position, &Velocity), With<Fluid>>();
    let mut found: Vec<_> = fluid.iter(world).map(|(id, x, v)| (id.0, x.0, v.0)).collect();
    found.sort_by_key(|(id, ..)| *id);
    found.into_iter().map(|(_, x, v)| (x, v)).collect()
}

/// Gives every fluid particle the velocity `velocity(x)`.
pub fn stir(world: &mut World, velocity: impl Fn(DVec3) -> DVec3) {
    world.query_filtered::<(&Position, &mut Velocity), With<Fluid>>().iter_mut(world).for_each(|(x, mut v)| {
        v.0 = velocity(x.0);
    });
    evaluate(world);
}

/// Gives every fluid particle the pressure `pressure(x)` (Pa) and the mass with which it fills its cell of the lattice.
pub fn press(world: &mut World, pressure: impl Fn(DVec3) -> f64) {
    let state = *world.resource::<EquationOfState>();
    let volume = world.resource::<Resolution>().particle_volume();
    let mut fluid = world.query_filtered::<(&Position, &ReferenceDensity, &mut Density, &mut Mass), With<Fluid>>();
    for (x, rho0, mut rho, mut m) in fluid.iter_mut(world) {
        rho.0 = rho0.0 * state.compression(pressure(x.0));
        m.0 = rho.0 * volume;
    }
    evaluate(world);
}
