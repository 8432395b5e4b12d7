//! How long a large scene takes to its first step, and the most memory that a run takes: `cargo bench --profile dev --bench start`.
//!
//! The time is that from the text of the scene to the end of the first step, on all cores, as in a run. The memory is the peak of a process of
//! its own, the program itself included, after some builds of lists; Linux tells it.

#[expect(dead_code, reason = "only other benches start from the tank after some steps")]
mod support;

use std::process::Command;
use std::time::Instant;
use std::{env, fs, io};

use bevy_ecs::prelude::{Or, With};
use storegga::neighbours::Neighbours;
use storegga::particles::{Fluid, Solid, Wall};
use support::{fluid_particles, scene, step, tank_scene};

/// The scenes: dimension and spacing (m), of 10⁶ and of 1.28·10⁵ fluid particles.
const SCENES: [(usize, &str); 2] = [(2, "0.0004"), (3, "0.005")];

/// Processes for each; the least time and the greatest memory count.
const ROUNDS: usize = 3;

/// Builds of lists after which the memory is looked at.
const BUILDS: u64 = 4;

fn main() -> io::Result<()> {
    let arguments: Vec<String> = env::args().collect();
    if let Some(one) = arguments.iter().position(|argument| argument == "--one") {
        return measure(&SCENES[usize::from(arguments[one + 1] == "3")]);
    }
    for (dimension, spacing) in SCENES {
        println!("tank in {dimension} dimensions, spacing {spacing} m");
        for _ in 0..ROUNDS {
            Command::new(env::current_exe()?).args(["--one", &dimension.to_string()]).status()?;
        }
    }
    Ok(())
}

/// Measures one scene in this process.
fn measure(&(dimension, spacing): &(usize, &str)) -> io::Result<()> {
    let start = Instant::now();
    let mut app = scene(tank_scene(dimension), &[("spacing", spacing)]);
    let world = app.world_mut();
    step(world);
    let seconds = start.elapsed().as_secs_f64();

    let fluid = fluid_particles(world);
    let all = world.query_filtered::<(), Or<(With<Fluid>, With<Wall>, With<Solid>)>>().iter(world).count();
    while world.resource::<Neighbours>().builds < BUILDS {
        world.resource_mut::<Neighbours>().invalidate();
        step(world);
    }
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak =
        status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix("kB")?.trim().parse().ok());
    let bytes = |particles: f64| peak.map_or("-".to_owned(), |kb: f64| format!("{:.0}", 1024.0 * kb / particles));
    println!(
        "  {seconds:.2} s to the first step; {fluid} fluid particles, {all} with walls; bytes: {} a particle, {} a fluid particle",
        bytes(all as f64),
        bytes(fluid as f64)
    );
    Ok(())
}
