//! The same scene gives the same bits, for any number of threads.

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::neighbours::Neighbours;
use storegga::particles::{Density, Fluid, ParticleId, Position, Pressure, Velocity, Viscosity};

use crate::support::{advance, app, tank};

/// A column of liquid that collapses: things move, lists are rebuilt, particles are re-sorted.
fn collapse(dimension: usize) -> String {
    tank(dimension)
        .replace("Box(min: (0.0, 0.0), max: (1.0, 0.5))", "Box(min: (0.0, 0.0), max: (0.4, 0.6))")
        .replace("Box(min: (0.0, 0.0, 0.0), max: (1.0, 1.0, 0.5))", "Box(min: (0.0, 0.0, 0.0), max: (0.4, 1.0, 0.6))")
        .replace("phases:", "neighbours: (skin: 0.02, sort_every: 2), phases:")
}

/// Every bit of the state after `steps` steps with `threads` threads, by particle.
fn bits(scene: &str, threads: usize, steps: u64) -> Vec<(u32, Vec<u64>)> {
    let mut app = app(scene, &["spacing=0.04"]);
    let world = app.world_mut();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
    pool.install(|| advance(world, steps));
    assert!(world.resource::<Neighbours>().builds > 5, "lists were hardly rebuilt");
    let mut fluid =
        world.query_filtered::<(&ParticleId, &Position, &Velocity, &Density, &Pressure, &Viscosity), With<Fluid>>();
    let each = |v: DVec3| v.to_array().map(f64::to_bits);
    fluid
        .iter(world)
        .map(|(id, x, v, rho, p, mu)| {
            let scalars = [rho.0, p.0, mu.0].map(f64::to_bits);
            (id.0, [each(x.0), each(v.0), scalars].concat())
        })
        .collect()
}

#[test]
fn one_and_two_threads_agree_to_the_bit() {
    for dimension in [2, 3] {
        let steps = 500;
        let one = bits(&collapse(dimension), 1, steps);
        // The order of rows is part of the state.
        assert!(one.windows(2).any(|pair| pair[0].0 > pair[1].0), "particles were never re-sorted");
        assert_eq!(one, bits(&collapse(dimension), 2, steps), "{dimension}D");
    }
}
