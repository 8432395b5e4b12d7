//! `storegga check`.

use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

use bevy_app::PluginGroup;
use bevy_ecs::prelude::*;

use super::args::CheckArgs;
use super::exit::say;
use super::number::{bytes, count, duration, short};
use super::summary::threads;
use super::table::Table;
use super::warnings;
use crate::app::{end_time, open};
use crate::boundary::LeftOut;
use crate::clock::Limit;
use crate::error::UserError;
use crate::estimate::Estimate;
use crate::kernels::SmoothingKernel;
use crate::log::{Fact, ParticleCounts, fixed_numbers};
use crate::outputs::{OutputKind, OutputTimes};
use crate::phases::phases;
use crate::physics::{EquationOfState, GREATEST_COMPRESSION, TimeStepSettings};
use crate::scene::{FilledFluids, Resolution, SceneFacts, SceneInfo, open_document};

/// Says what a run of a scene would be like.
pub(super) fn check<P: PluginGroup>(args: &CheckArgs, plugins: fn() -> P) -> Result<ExitCode, UserError> {
    let mut app = open(plugins(), open_document(&args.scene, &args.overrides.set)?)?;
    say(&report(&args.scene, app.world_mut(), args.threads.count()));
    Ok(ExitCode::SUCCESS)
}

fn report(scene: &Path, world: &mut World, thread_count: usize) -> String {
    let parts = [
        head(scene, world),
        overlaps(world),
        phase_table(world),
        time_steps(world, thread_count),
        defaults(world),
        fixed(world),
        warnings::text(&warnings::warnings(world), false),
    ];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

fn head(scene: &Path, world: &mut World) -> String {
    let counts = ParticleCounts::of(world);
    let resolution = *world.resource::<Resolution>();
    let info = world.resource::<SceneInfo>();
    let state = world.resource::<EquationOfState>();
    let times = world.resource::<OutputTimes>();
    format!(
        "{}: {}\n  \
         dimension         {}\n  \
         spacing           {} m\n  \
         smoothing length  {} m ({} spacings)\n  \
         kernel            {}, support {} m\n  \
         particles         {} fluid, {} wall, {} structure\n  \
         bulk modulus      {} Pa, from p_max = {} Pa and v_max = {} m/s (Eq. 8)\n  \
         limits            |v| < c, 1/{} < ρ/ρ0 < {}, Δt ≥ {} s, all values finite: beyond them the run ends as diverged\n  \
         end               {} s; frames every {} s, series every {} s\n",
        scene.display(),
        info.title,
        resolution.dimension,
        short(resolution.spacing),
        short(resolution.smoothing_length),
        short(resolution.smoothing_length / resolution.spacing),
        info.kernel,
        short(world.resource::<SmoothingKernel>().0.radius()),
        count(counts.fluid as u64),
        count(counts.wall as u64),
        count(counts.structure as u64),
        short(state.bulk_modulus),
        short(state.max_pressure),
        short(state.max_speed),
        short(GREATEST_COMPRESSION),
        short(GREATEST_COMPRESSION),
        short(world.resource::<TimeStepSettings>().least.unwrap_or(0.0)),
        short(end_time(world)),
        short(times.interval(OutputKind::Frames)),
        short(times.interval(OutputKind::Series)),
    )
}

/// Walls of which a part is left to the walls before them.
fn overlaps(world: &mut World) -> String {
    let line = |(name, left_out): (String, LeftOut)| {
        let LeftOut { ghosts, of, walls, .. } = left_out;
        let (ghosts, of) = (count(ghosts as u64), count(of as u64));
        format!("  {name}: {ghosts} of {of} ghosts left out, which lie in {}\n", warnings::these(&walls))
    };
    let lines: String = warnings::left_out(world).into_iter().map(line).collect();
    if lines.is_empty() { lines } else { format!("Walls that overlap:\n{lines}") }
}

fn phase_table(world: &mut World) -> String {
    let all = phases(world);
    let state = world.resource::<EquationOfState>();
    let filled = world.resource::<FilledFluids>();
    let mut table =
        Table::new(["phase", "particles", "ρ0 (kg/m³)", "sound speed (m/s)", "rheology", "greatest μ (Pa s)"]);
    for (phase, rho0) in &all {
        let particles = filled.particles.get(phase.index as usize).copied().unwrap_or(0);
        table.push([
            phase.name.clone(),
            count(particles as u64),
            short(*rho0),
            short(state.sound_speed(*rho0)),
            phase.rheology.name.clone(),
            short(phase.rheology.greatest_viscosity),
        ]);
    }
    table.render()
}

fn time_steps(world: &mut World, thread_count: usize) -> String {
    let estimate = Estimate::of(world, thread_count);
    let mut text = String::from("Estimates; a run can need more or less:\n");
    for (limit, by) in estimate.limits {
        let basis = match by {
            Limit::Sound => "sound speed and v_max",
            Limit::Viscosity => "the greatest viscosity that a rheology can give",
            Limit::Acceleration => "acceleration at the start",
            Limit::Output => "outputs",
            Limit::Plugin => "a plugin",
        };
        let shown = if limit.is_finite() { format!("{} s", short(limit)) } else { "none".to_owned() };
        let _ = writeln!(text, "  Δt by {by:<13} {shown:<12} {basis}");
    }
    let (time_step, by) = estimate.time_step();
    let _ = write!(
        text,
        "  Δt               {} s, bound by {by} (Eq. 19)\n  \
         steps            {}\n  \
         memory           {} ({} neighbours met by a fluid particle in a sweep)\n  \
         log              {}\n  \
         duration         {} on {}, assuming {} M updates/s\n",
        short(time_step),
        count(estimate.steps as u64),
        bytes(estimate.memory),
        short(estimate.pairs_per_particle),
        bytes(estimate.log),
        duration(estimate.duration),
        threads(thread_count),
        short(estimate.updates_per_second * 1e-6),
    );
    text
}

fn defaults(world: &World) -> String {
    let open = &world.resource::<SceneFacts>().defaults;
    let lines: String = open.iter().map(|(path, value)| format!("  {path} = {value}\n")).collect();
    if lines.is_empty() { lines } else { format!("Left open by the scene, with the value that it takes:\n{lines}") }
}

/// What no scene sets, with the digits that a reader needs; the log has all of them.
fn fixed(world: &World) -> String {
    let line = |fact: Fact| {
        let value = fact.value.parse().map_or(fact.value, short);
        format!("  {} = {value} {}", fact.name, fact.unit).trim_end().to_owned() + "\n"
    };
    let lines: String = fixed_numbers(world).into_iter().map(line).collect();
    format!("Fixed by the program (cargo doc explains them):\n{lines}")
}
