//! Periodic sides hold for bodies, too.

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::particles::{Fluid, Mass, Position, Pressure, Velocity, Wall};

use crate::support::{advance, app, periodic_box, tank};

/// Fluid particles left by a cylinder at `x`.
fn particles_around_a_cylinder_at(x: f64) -> usize {
    let body = format!(r#"structures: {{ "body": (shape: Circle(center: ({x:?}, 0.5), radius: 0.2)) }}, phases:"#);
    let mut app = app(&periodic_box(2).replace("phases:", &body), &["equation_of_state.background_pressure=0.0"]);
    let world = app.world_mut();
    world.query_filtered::<(), With<Fluid>>().iter(world).count()
}

#[test]
fn a_structure_on_a_side_displaces_as_much_as_in_the_middle() {
    let middle = particles_around_a_cylinder_at(0.5);
    assert!(middle < 380, "{middle}");
    assert_eq!(particles_around_a_cylinder_at(0.0), middle);
    assert_eq!(particles_around_a_cylinder_at(1.0), middle);
}

#[test]
fn a_moving_wall_goes_round() {
    // A lid that has gone through the period several times still covers the fluid and still drags it.
    let text = r#"Scene(
        dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 10.0, periodic: (x: (0.0, 0.5)),
        equation_of_state: (max_speed: 2.0, background_pressure: 100.0),
        phases: { "oil": (reference_density: 1000.0, rheology: Newtonian(viscosity: 50.0)) },
        fluids: [(phase: "oil", shape: Box(min: (0.0, 0.0), max: (0.5, 0.5)), pressure: Uniform(0.0))],
        walls: {
            "lid": (
                shape: Box(min: (0.0, 0.0), max: (0.5, 0.5)),
                cut: Box(min: (-1.0, -1.0), max: (1.5, 0.25)),
                motion: Translation(velocity: (2.0, 0.0)),
            ),
            "floor": (shape: Box(min: (0.0, 0.0), max: (0.5, 0.5)), cut: Box(min: (-1.0, 0.25), max: (1.5, 1.5))),
        },
    )"#;
    let mut app = app(text, &[]);
    let world = app.world_mut();
    let momentum = |world: &mut World| -> f64 {
        world.query_filtered::<(&Mass, &Velocity), With<Fluid>>().iter(world).map(|(m, v)| m.0 * v.0.x).sum()
    };
    while world.resource::<storegga::clock::Clock>().time < 3.0 {
        advance(world, 50);
    }
    for x in world.query_filtered::<&Position, With<Wall>>().iter(world) {
        assert!((-0.1..=0.6).contains(&x.0.x), "a ghost is at {}", x.0);
    }
    // Steady plane Couette flow (after six times H²/(π²ν)): the mean velocity is half the lid's.
    let steady = 1000.0 * 0.25 * 1.0;
    let found = momentum(world);
    assert!((found - steady).abs() < 0.03 * steady, "{found} kg m/s, steady {steady} kg m/s");
}

#[test]
fn air_between_two_waters_carries_no_pressure() {
    let text =
        tank(2).replace("fluids: [", r#"fluids: [(phase: "water", shape: Box(min: (0.3, 0.7), max: (0.7, 0.9))), "#);
    let mut app = app(&text, &[]);
    let world = app.world_mut();
    let deepest = world
        .query_filtered::<(&Position, &Pressure), With<Fluid>>()
        .iter(world)
        .filter(|(x, _)| (x.0 - DVec3::new(0.5, 0.0, 0.0)).length() < 0.1)
        .map(|(_, p)| p.0)
        .fold(0.0, f64::max);
    assert!((deepest - 1000.0 * 9.81 * 0.475).abs() < 0.01 * deepest, "{deepest} Pa");
}
