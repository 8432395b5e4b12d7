//! Linear fields: the discrete operators return their exact derivatives.

use bevy_ecs::prelude::*;
use glam::{DMat3, DVec3};
use storegga::clock::Clock;
use storegga::neighbours::PeriodicSides;
use storegga::particles::{Density, DensityRate, Fluid, Position, ShearRate};
use storegga::physics::{MidwaySums, midway_sums, strain_rate};

use crate::support::{app, disturb, evaluate, periodic_box};

/// v = G x, with shear, rotation and expansion.
fn gradient(dimension: usize) -> DMat3 {
    let g = DMat3::from_cols_array_2d(&[[0.3, -0.2, 0.5], [1.1, -0.1, 0.2], [-0.4, 0.6, 0.15]]);
    if dimension == 3 {
        return g;
    }
    DMat3::from_cols(g.x_axis.with_z(0.0), g.y_axis.with_z(0.0), DVec3::ZERO)
}

/// Particles so far from the periodic sides that the jump of the field there does not reach them.
fn is_inner(x: DVec3, world: &World, margin: f64) -> bool {
    is_inside(x, world.resource::<PeriodicSides>(), margin)
}

fn is_inside(x: DVec3, sides: &PeriodicSides, margin: f64) -> bool {
    x.to_array()
        .iter()
        .zip(sides.0)
        .all(|(x, sides)| sides.is_none_or(|(from, to)| *x > from + margin && *x < to - margin))
}

fn shear_rate_errors(dimension: usize, amplitude: f64, corrected: bool) -> Vec<f64> {
    let setting = format!("strain_rate.gradient_correction={corrected}");
    // In 3D a box of 8 particles would have no inner ones.
    let spacing = if dimension == 3 { "spacing=0.0625" } else { "spacing=0.05" };
    let scene = periodic_box(dimension).replace("phases:", "strain_rate: (), phases:");
    let mut app = app(&scene, &[&setting, spacing]);
    let world = app.world_mut();
    let g = gradient(dimension);
    disturb(world, dimension, amplitude, |x| g * x);
    evaluate(world);
    let d = (g + g.transpose()) * 0.5;
    let exact = (2.0 * d.to_cols_array().iter().map(|x| x * x).sum::<f64>()).sqrt();
    let found: Vec<(DVec3, f64)> =
        world.query_filtered::<(&Position, &ShearRate), With<Fluid>>().iter(world).map(|(x, s)| (x.0, s.0)).collect();
    let inner: Vec<f64> =
        found.into_iter().filter(|(x, _)| is_inner(*x, world, 0.25)).map(|(_, s)| (s / exact - 1.0).abs()).collect();
    assert!(inner.len() > 50, "only {} inner particles", inner.len());
    inner
}

#[test]
fn corrected_shear_rate_is_exact_for_disordered_particles() {
    for dimension in [2, 3] {
        let worst = shear_rate_errors(dimension, 0.01, true).into_iter().fold(0.0, f64::max);
        assert!(worst < 1e-12, "{dimension}D: {worst}");
    }
}

/// `v = G x` where particles are in the middle of a drift: γ̇ has nothing of order Δt, whether the sums are made together or
/// by the stage alone. (With the positions of the end it would be off by `½Δt |G|`, here a tenth.)
#[test]
fn shear_rate_is_that_of_the_middle_of_the_drift() {
    let time_step = 0.1;
    let mut app = app(&periodic_box(2).replace("phases:", "strain_rate: (), phases:"), &[]);
    let world = app.world_mut();
    let g = gradient(2);
    let to_middle = (DMat3::IDENTITY + g * (0.5 * time_step)).inverse();
    disturb(world, 2, 0.0, |x| g * (to_middle * x));
    evaluate(world);
    let d = (g + g.transpose()) * 0.5;
    let exact = (2.0 * d.to_cols_array().iter().map(|x| x * x).sum::<f64>()).sqrt();
    world.resource_mut::<Clock>().time_step = time_step;
    let check = |world: &mut World| {
        let mut fluid = world.query_filtered::<(&Position, &mut ShearRate), With<Fluid>>();
        let sides = *world.resource::<PeriodicSides>();
        let mut inner = 0;
        for (x, mut shear_rate) in fluid.iter_mut(world) {
            if is_inside(x.0, &sides, 0.25) {
                inner += 1;
                assert!((shear_rate.0 / exact - 1.0).abs() < 1e-12, "{} at {}, exact {exact}", shear_rate.0, x.0);
            }
            shear_rate.0 = 0.0;
        }
        assert!(inner > 50, "only {inner} inner particles");
    };
    let made: Result<(), _> = world.run_system_cached(midway_sums::<2>);
    made.expect("the sums are made");
    check(world);
    world.resource_mut::<MidwaySums>().clear();
    let made: Result<(), _> = world.run_system_cached(strain_rate::<2>);
    made.expect("the sums are made");
    check(world);
}

#[test]
fn plain_shear_rate_is_right_on_a_lattice() {
    for dimension in [2, 3] {
        let worst = shear_rate_errors(dimension, 0.0, false).into_iter().fold(0.0, f64::max);
        assert!(worst < 5e-3, "{dimension}D: {worst}");
    }
}

#[test]
fn continuity_of_a_uniform_expansion() {
    for dimension in [2, 3] {
        let spacing = if dimension == 3 { "spacing=0.0625" } else { "spacing=0.05" };
        let scene = periodic_box(dimension).replace("phases:", "diffusion: Off, phases:");
        let mut app = app(&scene, &[spacing]);
        let world = app.world_mut();
        let g = gradient(dimension);
        disturb(world, dimension, 0.0, |x| g * x);
        evaluate(world);
        let divergence = g.x_axis.x + g.y_axis.y + g.z_axis.z;
        let rates: Vec<(DVec3, f64)> = world
            .query_filtered::<(&Position, &Density, &DensityRate), With<Fluid>>()
            .iter(world)
            .map(|(x, rho, rate)| (x.0, rate.0 / rho.0))
            .collect();
        let inner: Vec<f64> =
            rates.into_iter().filter(|(x, _)| is_inner(*x, world, 0.25)).map(|(_, rate)| rate).collect();
        assert!(inner.len() > 50);
        for rate in inner {
            assert!((rate + divergence).abs() < 5e-3 * divergence.abs(), "{dimension}D: {rate}, {divergence}");
        }
    }
}
