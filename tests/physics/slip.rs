//! Walls along which the fluid slips, and walls to which it sticks.

use std::f64::consts::PI;

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{StopFlag, run};
use storegga::boundary::Load;
use storegga::particles::{Fluid, Position, ShearRate, Velocity};

use crate::support::{app, disturb, evaluate, periodic_box};

/// Oil between two plates 1 m apart, periodic along them, that starts with 1 m/s.
fn plates(slip: &str) -> App {
    let text = format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 10.0, periodic: (x: (0.0, 0.3)),
            equation_of_state: (max_speed: 1.0), strain_rate: (),
            phases: {{ "oil": (reference_density: 1000.0, rheology: Newtonian(viscosity: 100.0)) }},
            fluids: [(
                phase: "oil", shape: Box(min: (0.0, 0.0), max: (0.3, 1.0)),
                velocity: (1.0, 0.0), pressure: Uniform(0.0),
            )],
            walls: {{ "plates": (shape: Box(min: (-1.0, 0.0), max: (1.3, 1.0)), slip: {slip}) }},
        )"#
    );
    app(&text, &[])
}

/// Mean velocity (m/s) along the plates after `end` (s).
fn mean_velocity(slip: &str, end: f64) -> f64 {
    let mut app = plates(slip);
    let world = app.world_mut();
    run(world, end, &StopFlag::default(), |_| {});
    let speeds: Vec<f64> = world.query_filtered::<&Velocity, With<Fluid>>().iter(world).map(|v| v.0.x).collect();
    speeds.iter().sum::<f64>() / speeds.len() as f64
}

#[test]
fn fluid_slides_along_a_free_slip_wall_for_ever() {
    let kept = mean_velocity("FreeSlip", 1.0);
    assert!((kept - 1.0).abs() < 1e-3, "{kept} m/s");
}

#[test]
fn a_no_slip_wall_brakes_the_fluid() {
    // Decay of a plug flow between two plates: ū = Σ 8/(n²π²) e^(−n²π²νt/H²), n = 1, 3, 5 …, with ν = 0.1 m²/s.
    for time in [0.3, 1.0] {
        let exact: f64 = (0..50)
            .map(|k| PI * f64::from(2 * k + 1))
            .map(|wave| 8.0 / (wave * wave) * (-wave * wave * 0.1 * time).exp())
            .sum();
        let found = mean_velocity("NoSlip", time);
        assert!((found - exact).abs() < 0.03 * exact, "after {time} s {found} m/s, exact {exact} m/s");
    }
}

#[test]
fn a_free_slip_wall_does_not_enter_the_shear_rate() {
    let mut app = plates("FreeSlip");
    let world = app.world_mut();
    // Simple shear, at the walls too: corrected for the missing neighbours, γ̇ is exact.
    disturb(world, 2, 0.0, |x| DVec3::X * (0.2 + 0.7 * x.y));
    evaluate(world);
    for (x, rate) in world.query_filtered::<(&Position, &ShearRate), With<Fluid>>().iter(world) {
        assert!((rate.0 - 0.7).abs() < 1e-10, "γ̇ = {} 1/s at {}", rate.0, x.0);
    }
}

/// The load on a cylinder in a uniform stream that has just set in.
fn load_in_a_stream(slip: &str) -> Load {
    let body =
        format!(r#"structures: {{ "body": (shape: Circle(center: (0.5, 0.5), radius: 0.2), slip: {slip}) }}, phases:"#);
    let mut app = app(&periodic_box(2).replace("phases:", &body), &[]);
    let world = app.world_mut();
    disturb(world, 2, 0.005, |_| DVec3::X);
    evaluate(world);
    let load = *world.query::<&Load>().single(world).expect("one structure");
    // Around a body that brings no shear a uniform stream has none.
    let shear: Vec<f64> = world.query_filtered::<&ShearRate, With<Fluid>>().iter(world).map(|rate| rate.0).collect();
    assert_eq!(slip == "FreeSlip", shear.iter().all(|rate| *rate < 1e-10), "{slip}");
    load
}

#[test]
fn a_free_slip_structure_feels_no_viscous_force() {
    assert_eq!(load_in_a_stream("FreeSlip").viscous_force, DVec3::ZERO);
    let held = load_in_a_stream("NoSlip").viscous_force;
    assert!(held.x > 1.0 && held.y.abs() < held.x, "a structure in a stream is dragged along: {held} N/m");
}
