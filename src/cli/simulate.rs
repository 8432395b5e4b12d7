//! One simulation from scene to end, as `run` and `test` do it.

use std::path::{Path, PathBuf};
use std::time::Instant;

use bevy_app::App;
use bevy_ecs::prelude::*;

use super::exit::complain;
use super::progress::Progress;
use crate::app::{self, End, StopFlag};
use crate::checkpoint::{Checkpoint, Checkpoints, Origin, start_checkpoints};
use crate::clock::Clock;
use crate::error::UserError;
use crate::expect::{Check, evaluate, has_expectations};
use crate::log::{Level, ParticleCounts, close_log, log_message, open_log};
use crate::scene::{Resolution, SceneInfo};

/// How to run.
pub(super) struct Settings<'a> {
    /// End time (s) in the place of the scene's.
    pub until: Option<f64>,
    /// Where the log goes, if there is to be one.
    pub log: Option<&'a Path>,
    /// What the log is told at the start.
    pub warnings: Vec<String>,
    /// Where checkpoints go, and how the run was started, if there are to be any.
    pub checkpoints: Option<(PathBuf, Origin)>,
    /// The checkpoint from which the run goes on.
    pub resume: Option<&'a Checkpoint>,
    /// Number of threads.
    pub threads: usize,
}

/// What came out of a simulation.
pub(super) struct Outcome {
    pub end: End,
    pub title: String,
    pub resolution: Resolution,
    pub particles: ParticleCounts,
    pub clock: Clock,
    /// Duration (s) of the loop.
    pub wall: f64,
    /// The last checkpoint, if there is one.
    pub checkpoint: Option<PathBuf>,
    /// Steps that it did: all of them, unless the run goes on from a checkpoint.
    pub steps: u64,
    pub threads: usize,
    /// `None` if the run did not reach the end of the scene.
    pub checks: Option<Vec<Check>>,
    /// Whether the scene has any.
    pub has_expectations: bool,
}

impl Outcome {
    /// Fluid particles advanced by a step, per second of wall time.
    pub fn updates_per_second(&self) -> f64 {
        if self.wall > 0.0 { self.particles.fluid as f64 * self.steps as f64 / self.wall } else { 0.0 }
    }

    /// Whether every expectation is met.
    pub fn passes(&self) -> bool {
        self.checks.iter().flatten().all(|check| check.pass)
    }
}

/// Runs the app to its end.
///
/// # Errors
/// The log or the threads cannot be had.
pub(super) fn simulate(
    app: &mut App,
    settings: &Settings<'_>,
    stop: &StopFlag,
    progress: &mut Progress,
) -> Result<Outcome, UserError> {
    let world = app.world_mut();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads)
        .build()
        .map_err(|error| UserError::plain(format!("cannot start {} threads: {error}", settings.threads)))?;
    pool.install(|| run_in_pool(world, settings, stop, progress))
}

fn run_in_pool(
    world: &mut World,
    settings: &Settings<'_>,
    stop: &StopFlag,
    progress: &mut Progress,
) -> Result<Outcome, UserError> {
    let scene_end = app::end_time(world);
    let end_time = settings.until.unwrap_or(scene_end);
    if let (Some(path), Some(checkpoint)) = (settings.log, settings.resume) {
        checkpoint.resume(world, path, end_time)?;
    } else if let Some(path) = settings.log {
        open_log(world, path, end_time)
            .map_err(|error| UserError::plain(error.to_string()).help("choose another file with --out"))?;
        settings.warnings.iter().for_each(|line| log_message(world, Level::Warning, line));
    }
    if let Some((path, origin)) = &settings.checkpoints {
        start_checkpoints(world, Checkpoints::new(path, origin.clone(), complain))?;
    }
    let particles = ParticleCounts::of(world);
    let first = *world.resource::<Clock>();
    progress.start(particles.fluid, end_time, &first);
    let started = Instant::now();
    let mut end = app::run(world, end_time, stop, |clock| progress.step(clock));
    let wall = started.elapsed().as_secs_f64();
    progress.finish();
    // A log that failed before says so; that it cannot be closed either adds nothing.
    match close_log(world, &end) {
        Err(failure) if !matches!(end, End::LogFailed(_)) => end = End::LogFailed(failure),
        _ => {}
    }
    let clock = *world.resource::<Clock>();
    let is_whole = end == End::Done && end_time >= scene_end;
    Ok(Outcome {
        title: world.resource::<SceneInfo>().title.clone(),
        resolution: *world.resource::<Resolution>(),
        particles,
        clock,
        wall,
        checkpoint: settings.checkpoints.as_ref().map(|(path, _)| path.clone()),
        steps: clock.step - first.step,
        threads: settings.threads,
        has_expectations: has_expectations(world),
        checks: is_whole.then(|| evaluate(world)),
        end,
    })
}
