//! Density of spray, and of surfaces that are none.

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{StopFlag, run};
use storegga::particles::{Acceleration, Density, Fluid, ParticleId, Position, Pressure, Velocity};

use crate::support::{advance, app, cube, tank};

/// A cube of liquid from which the particle in a corner is shot off at a fifth of the sound speed.
fn shot(dimension: usize) -> App {
    let mut app = app(&cube(dimension, 6, ""), &[]);
    let world = app.world_mut();
    let mut fluid = world.query_filtered::<(&Position, &mut Velocity), With<Fluid>>();
    let outwards = DVec3::new(1.0, 1.0, if dimension == 3 { 1.0 } else { 0.0 });
    let is_shot = |x: DVec3| (x - 0.275 * outwards).length() < 1e-9;
    let shot = fluid.iter_mut(world).filter(|(x, _)| is_shot(x.0)).map(|(_, mut v)| v.0 = 1.5 * outwards).count();
    assert_eq!(shot, 1);
    // Its neighbours are out of reach after 0.12 s.
    run(world, 0.25, &StopFlag::default(), |_| {});
    app
}

/// Density, pressure and acceleration of the highest particle.
fn highest(app: &mut App) -> (f64, f64, DVec3) {
    let world = app.world_mut();
    let mut fluid = world.query_filtered::<(&Position, &Density, &Pressure, &Acceleration), With<Fluid>>();
    let (x, rho, p, a) = fluid.iter(world).max_by(|a, b| a.0.0.y.total_cmp(&b.0.0.y)).expect("there is fluid");
    assert!(x.0.y > 0.55, "it was held back: {}", x.0);
    (rho.0, p.0, a.0)
}

#[test]
fn what_flies_off_alone_is_neither_stretched_nor_pressed() {
    for dimension in [2, 3] {
        assert_eq!(highest(&mut shot(dimension)), (1000.0, 0.0, DVec3::ZERO), "{dimension}D");
    }
}

/// A sheet one particle thick that is stretched by a tenth and pushed together again does not gain density.
#[test]
fn a_thin_sheet_has_no_memory() {
    let sheet = cube(2, 20, "").replace("max: (1.0, 1.0)", "max: (1.0, 0.05)");
    let mut app = app(&sheet, &[]);
    let world = app.world_mut();
    for stretching in [0.5, -0.5, 0.5, -0.5] {
        let mut fluid = world.query_filtered::<(&Position, &mut Velocity), With<Fluid>>();
        fluid.iter_mut(world).for_each(|(x, mut v)| v.0 = DVec3::X * (stretching * (x.0.x - 0.5)));
        let end = world.resource::<storegga::clock::Clock>().time + 0.2;
        run(world, end, &StopFlag::default(), |_| {});
    }
    let mut fluid = world.query_filtered::<&Density, With<Fluid>>();
    let densest = fluid.iter(world).map(|rho| rho.0).fold(0.0, f64::max);
    assert!(densest < 1000.5, "{densest} kg/m³");
}

/// Density of every particle, by identity, after 20 steps.
fn densities(text: &str, overrides: &[&str]) -> Vec<(ParticleId, f64)> {
    let mut app = app(text, overrides);
    let world = app.world_mut();
    advance(world, 20);
    let mut fluid = world.query_filtered::<(&ParticleId, &Density), With<Fluid>>();
    let mut found: Vec<(ParticleId, f64)> = fluid.iter(world).map(|(id, rho)| (*id, rho.0)).collect();
    found.sort_by_key(|(id, _)| *id);
    found
}

#[test]
fn a_flat_surface_at_rest_is_left_alone() {
    for dimension in [2, 3] {
        for kernel in ["kernel=QuinticSpline", "kernel=WendlandC2"] {
            for ratio in ["smoothing_ratio=0.9", "smoothing_ratio=1.2", "smoothing_ratio=1.6"] {
                let of = |setting: &str| densities(&tank(dimension), &["spacing=0.1", kernel, ratio, setting]);
                let with = of("free_surface=Summation");
                assert!(with == of("free_surface=Off"), "{dimension}D, {kernel}, {ratio}");
            }
        }
    }
}
