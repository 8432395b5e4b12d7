//! The tank that all benches step.

use bevy_app::App;
use bevy_ecs::prelude::*;
use storegga::app::{PaperPlugins, open};
use storegga::clock::Clock;
use storegga::particles::Fluid;
use storegga::scene::Document;
use storegga::schedule::Step;

/// The two-phase tank in the plane (the paper's section 3.1) or in space with some values overridden, after some steps, and its
/// number of fluid particles.
pub fn tank(dimension: usize, overrides: &[(&str, &str)]) -> (App, u64) {
    let (name, text) = if dimension == 2 {
        ("two_phase_tank.ron", include_str!("../../scenes/two_phase_tank.ron"))
    } else {
        ("tank_3d.ron", include_str!("../../scenes/tank_3d.ron"))
    };
    // The expectations of the shipped scene, and probes but `Books`, take no part in a step.
    let overrides = [("expect", "[]")].into_iter().chain(overrides.iter().copied());
    let document = overrides
        .fold(Document::parse(name, text), |scene, (path, value)| scene.and_then(|scene| scene.set(path, value)));
    let mut app = document.and_then(|scene| open(PaperPlugins, scene)).expect("the shipped scene is right");
    let world = app.world_mut();
    for _ in 0..3 {
        step(world);
    }
    let particles = world.query_filtered::<(), With<Fluid>>().iter(world).count() as u64;
    (app, particles)
}

/// One step, as long as it may be.
pub fn step(world: &mut World) {
    world.resource_mut::<Clock>().begin_step(f64::INFINITY);
    world.run_schedule(Step);
}
