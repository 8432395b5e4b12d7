//! Every fluid by name against its own exact flow between plates, from its law as it is written here.
//!
//! The stress at the distance s from the mid-plane is `τ = f s`. With the shear rate γ̇(τ) that carries it, the velocity is
//! `u(s) = ∫_s^b γ̇(f s′) ds′`.

use glam::DVec3;
use storegga::app::{StopFlag, run};

use crate::channel::{error, plates};
use crate::support::{disturb, evaluate};

/// Driving force f (N/m³) and half width b (m) of [`plates`].
const FORCE: f64 = 800.0;
const HALF_WIDTH: f64 = 0.5;

/// ∫ γ̇(f s′) ds′ (m/s) from the distance of `y` (m) from the mid-plane to the wall.
fn velocity(y: f64, shear_rate: &impl Fn(f64) -> f64) -> f64 {
    let (s, pieces) = ((y - HALF_WIDTH).abs(), 400);
    let step = (HALF_WIDTH - s) / f64::from(pieces);
    (0..pieces).map(|k| shear_rate(FORCE * (s + (f64::from(k) + 0.5) * step)) * step).sum()
}

/// Root of `stress(γ̇) = τ` by bisection.
fn by_bisection(stress: impl Fn(f64) -> f64) -> impl Fn(f64) -> f64 {
    move |tau| {
        let (mut low, mut high) = (0.0, 100.0);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if stress(middle) > tau { high = middle } else { low = middle }
        }
        low
    }
}

/// Relative L2 error that twenty particles across may leave. Thinning fluids, whose shear rate changes most at the wall, leave
/// 4 %; with forty particles across the power law leaves 2 %.
const TOLERANCE: f64 = 0.05;

/// Runs a fluid from a profile a tenth too slow, until hardly anything of that is left.
#[track_caller]
fn assert_profile(rheology: &str, shear_rate: impl Fn(f64) -> f64) {
    let mut app = plates("", rheology);
    let world = app.world_mut();
    disturb(world, 2, 0.0, |x| 0.9 * DVec3::X * velocity(x.y, &shear_rate));
    evaluate(world);
    run(world, 4.0, &StopFlag::default(), |_| {});
    let l2 = error(world, |y| velocity(y, &shear_rate));
    assert!(l2 < TOLERANCE, "{rheology}: L2 error {l2}");
}

#[test]
fn the_quadrature_gives_a_newtonian_fluid_its_parabola() {
    for y in [0.0, 0.1, 0.5, 0.8] {
        let parabola = FORCE / (2.0 * 100.0) * y * (1.0 - y);
        assert!((velocity(y, &|tau| tau / 100.0) - parabola).abs() < 1e-9);
    }
}

#[test]
fn bingham() {
    // Below the cap's kink at τ_y μ_max/(μ_max − μ_p) the plug creeps.
    let rheology = "Bingham(plastic_viscosity: 60.0, yield_stress: 150.0, max_viscosity: 3000.0)";
    let kink = 150.0 * 3000.0 / 2940.0;
    assert_profile(rheology, |tau| if tau < kink { tau / 3000.0 } else { (tau - 150.0) / 60.0 });
}

#[test]
fn power_law_that_thins() {
    let rheology = "PowerLaw(consistency: 180.0, exponent: 0.5, max_viscosity: 5000.0)";
    assert_profile(rheology, |tau| (tau / 180.0).powi(2));
}

#[test]
fn power_law_that_thickens() {
    let rheology = "PowerLaw(consistency: 100.0, exponent: 2.0, max_viscosity: 5000.0)";
    assert_profile(rheology, |tau| (tau / 100.0).sqrt());
}

#[test]
fn casson() {
    let rheology = "Casson(infinite_shear_viscosity: 40.0, yield_stress: 80.0, max_viscosity: 3000.0)";
    // √(μ_max γ̇) = √τ_y + √(μ_∞ γ̇) at the cap's kink.
    let kink = 80.0 / (1.0 - (40.0 / 3000.0_f64).sqrt()).powi(2);
    assert_profile(
        rheology,
        |tau| {
            if tau < kink { tau / 3000.0 } else { (tau.sqrt() - 80.0_f64.sqrt()).powi(2) / 40.0 }
        },
    );
}

#[test]
fn bi_viscosity() {
    let rheology = "BiViscosity(unyielded_viscosity: 1500.0, plastic_viscosity: 60.0, yield_stress: 150.0)";
    assert_profile(rheology, |tau| if tau < 150.0 { tau / 1500.0 } else { 0.1 + (tau - 150.0) / 60.0 });
}

#[test]
fn carreau_yasuda() {
    let rheology = "CarreauYasuda(zero_shear_viscosity: 400.0, infinite_shear_viscosity: 20.0, relaxation_time: 2.0, \
        exponent: 0.3, transition: 1.5)";
    let stress = |rate: f64| rate * (20.0 + 380.0 * (1.0 + (2.0 * rate).powf(1.5)).powf(-0.7 / 1.5));
    assert_profile(rheology, by_bisection(stress));
}

#[test]
fn cross() {
    let rheology = "Cross(zero_shear_viscosity: 400.0, infinite_shear_viscosity: 20.0, relaxation_time: 1.5, \
        exponent: 0.8)";
    assert_profile(rheology, by_bisection(|rate: f64| rate * (20.0 + 380.0 / (1.0 + (1.5 * rate).powf(0.8)))));
}
