//! The slide on its way, with every rebuild of lists and every re-sorting in it: `cargo bench --profile dev --bench slide`.

#[expect(dead_code, reason = "only other benches start from the tank after some steps")]
mod support;

use std::time::Instant;

use bevy_ecs::prelude::World;
use clap::Parser;
use rayon::ThreadPoolBuilder;
use storegga::clock::Clock;
use storegga::neighbours::Neighbours;
use support::{fluid_particles, scene, step};

/// Times the submarine slide while it moves, a twentieth of a second of it at a time.
///
/// Example: cargo bench --profile dev --bench slide -- --spacing 0.01 --threads 2
#[derive(Parser)]
struct Arguments {
    /// Spacing of particles (m)
    #[arg(long, default_value = "0.02")]
    spacing: String,
    /// Threads
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// With the energy books that the shipped scene keeps
    #[arg(long)]
    books: bool,
    /// What cargo adds
    #[arg(long, hide = true)]
    bench: bool,
}

/// When timing begins (s of simulated time).
const FROM: f64 = 0.4;

/// How long a piece of it is (s of simulated time).
const PIECE: f64 = 0.05;

/// How many of them are timed.
const PIECES: u32 = 8;

const SLIDE: (&str, &str) = ("submarine_slide.ron", include_str!("../scenes/submarine_slide.ron"));

fn main() -> Result<(), rayon::ThreadPoolBuildError> {
    let arguments = Arguments::parse();
    let without_books = ("probes", "{}");
    let spacing = ("spacing", arguments.spacing.as_str());
    let mut app = if arguments.books { scene(SLIDE, &[spacing]) } else { scene(SLIDE, &[spacing, without_books]) };
    let world = app.world_mut();
    let pool = ThreadPoolBuilder::new().num_threads(arguments.threads).build()?;
    let particles = fluid_particles(world);
    pool.install(|| measure(world, particles));
    Ok(())
}

/// Prints a line for every piece, and one for the whole.
fn measure(world: &mut World, particles: u64) {
    run_until(world, FROM);
    println!("{particles} fluid particles");
    println!("{:>16}{:>10}{:>14}{:>16}", "simulated_s", "steps", "new_lists", "updates_per_s");
    let mut all = (0, 0, 0.0);
    for piece in 1..=PIECES {
        let end = FROM + PIECE * f64::from(piece);
        let (lists, start) = (world.resource::<Neighbours>().builds, Instant::now());
        let steps = run_until(world, end);
        let (lists, seconds) = (world.resource::<Neighbours>().builds - lists, start.elapsed().as_secs_f64());
        print_line(&format!("{:.2}-{end:.2}", end - PIECE), particles, (steps, lists, seconds));
        all = (all.0 + steps, all.1 + lists, all.2 + seconds);
    }
    print_line("all", particles, all);
}

fn print_line(what: &str, particles: u64, (steps, lists, seconds): (u64, u64, f64)) {
    println!("{what:>16}{steps:>10}{lists:>14}{:>16.0}", (steps * particles) as f64 / seconds);
}

/// Steps until the simulated time `end` (s); how many.
fn run_until(world: &mut World, end: f64) -> u64 {
    let mut steps = 0;
    while world.resource::<Clock>().time < end {
        step(world);
        steps += 1;
    }
    steps
}
