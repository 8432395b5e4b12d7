//! Walls that overlap count once.

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::particles::{Acceleration, Fluid, Position, Wall};

use crate::support::{app, refusal, tank};

/// The tank with further walls, before and after it.
fn composed(dimension: usize, before: &str, after: &str) -> String {
    let scene = tank(dimension);
    let (head, tail) = scene.split_once("walls: {").unwrap_or_else(|| panic!("no walls in {scene}"));
    let (own, tail) = tail.split_once(" },").unwrap_or_else(|| panic!("no end of walls in {scene}"));
    format!("{head}walls: {{ {before} {own}, {after} }},{tail}")
}

fn ghosts(world: &mut World) -> Vec<DVec3> {
    world.query_filtered::<&Position, With<Wall>>().iter(world).map(|x| x.0).collect()
}

/// A block under the tank, its top at the tank's floor, on the lattice if `off` is 0.
fn floor(dimension: usize, off: f64) -> String {
    let point = |x: f64, z: f64| match dimension {
        2 => format!("({:?}, {z:?})", x + off),
        _ => format!("({:?}, {:?}, {z:?})", x + off, x + off),
    };
    format!(r#""floor": (shape: Box(min: {}, max: {}), fluid: Outside),"#, point(-0.5, -0.4), point(1.5, 0.0))
}

#[test]
fn a_wall_written_twice_is_there_once() {
    for dimension in [2, 3] {
        let (mut once, twice) = (app(&tank(dimension), &[]), tank(dimension).replace("\"tank\"", "\"again\""));
        let (_, again) = twice.split_once("walls: {").unwrap_or_default();
        let (again, _) = again.split_once(" },").unwrap_or_default();
        let mut twice = app(&composed(dimension, "", again), &[]);
        assert_eq!(ghosts(once.world_mut()), ghosts(twice.world_mut()), "{dimension}D");
    }
}

/// At rest in layers the fluid does not fall, nor is it thrown up by a floor that weighs twice.
#[test]
fn a_floor_under_a_tank_bears_the_fluid_as_the_tank_alone_does() {
    for dimension in [2, 3] {
        let strongest = |scene: &str| {
            let mut app = app(scene, &[]);
            let world = app.world_mut();
            crate::support::evaluate(world);
            let mut fluid = world.query_filtered::<(&Position, &Acceleration), With<Fluid>>();
            let deep = fluid.iter(world).filter(|(x, _)| x.0[dimension - 1] < 0.3);
            deep.map(|(_, a)| a.0.length()).fold(0.0, f64::max)
        };
        let alone = strongest(&tank(dimension));
        for off in [0.0, 0.02] {
            let floor = floor(dimension, off);
            for (before, after) in [(&*floor, ""), ("", &*floor)] {
                let together = strongest(&composed(dimension, before, after));
                assert!(together < alone + 0.05 * 9.81, "{dimension}D, off by {off} m: {together} m/s², alone {alone}");
            }
        }
    }
}

#[test]
fn what_walls_leave_to_the_fluid_keeps_the_ghosts_of_others() {
    let sill = r#""sill": (shape: Box(min: (0.4, 0.0), max: (0.6, 0.2)), fluid: Outside)"#;
    let mut app = app(
        &composed(2, "", sill).replace("max: (1.0, 0.5)", "max: (1.0, 0.2)"),
        &["fluids.0.shape=Box(min: (0.0, 0.2), max: (1.0, 0.5))"],
    );
    let inside = ghosts(app.world_mut()).into_iter().filter(|x| x.x > 0.4 && x.x < 0.6 && x.y > 0.0 && x.y < 0.2);
    assert_eq!(inside.count(), 16, "4 by 4 cells of 0.05 m");
}

/// A block across a periodic side, on the floor of a channel: the half beyond the side is filled as the one within.
#[test]
fn a_block_across_a_periodic_side_is_whole() {
    let block = r#""block": (shape: Box(min: (-0.2, 0.0), max: (0.2, 0.2)), fluid: Outside),"#;
    for (before, after) in [(block, ""), ("", block)] {
        let scene = composed(2, before, after).replace("dimension: 2,", "dimension: 2, periodic: (x: (0.0, 1.0)),");
        let mut app = app(&scene, &["fluids.0.shape=Box(min: (0.0, 0.25), max: (1.0, 0.5))"]);
        let inside = ghosts(app.world_mut()).into_iter().filter(|x| x.y > 0.0 && x.y < 0.2);
        assert_eq!(inside.filter(|x| x.x < 0.2 || x.x > 0.8 || x.x < 0.0).count(), 32, "8 by 4 cells of 0.05 m");
    }
}

#[test]
fn walls_that_part_must_not_overlap() {
    let moving = floor(2, 0.0).replace("Outside", "Outside, motion: Translation(velocity: (0.0, -0.1))");
    for (before, after) in [(&*moving, ""), ("", &*moving)] {
        let said = refusal(&composed(2, before, after), &[]);
        assert!(said.contains("which moves otherwise"), "{said}");
    }
    // Out of the tank's ghosts, four layers deep, it may move as it likes.
    let below = moving.replace("max: (1.5, 0.0)", "max: (1.5, -0.25)");
    assert!(!ghosts(app(&composed(2, "", &below), &[]).world_mut()).is_empty());
}
