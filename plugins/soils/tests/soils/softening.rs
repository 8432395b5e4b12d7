//! Strain softening in simple shear between a floor and a lid.

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{StopFlag, run};
use storegga::boundary::Load;
use storegga::checkpoint::{check_state, restore_state, save_state};
use storegga::particles::{Fluid, Position};
use storegga_soils::AccumulatedStrain;

use crate::support::{app, set_velocity};

/// Clay 1 m thick below a lid that moves at a rate (1/s) times a metre, sheared as far as simple shear goes from the start.
fn sheared(rate: f64) -> App {
    let text = format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 10.0, periodic: (x: (0.0, 0.3)),
            equation_of_state: (max_speed: 1.0, background_pressure: 2000.0),
            phases: {{ "clay": (reference_density: 1000.0, rheology: StrainSoftening(
                consistency: 200.0, exponent: 1.0, peak_yield_stress: 300.0, sensitivity: 3.0, strain_95: 1.5,
                max_viscosity: 2000.0)) }},
            fluids: [(phase: "clay", shape: Box(min: (0.0, 0.0), max: (0.3, 1.0)), pressure: Uniform(0.0))],
            walls: {{ "floor": (shape: Box(min: (-1.0, -0.2), max: (1.3, 0.0)), fluid: Outside) }},
            structures: {{ "lid": (
                shape: Box(min: (0.0, 1.0), max: (0.3, 1.2)), motion: Translation(velocity: ({rate:?}, 0.0)),
            ) }},
        )"#
    );
    let mut app = app(&text);
    set_velocity(app.world_mut(), |x| rate * x.y * DVec3::X);
    app
}

/// Shear stress (Pa) on the lid.
fn stress(world: &mut World) -> f64 {
    -world.query::<&Load>().single(world).expect("one structure").viscous_force.x / 0.3
}

/// Least and greatest strain of particles that are farther than 0.2 m from floor and lid.
fn strains(world: &mut World) -> (f64, f64) {
    let mut fluid = world.query_filtered::<(&Position, &AccumulatedStrain), With<Fluid>>();
    let inside = fluid.iter(world).filter(|(x, _)| (0.2..0.8).contains(&x.0.y)).map(|(_, strain)| strain.0);
    inside.fold((f64::INFINITY, 0.0), |(least, greatest), strain| (strain.min(least), strain.max(greatest)))
}

#[test]
fn stress_falls_with_the_strain_as_it_should() {
    let mut app = sheared(1.0);
    let world = app.world_mut();
    for time in [0.0, 0.25, 0.5, 1.0, 2.0] {
        run(world, time, &StopFlag::default(), |_| {});
        // τ = η γ̇ + [1/S_t + (1 − 1/S_t) e^(−3 γ̇t/ξ_95)] τ_peak
        let exact = 200.0 + 300.0 * (1.0 / 3.0 + 2.0 / 3.0 * f64::exp(-3.0 * time / 1.5));
        let (found, (least, greatest)) = (stress(world), strains(world));
        assert!((found / exact - 1.0).abs() < 0.03, "t = {time}: {found} Pa, exact {exact} Pa");
        assert!((least - time).abs() < 0.03 && (greatest - time).abs() < 0.03, "t = {time}: {least} … {greatest}");
    }
}

#[test]
fn what_does_not_yield_does_not_soften() {
    // μ_max γ̇ = 200 Pa, below the peak of 300 Pa.
    let mut app = sheared(0.1);
    let world = app.world_mut();
    run(world, 1.0, &StopFlag::default(), |_| {});
    assert_eq!(strains(world), (0.0, 0.0));
    let found = stress(world);
    assert!((found / 200.0 - 1.0).abs() < 0.03, "{found} Pa");
}

#[test]
fn a_resumed_run_softens_to_the_bit() {
    let (mut straight, mut resumed) = (sheared(1.0), sheared(1.0));
    run(straight.world_mut(), 0.1, &StopFlag::default(), |_| {});
    assert_eq!(check_state(straight.world()), Ok(()));
    let saved = save_state(straight.world_mut()).expect("the state is saved");
    restore_state(resumed.world_mut(), &saved).expect("the state fits");
    let [straight, resumed] = [straight, resumed].map(|mut app| {
        run(app.world_mut(), 0.2, &StopFlag::default(), |_| {});
        assert!(strains(app.world_mut()).0 > 0.19);
        save_state(app.world_mut()).expect("the state is saved")
    });
    assert!(straight != saved && straight == resumed, "the resumed run went another way");
}
