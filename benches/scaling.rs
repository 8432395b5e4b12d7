//! Threads × size: `cargo bench --profile dev --bench scaling` prints a table and writes it to `target/scaling.csv`.

mod support;

use std::fs::File;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use rayon::ThreadPoolBuilder;
use support::{step, tank};

/// Times steps of the two-phase tank, in two and three dimensions, for each size and number of threads.
///
/// Example: cargo bench --profile dev --bench scaling -- --spacings 0.004,0.002 --threads 1,2
#[derive(Parser)]
struct Arguments {
    /// Spacings (m) of the tank in the plane: 10⁴, 4·10⁴, 1.6·10⁵ and 10⁶ fluid particles
    #[arg(long, value_delimiter = ',', default_value = "0.004,0.002,0.001,0.0004")]
    spacings: Vec<String>,
    /// Spacings (m) of the tank in space: 1.6·10⁴ and 1.28·10⁵ fluid particles
    #[arg(long, value_delimiter = ',', default_value = "0.01,0.005")]
    spacings_3d: Vec<String>,
    /// Numbers of threads [default: 1, 2, 4, … up to the cores]
    #[arg(long, value_delimiter = ',')]
    threads: Vec<usize>,
    /// Rounds; the fastest counts
    #[arg(long, default_value_t = 5)]
    rounds: u32,
    /// Where the table is written
    #[arg(long, default_value = "target/scaling.csv")]
    out: PathBuf,
    /// What cargo adds
    #[arg(long, hide = true)]
    bench: bool,
}

/// Particle updates in a round.
const UPDATES: u64 = 2_000_000;

const HEADER: [&str; 7] =
    ["dimension", "spacing_m", "fluid_particles", "threads", "ms_per_step", "ns_per_update", "updates_per_s"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse();
    let cores = std::thread::available_parallelism()?.get();
    let powers = (0..).map(|power| 1 << power).take_while(|threads| *threads <= cores);
    let threads = if arguments.threads.is_empty() { powers.collect() } else { arguments.threads };
    let mut table = csv::Writer::from_writer(File::create(&arguments.out)?);
    table.write_record(HEADER)?;
    println!("{}", HEADER.map(|name| format!("{name:>16}")).concat());
    for (dimension, spacings) in [(2, &arguments.spacings), (3, &arguments.spacings_3d)] {
        for spacing in spacings {
            let (mut app, particles) = tank(dimension, &[("spacing", spacing)]);
            let world = app.world_mut();
            for &threads in &threads {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
                let steps = (UPDATES / particles).max(2);
                let seconds = (0..arguments.rounds).map(|_| {
                    let start = Instant::now();
                    pool.install(|| (0..steps).for_each(|_| step(world)));
                    start.elapsed().as_secs_f64() / steps as f64
                });
                let seconds = seconds.fold(f64::INFINITY, f64::min);
                let row = [
                    dimension.to_string(),
                    spacing.clone(),
                    particles.to_string(),
                    threads.to_string(),
                    format!("{:.3}", 1e3 * seconds),
                    format!("{:.1}", 1e9 * seconds / particles as f64),
                    format!("{:.0}", particles as f64 / seconds),
                ];
                table.write_record(&row)?;
                println!("{}", row.map(|value| format!("{value:>16}")).concat());
            }
        }
    }
    table.flush()?;
    println!("written: {}", arguments.out.display());
    Ok(())
}
