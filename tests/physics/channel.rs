//! Flow between plates against exact profiles, for what no scene runs: Wendland's kernel and Papanastasiou's
//! regularisation.

use std::f64::consts::PI;

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{StopFlag, run};
use storegga::particles::{Fluid, Position, Velocity};

use crate::support::{app, disturb, evaluate};

/// Liquid between two plates 1 m apart, drawn along them by 0.8 m/s².
pub fn plates(head: &str, rheology: &str) -> App {
    let text = format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: (0.8, 0.0), end_time: 10.0, periodic: (x: (0.0, 0.3)), {head}
            equation_of_state: (max_speed: 1.0, background_pressure: 2000.0),
            phases: {{ "liquid": (reference_density: 1000.0, rheology: {rheology}) }},
            fluids: [(phase: "liquid", shape: Box(min: (0.0, 0.0), max: (0.3, 1.0)), pressure: Uniform(0.0))],
            walls: {{ "plates": (shape: Box(min: (-1.0, 0.0), max: (1.3, 1.0))) }},
        )"#
    );
    app(&text, &[])
}

/// Relative L2 error of the velocity along the plates.
pub fn error(world: &mut World, exact: impl Fn(f64) -> f64) -> f64 {
    let (mut difference, mut norm) = (0.0, 0.0);
    for (x, v) in world.query_filtered::<(&Position, &Velocity), With<Fluid>>().iter(world) {
        let u = exact(x.0.y);
        (difference, norm) = (difference + (v.0.x - u).powi(2), norm + u * u);
    }
    (difference / norm).sqrt()
}

#[test]
fn a_newtonian_flow_sets_in_as_it_should_with_either_kernel() {
    for head in ["kernel: QuinticSpline,", "kernel: WendlandC2, smoothing_ratio: 1.6,"] {
        let mut app = plates(head, "Newtonian(viscosity: 100.0)");
        let world = app.world_mut();
        let (g, nu, time) = (0.8, 0.1, 0.8);
        run(world, time, &StopFlag::default(), |_| {});
        // The steady parabola less its sine series, each term of which decays by itself.
        let exact = |y: f64| -> f64 {
            let transient = (0..30)
                .map(|k| PI * f64::from(2 * k + 1))
                .map(|wave| 4.0 * g / (nu * wave.powi(3)) * (wave * y).sin() * (-wave * wave * nu * time).exp());
            0.5 * g / nu * y * (1.0 - y) - transient.sum::<f64>()
        };
        let l2 = error(world, exact);
        assert!(l2 < 0.02, "{head} L2 error {l2}");
    }
}

/// Velocity (m/s) at `y` (m): ∫ γ̇ over the distance from the plate, where γ̇, by bisection, carries the stress f s at
/// the distance s from the mid-plane.
fn papanastasiou(y: f64, stress: impl Fn(f64) -> f64) -> f64 {
    let shear_rate = |tau: f64| {
        let (mut low, mut high) = (0.0, 100.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if stress(middle) > tau { high = middle } else { low = middle }
        }
        low
    };
    let (s, pieces) = ((y - 0.5).abs(), 200);
    let step = (0.5 - s) / f64::from(pieces);
    (0..pieces).map(|k| shear_rate(800.0 * (s + (f64::from(k) + 0.5) * step)) * step).sum()
}

#[test]
fn a_papanastasiou_flow_keeps_its_steady_profile() {
    let rheology = "HerschelBulkley(consistency: 60.0, exponent: 1.0, yield_stress: 150.0, max_viscosity: 1e4, \
        regularisation: Papanastasiou(m: 1.0))";
    let stress = |rate: f64| 60.0 * rate + 150.0 * (1.0 - (-rate).exp());
    let mut app = plates("", rheology);
    let world = app.world_mut();
    // From a profile 20 % too slow, for so long that hardly anything of that is left.
    disturb(world, 2, 0.0, |x| 0.8 * DVec3::X * papanastasiou(x.y, stress));
    evaluate(world);
    run(world, 6.0, &StopFlag::default(), |_| {});
    let l2 = error(world, |y| papanastasiou(y, stress));
    assert!(l2 < 0.02, "L2 error {l2}");
}
