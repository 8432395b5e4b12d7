//! When checkpoints are written during a run.
//!
//! A checkpoint is written between two steps and changes nothing: no step is cut short to meet one, no list is rebuilt for
//! one. So a run with checkpoints has the bits of one without.

use std::path::{Path, PathBuf};
use std::time::Instant;

use bevy_ecs::prelude::*;

use super::file::{About, Checkpoint, Origin, program_checksum, to_bytes};
use super::place::refuse_to_overwrite;
use super::state::{check_state, save_state};
use crate::clock::Clock;
use crate::error::UserError;
use crate::log::mark_log;
use crate::replace::replace;
use crate::scene::{SceneDocument, SceneFiles, SceneInfo};

/// Where the checkpoints of a run go, and when the next one is due. Without this resource none is written.
#[derive(Resource, Debug)]
pub struct Checkpoints {
    path: PathBuf,
    origin: Origin,
    /// CRC-32 of the executable.
    program: Option<u32>,
    /// Simulated time (s) of the next one.
    next: f64,
    written: Instant,
    /// Whether the last one was written, before the steps that the end of the run cuts short.
    is_last: bool,
    /// Hears of a checkpoint that could not be written; the run goes on, and the one before it stays.
    warn: fn(&str),
}

impl Checkpoints {
    /// The checkpoints of a run, which go to `path`; `warn` hears of one that could not be written.
    #[must_use]
    pub fn new(path: &Path, origin: Origin, warn: fn(&str)) -> Self {
        let (path, program) = (path.to_owned(), program_checksum());
        Self { path, origin, program, next: 0.0, written: Instant::now(), is_last: false, warn }
    }

    /// Whether one is due at the simulated time `time` (s).
    fn is_due(&self, time: f64) -> bool {
        if self.is_last {
            return false;
        }
        let wall = self.origin.every_wall.is_some_and(|every| self.written.elapsed().as_secs_f64() >= every);
        wall || (self.origin.every.is_some() && time >= self.next)
    }

    /// One was written, or should have been, at the simulated time `time` (s).
    fn set_next(&mut self, time: f64) {
        self.written = Instant::now();
        let next = self.origin.every.map_or(f64::INFINITY, |every| ((time / every).floor() + 1.0) * every);
        // An interval so short that it cannot be counted is one of a step.
        self.next = if self.origin.every.is_some() && next.is_infinite() { time } else { next };
    }
}

/// Starts to write checkpoints: the first one now, so that there is one of this run at any time, and so that it is known that
/// they can be written.
///
/// # Errors
/// State that would be lost, or a file that cannot be written.
pub fn start_checkpoints(world: &mut World, checkpoints: Checkpoints) -> Result<(), UserError> {
    check_state(world).map_err(|forgotten| {
        let message = format!("checkpoints would lose the state of a plugin: `{}`", forgotten.join("`, `"));
        UserError::plain(message).help("register it with `register_saved` or `register_rebuilt`")
    })?;
    refuse_to_overwrite(&checkpoints.path, &checkpoints.origin.log)?;
    world.insert_resource(checkpoints);
    write_checkpoint(world, false)
        .map_err(|why| UserError::plain(why).help("the checkpoint lies beside the log: see --out"))
}

/// Writes a checkpoint if one is due.
pub(crate) fn write_if_due(world: &mut World) {
    let time = world.resource::<Clock>().time;
    if world.get_resource::<Checkpoints>().is_some_and(|checkpoints| checkpoints.is_due(time)) {
        let written = write_checkpoint(world, false);
        warn(world, written);
    }
}

/// Writes the last checkpoint of a run whose next step is cut short by its end, and by nothing else: a run to a later end does
/// not cut it, and goes on from here with the bits that it would have had.
pub(crate) fn write_before_end(world: &mut World) {
    let Some(checkpoints) = world.get_resource::<Checkpoints>() else { return };
    if !checkpoints.is_last {
        let written = write_checkpoint(world, false);
        world.resource_mut::<Checkpoints>().is_last = written.is_ok();
        warn(world, written);
    }
}

/// Writes the checkpoint of where a run ends or is interrupted; or says of the last one that the run has ended.
pub(crate) fn write_last(world: &mut World, is_done: bool) {
    let Some(checkpoints) = world.get_resource::<Checkpoints>() else { return };
    let written = match (checkpoints.is_last, is_done) {
        (true, true) => say_that_it_is_done(&checkpoints.path),
        (true, false) => Ok(()),
        (false, _) => write_checkpoint(world, is_done),
    };
    warn(world, written);
}

fn say_that_it_is_done(path: &Path) -> Result<(), String> {
    let mut last = Checkpoint::read(path).map_err(|error| error.to_string())?;
    last.about.is_done = true;
    let fail = |why: String| format!("cannot write the checkpoint {}: {why}", path.display());
    let bytes = to_bytes(&last.about, &last.state).map_err(fail)?;
    replace(path, &bytes).map_err(|error| fail(error.to_string()))
}

fn warn(world: &World, written: Result<(), String>) {
    if let Err(why) = written {
        let checkpoints = world.resource::<Checkpoints>();
        (checkpoints.warn)(&format!("Warning: {why}; the run goes on, and the checkpoint before this one stays\n"));
    }
}

/// Writes a checkpoint of the world as it is now.
fn write_checkpoint(world: &mut World, is_done: bool) -> Result<(), String> {
    let Clock { time, step, .. } = *world.resource::<Clock>();
    let text = world.resource::<SceneDocument>().0.text().to_string();
    let scene_end = world.resource::<SceneInfo>().end_time;
    let files = world.resource::<SceneFiles>().fingerprints().to_vec();
    let mut checkpoints = world.resource_mut::<Checkpoints>();
    checkpoints.set_next(time);
    let path = checkpoints.path.clone();
    let (origin, program) = (checkpoints.origin.clone(), checkpoints.program);
    let fail = |why: String| format!("cannot write the checkpoint {}: {why}", path.display());
    // What the checkpoint counts on is on the disk before it is.
    let mark = mark_log(world).map_err(|error| error.to_string())?;
    let end_time = origin.until.unwrap_or(scene_end);
    let about = About { origin, program, text, files, mark, time, end_time, is_done, step };
    let state = save_state(world).map_err(fail)?;
    let bytes = to_bytes(&about, &state).map_err(fail)?;
    replace(&path, &bytes).map_err(|error| fail(error.to_string()))
}
