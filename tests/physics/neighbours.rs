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

/// Skins follow the speed of each particle: between those of fast and slow ones no pair may be missing.
#[test]
fn lists_stay_complete_around_particles_much_faster_than_others() {
    for dimension in [2, 3] {
        let mut app = app(&periodic_box(dimension), &[]);
        let world = app.world_mut();
        let mut count = 0;
        disturb(world, dimension, 0.002, |_| {
            count += 1;
            if count % 97 == 0 { DVec3::new(1.0, 0.7, 0.0) } else { 0.02 * DVec3::X }
        });
        evaluate(world);
        let builds = world.resource::<Neighbours>().builds;
        for _ in 0..20 {
            advance(world, 3);
            compare(world);
        }
        assert!(world.resource::<Neighbours>().builds > builds + 1, "skins were never used up: nothing was tested");
    }
}

/// A skin of nothing, whatever its sign, tells fluid from ghosts.
#[test]
fn lists_without_a_skin_are_complete_at_walls() {
    for skin in ["0.0", "-0.0"] {
        let scene = tank(2).replace("dimension: 2,", &format!("dimension: 2, neighbours: (skin: {skin}),"));
        let mut app = app(&scene, &[]);
        let world = app.world_mut();
        advance(world, 3);
        compare(world);
        compare_ghosts(world);
    }
}

/// Whoever puts a particle elsewhere need not tell the lists.
#[test]
fn a_particle_that_was_put_elsewhere_is_found() {
    let mut app = app(&periodic_box(2), &[]);
    let world = app.world_mut();
    advance(world, 2);
    let mut fluid = world.query_filtered::<&mut Position, With<Fluid>>();
    if let Some(mut x) = fluid.iter_mut(world).next() {
        x.0 += DVec3::new(0.02, 0.33, 0.0);
    }
    advance(world, 1);
    compare(world);
}

#[test]
fn lists_are_complete_at_walls_that_move() {
    let still = tank(2);
    let scene = still.replace("max: (1.0, 1.0))) }", "max: (1.0, 1.0)), motion: Translation(velocity: (0.3, 0.0))) }");
    assert_ne!(scene, still);
    let mut app = app(&scene, &[]);
    let world = app.world_mut();
    let builds = world.resource::<Neighbours>().builds;
    for _ in 0..10 {
        advance(world, 7);
        compare(world);
        compare_ghosts(world);
    }
    assert!(world.resource::<Neighbours>().builds > builds + 2, "skins were never used up: nothing was tested");
}

#[test]
fn lists_are_complete_at_walls() {
    for dimension in [2, 3] {
        let mut app = app(&tank(dimension), &[]);
        let world = app.world_mut();
        advance(world, 5);
        compare(world);
        compare_ghosts(world);
    }
}

/// Each ghost of a wall lists the fluid within the support, and each fluid particle those ghosts.
fn compare_ghosts(world: &mut World) {
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
    for (i, x) in fluid.iter().enumerate() {
        let near = |b: &DVec3| b.distance(*x) < radius * (1.0 - 1e-6);
        let brute = walls.iter().filter(|b| near(b)).count();
        let ghosts = neighbours.fluid.of(i).ghosts.iter();
        let listed = ghosts.filter(|row| near(&walls[**row as usize - fluid.len()])).count();
        assert_eq!(listed, brute, "ghosts near particle {i}");
    }
}
