//! The same scene gives the same bits, for any number of threads.

use std::f64::consts::TAU;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{PaperPlugins, StoreggaApp, open};
use storegga::boundary::Load;
use storegga::checkpoint::{check_state, restore_state, save_state};
use storegga::neighbours::Neighbours;
use storegga::particles::{Density, DensityRate, Fluid, ParticleId, Position, Pressure, Velocity, Viscosity};
use storegga::physics::{MidwaySums, density_diffusion, density_rate, free_surface, strain_rate};
use storegga::scene::Document;
use storegga::schedule::Stage;

use crate::support::{advance, app, cube, disturb, evaluate, periodic_box, tank};

/// A column of liquid that collapses: things move, lists are rebuilt, particles are re-sorted.
fn collapse(dimension: usize) -> String {
    tank(dimension)
        .replace("Box(min: (0.0, 0.0), max: (1.0, 0.5))", "Box(min: (0.0, 0.0), max: (0.4, 0.6))")
        .replace("Box(min: (0.0, 0.0, 0.0), max: (1.0, 1.0, 0.5))", "Box(min: (0.0, 0.0, 0.0), max: (0.4, 1.0, 0.6))")
        .replace("phases:", "neighbours: (skin: 0.02, sort_every: 2), phases:")
        .replace("spacing: 0.05", if dimension == 2 { "spacing: 0.04" } else { "spacing: 0.05" })
        .replace("walls:", "probes: { \"fluid\": DensityError() }, log: (series: 0.01), walls:")
}

/// Every bit of the particles, in the order of their rows, and of loads.
type Bits = Vec<(u32, Vec<u64>)>;

/// Every bit of the particles after `steps` steps with `threads` threads, and all that a checkpoint would hold.
fn bits(scene: &str, threads: usize, steps: u64) -> (Bits, Vec<u8>) {
    bits_of(app(scene, &[]), threads, steps)
}

fn bits_of(mut app: App, threads: usize, steps: u64) -> (Bits, Vec<u8>) {
    let world = app.world_mut();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
    pool.install(|| advance(world, steps));
    assert!(world.resource::<Neighbours>().builds > 5, "lists were hardly rebuilt");
    let mut fluid =
        world.query_filtered::<(&ParticleId, &Position, &Velocity, &Density, &Pressure, &Viscosity), With<Fluid>>();
    let each = |v: DVec3| v.to_array().map(f64::to_bits);
    let mut bits: Bits = fluid
        .iter(world)
        .map(|(id, x, v, rho, p, mu)| {
            let scalars = [rho.0, p.0, mu.0].map(f64::to_bits);
            (id.0, [each(x.0), each(v.0), scalars].concat())
        })
        .collect();
    for load in world.query::<&Load>().iter(world) {
        bits.push((u32::MAX, [each(load.force()), each(load.moment())].concat()));
    }
    (bits, save_state(world).expect("the state is saved"))
}

/// Threads that must not make a difference: more than there are cores as well, and a number that divides nothing.
const THREADS: [usize; 3] = [2, 3, 8];

/// Checks that all numbers of threads give the same state, order of rows, loads, series and books.
fn threads_agree(scene: &str, steps: u64) {
    let (one, saved) = bits(scene, 1, steps);
    // The order of rows is part of the state.
    assert!(one.windows(2).any(|pair| pair[0].0 > pair[1].0), "particles were never re-sorted");
    for threads in THREADS {
        let (bits, also_saved) = bits(scene, threads, steps);
        assert!(one == bits, "{threads} threads: another state than 1");
        assert!(saved == also_saved, "{threads} threads: other series or other state besides the particles than 1");
    }
}

#[test]
fn threads_agree_to_the_bit() {
    for dimension in [2, 3] {
        threads_agree(&collapse(dimension), 300);
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
            periodic: (x: (0.0, 0.8){z}), neighbours: (skin: 0.02, sort_every: 2), equation_of_state: (max_speed: 3.0), shifting: Fickian(),
            tensile_control: PressureDifference,
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
            probes: {{ "books": Books(), "mud": CenterOfMass(phase: "mud"), "fluid": DensityError() }},
            log: (series: 0.01),
        )"#,
        at(0.4, 0.3, 0.4),
    )
}

#[test]
fn threads_agree_on_two_phases_moving_walls_structures_periodic_sides_and_probes() {
    for dimension in [2, 3] {
        threads_agree(&stream(dimension), 300);
    }
}

/// The stream with what a scene gets that says nothing of neighbours, and without books.
fn ordinary_stream(dimension: usize) -> String {
    let scene = stream(dimension);
    let ordinary = scene.replace("neighbours: (skin: 0.02, sort_every: 2),", "").replace("\"books\": Books(),", "");
    assert!(ordinary.len() < scene.len() - 50, "both are gone");
    ordinary
}

#[test]
fn threads_agree_on_a_skin_that_follows_the_flow() {
    for dimension in [2, 3] {
        threads_agree(&ordinary_stream(dimension), 300);
    }
}

/// The plain loops (one particle at a time, the formulas as they stand) are what the fast ones are measured against.
#[test]
fn fast_loops_give_the_bits_of_plain_ones() {
    for dimension in [2, 3] {
        let fast = ordinary_stream(dimension);
        let plain = fast.replace("phases:", "neighbours: (loops: Plain), phases:");
        assert_ne!(plain, fast);
        let steps = if dimension == 2 { 300 } else { 60 };
        assert!(bits(&plain, 1, steps) == bits(&fast, 2, steps), "plain and fast loops differ in {dimension}D");
        let [plain, fast] = [plain, fast].map(|scene| scene.replace("probes: {", "probes: { \"books\": Books(),"));
        assert!(bits(&plain, 1, steps) == bits(&fast, 2, steps), "and with books, in {dimension}D");
    }
}

/// Where nothing moves, sums are zero, and zeros have a sign too.
#[test]
fn zeros_have_the_same_sign_in_fast_and_plain_loops() {
    for dimension in [2, 3] {
        let rates = |loops: &str| {
            let mut app = app(&cube(dimension, 6, &format!("diffusion: Off, neighbours: (loops: {loops}),")), &[]);
            let world = app.world_mut();
            world
                .query_filtered::<&DensityRate, With<Fluid>>()
                .iter(world)
                .map(|rate| rate.0.to_bits())
                .collect::<Vec<_>>()
        };
        assert!(rates("Plain") == rates("Fast"), "in {dimension}D");
    }
}

/// Without the stage of the impact pressure there is none, as if it were off.
#[test]
fn a_step_without_impact_pressures_is_one_with_them_off() {
    struct Without;
    impl Plugin for Without {
        fn build(&self, app: &mut App) {
            app.set_stage(Stage::WallImpact, || {}, || {});
        }
    }
    let particles = |app: App| bits_of(app, 1, 300).0;
    let scene = stream(2);
    let off = scene.replace("tensile_control", "wall_impact: Off, tensile_control");
    let document = Document::parse("test.ron", &scene).expect("the scene is right");
    let without = particles(open((PaperPlugins, Without), document).expect("the scene is right"));
    assert!(without == particles(app(&off, &[])), "other bits");
    assert!(without != particles(app(&scene, &[])), "nothing met a wall");
}

/// A stage that is put in charge anew makes its sum by itself: strain rate, continuity, diffusion and free surface do when
/// nobody has made their sums ahead, be it from the first of them on or from a later one.
#[test]
fn stages_alone_give_the_bits_of_their_sums_made_together() {
    struct Alone(Stage);
    impl Plugin for Alone {
        fn build(&self, app: &mut App) {
            let forget = |mut sums: ResMut<MidwaySums>| sums.clear();
            let stage = self.0;
            match stage {
                Stage::StrainRate => app.set_stage(stage, strain_rate::<2>, strain_rate::<3>),
                Stage::Continuity => {
                    app.set_stage(stage, (forget, density_rate::<2>).chain(), (forget, density_rate::<3>).chain())
                }
                Stage::Diffusion => {
                    let two = (forget, density_diffusion::<2>).chain();
                    app.set_stage(stage, two, (forget, density_diffusion::<3>).chain())
                }
                _ => app.set_stage(stage, (forget, free_surface::<2>).chain(), (forget, free_surface::<3>).chain()),
            };
        }
    }
    for dimension in [2, 3] {
        let (scene, steps) = (stream(dimension), if dimension == 2 { 300 } else { 60 });
        let together = bits(&scene, 1, steps);
        for stage in [Stage::StrainRate, Stage::Continuity, Stage::Diffusion, Stage::FreeSurface] {
            let document = Document::parse("test.ron", &scene).expect("the scene is right");
            let alone = open((PaperPlugins, Alone(stage)), document).expect("the scene is right");
            assert!(bits_of(alone, 1, steps) == together, "other bits with {stage:?} alone in {dimension}D");
        }
    }
}

/// The books tell the forces of a step apart and leave their sum to the momentum stage, which makes it by itself without them.
#[test]
fn books_change_no_bit_of_the_particles() {
    for dimension in [2, 3] {
        let (with, steps) = (stream(dimension), if dimension == 2 { 300 } else { 60 });
        let without = with.replace("\"books\": Books(),", "");
        assert_ne!(with, without);
        assert!(bits(&with, 1, steps).0 == bits(&without, 1, steps).0, "other bits in {dimension}D");
    }
}

/// Positions, velocities and densities by identity after `steps` steps of four eddies between periodic sides.
fn eddies(dimension: usize, sort_every: u32, steps: u64) -> Vec<(u32, DVec3, DVec3, f64)> {
    let scene = periodic_box(dimension).replace("phases:", &format!("neighbours: (sort_every: {sort_every}), phases:"));
    let mut app = app(&scene, &["equation_of_state.background_pressure=500.0"]);
    let world = app.world_mut();
    let wave = |x: f64| (TAU * x).sin_cos();
    disturb(world, dimension, 0.0, |x| {
        let ((sin_x, cos_x), (sin_y, cos_y)) = (wave(x.x), wave(x.y));
        0.2 * DVec3::new(sin_x * cos_y, -cos_x * sin_y, 0.0)
    });
    evaluate(world);
    advance(world, steps);
    let mut fluid = world.query_filtered::<(&ParticleId, &Position, &Velocity, &Density), With<Fluid>>();
    let mut state: Vec<_> = fluid.iter(world).map(|(id, x, v, rho)| (id.0, x.0, v.0, rho.0)).collect();
    let is_sorted = state.is_sorted_by_key(|particle| particle.0);
    assert_eq!(is_sorted, sort_every == 0, "re-sorting is off, or never happened");
    state.sort_by_key(|particle| particle.0);
    state
}

#[test]
fn re_sorting_changes_a_smooth_flow_by_rounding_only() {
    for dimension in [2, 3] {
        let (kept, sorted) = (eddies(dimension, 0, 500), eddies(dimension, 1, 500));
        let mut greatest: f64 = 0.0;
        for ((id, x, v, rho), (also_id, also_x, also_v, also_rho)) in kept.into_iter().zip(sorted) {
            assert_eq!(id, also_id);
            // The box is 1 m long, the eddies turn at 0.2 m/s.
            let differences = [x.distance(also_x), v.distance(also_v) / 0.2, rho / also_rho - 1.0];
            greatest = differences.into_iter().fold(greatest, |greatest, difference| greatest.max(difference.abs()));
        }
        // The sums are made in another order: they cannot all be the same.
        assert!(greatest > 0.0 && greatest < 1e-12, "{dimension}D: {greatest:.1e}");
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
        goes_on_like_before(&ordinary_stream(dimension), 233, 300);
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
