//! The scenes that benches step.

use bevy_app::App;
use bevy_ecs::prelude::*;
use storegga::app::{PaperPlugins, open};
use storegga::clock::Clock;
use storegga::particles::Fluid;
use storegga::scene::Document;
use storegga::schedule::Step;

/// A shipped scene, by name and text, without expectations and with some values overridden.
pub fn scene((name, text): (&str, &str), overrides: &[(&str, &str)]) -> App {
    // Expectations, and probes but `Books`, take no part in a step.
    let overrides = [("expect", "[]")].into_iter().chain(overrides.iter().copied());
    let document = overrides
        .fold(Document::parse(name, text), |scene, (path, value)| scene.and_then(|scene| scene.set(path, value)));
    document.and_then(|scene| open(PaperPlugins, scene)).expect("the shipped scene is right")
}

/// The two-phase tank in the plane (the paper's section 3.1) or in space.
pub fn tank_scene(dimension: usize) -> (&'static str, &'static str) {
    if dimension == 2 {
        ("two_phase_tank.ron", include_str!("../../scenes/two_phase_tank.ron"))
    } else {
        ("tank_3d.ron", include_str!("../../scenes/tank_3d.ron"))
    }
}

/// [`tank_scene`] with some values overridden, after some steps, and its number of fluid particles.
pub fn tank(dimension: usize, overrides: &[(&str, &str)]) -> (App, u64) {
    let mut app = scene(tank_scene(dimension), overrides);
    let world = app.world_mut();
    for _ in 0..3 {
        step(world);
    }
    let particles = fluid_particles(world);
    (app, particles)
}

/// How many fluid particles there are.
pub fn fluid_particles(world: &mut World) -> u64 {
    world.query_filtered::<(), With<Fluid>>().iter(world).count() as u64
}

/// One step, as long as it may be.
pub fn step(world: &mut World) {
    world.resource_mut::<Clock>().begin_step(f64::INFINITY);
    world.run_schedule(Step);
}
