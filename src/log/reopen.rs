//! Continuing the log of a run that was stopped.

use std::fs::{self, File};
use std::path::Path;

use bevy_ecs::prelude::*;
use serde::{Deserialize, Serialize};

use super::place::is_written;
use super::plugin::Log;
use super::{LogError, LogWriter, copy_log, program_facts};
use crate::probes::Series;
use crate::replace::{part_of, put_in_place};

/// How far the log of a run had been written at one moment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct LogMark {
    /// Number of messages.
    messages: u64,
    /// CRC-32 of them all.
    checksum: u32,
    /// Simulated time (s) of the last frame of particles.
    last_frame: Option<f64>,
}

/// Brings the log to the disk and says how far it has been written.
pub(crate) fn mark_log(world: &mut World) -> Result<LogMark, LogError> {
    let Some(mut log) = world.get_resource_mut::<Log>() else { return Ok(LogMark::default()) };
    log.writer.sync()?;
    let (messages, checksum) = log.writer.written();
    Ok(LogMark { messages, checksum, last_frame: log.last_frame })
}

/// Opens the log at `path` as it was at `mark`: from then on outputs are written to it again. Messages behind the mark are left
/// out. It is written beside the old one and takes its place when everything up to the mark is on the disk, so that nothing is
/// lost whenever this is interrupted.
///
/// # Errors
/// The log does not hold what had been written at the mark, or cannot be written.
pub(crate) fn reopen_log(world: &mut World, path: &Path, mark: LogMark) -> Result<(), LogError> {
    let old = File::open(path).map_err(|error| LogError::new(path, "read", error))?;
    // Held until the new one has its place: a run that is still on its way must not lose its log.
    if is_written(&old) {
        return Err(LogError::new(path, "go on with", "another run is writing it: was the run not stopped?"));
    }
    let part = part_of(path);
    let writer = LogWriter::create(&part)?;
    let reopened = continue_log(world, path, writer, mark).and_then(|log| {
        put_in_place(&part, path).map_err(|error| LogError::new(path, "write", error))?;
        Ok(log)
    });
    let mut log = reopened.inspect_err(|_| drop(fs::remove_file(&part)))?;
    log.writer.set_path(path);
    world.insert_resource(log);
    Ok(())
}

/// Writes to a log that goes on to another end (s) than before what the program is told now; the last such record counts.
pub(crate) fn log_program(world: &mut World, end_time: f64) -> Result<(), LogError> {
    let Some(mut log) = world.get_resource_mut::<Log>() else { return Ok(()) };
    log.writer.metadata("program", &program_facts(end_time))
}

/// Copies the log at `path` up to `mark` to `writer`, and puts everything else in its way so that it goes on there.
fn continue_log(world: &mut World, path: &Path, mut writer: LogWriter, mark: LogMark) -> Result<Log, LogError> {
    let copied = copy_log(path, &mut writer, Some(mark.messages))?;
    let found = copied.messages();
    if found < mark.messages {
        let what = format!("of the {} messages at the checkpoint {found} are in it", mark.messages);
        return Err(LogError::new(path, "go on with", what));
    }
    if writer.written() != (mark.messages, mark.checksum) {
        let what = "it is the log of another run, or of a later one of the same scene";
        return Err(LogError::new(path, "go on with", what));
    }
    let mut log = Log::new(world, writer)?;
    log.last_frame = mark.last_frame;
    let written = |topic: &str| copied.channels.iter().find(|channel| channel.topic == topic);
    for (entity, series) in world.query::<(Entity, &Series)>().iter(world) {
        if let Some(channel) = written(&series.topic) {
            log.add_channel(entity, series, channel.messages as usize)?;
        }
    }
    log.writer.flush()?;
    Ok(log)
}
