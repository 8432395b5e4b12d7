//! Shifting of particles: the formula, and where it must leave out a part of it.

use std::f64::consts::TAU;

use bevy_ecs::prelude::*;
use bevy_ecs::system::RunSystemOnce;
use glam::DVec3;
use storegga::clock::Clock;
use storegga::particles::{Density, Fluid, Mass, ParticleId, Position};
use storegga::physics::shift_particles;
use storegga::scene::Resolution;

use crate::support::{advance, app, cube, disturb, evaluate, is_inside_cube, periodic_box};

const A: f64 = 2.0;
const TIME_STEP: f64 = 1e-3;

fn with_shifting(scene: &str) -> String {
    scene.replace("phases:", "shifting: Fickian(coefficient: 2.0), phases:")
}

/// Place and shift (m) of every particle, all of which have the speed 1 m/s.
fn shifts(world: &mut World, dimension: usize) -> Vec<(DVec3, DVec3)> {
    world.resource_mut::<Clock>().time_step = TIME_STEP;
    let mut places = world.query_filtered::<(&ParticleId, &Position), With<Fluid>>();
    let mut sorted = |world: &mut World| {
        let mut all: Vec<_> = places.iter(world).map(|(id, x)| (id.0, x.0)).collect();
        all.sort_by_key(|particle| particle.0);
        all
    };
    let before = sorted(world);
    let ran: Result<(), _> = if dimension == 2 {
        world.run_system_once(shift_particles::<2>)
    } else {
        world.run_system_once(shift_particles::<3>)
    };
    ran.expect("the stage runs");
    before.into_iter().zip(sorted(world)).map(|((_, from), (_, to))| (from, to - from)).collect()
}

/// `(dW/dr)/r` of the quintic spline.
fn gradient(r: f64, h: f64, dimension: usize) -> f64 {
    use std::f64::consts::PI;
    let alpha = if dimension == 2 { 7.0 / (478.0 * PI * h * h) } else { 1.0 / (120.0 * PI * h.powi(3)) };
    let fourth = |edge: f64| (edge - r / h).max(0.0).powi(4);
    -5.0 * alpha / h * (fourth(3.0) - 6.0 * fourth(2.0) + 15.0 * fourth(1.0)) / r
}

/// `−A h |v| Δt Σ_j V_j ∇_iW_ij` at `x`, over every particle of a box of 1 m and its images.
fn brute_force(world: &mut World, x: DVec3, dimension: usize) -> DVec3 {
    let h = world.resource::<Resolution>().smoothing_length;
    let mut fluid = world.query_filtered::<(&Position, &Mass, &Density), With<Fluid>>();
    let sum: DVec3 = fluid
        .iter(world)
        .map(|(other, m, rho)| {
            let apart = x - other.0;
            let r_ij = apart - apart.round();
            if r_ij.length() < 1e-12 { DVec3::ZERO } else { m.0 / rho.0 * gradient(r_ij.length(), h, dimension) * r_ij }
        })
        .sum();
    -A * h * TIME_STEP * sum
}

#[test]
fn inside_a_fluid_it_is_ficks_law() {
    for dimension in [2, 3] {
        // One liquid, so that there is no interface.
        let scene = with_shifting(&periodic_box(dimension)).replace("1950.0", "1000.0");
        let mut app = app(&scene, &[]);
        let world = app.world_mut();
        disturb(world, dimension, 0.01, |_| DVec3::X);
        evaluate(world);
        let exact: Vec<_> = {
            let mut places = world.query_filtered::<(&ParticleId, &Position), With<Fluid>>();
            let mut all: Vec<_> = places.iter(world).map(|(id, x)| (id.0, x.0)).collect();
            all.sort_by_key(|particle| particle.0);
            all.into_iter().take(40).map(|(_, x)| brute_force(world, x, dimension)).collect()
        };
        let found = shifts(world, dimension);
        let greatest = exact.iter().map(|shift| shift.length()).fold(0.0, f64::max);
        assert!(greatest > 1e-5, "{dimension}D: nothing is shifted by more than {greatest} m");
        for (exact, (x, found)) in exact.into_iter().zip(found) {
            // Positions of about 1 m have sixteen digits.
            assert!((found - exact).length() < 1e-9 * greatest + 1e-15, "{dimension}D at {x}: {found}, exact {exact}");
        }
    }
}

#[test]
fn across_an_interface_nothing_is_shifted() {
    let mut app = app(&with_shifting(&periodic_box(2)), &[]);
    let world = app.world_mut();
    disturb(world, 2, 0.005, |_| DVec3::X);
    evaluate(world);
    let found = shifts(world, 2);
    let rms = |near: &dyn Fn(f64) -> bool, axis: usize| {
        let squares: Vec<f64> = found.iter().filter(|(x, _)| near(x.y)).map(|(_, shift)| shift[axis].powi(2)).collect();
        assert!(squares.len() > 30);
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    // Liquids meet at y = 0.5 m; at y = 0.25 m and 0.75 m no other is in reach.
    let at_interface = |y: f64| (y - 0.5).abs() < 0.03;
    let inside = |y: f64| (y - 0.25).abs() < 0.06 || (y - 0.75).abs() < 0.06;
    let (across, along) = (rms(&at_interface, 1), rms(&at_interface, 0));
    assert!(across < 0.15 * along, "{across} m across, {along} m along");
    assert!(rms(&inside, 1) > 0.6 * rms(&inside, 0));
}

#[test]
fn a_free_surface_is_not_driven_apart() {
    for (dimension, cells) in [(2, 20), (3, 12)] {
        let mut app = app(&with_shifting(&cube(dimension, cells, "")), &[]);
        let world = app.world_mut();
        disturb(world, dimension, 0.0, |_| DVec3::X);
        evaluate(world);
        let h = world.resource::<Resolution>().smoothing_length;
        // What ∇C alone would do to the first layer: of the order of A |v| Δt.
        let scale = A * TIME_STEP;
        let side = 0.05 * cells as f64;
        let near_an_edge = |x: DVec3| {
            let sides = x.to_array()[..dimension].iter().filter(|x| **x < 3.0 * h || **x > side - 3.0 * h).count();
            sides > 1
        };
        let found = shifts(world, dimension);
        let faces: Vec<_> = found.iter().filter(|(x, _)| !near_an_edge(*x)).collect();
        assert!(faces.iter().any(|(x, _)| !is_inside_cube(*x, dimension, cells, 0.05)));
        for (x, shift) in faces {
            assert!(shift.length() < 0.02 * scale, "{dimension}D at {x}: {shift} m");
        }
    }
}

/// Least distance between two particles (spacings) after the eddies have turned.
fn least_distance(scene: &str) -> f64 {
    let mut app = app(scene, &["phases.heavy.reference_density=1000.0", "phases.light.rheology.viscosity=0.01"]);
    let world = app.world_mut();
    let wave = |x: f64| (TAU * x).sin_cos();
    disturb(world, 2, 0.0, |x| {
        let ((sin_x, cos_x), (sin_y, cos_y)) = (wave(x.x), wave(x.y));
        DVec3::new(sin_x * cos_y, -cos_x * sin_y, 0.0)
    });
    evaluate(world);
    advance(world, 600);
    let places: Vec<DVec3> = world.query_filtered::<&Position, With<Fluid>>().iter(world).map(|x| x.0).collect();
    let mut least = f64::INFINITY;
    for (k, x) in places.iter().enumerate() {
        for other in &places[..k] {
            let apart = *x - *other;
            least = least.min((apart - apart.round()).length());
        }
    }
    least / 0.05
}

#[test]
fn eddies_leave_particles_evenly_spread() {
    let scene = periodic_box(2);
    let (without, with) = (least_distance(&scene), least_distance(&with_shifting(&scene)));
    assert!(with > 2.0 * without && with > 0.35, "{with} spacings with, {without} without");
}
