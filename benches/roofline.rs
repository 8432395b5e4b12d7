//! What this machine can do at most, for [the page on speed](../docs/speed.md): `cargo bench --profile dev --bench roofline`.
//!
//! One thread. Fused products, and roots with divisions, as fast as the processor takes them; bytes from memory; and the kernel, whose
//! pairs the loops over pairs cannot outrun. Then what a pair of the lists takes in the two sweeps of a step. The last line is the share of a run
//! that the frames of a log take.

mod support;

use std::hint::black_box;
use std::time::Instant;

use bevy_ecs::system::IntoSystem;
use pulp::{Arch, Simd, WithSimd};
use storegga::clock::Clock;
use storegga::kernels::SmoothingKernel;
use storegga::log::{Column, FLUID_FIELDS, LogWriter};
use storegga::neighbours::Neighbours;
use storegga::particles::{Fluid, Position, Workspace};
use storegga::physics;
use support::{step, tank};

/// Rounds; the fastest counts.
const ROUNDS: usize = 20;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let (count, seconds) = fastest(|| Arch::new().dispatch(FusedProducts));
    println!("{:<44}{:>9.2} G/s", "fused products of 64 bits", count / seconds / 1e9);
    let (count, seconds) = fastest(|| Arch::new().dispatch(RootsAndDivisions));
    println!("{:<44}{:>9.2} G/s", "roots, each with a division", count / seconds / 1e9);
    let (bytes, seconds) = memory();
    println!("{:<44}{:>9.2} GB/s", "bytes read and written, a = b + s c", bytes / seconds / 1e9);
    let (pairs, seconds) = kernel();
    println!("{:<44}{:>9.2} G/s", "(dW/dr)/r of the quintic, r² near", pairs / seconds / 1e9);
    sweeps(2, "0.002", physics::midway_sums::<2>, physics::momentum::<2>);
    sweeps(3, "0.005", physics::midway_sums::<3>, physics::momentum::<3>);
    share_of_log()
}

/// What `work` counts, and the seconds of its fastest round.
fn fastest(work: impl FnMut() -> f64) -> (f64, f64) {
    fastest_of(ROUNDS, work)
}

/// Turns of the loops over registers.
const TURNS: usize = 1_000_000;

/// Chains that do not wait for one another: more than a processor has on the way at once, and few enough for its registers.
const CHAINS: usize = 10;

struct FusedProducts;

impl WithSimd for FusedProducts {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (factor, addend) = (simd.splat_f64s(black_box(0.999)), simd.splat_f64s(black_box(0.001)));
        let mut sums = [simd.splat_f64s(black_box(0.5)); CHAINS];
        for _ in 0..TURNS {
            for sum in &mut sums {
                *sum = simd.mul_add_f64s(*sum, factor, addend);
            }
        }
        black_box(sums);
        (TURNS * CHAINS * S::F64_LANES) as f64
    }
}

struct RootsAndDivisions;

impl WithSimd for RootsAndDivisions {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        // v ← a/√v goes to and fro about a^(2/3) for long: √1 and 1/1 may be easier than others.
        let a = simd.splat_f64s(black_box(1.234_567));
        let mut values = [simd.splat_f64s(black_box(3.3)); CHAINS];
        for _ in 0..TURNS / 10 {
            for value in &mut values {
                *value = simd.div_f64s(a, simd.sqrt_f64s(*value));
            }
        }
        black_box(values);
        (TURNS / 10 * CHAINS * S::F64_LANES) as f64
    }
}

/// Three columns that no cache holds.
fn memory() -> (f64, f64) {
    let (mut a, b, c) = (vec![0.0; 1 << 23], vec![1.0; 1 << 23], vec![2.0; 1 << 23]);
    fastest(|| {
        let s = black_box(3.0);
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = b + s * c;
        }
        black_box(&a);
        (3 * 8 * a.len()) as f64
    })
}

fn kernel() -> (f64, f64) {
    let (app, _) = tank(2, &[("spacing", "0.02")]);
    let kernel = app.world().resource::<SmoothingKernel>().0.clone();
    let radius = kernel.radius();
    let squares: [f64; 256] = std::array::from_fn(|k| (radius * (k as f64 + 0.5) / 256.0).powi(2));
    fastest(|| {
        for _ in 0..1000 {
            let mut pairs = squares;
            kernel.gradients(black_box(&mut pairs));
            black_box(&pairs);
        }
        256e3
    })
}

/// Prints how many pairs the lists of the tank have, and what one takes in the sweep over the middle of the drift (1) and that over its end (2), what is
/// done once a particle included.
fn sweeps<A, B>(
    dimension: usize,
    spacing: &str,
    midway: impl IntoSystem<(), (), A> + 'static,
    momentum: impl IntoSystem<(), (), B> + 'static,
) {
    let (mut app, particles) = tank(dimension, &[("spacing", spacing)]);
    let world = app.world_mut();
    let pairs = world.resource::<Neighbours>().fluid.len() as f64;
    println!("{:<44}{:>9.2}", format!("{dimension}D: pairs listed, a fluid particle"), pairs / particles as f64);
    for (name, system) in [("1", world.register_system(midway)), ("2", world.register_system(momentum))] {
        let (_, seconds) = fastest_of(ROUNDS, || assert!(world.run_system(system).is_ok(), "a stage fails"));
        println!("{:<44}{:>9.2} ns", format!("{dimension}D: a pair in sweep {name}"), 1e9 * seconds / pairs);
    }
}

/// Simulated seconds between two frames.
const FRAME_INTERVAL: f64 = 0.01;

/// A frame of 10⁶ particles, written and brought to the operating system, beside the steps until the next.
fn share_of_log() -> Result<(), Box<dyn std::error::Error>> {
    let (mut app, particles) = tank(2, &[("spacing", "0.0004")]);
    let world = app.world_mut();
    let (_, step) = fastest_of(3, || step(world));
    let mut places = world.query_filtered::<&Position, bevy_ecs::prelude::With<Fluid>>();
    let places: Vec<_> = places.iter(world).map(|place| place.0).collect();
    let (scalars, bytes, numbers) = (places.iter().map(|x| x.y), vec![1; places.len()], vec![2; places.len()]);
    let scalars: Vec<f64> = scalars.collect();
    let path = std::env::temp_dir().join(format!("storegga_roofline_{}.mcap", std::process::id()));
    let mut log = LogWriter::create(&path)?;
    let cloud = log.add_points("/particles", &FLUID_FIELDS)?;
    let vector = Column::Vector(&places);
    let scalar = Column::Scalar(&scalars);
    let columns = [vector, vector, scalar, scalar, scalar, scalar, Column::U8(&bytes), Column::U32(&numbers)];
    let mut workspace = Workspace::default();
    let (result, frame) =
        fastest_of(3, || log.write_points(cloud, 0.0, &columns, &mut workspace).and_then(|()| log.flush()));
    result?;
    log.finish()?;
    std::fs::remove_file(&path)?;
    let steps = FRAME_INTERVAL / world.resource::<Clock>().time_step;
    println!(
        "{:<44}{:>9.3} %   ({frame:.3} s a frame of {particles} particles, {steps:.0} steps of {step:.3} s)",
        "log: of a run's time, a frame every 0.01 s",
        100.0 * frame / (frame + steps * step),
    );
    Ok(())
}

/// The last result and the seconds of the fastest of `rounds`.
fn fastest_of<T>(rounds: usize, mut work: impl FnMut() -> T) -> (T, f64) {
    let mut timed = || {
        let start = Instant::now();
        (work(), start.elapsed().as_secs_f64())
    };
    let first = timed();
    (1..rounds).fold(first, |least, _| {
        let next = timed();
        (next.0, least.1.min(next.1))
    })
}
