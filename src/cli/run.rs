//! `storegga run`.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use bevy_app::PluginGroup;

use super::args::{RunArgs, Shown};
use super::exit::{self, complain, say};
use super::number::short;
use super::progress::Progress;
use super::simulate::{Outcome, Settings, simulate};
use super::summary::{checks_table, divergence, summary};
use super::{json, warnings};
use crate::app::{End, open};
use crate::checkpoint::{self, Origin, checkpoint_of, keep_unfinished};
use crate::error::UserError;
use crate::scene::open_document;

/// Runs a scene and writes its log.
pub(super) fn run<P: PluginGroup>(args: &RunArgs, plugins: fn() -> P) -> Result<ExitCode, UserError> {
    let document = open_document(&args.scene, &args.overrides.set)?;
    let log = args.out.clone().unwrap_or_else(|| default_log(&args.scene));
    refuse_to_overwrite(&log)?;
    let checkpoints = checkpoints(args, &log);
    if let Some((path, _)) = &checkpoints {
        checkpoint::refuse_to_overwrite(path, &log)?;
    }
    let stop = exit::stop_on_interrupt();
    exit::stop_at_end_of_input(args.input, &stop);
    let mut app = open(plugins(), document)?;
    make_folder(&log)?;
    let warnings = warnings::warnings(app.world_mut());
    if !args.shown.quiet {
        complain(&warnings::text(&warnings, exit::colour()));
    }
    if let Some(kept) = keep_unfinished(&log)? {
        complain(&format!("Warning: {kept}\n"));
    }
    let settings = Settings {
        until: args.until,
        log: Some(&log),
        warnings: warnings.iter().map(ToString::to_string).collect(),
        checkpoints,
        resume: None,
        threads: args.threads.count(),
    };
    let outcome = simulate(&mut app, &settings, &stop, &mut Progress::new(args.shown.quiet))?;
    show(&args.scene, args.shown, &log, &outcome)
}

/// Where the checkpoints go, if there are to be any.
fn checkpoints(args: &RunArgs, log: &Path) -> Option<(PathBuf, Origin)> {
    let (every, every_wall) = (args.checkpoint_every, args.checkpoint_every_wall);
    every.or(every_wall)?;
    let origin = Origin {
        folder: std::env::current_dir().unwrap_or_default(),
        scene: args.scene.clone(),
        overrides: args.overrides.set.clone(),
        until: args.until,
        every,
        every_wall,
        log: log.to_owned(),
    };
    Some((checkpoint_of(log), origin))
}

/// Prints what came out of a run, and returns the exit code.
///
/// # Errors
/// The log could not be written.
pub(super) fn show(scene: &Path, shown: Shown, log: &Path, outcome: &Outcome) -> Result<ExitCode, UserError> {
    tell(scene, shown, log, outcome);
    code(log, outcome)
}

/// The exit code of a run.
fn code(log: &Path, outcome: &Outcome) -> Result<ExitCode, UserError> {
    Ok(ExitCode::from(match &outcome.end {
        End::Diverged(_) => exit::DIVERGED,
        End::Interrupted => exit::INTERRUPTED,
        End::Failed(_) => exit::BUG,
        End::LogFailed(why) => return Err(log_failed(why, log, outcome)),
        End::Done if !outcome.passes() => exit::FAILED,
        End::Done => 0,
    }))
}

/// What is left of a log that could not be written any more.
fn log_failed(why: &str, log: &Path, outcome: &Outcome) -> UserError {
    let error = UserError::plain(why).help(format!("the run ended at t = {} s.", short(outcome.clock.time)));
    let error = if log.is_file() {
        error.help(format!("`storegga recover {}` keeps what was written up to then.", log.display()))
    } else {
        error
    };
    error.help("Choose another place with --out")
}

/// Prints what came out: the result to standard output, what is wrong to standard error.
fn tell(scene: &Path, shown: Shown, log: &Path, outcome: &Outcome) {
    if shown.json {
        say(&format!("{}\n", json::object(scene, log, outcome)));
    } else if !shown.quiet {
        say(&summary(scene, log, outcome));
    }
    if let End::Failed(what) = &outcome.end {
        complain(&format!(
            "Error: the run failed at t = {} s: {what}\n  The log {} is closed and readable.\n",
            outcome.clock.time,
            log.display()
        ));
    }
    if let End::Diverged(report) = &outcome.end {
        complain(&divergence(report, log));
    }
    if let (End::Interrupted | End::LogFailed(_), Some(checkpoint)) = (&outcome.end, &outcome.checkpoint) {
        complain(&format!("The run can go on: storegga resume {}\n", checkpoint.display()));
    }
    if (shown.json || shown.quiet) && !outcome.passes() {
        complain(&checks_table(outcome.checks.as_deref().unwrap_or_default()));
    }
}

/// `runs/<scene>.mcap`.
fn default_log(scene: &Path) -> PathBuf {
    let name = scene.file_stem().unwrap_or(scene.as_os_str());
    Path::new("runs").join(name).with_added_extension("mcap")
}

/// How every log begins.
const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// Refuses to write a log in the place of a file with something else in it.
pub(super) fn refuse_to_overwrite(log: &Path) -> Result<(), UserError> {
    // Nothing is lost in an empty file or in what is no plain file; what cannot be read is not written either.
    if !fs::metadata(log).is_ok_and(|data| data.is_file() && data.len() > 0) {
        return Ok(());
    }
    let mut start = [0; MAGIC.len()];
    let is_log = File::open(log).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == MAGIC;
    if is_log {
        return Ok(());
    }
    let message = format!("{} exists and is not a log: it would be lost", log.display());
    Err(UserError::plain(message).help("choose another file with --out"))
}

/// Makes the folder of a log.
pub(super) fn make_folder(log: &Path) -> Result<(), UserError> {
    let Some(folder) = log.parent().filter(|folder| !folder.as_os_str().is_empty()) else { return Ok(()) };
    fs::create_dir_all(folder).map_err(|error| {
        let message = format!("cannot make the folder {} for the log: {error}", folder.display());
        UserError::plain(message).help("choose another file with --out")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_is_named_after_the_scene() {
        assert_eq!(default_log(Path::new("scenes/tank.ron")), Path::new("runs/tank.mcap"));
        assert_eq!(default_log(Path::new("tank.v2.ron")), Path::new("runs/tank.v2.mcap"));
    }
}
