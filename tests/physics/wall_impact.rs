//! What has come into a wall or structure is pushed out again.

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::clock::Clock;
use storegga::particles::{Fluid, Position, Velocity};

use crate::support::{advance, app};

const SPACING: f64 = 0.05;

/// Sound speed (m/s) of the scenes here: ten times their greatest speed.
const SOUND_SPEED: f64 = 10.0;

/// Bodies two and a half and two spacings thick.
const ROD: &str = "Circle(center: (0.2, 0.525), radius: 0.0625)";
const ROD_3D: &str = "Cylinder(center: (0.2, 0.525, 0.5), axis: Z, radius: 0.0625, length: 0.6)";
const SQUARE: &str = "Box(min: (0.15, 0.475), max: (0.25, 0.575))";

fn rod(dimension: usize) -> &'static str {
    if dimension == 3 { ROD_3D } else { ROD }
}

/// A single particle of fluid in a tank with a body, without gravity.
fn single(dimension: usize, motion: &str, body: &str) -> App {
    let third = |value: &str| if dimension == 3 { format!(", {value}") } else { String::new() };
    let (g, from, to, floor, top) = (third("0.0"), third("0.5"), third("0.55"), third("0.0"), third("1.0"));
    let scene = format!(
        r#"Scene(
            dimension: {dimension}, spacing: {SPACING}, gravity: (0.0, 0.0{g}), end_time: 10.0,
            equation_of_state: (max_speed: 1.0, max_pressure: 1000.0),
            phases: {{ "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.0001)) }},
            fluids: [(phase: "water", shape: Box(min: (0.5, 0.5{from}), max: (0.55, 0.55{to})), pressure: Uniform(0.0))],
            walls: {{ "tank": (shape: Box(min: (0.0, 0.0{floor}), max: (1.0, 1.0{top})), motion: {motion}) }},
            structures: {{ "body": (shape: {body}) }},
        )"#
    );
    app(&scene, &[])
}

/// Puts the particle at `x` with the velocity `v`, lets `duration` (s) pass, and says where it is and how fast, step by step.
fn fly(app: &mut App, x: DVec3, v: DVec3, duration: f64) -> Vec<(DVec3, DVec3)> {
    let world = app.world_mut();
    let mut fluid = world.query_filtered::<(&mut Position, &mut Velocity), With<Fluid>>();
    for (mut position, mut velocity) in fluid.iter_mut(world) {
        (position.0, velocity.0) = (x, v);
    }
    let mut way = Vec::new();
    while world.resource::<Clock>().time < duration {
        advance(world, 1);
        let (x, v) = fluid.iter(world).next().map(|(x, v)| (x.0, v.0)).expect("there is fluid");
        way.push((x, v));
    }
    way
}

/// Out of a floor and out of a thin rod, to well below the half spacing that counts as inside, with no more than the energy of a spring that holds
/// it with `ω = c/√(dp h)`. (It ends where the spring balances the tension of a particle that has left its ghosts behind.)
#[test]
fn what_rests_in_a_body_comes_out_gently() {
    for dimension in [2, 3] {
        for depth in [0.6, 0.9] {
            let z = if dimension == 3 { 0.525 } else { 0.0 };
            let places = [
                (DVec3::new(0.525, -depth * SPACING, z), DVec3::Y),
                (DVec3::new(0.2, 0.525 + 0.0625 - depth * SPACING, z), DVec3::Y),
            ];
            for (start, out) in places {
                let way = fly(&mut single(dimension, "Still", rod(dimension)), start, DVec3::ZERO, 0.05);
                let (x, v) = way[way.len() - 1];
                let told = format!("{dimension}D, {depth} spacings deep at {start}: at {x} with {v} m/s");
                assert!((x - start).dot(out) > (depth - 0.4) * SPACING, "{told}");
                let fastest = way.iter().map(|(_, v)| v.length()).fold(0.0, f64::max);
                assert!(fastest < 1.2 * SOUND_SPEED * (depth - 0.25), "{told}, {fastest} m/s on the way");
            }
        }
    }
}

/// What is a little behind a face and slides along it over its edge is not flung from there: the ghosts of an edge push aside, too, and
/// a push that asks for the depth alone is no spring beside it.
#[test]
fn what_slides_over_an_edge_gains_nothing() {
    for depth in [0.05, 0.1] {
        let start = DVec3::new(0.225, 0.575 - depth * SPACING, 0.0);
        let way = fly(&mut single(2, "Still", SQUARE), start, 0.6 * DVec3::X, 0.1);
        let fastest = way.iter().map(|(_, v)| v.length()).fold(0.0, f64::max);
        assert!(way[way.len() - 1].0.x > 0.26, "{depth} spacings deep: it is still beside the body");
        assert!(fastest < 0.6 * 1.05, "{depth} spacings deep: {fastest} m/s");
    }
}

/// What is shot at a wall, one that moves towards it too, comes in by a fraction of a spacing, and does not come back faster than it arrived.
#[test]
fn what_hits_a_wall_stays_out_of_it() {
    for (dimension, motion, wall) in
        [(2, "Still", 0.0), (3, "Still", 0.0), (2, "Translation(velocity: (0.0, 0.5))", 0.5)]
    {
        let start = DVec3::new(0.525, 0.15, if dimension == 3 { 0.525 } else { 0.0 });
        let way = fly(&mut single(dimension, motion, rod(dimension)), start, -DVec3::Y, 0.4);
        let steps = way.len() as f64;
        let clearances = way.iter().enumerate().map(|(k, (x, _))| x.y - wall * 0.4 * (k as f64 + 1.0) / steps);
        let least = clearances.fold(f64::INFINITY, f64::min);
        assert!(least > -0.15 * SPACING, "{dimension}D, {motion}: {least} m");
        let fastest = way.iter().map(|(_, v)| v.y - wall).fold(0.0, f64::max);
        assert!(fastest < 1.0 + wall, "{dimension}D, {motion}: {fastest} m/s");
    }
}
