//! The stress with which a wall holds a fluid that yields, against its yield stress.

use bevy_app::App;
use bevy_ecs::prelude::*;
use storegga::particles::{Acceleration, Fluid, Mass, Position, ShearRate};

use crate::support::{app, disturb, evaluate};

/// Length (m) of the plates of [`plug`].
const LENGTH: f64 = 0.3;

/// A plug of mud without viscosity that moves with 1 m/s, or is at rest, between two plates that are at rest, or move with 1 m/s.
fn plug(head: &str, moves: &str) -> App {
    let (fluid, plates) = match moves {
        "mud" => ("velocity: (1.0, 0.0),", ""),
        _ => ("", "motion: Translation(velocity: (1.0, 0.0)),"),
    };
    let text = format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 1.0, periodic: (x: (0.0, {LENGTH})), {head}
            equation_of_state: (max_speed: 1.0),
            phases: {{ "mud": (
                reference_density: 1000.0,
                rheology: Bingham(plastic_viscosity: 0.0, yield_stress: 100.0, max_viscosity: 1e4),
            ) }},
            fluids: [
                (phase: "mud", shape: Box(min: (0.0, 0.0), max: ({LENGTH}, 1.0)), {fluid} pressure: Uniform(0.0)),
            ],
            walls: {{ "plates": (shape: Box(min: (-1.0, 0.0), max: (1.3, 1.0)), {plates}) }},
        )"#
    );
    app(&text, &[])
}

/// Stress (Pa) with which the two plates hold the fluid.
fn stress(world: &mut World) -> f64 {
    evaluate(world);
    let forces = world.query_filtered::<(&Mass, &Acceleration), With<Fluid>>();
    { forces }.iter(world).map(|(m, a)| m.0 * a.0.x).sum::<f64>().abs() / (2.0 * LENGTH)
}

/// A fluid that yields nowhere but at the wall is held with its yield stress. What the sums over a lattice leave of that is for Eq. 12 a
/// few percent; the central form has 8 % too little for a shear along a square lattice (`viscous_forces.rs`).
#[test]
fn a_plug_is_held_with_the_yield_stress() {
    for (head, tolerance) in
        [("", 0.05), ("kernel: WendlandC2, smoothing_ratio: 1.6,", 0.05), ("momentum: (viscosity: Central),", 0.15)]
    {
        for moves in ["mud", "plates"] {
            let stress = stress(plug(head, moves).world_mut());
            assert!((stress - 100.0).abs() < 100.0 * tolerance, "{head} the {moves}: {stress} Pa instead of 100");
        }
    }
}

/// The rate of strain of a kernel that is wider than the layer at the wall is too low, and so the viscosity too great.
#[test]
fn without_it_the_stress_is_twice_as_great() {
    let stress = stress(plug("strain_rate: (wall_shear: false),", "mud").world_mut());
    assert!(stress > 200.0, "{stress} Pa");
}

/// What is resolved has its shear rate from Eq. 14: not a bit is changed next to the lower plate in a simple shear, nor in
/// a parabola of 20 spacings.
#[test]
fn a_resolved_flow_keeps_its_shear_rate() {
    for profile in [|y: f64| 3.0 * y, |y: f64| 4.0 * y * (1.0 - y)] {
        let [with, without] = ["true", "false"].map(|on| {
            let mut app = plug(&format!("strain_rate: (wall_shear: {on}),"), "mud");
            let world = app.world_mut();
            disturb(world, 2, 0.0, |x| (profile(x.y), 0.0, 0.0).into());
            evaluate(world);
            let near = |(x, _): &(&Position, &ShearRate)| x.0.y < 0.5;
            let rates = world.query_filtered::<(&Position, &ShearRate), With<Fluid>>();
            { rates }.iter(world).filter(near).map(|(_, rate)| rate.0).collect::<Vec<f64>>()
        });
        assert_eq!(with, without);
    }
}

/// Along a wall that slips nothing is held.
#[test]
fn a_wall_that_slips_does_not_count() {
    let mut slips = plug("", "mud");
    let world = slips.world_mut();
    let mut walls = world.query::<&mut storegga::particles::Slip>();
    walls.iter_mut(world).for_each(|mut slip| *slip = storegga::particles::Slip::FreeSlip);
    evaluate(world);
    let rates = world.query_filtered::<&ShearRate, With<Fluid>>();
    assert!({ rates }.iter(world).all(|rate| rate.0.abs() < 1e-9));
}

/// Mud that turns with its drum, as a rigid body, is not sheared by it.
#[test]
fn what_turns_with_its_wall_does_not_jump() {
    let text = r#"Scene(
        dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 1.0, equation_of_state: (max_speed: 1.0),
        phases: { "mud": (
            reference_density: 1000.0,
            rheology: Bingham(plastic_viscosity: 0.0, yield_stress: 100.0, max_viscosity: 1e4),
        ) },
        fluids: [(
            phase: "mud", shape: Circle(center: (0.0, 0.0), radius: 0.5), pressure: Centrifugal(0.0),
            rotation: (center: (0.0, 0.0), rate: 1.0),
        )],
        walls: { "drum": (
            shape: Circle(center: (0.0, 0.0), radius: 0.5), motion: Rotation(center: (0.0, 0.0), rate: 1.0),
        ) },
    )"#;
    let mut drum = app(text, &[]);
    let world = drum.world_mut();
    evaluate(world);
    let rates = world.query_filtered::<&ShearRate, With<Fluid>>();
    let greatest = { rates }.iter(world).map(|rate| rate.0).fold(0.0, f64::max);
    // Next to nothing beside the 1/s at which it turns.
    assert!(greatest < 0.1, "{greatest} 1/s");
}
