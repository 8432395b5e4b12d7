//! Neighbour lists against brute force, across periodic sides and through moves within the skin.

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::kernels::SmoothingKernel;
use storegga::neighbours::{Neighbours, PeriodicSides};
use storegga::particles::{Fluid, Position, Wall};

use crate::support::{Noise, advance, app, disturb, evaluate, periodic_box, tank};

/// Pairs (i, j) of fluid particles nearer than the support, by the lists and by brute force.
fn compare(world: &mut World) {
    let radius = world.resource::<SmoothingKernel>().0.radius();
    let sides = *world.resource::<PeriodicSides>();
    let mut query = world.query_filtered::<&Position, With<Fluid>>();
    let positions: Vec<DVec3> = query.iter(world).map(|x| x.0).collect();
    let neighbours = world.resource::<Neighbours>();
    for i in 0..positions.len() {
        let rows = &neighbours.rows;
        let reaches = |row: &u32| {
            let x_j = positions[rows.source(*row)] + rows.shift(*row);
            positions[i].distance(x_j) < radius * (1.0 - 1e-6)
        };
        let near = neighbours.fluid.of(i).fluid.iter();
        let mut listed: Vec<usize> = near.filter(reaches).map(|row| rows.source(row)).filter(|j| *j != i).collect();
        let near = |j: &usize| sides.separation(positions[i], positions[*j]).length() < radius * (1.0 - 1e-6);
        let mut brute: Vec<usize> = (0..positions.len()).filter(|j| *j != i && near(j)).collect();
        listed.sort_unstable();
        brute.sort_unstable();
        assert_eq!(listed, brute, "neighbours of particle {i}");
    }
}

#[test]
fn lists_are_complete_in_periodic_boxes() {
    for dimension in [2, 3] {
        let mut app = app(&periodic_box(dimension), &[]);
        let world = app.world_mut();
        disturb(world, dimension, 0.02, |_| DVec3::ZERO);
        evaluate(world);
        compare(world);
    }
}

#[test]
fn lists_stay_complete_while_particles_move() {
    for dimension in [2, 3] {
        let mut app = app(&periodic_box(dimension), &[]);
        let world = app.world_mut();
        let mut noise = Noise(3);
        disturb(world, dimension, 0.005, |_| DVec3::X + 0.5 * noise.vector(dimension));
        evaluate(world);
        let builds = world.resource::<Neighbours>().builds;
        for _ in 0..15 {
            advance(world, 7);
            compare(world);
        }
        assert!(world.resource::<Neighbours>().builds > builds, "the skin was never used up: nothing was tested");
    }
}

#[test]
fn lists_are_complete_at_walls() {
    for dimension in [2, 3] {
        let mut app = app(&tank(dimension), &[]);
        let world = app.world_mut();
        advance(world, 5);
        compare(world);
        // Each ghost lists the fluid within the support.
        let radius = world.resource::<SmoothingKernel>().0.radius();
        let fluid: Vec<DVec3> = world.query_filtered::<&Position, With<Fluid>>().iter(world).map(|x| x.0).collect();
        let walls: Vec<DVec3> = world.query_filtered::<&Position, With<Wall>>().iter(world).map(|x| x.0).collect();
        let neighbours = world.resource::<Neighbours>();
        for (b, x) in walls.iter().enumerate() {
            let near = |f: &DVec3| f.distance(*x) < radius * (1.0 - 1e-6);
            let brute = fluid.iter().filter(|f| near(f)).count();
            let listed = neighbours.walls.of(b).rows.iter().filter(|row| near(&fluid[**row as usize])).count();
            assert_eq!(listed, brute, "neighbours of ghost {b}");
        }
    }
}
