//! The same scene gives the same bits, for any number of threads.

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::boundary::Load;
use storegga::checkpoint::{check_state, restore_state, save_state};
use storegga::neighbours::Neighbours;
use storegga::particles::{Density, Fluid, ParticleId, Position, Pressure, Velocity, Viscosity};

use crate::support::{advance, app, tank};

/// A column of liquid that collapses: things move, lists are rebuilt, particles are re-sorted.
fn collapse(dimension: usize) -> String {
    tank(dimension)
        .replace("Box(min: (0.0, 0.0), max: (1.0, 0.5))", "Box(min: (0.0, 0.0), max: (0.4, 0.6))")
        .replace("Box(min: (0.0, 0.0, 0.0), max: (1.0, 1.0, 0.5))", "Box(min: (0.0, 0.0, 0.0), max: (0.4, 1.0, 0.6))")
        .replace("phases:", "neighbours: (skin: 0.02, sort_every: 2), phases:")
        .replace("spacing: 0.05", "spacing: 0.04")
}

/// Every bit of the state after `steps` steps with `threads` threads, by particle.
fn bits(scene: &str, threads: usize, steps: u64) -> Vec<(u32, Vec<u64>)> {
    let mut app = app(scene, &[]);
    let world = app.world_mut();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
    pool.install(|| advance(world, steps));
    assert!(world.resource::<Neighbours>().builds > 5, "lists were hardly rebuilt");
    let mut fluid =
        world.query_filtered::<(&ParticleId, &Position, &Velocity, &Density, &Pressure, &Viscosity), With<Fluid>>();
    let each = |v: DVec3| v.to_array().map(f64::to_bits);
    let mut bits: Vec<(u32, Vec<u64>)> = fluid
        .iter(world)
        .map(|(id, x, v, rho, p, mu)| {
            let scalars = [rho.0, p.0, mu.0].map(f64::to_bits);
            (id.0, [each(x.0), each(v.0), scalars].concat())
        })
        .collect();
    for load in world.query::<&Load>().iter(world) {
        bits.push((u32::MAX, [each(load.force()), each(load.moment())].concat()));
    }
    bits
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

/// Two liquids, one of them with a yield stress, that a body force drives over a floor that moves, past a structure and
/// round through the sides.
fn stream(dimension: usize) -> String {
    let (spacing, z) = if dimension == 2 { (0.04, "") } else { (0.1, ", z: (0.0, 0.8)") };
    let at = |x: f64, y: f64, z: f64| {
        if dimension == 2 { format!("({x:?}, {y:?})") } else { format!("({x:?}, {y:?}, {z:?})") }
    };
    let block = |(x0, y0, z0), (x1, y1, z1)| format!("Box(min: {}, max: {})", at(x0, y0, z0), at(x1, y1, z1));
    let round = if dimension == 2 { "Circle" } else { "Sphere" };
    let (mud, water) = (block((0.0, 0.0, 0.0), (0.8, 0.32, 0.8)), block((0.0, 0.32, 0.0), (0.8, 0.64, 0.8)));
    let (floor, open) = (block((-1.0, 0.0, -1.0), (2.0, 2.0, 2.0)), block((-3.0, 0.0, -3.0), (3.0, 3.0, 3.0)));
    let (gravity, stream, backwards) = (at(4.0, -9.81, 0.0), at(1.0, 0.0, 0.0), at(-0.5, 0.0, 0.0));
    format!(
        r#"Scene(
            dimension: {dimension}, spacing: {spacing:?}, gravity: {gravity}, end_time: 10.0,
            periodic: (x: (0.0, 0.8){z}), neighbours: (skin: 0.02, sort_every: 2), equation_of_state: (max_speed: 3.0),
            phases: {{
                "mud": (reference_density: 1500.0, rheology: HerschelBulkley(
                    consistency: 3.0, exponent: 0.7, yield_stress: 50.0, max_viscosity: 50.0)),
                "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)),
            }},
            fluids: [
                (phase: "mud", shape: {mud}, pressure: Uniform(0.0)),
                (phase: "water", shape: {water}, velocity: {stream}, pressure: Uniform(0.0)),
            ],
            walls: {{ "floor": (shape: {floor}, cut: {open}, motion: Translation(velocity: {backwards})) }},
            structures: {{ "body": (shape: {round}(center: {}, radius: 0.15)) }},
        )"#,
        at(0.4, 0.3, 0.4),
    )
}

#[test]
fn threads_agree_on_two_phases_moving_walls_structures_and_periodic_sides() {
    for dimension in [2, 3] {
        let one = bits(&stream(dimension), 1, 300);
        assert!(one.windows(2).any(|pair| pair[0].0 > pair[1].0), "particles were never re-sorted");
        assert_eq!(one, bits(&stream(dimension), 2, 300), "{dimension}D");
    }
}

/// A run to step `stop` whose state is put into a new world and goes on, against one that was not stopped: every bit.
fn goes_on_like_before(scene: &str, stop: u64, end: u64) {
    let mut straight = app(scene, &[]);
    advance(straight.world_mut(), stop);
    let saved = save_state(straight.world_mut()).expect("the state is saved");
    assert!(straight.world().resource::<Neighbours>().builds > 3, "lists were hardly rebuilt");
    check_state(straight.world()).unwrap_or_else(|forgotten| panic!("neither saved nor rebuilt: {forgotten:?}"));

    let mut resumed = app(scene, &[]);
    restore_state(resumed.world_mut(), &saved).expect("the state fits");
    assert!(saved == save_state(resumed.world_mut()).expect("it is saved again"), "the state is not what was saved");
    for app in [&mut straight, &mut resumed] {
        advance(app.world_mut(), end - stop);
    }
    let [straight, resumed] = [straight, resumed].map(|mut app| save_state(app.world_mut()).expect("it is saved"));
    assert!(straight != saved && straight == resumed, "the resumed run went another way");
}

#[test]
fn a_restored_state_goes_on_with_the_same_bits() {
    for dimension in [2, 3] {
        // Between two builds of the lists, and wherever in the rhythm of re-sorting.
        for stop in [60, 61, 62, 63, 64] {
            goes_on_like_before(&stream(dimension), stop, 100);
        }
        goes_on_like_before(&collapse(dimension), 230, 300);
    }
}

#[test]
fn a_state_that_does_not_fit_is_refused() {
    let saved = save_state(app(&stream(2), &[]).world_mut()).expect("the state is saved");
    let refusal =
        |scene: &str, bytes: &[u8]| restore_state(app(scene, &[]).world_mut(), bytes).expect_err("it is refused");
    let other = refusal(&collapse(2), &saved);
    assert!(other.contains("does not fit") && other.contains("places"), "{other}");
    // No damage may panic, whether it is found or not: a checksum stands around this.
    for k in (0..saved.len()).step_by(997) {
        assert!(!refusal(&stream(2), &saved[..k]).is_empty());
    }
}
