//! Periodic sides hold for bodies, too.

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::boundary::Load;
use storegga::particles::{Fluid, Mass, Position, Pressure, Solid, Velocity, Wall};

use crate::support::{advance, app, evaluate, periodic_box, refusal, tank};

/// The periodic box with more sections, its fluids cut by the shapes `minus`.
fn cut_box(sections: &str, minus: &str) -> App {
    let mut text = periodic_box(2).replace("phases:", &format!("{sections} phases:"));
    for shape in ["Box(min: (0.0, 0.5), max: (1.0, 1.0))", "Box(min: (0.0, 0.0), max: (1.0, 0.5))"] {
        text = text.replace(shape, &format!("Difference(of: {shape}, minus: [{minus}])"));
    }
    app(&text, &["equation_of_state.background_pressure=0.0"])
}

/// The periodic box with a cylinder at `x`: a structure, or a wall around which the fluid is.
fn with_cylinder(section: &str, x: f64) -> App {
    let circle = |x: f64| format!("Circle(center: ({x:?}, 0.5), radius: 0.2)");
    let (more, minus) = match section {
        "walls" => (", fluid: Outside", [x - 1.0, x, x + 1.0].map(circle).join(", ")),
        // Structures displace fluid by themselves: nothing is cut.
        _ => ("", circle(9.0)),
    };
    cut_box(&format!(r#"{section}: {{ "body": (shape: {}{more}) }},"#, circle(x)), &minus)
}

/// Particles of the fluid, and ghosts of walls and structures.
fn counts(app: &mut App) -> [usize; 3] {
    let world = app.world_mut();
    [
        world.query_filtered::<(), With<Fluid>>().iter(world).count(),
        world.query_filtered::<(), With<Wall>>().iter(world).count(),
        world.query_filtered::<(), With<Solid>>().iter(world).count(),
    ]
}

#[test]
fn a_body_on_a_side_is_as_whole_as_in_the_middle() {
    for section in ["structures", "walls"] {
        let middle = counts(&mut with_cylinder(section, 0.5));
        assert!(middle[0] < 380 && middle[1] + middle[2] > 30, "{middle:?}");
        for x in [0.0, 1.0] {
            assert_eq!(counts(&mut with_cylinder(section, x)), middle, "{section} at {x}");
        }
    }
}

#[test]
fn an_obstacle_right_across_has_its_ghosts_once() {
    // A sill that is longer than the period: 20 by 4 of the box's 20 by 20 places are ghosts.
    let shape = "Box(min: (-0.5, 0.4), max: (1.5, 0.6))";
    let sill = format!(r#"walls: {{ "sill": (shape: {shape}, fluid: Outside) }},"#);
    assert_eq!(counts(&mut cut_box(&sill, shape)), [320, 80, 0]);
}

#[test]
fn the_moment_on_a_structure_does_not_depend_on_where_the_sides_are() {
    let text = |x: f64| {
        format!(
            r#"Scene(
            dimension: 2, spacing: 0.02, gravity: (0.0, -9.81), end_time: 1.0, periodic: (x: (0.0, 0.6)),
            phases: {{ "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)) }},
            fluids: [(phase: "water", shape: Box(min: (0.0, 0.0), max: (0.6, 0.6)))],
            walls: {{ "floor": (shape: Box(min: (0.0, 0.0), max: (0.6, 1.0)), cut: Box(min: (-1.0, 0.5), max: (2.0, 2.0))) }},
            structures: {{ "body": (shape: Circle(center: ({x:?}, 0.3), radius: 0.1)) }},
        )"#
        )
    };
    for x in [0.0, 0.3, 0.6] {
        let mut app = app(&text(x), &[]);
        evaluate(app.world_mut());
        let world = app.world_mut();
        let load = *world.query::<&Load>().single(world).expect("one structure");
        let buoyancy = load.force().y;
        assert!(buoyancy > 200.0, "{buoyancy}");
        assert!(load.moment().z.abs() < 1e-6 * buoyancy, "at {x}: {} N m", load.moment().z);
    }
}

#[test]
fn fluid_beyond_the_sides_is_refused() {
    let text = periodic_box(2).replace("max: (1.0, 1.0)", "max: (1.2, 1.0)");
    let error = refusal(&text, &[]);
    assert!(error.contains("beyond the periodic sides"), "{error}");
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
