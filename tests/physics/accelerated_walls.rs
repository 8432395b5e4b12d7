//! Eq. 15 beside walls that are accelerated: the fluid's pressure continues with the slope ρ (g − a_w).

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{StopFlag, run};
use storegga::particles::{Fluid, GhostVelocity, Position, Pressure, Velocity, Wall, WallAcceleration};

use crate::support::{app, evaluate, press, tank};

#[test]
fn the_pressure_in_an_accelerated_wall_continues_that_of_the_fluid() {
    for dimension in [2, 3] {
        // So stiff that ρ is ρ0.
        let mut app = app(&tank(dimension).replace("phases:", "equation_of_state: (max_speed: 50.0), phases:"), &[]);
        let world = app.world_mut();
        let (a_w, g) = if dimension == 2 {
            (DVec3::new(2.0, 4.0, 0.0), DVec3::new(0.0, -9.81, 0.0))
        } else {
            (DVec3::new(2.0, -3.0, 4.0), DVec3::new(0.0, 0.0, -9.81))
        };
        world.query_filtered::<&mut WallAcceleration, With<Wall>>().iter_mut(world).for_each(|mut a| a.0 = a_w);
        // At rest in the frame of the tank: ∇p = ρ (g − a_w).
        let exact = |x: DVec3| 12e3 + 1000.0 * (g - a_w).dot(x);
        press(world, exact);
        evaluate(world);
        let mut wet = 0;
        for (x, p) in world.query_filtered::<(&Position, &Pressure), With<Wall>>().iter(world) {
            // A ghost without fluid near it has none to continue.
            if p.0 != 0.0 {
                wet += 1;
                assert!((p.0 - exact(x.0)).abs() < 5.0, "{dimension}D at {}: {} Pa, exact {} Pa", x.0, p.0, exact(x.0));
            }
        }
        assert!(wet > 50, "only {wet} ghosts compared");
    }
}

/// A closed tank full of oil, drawn to the right from rest with 5 m/s² from t = 0 on. Rows every 0.1 s make a cubic
/// that is ½ a t² but for the first and last pieces.
fn drawn_tank() -> String {
    let rows: Vec<String> = (-2..=8)
        .map(|k| f64::from(k) * 0.1)
        .map(|t| format!("(time: {t:?}, displacement: ({:?}, 0.0))", 0.5 * 5.0 * t * t))
        .collect();
    format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 1.0,
            equation_of_state: (max_speed: 2.5, background_pressure: 10000.0), momentum: (),
            phases: {{ "oil": (reference_density: 1000.0, rheology: Newtonian(viscosity: 20.0)) }},
            fluids: [(phase: "oil", shape: Box(min: (0.0, 0.0), max: (1.0, 0.5)), pressure: Uniform(0.0))],
            walls: {{ "tank": (
                shape: Box(min: (0.0, 0.0), max: (1.0, 0.5)),
                motion: Table(center: (0.0, 0.0), rows: [{}]),
            ) }},
        )"#,
        rows.join(", ")
    )
}

#[test]
fn oil_in_an_accelerated_tank_is_pushed_by_the_wall_behind_it() {
    let mut app = app(&drawn_tank(), &[]);
    let world = app.world_mut();
    press(world, |x| 10e3 - 1000.0 * 5.0 * (x.x - 0.5));
    let time = 0.2;
    run(world, time, &StopFlag::default(), |_| {});
    let travelled = 0.5 * 5.0 * time * time;
    let (mut products, mut squares, mut speed, mut count) = (0.0, 0.0, 0.0, 0.0);
    for (x, p, v) in world.query_filtered::<(&Position, &Pressure, &Velocity), With<Fluid>>().iter(world) {
        let s = x.0.x - travelled - 0.5;
        (products, squares) = (products + s * (p.0 - 10e3), squares + s * s);
        (speed, count) = (speed + v.0.x, count + 1.0);
    }
    let slope = products / squares;
    assert!((slope / -5000.0 - 1.0).abs() < 0.05, "{slope} Pa/m, exact −5000 Pa/m");
    assert!((speed / count - 5.0 * time).abs() < 0.02 * 5.0 * time, "{} m/s", speed / count);
}

/// A drum full of oil that turns with it like a rigid body, at its start.
const DRUM: &str = r#"Scene(
    dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 1.0, equation_of_state: (max_speed: 20.0),
    phases: { "oil": (reference_density: 1000.0, rheology: Newtonian(viscosity: 20.0)) },
    fluids: [(
        phase: "oil",
        shape: Circle(center: (0.2, -0.1), radius: 1.0),
        rotation: (center: (0.2, -0.1), rate: 3.0),
        pressure: Centrifugal(100.0),
    )],
    walls: { "drum": (
        shape: Circle(center: (0.2, -0.1), radius: 1.0),
        motion: Rotation(center: (0.2, -0.1), rate: 3.0),
    ) },
)"#;

/// With a_w of the ghosts alone, Eq. 15 adds up to 1/2 ρ ω² (3h)² to their pressure, 146 Pa; with 2 v_w − ⟨v_f⟩ alone, Eq. 16 makes
/// them up to 0.5 m/s too fast.
#[test]
fn a_drum_continues_the_rigid_rotation_of_its_fluid() {
    let mut app = app(DRUM, &[]);
    let world = app.world_mut();
    evaluate(world);
    let arm = |x: DVec3| x - DVec3::new(0.2, -0.1, 0.0);
    let mut wet = 0;
    for (x, p, v) in world.query_filtered::<(&Position, &Pressure, &GhostVelocity), With<Wall>>().iter(world) {
        if p.0 != 0.0 {
            wet += 1;
            let (pressure, velocity) = (100.0 + 4500.0 * arm(x.0).length_squared(), 3.0 * DVec3::Z.cross(arm(x.0)));
            // The fluid is compressed by up to p/B = 1e-4, and so is the sum with ρ_f.
            assert!((p.0 - pressure).abs() < 1.0, "at {}: {} Pa, exact {pressure} Pa", x.0, p.0);
            assert!(v.0.distance(velocity) < 1e-12, "at {}: {} m/s, exact {velocity} m/s", x.0, v.0);
        }
    }
    assert!(wet > 200, "only {wet} ghosts compared");
}
