//! The settling phase: a ramp of gravity, and damping.

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{StopFlag, run};
use storegga::boundary::Load;
use storegga::outputs::OutputTimes;
use storegga::particles::{Fluid, Mass, Velocity};
use storegga::physics::Gravity;

use crate::support::{advance, app, disturb, evaluate, periodic_box};

/// Viscous oil 0.5 m deep on a floor that reports its load, periodic in x; gravity is ramped up until 1 s.
fn ramped_column() -> App {
    let text = r#"Scene(
        dimension: 2, spacing: 0.05, gravity: (0.0, -9.81), end_time: 10.0, periodic: (x: (0.0, 0.3)),
        equation_of_state: (max_speed: 2.5), settling: GravityRamp(until: 1.0),
        phases: { "oil": (reference_density: 1000.0, rheology: Newtonian(viscosity: 20.0)) },
        fluids: [(phase: "oil", shape: Box(min: (0.0, 0.0), max: (0.3, 0.5)), pressure: Uniform(0.0))],
        structures: { "floor": (shape: Box(min: (0.0, -0.2), max: (0.3, 0.0))) },
    )"#;
    app(text, &[])
}

#[test]
fn the_weight_on_the_floor_follows_the_ramp() {
    let mut app = ramped_column();
    let world = app.world_mut();
    let weight: f64 = world.query_filtered::<&Mass, With<Fluid>>().iter(world).map(|m| m.0 * 9.81).sum();
    assert_eq!(world.resource::<Gravity>().now, DVec3::ZERO, "a ramp begins at nothing");
    // A smooth ramp is antisymmetric about its middle: half the weight at half its time.
    for (time, fraction) in [(0.5, 0.5), (1.0, 1.0), (1.25, 1.0)] {
        run(world, time, &StopFlag::default(), |_| {});
        let gravity = *world.resource::<Gravity>();
        assert!((gravity.now - fraction * gravity.full).length() < 1e-12, "at {time} s {}", gravity.now);
        let load = world.query::<&Load>().single(world).expect("one structure").force();
        assert!((load.y + fraction * weight).abs() < 0.03 * weight, "at {time} s {} N/m of {weight} N/m", load.y);
    }
}

#[test]
fn gravity_grows_all_along_the_ramp() {
    let mut app = ramped_column();
    let world = app.world_mut();
    let mut last = 0.0;
    for k in 1..=10 {
        run(world, 0.1 * f64::from(k), &StopFlag::default(), |_| {});
        let now = -world.resource::<Gravity>().now.y;
        assert!(now > last, "{now} m/s² after {last} m/s²");
        last = now;
    }
    assert_eq!(last, 9.81);
}

/// A periodic box of fluid whose velocities are damped at `rate` (1/s).
fn damped(rate: &str) -> App {
    let text = periodic_box(2).replace("phases:", &format!("settling: Damping(until: 100.0, rate: {rate}), phases:"));
    app(&text, &[])
}

#[test]
fn a_uniform_flow_decays_exponentially() {
    let mut app = damped("30.0");
    let world = app.world_mut();
    let start = DVec3::new(0.8, -0.3, 0.0);
    disturb(world, 2, 0.0, |_| start);
    evaluate(world);
    // Outputs make steps uneven.
    world.insert_resource(OutputTimes::new(f64::INFINITY, 0.0037));
    for time in [0.01, 0.1, 0.3] {
        run(world, time, &StopFlag::default(), |_| {});
        let exact = start * (-30.0 * time).exp();
        for v in world.query_filtered::<&Velocity, With<Fluid>>().iter(world) {
            assert!((v.0 - exact).length() < 1e-6 * exact.length(), "after {time} s {}, exact {exact}", v.0);
        }
    }
}

fn kinetic_energy(world: &mut World) -> f64 {
    let mut fluid = world.query_filtered::<(&Mass, &Velocity), With<Fluid>>();
    fluid.iter(world).map(|(m, v)| 0.5 * m.0 * v.0.length_squared()).sum()
}

#[test]
fn no_rate_of_damping_is_too_great() {
    for rate in ["1e2", "1e4", "1e6"] {
        let mut app = damped(rate);
        let world = app.world_mut();
        disturb(world, 2, 0.0, |_| DVec3::X);
        evaluate(world);
        let start = kinetic_energy(world);
        let mut last = start;
        // Every step, the first one after the start too.
        for step in 1..=30 {
            advance(world, 1);
            let now = kinetic_energy(world);
            assert!(now <= last + 1e-20 * start, "rate {rate}/s, step {step}: {now} J after {last} J");
            last = now;
        }
        assert!(last < 0.1 * start, "rate {rate}/s: {last} J of {start} J left");
    }
}
