//! One bench a stage, and the whole step, on the two-phase tank: `cargo bench --profile dev --bench stages`.
//!
//! Every figure is for one thread; `items` are fluid particles, so that items per second are particle updates.

mod support;

use bevy_ecs::prelude::*;
use bevy_ecs::system::IntoSystem;
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use rayon::prelude::*;
use storegga::kernels::SmoothingKernel;
use storegga::neighbours::Neighbours;
use storegga::particles::{Acceleration, Density, Fluid, GRAIN, PIECE, Velocity, Viscosity};
use storegga::physics;
use storegga::rheology::{HerschelBulkley, apply_flow_curve};
use support::tank;

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

const SPACING: (&str, &str) = ("spacing", "0.002");
const ANTUONO: (&str, &str) = ("diffusion", "Antuono(delta: 0.1)");

fn bench_stage<M>(bencher: Bencher<'_, '_>, stage: impl IntoSystem<(), (), M> + 'static) {
    bench_stage_of(&[SPACING], bencher, stage);
}

fn bench_stage_of<M>(
    overrides: &[(&str, &str)],
    bencher: Bencher<'_, '_>,
    stage: impl IntoSystem<(), (), M> + 'static,
) {
    let (mut app, particles) = tank(2, overrides);
    let world = app.world_mut();
    // A stage that is benched makes its sums by itself.
    world.resource_mut::<physics::MidwaySums>().clear();
    let system = world.register_system(stage);
    bencher.counter(ItemsCount::new(particles)).bench_local(|| {
        assert!(black_box(world.run_system(system)).is_ok(), "a stage fails");
    });
}

/// ∇W alone, for 256 pairs whose r² lie in the nearest cache: items are pairs.
#[divan::bench]
fn k1_kernel_gradient(bencher: Bencher<'_, '_>) {
    let (app, _) = tank(2, &[("spacing", "0.02")]);
    let kernel = app.world().resource::<SmoothingKernel>().clone();
    let radius = kernel.0.radius();
    let inputs = || std::array::from_fn::<f64, 256, _>(|k| (radius * (k as f64 + 0.5) / 256.0).powi(2));
    bencher.counter(ItemsCount::new(256_u64)).with_inputs(inputs).bench_local_refs(|pairs| {
        kernel.0.gradients(black_box(pairs));
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

/// What s3, s5 and s6 do when each does it alone, in one sweep.
#[divan::bench]
fn s3_midway_sums(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::midway_sums::<2>);
}

#[divan::bench]
fn s3_strain_rate(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::strain_rate::<2>);
}

#[divan::bench]
fn s3_wall_shear(bencher: Bencher<'_, '_>) {
    bench_stage(bencher, physics::wall_shear);
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

/// The two stages of `Antuono(delta)`.
#[divan::bench]
fn s6_diffusion_antuono_gradient(bencher: Bencher<'_, '_>) {
    bench_stage_of(&[SPACING, ANTUONO], bencher, physics::compression_gradient::<2>);
}

#[divan::bench]
fn s6_diffusion_antuono(bencher: Bencher<'_, '_>) {
    bench_stage_of(&[SPACING, ANTUONO], bencher, physics::density_diffusion::<2>);
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

/// What Δt alone needs, without the watch over divergence: what the watch costs is the difference.
#[divan::bench]
fn t2_time_step_without_watch(bencher: Bencher<'_, '_>) {
    type Needed = (&'static Velocity, &'static Acceleration, &'static Density, &'static Viscosity);
    fn extremes(fluid: Query<Needed, With<Fluid>>) -> Result {
        for columns in fluid.contiguous_iter()? {
            let each = columns.into_par_iter().with_min_len(GRAIN).with_max_len(PIECE);
            let of = |(v, a, rho, mu): (&Velocity, &Acceleration, &Density, &Viscosity)| {
                [v.0.length_squared(), a.0.length_squared(), mu.0 / rho.0]
            };
            black_box(each.map(of).reduce(|| [0.0; 3], |a, b| std::array::from_fn(|k| f64::max(a[k], b[k]))));
        }
        Ok(())
    }
    bench_stage(bencher, extremes);
}

#[divan::bench(args = SPACINGS, sample_count = 10)]
fn step(bencher: Bencher<'_, '_>, spacing: &str) {
    let (mut app, particles) = tank(2, &[("spacing", spacing)]);
    bencher.counter(ItemsCount::new(particles)).bench_local(|| support::step(app.world_mut()));
}

/// The tank in space at 5 mm: 1.28·10⁵ fluid particles of two phases, h = 1.0 spacing, 113 neighbours.
#[divan::bench(sample_count = 10)]
fn step_3d(bencher: Bencher<'_, '_>) {
    let (mut app, particles) = tank(3, &[("spacing", "0.005")]);
    bencher.counter(ItemsCount::new(particles)).bench_local(|| support::step(app.world_mut()));
}

/// The step at 2 mm with a value overridden, to be compared with the `step` at that spacing.
#[divan::bench(args = ["free_surface=Off", "diffusion=Antuono(delta: 0.1)", "probes={\"books\": Books()}"], sample_count = 10)]
fn step_with(bencher: Bencher<'_, '_>, value: &str) {
    let (mut app, particles) = tank(2, &[SPACING, value.split_once('=').expect("a path and a value")]);
    bencher.counter(ItemsCount::new(particles)).bench_local(|| support::step(app.world_mut()));
}

#[divan::bench(args = ["0.002"], sample_count = 10)]
fn step_with_new_lists(bencher: Bencher<'_, '_>, spacing: &str) {
    let (mut app, particles) = tank(2, &[("spacing", spacing)]);
    let world = app.world_mut();
    bencher.counter(ItemsCount::new(particles)).bench_local(|| {
        world.resource_mut::<Neighbours>().invalidate();
        support::step(world);
    });
}
