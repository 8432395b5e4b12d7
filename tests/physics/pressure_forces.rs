//! The pressure forces against the gradient of a linear pressure, and pair by pair.

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::kernels::SmoothingKernel;
use storegga::particles::{Acceleration, Density, Fluid, Mass, Position, Velocity};

use crate::support::{app, cube, evaluate, is_inside_cube, press};

const FORMS: [&str; 2] = ["VolumeWeighted", "DensityWeighted"];

#[test]
fn a_linear_pressure_accelerates_by_its_gradient_over_the_density() {
    for (dimension, cells) in [(2, 16), (3, 11)] {
        let slope = DVec3::new(1500.0, -800.0, if dimension == 3 { 600.0 } else { 0.0 });
        for form in FORMS {
            let mut app = app(&cube(dimension, cells, &format!("momentum: (pressure: {form}),")), &[]);
            let world = app.world_mut();
            press(world, |x| 2000.0 + slope.dot(x));
            evaluate(world);
            let mut compared = 0;
            for (x, rho, a) in world.query_filtered::<(&Position, &Density, &Acceleration), With<Fluid>>().iter(world) {
                if is_inside_cube(x.0, dimension, cells, 0.19) {
                    compared += 1;
                    let exact = -slope / rho.0;
                    let error = (a.0 - exact).length() / exact.length();
                    assert!(error < 0.02, "{dimension}D {form} at {}: {}, exact {exact}", x.0, a.0);
                }
            }
            assert!(compared >= 27, "only {compared} particles compared");
        }
    }
}

/// Two particles, the left one of a liquid four times as light as the right one's.
fn two_particles(momentum: &str) -> App {
    let text = format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 1.0,
            equation_of_state: (max_speed: 1.0), momentum: ({momentum}), free_surface: Off,
            phases: {{
                "light": (reference_density: 1000.0, rheology: Newtonian(viscosity: 1.0)),
                "heavy": (reference_density: 4000.0, rheology: Newtonian(viscosity: 3.0)),
            }},
            fluids: [
                (phase: "light", shape: Box(min: (0.0, 0.0), max: (0.05, 0.05)), pressure: Uniform(0.0)),
                (phase: "heavy", shape: Box(min: (0.05, 0.0), max: (0.1, 0.05)), pressure: Uniform(0.0)),
            ],
        )"#
    );
    app(&text, &[])
}

/// m a of the left particle and of the right one.
fn forces(world: &mut World) -> [DVec3; 2] {
    let mut found: Vec<(f64, DVec3)> = world
        .query_filtered::<(&Position, &Mass, &Acceleration), With<Fluid>>()
        .iter(world)
        .map(|(x, m, a)| (x.0.x, m.0 * a.0))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    [found[0].1, found[1].1]
}

#[test]
fn the_density_weighted_pressure_leaves_both_particles_the_same_acceleration() {
    let mut app = two_particles("pressure: DensityWeighted");
    let world = app.world_mut();
    let (light, heavy) = (300.0, 900.0);
    press(world, |x| if x.x < 0.05 { light } else { heavy });
    evaluate(world);
    // ∇p/ρ is continuous at the interface between them: (p̃ − p_i)/ρ_i = (p_j − p̃)/ρ_j, found by bisection.
    let density = |rho0: f64, p: f64| rho0 * (1.0 + p / (4000.0 * 100.0));
    let (rho_i, rho_j) = (density(1000.0, light), density(4000.0, heavy));
    let (mut low, mut high) = (light, heavy);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if (middle - light) / rho_i < (heavy - middle) / rho_j { low = middle } else { high = middle }
    }
    let cell: f64 = 0.05 * 0.05;
    let kernel = world.resource::<SmoothingKernel>().clone();
    let step = 1e-6;
    let slope = (kernel.value(0.05 + step) - kernel.value(0.05 - step)) / (2.0 * step);
    let exact = 2.0 * cell * cell * low * slope;
    let [left, right] = forces(world);
    assert!((left.x - exact).abs() < 1e-6 * exact.abs(), "{} N, by hand {exact} N", left.x);
    assert!((left + right).length() < 1e-12 * exact.abs());
}

#[test]
fn two_particles_in_one_place_have_no_direction_and_no_force() {
    for pressure in FORMS {
        for viscosity in ["Laplacian", "Central"] {
            let mut app = two_particles(&format!("pressure: {pressure}, viscosity: {viscosity}"));
            let world = app.world_mut();
            press(world, |_| 500.0);
            for (mut x, mut v) in world.query_filtered::<(&mut Position, &mut Velocity), With<Fluid>>().iter_mut(world)
            {
                v.0 = DVec3::Y * x.0.x;
                x.0 = DVec3::new(0.05, 0.025, 0.0);
            }
            evaluate(world);
            // The pressure and Eq. 11 act along r_ij, which is null; Eq. 12 may brake what slides past.
            let [one, other] = forces(world);
            assert!(one.is_finite() && (one + other).length() <= 1e-12 * one.length(), "{one} {other}");
            assert_eq!(one.x, 0.0, "{pressure} {viscosity}");
            if viscosity == "Central" {
                assert_eq!(one, DVec3::ZERO, "{pressure}");
            }
        }
    }
}
