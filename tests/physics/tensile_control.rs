//! The control of tension: the formula of Sun et al. 2018 pair by pair, where it must stay away, and what it is for.

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::particles::{Acceleration, Density, Fluid, Mass, ParticleId, Position, Pressure};
use storegga::scene::Resolution;

use crate::support::{advance, app, cube, disturb, evaluate, is_inside_cube, press};

fn with_control(scene: &str) -> String {
    scene.replace("phases:", "tensile_control: PressureDifference, phases:")
}

/// A periodic box of one liquid, 20 by 20 or 8 by 8 by 8 particles, without viscosity and without background pressure.
fn liquid(dimension: usize, momentum: &str) -> String {
    let (spacing, gravity, third, high) = if dimension == 2 {
        (0.05, "(0.0, 0.0)", "", "(0.0, 0.0), max: (1.0, 1.0)")
    } else {
        (0.125, "(0.0, 0.0, 0.0)", ", z: (0.0, 1.0)", "(0.0, 0.0, 0.0), max: (1.0, 1.0, 1.0)")
    };
    format!(
        r#"Scene(
            dimension: {dimension}, spacing: {spacing}, gravity: {gravity}, end_time: 1.0,
            periodic: (x: (0.0, 1.0), y: (0.0, 1.0){third}), equation_of_state: (max_speed: 1.0),
            momentum: (pressure: {momentum}),
            phases: {{ "oil": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.0)) }},
            fluids: [(phase: "oil", shape: Box(min: {high}), pressure: Uniform(0.0))],
        )"#
    )
}

/// A particle of the fluid.
struct Particle {
    x: DVec3,
    mass: f64,
    density: f64,
    pressure: f64,
    acceleration: DVec3,
}

fn particles(world: &mut World) -> Vec<Particle> {
    let mut fluid =
        world.query_filtered::<(&ParticleId, &Position, &Mass, &Density, &Pressure, &Acceleration), With<Fluid>>();
    let mut all: Vec<_> = fluid
        .iter(world)
        .map(|(id, x, m, rho, p, a)| {
            (id.0, Particle { x: x.0, mass: m.0, density: rho.0, pressure: p.0, acceleration: a.0 })
        })
        .collect();
    all.sort_by_key(|(id, _)| *id);
    all.into_iter().map(|(_, particle)| particle).collect()
}

/// `(dW/dr)/r` of the quintic spline.
fn gradient(r: f64, h: f64, dimension: usize) -> f64 {
    use std::f64::consts::PI;
    let alpha = if dimension == 2 { 7.0 / (478.0 * PI * h * h) } else { 1.0 / (120.0 * PI * h.powi(3)) };
    let fourth = |edge: f64| (edge - r / h).max(0.0).powi(4);
    -5.0 * alpha / h * (fourth(3.0) - 6.0 * fourth(2.0) + 15.0 * fourth(1.0)) / r
}

/// Acceleration of `i`, pair by pair: `p_j + p_i`, or `p_j − p_i` if `p_i < 0`, weighted as `form` has it.
fn by_hand(all: &[Particle], i: &Particle, h: f64, dimension: usize, form: &str) -> DVec3 {
    let own = i.pressure.abs();
    let volume = |k: &Particle| k.mass / k.density;
    let pairs = all.iter().map(|j| {
        let apart = i.x - j.x;
        let r_ij = apart - apart.round();
        if r_ij.length() < 1e-12 {
            return DVec3::ZERO;
        }
        let (v_i, v_j) = (volume(i).powi(2), volume(j).powi(2));
        let average = if form == "VolumeWeighted" {
            own * v_i + j.pressure * v_j
        } else {
            (v_i + v_j) * (j.density * own + i.density * j.pressure) / (i.density + j.density)
        };
        -average * gradient(r_ij.length(), h, dimension) * r_ij
    });
    pairs.sum::<DVec3>() / i.mass
}

#[test]
fn what_is_under_tension_is_driven_by_differences_of_pressure() {
    for dimension in [2, 3] {
        for form in ["VolumeWeighted", "DensityWeighted"] {
            let mut app = app(&with_control(&liquid(dimension, form)), &[]);
            let world = app.world_mut();
            // Half of the particles are under tension.
            press(world, |x| 300.0 * (std::f64::consts::TAU * x.y).sin());
            disturb(world, dimension, 0.01, |_| DVec3::ZERO);
            evaluate(world);
            let h = world.resource::<Resolution>().smoothing_length;
            let all = particles(world);
            let greatest = all.iter().map(|i| i.acceleration.length()).fold(0.0, f64::max);
            let tense = all.iter().filter(|i| i.pressure < 0.0).count();
            assert!(tense > all.len() / 3 && tense < 2 * all.len() / 3, "{tense} of {}", all.len());
            for i in &all {
                let exact = by_hand(&all, i, h, dimension, form);
                let error = (i.acceleration - exact).length();
                assert!(error < 1e-9 * greatest, "{dimension}D {form} at {}: {}, by hand {exact}", i.x, i.acceleration);
            }
        }
    }
}

#[test]
fn near_a_free_surface_nothing_is_changed() {
    for (dimension, cells) in [(2, 24), (3, 14)] {
        let accelerations = |scene: &str| {
            let mut app = app(scene, &[]);
            let world = app.world_mut();
            press(world, |_| -200.0);
            disturb(world, dimension, 0.004, |_| DVec3::ZERO);
            evaluate(world);
            particles(world)
        };
        let scene = cube(dimension, cells, "");
        let (without, with) = (accelerations(&scene), accelerations(&with_control(&scene)));
        let (mut kept, mut changed) = (0, 0);
        for (without, with) in without.iter().zip(&with) {
            let is_same = without.acceleration == with.acceleration;
            // The first layer lies at the surface, and reaches no farther than 0.18 m.
            if !is_inside_cube(with.x, dimension, cells, 0.1) {
                assert!(is_same, "{dimension}D at {}", with.x);
                kept += 1;
            } else if is_inside_cube(with.x, dimension, cells, 0.25) {
                assert!(!is_same, "{dimension}D at {}", with.x);
                changed += 1;
            }
        }
        assert!(kept > 50 && changed > 50, "{kept} kept, {changed} changed");
    }
}

/// A drop that lies on a plate has no neighbour at the surface, and is at it itself.
#[test]
fn a_lone_drop_on_a_plate_is_left_alone() {
    let plate = r#"structures: { "plate": (shape: Box(min: (-0.5, -0.2), max: (0.5, 0.0))) }, free_surface: Off,"#;
    let acceleration = |scene: &str| {
        let mut app = app(scene, &[]);
        press(app.world_mut(), |_| -200.0);
        evaluate(app.world_mut());
        particles(app.world_mut())[0].acceleration
    };
    let scene = cube(2, 1, plate);
    let (without, with) = (acceleration(&scene), acceleration(&with_control(&scene)));
    assert!(without.y != 0.0, "the plate acts on it");
    assert_eq!(without, with);
}

/// Least distance between two particles (spacings) of a liquid under tension after `steps` steps.
fn least_distance(scene: &str, steps: u64) -> f64 {
    let mut app = app(scene, &[]);
    let world = app.world_mut();
    press(world, |_| -500.0);
    disturb(world, 2, 0.0005, |_| DVec3::ZERO);
    evaluate(world);
    advance(world, steps);
    let all = particles(world);
    let mut least = f64::INFINITY;
    for (k, i) in all.iter().enumerate() {
        for j in &all[..k] {
            let apart = i.x - j.x;
            least = least.min((apart - apart.round()).length());
        }
    }
    least / 0.05
}

#[test]
fn a_stretched_liquid_does_not_clump() {
    let scene = liquid(2, "VolumeWeighted");
    let (without, with) = (least_distance(&scene, 600), least_distance(&with_control(&scene), 600));
    assert!(without < 0.5 && with > 0.85, "{without} spacings without, {with} with");
}
