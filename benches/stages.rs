//! One bench a stage, and the whole step, on the two-phase tank: `cargo bench --profile dev --bench stages`.
//!
//! Every figure is for one thread; `items` are fluid particles, so that items per second are particle updates.

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_ecs::system::IntoSystem;
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use storegga::app::{PaperPlugins, open};
use storegga::clock::Clock;
use storegga::neighbours::Neighbours;
use storegga::particles::Fluid;
use storegga::physics;
use storegga::rheology::{HerschelBulkley, apply_flow_curve};
use storegga::scene::Document;
use storegga::schedule::Step;

fn main() {
    // Stages run on rayon's global threads: one of them, unless the environment says otherwise.
    if std::env::var_os("RAYON_NUM_THREADS").is_none() {
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build_global();
        assert!(one.is_ok(), "the thread pool was there before");
    }
    divan::main();
}

/// Fluid particles: of the tank at spacings of 4, 2 and 0.4 mm.
const SPACINGS: [&str; 3] = ["0.004", "0.002", "0.0004"];

/// The tank of the paper's section 3.1, after some steps.
fn tank(spacing: &str) -> (App, u64) {
    let text = include_str!("../scenes/two_phase_tank.ron");
    // The probes and expectations of the shipped scene take no part in a step.
    let document = Document::parse("two_phase_tank.ron", text).and_then(|scene| scene.set("spacing", spacing));
    let mut app = document.and_then(|scene| open(PaperPlugins, scene)).expect("the shipped scene is right");
    let world = app.world_mut();
    for _ in 0..3 {
        world.resource_mut::<Clock>().begin_step(f64::INFINITY);
        world.run_schedule(Step);
    }
    let particles = world.query_filtered::<(), With<Fluid>>().iter(world).count() as u64;
    (app, particles)
}

fn bench_stage<M>(bencher: Bencher<'_, '_>, stage: impl IntoSystem<(), (), M> + 'static) {
    let (mut app, particles) = tank("0.002");
    let world = app.world_mut();
    let system = world.register_system(stage);
    bencher.counter(ItemsCount::new(particles)).bench_local(|| {
        assert!(black_box(world.run_system(system)).is_ok(), "a stage fails");
    });
}

#[divan::bench]
fn s1_pair_kernel(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::pair_kernel::<2>);
}

#[divan::bench]
fn s2_ghost_velocity(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::ghost_velocity);
}

#[divan::bench]
fn s3_strain_rate(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::strain_rate::<2>);
}

#[divan::bench]
fn s4_rheology(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, apply_flow_curve::<HerschelBulkley>);
}

#[divan::bench]
fn s5_continuity(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::density_rate::<2>);
}

#[divan::bench]
fn s6_diffusion(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::density_diffusion::<2>);
}

#[divan::bench]
fn s6_free_surface(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::free_surface::<2>);
}

#[divan::bench]
fn s7_ghost_pressure(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::ghost_pressure);
}

#[divan::bench]
fn s8_wall_impact(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::wall_impact);
}

#[divan::bench]
fn s9_momentum(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::momentum::<2>);
}

/// Δt and the watch over divergence.
#[divan::bench]
fn t1_time_step(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::next_time_step);
}

#[divan::bench(args = SPACINGS, sample_count = 10)]
fn step(bencher: Bencher<'_, '_>, spacing: &str) {
    let (mut app, particles) = tank(spacing);
    let world = app.world_mut();
    bencher.counter(ItemsCount::new(particles)).bench_local(|| {
        world.resource_mut::<Clock>().begin_step(f64::INFINITY);
        world.run_schedule(Step);
    });
}

#[divan::bench(args = ["0.002"], sample_count = 10)]
fn step_with_new_lists(bencher: Bencher<'_, '_>, spacing: &str) {
    let (mut app, particles) = tank(spacing);
    let world = app.world_mut();
    bencher.counter(ItemsCount::new(particles)).bench_local(|| {
        world.resource_mut::<Neighbours>().invalidate();
        world.resource_mut::<Clock>().begin_step(f64::INFINITY);
        world.run_schedule(Step);
    });
}
