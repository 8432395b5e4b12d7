//! Going on from a checkpoint.

use std::path::{Path, PathBuf};

use bevy_ecs::prelude::*;

use super::Checkpoint;
use super::state::restore_state;
use crate::clock::Clock;
use crate::error::UserError;
use crate::log::{log_program, reopen_log};
use crate::scene::{Document, SceneFiles};

/// Says which line is the first that differs between two texts of a scene.
pub(crate) fn changed_line(then: &str, now: &str) -> String {
    let line = then.lines().zip(now.lines()).take_while(|(then, now)| then == now).count();
    let shown = |text: &str| text.lines().nth(line).unwrap_or("(the end)").trim().to_owned();
    format!("its line {} was `{}` and is `{}`", line + 1, shown(then), shown(now))
}

impl Checkpoint {
    /// A file of the run, seen from the folder in which the program runs now, or else from the one in which the run was
    /// started.
    #[must_use]
    pub fn find(&self, file: &Path) -> PathBuf {
        if file.exists() { file.to_owned() } else { self.about.origin.folder.join(file) }
    }

    /// Refuses a scene that is not the one of the run.
    ///
    /// # Errors
    /// The first line that is another one.
    pub fn check_scene(&self, document: &Document) -> Result<(), UserError> {
        let (then, now) = (&self.about.text, document.text());
        if then.as_str() == &**now {
            return Ok(());
        }
        let message =
            format!("the scene {} is not the one of the checkpoint: {}", document.file(), changed_line(then, now));
        let help =
            "put the scene back as it was (its text is an attachment of the log), or start a new run of the new scene";
        Err(UserError::plain(message).help(help))
    }

    /// Puts the state of the checkpoint into the world that its scene has filled, and continues its log at `log`, as far as it
    /// had been written then: what came after is computed again. The run is to go on to `end_time` (s).
    ///
    /// # Errors
    /// A file of the scene that has changed, state that does not fit the program, a log that is not that of the run; or another end
    /// than that of the run, but so early that a run to it would not have come by the checkpoint.
    pub fn resume(&self, world: &mut World, log: &Path, end_time: f64) -> Result<(), UserError> {
        let refused = |why: String| UserError::plain(format!("cannot resume: {why}"));
        let files = world.resource::<SceneFiles>().fingerprints();
        let file_name = |path: &Path| path.file_name().map(std::ffi::OsStr::to_owned);
        for ((path, length, crc), (then, length_then, crc_then)) in files.iter().zip(&self.about.files) {
            if (file_name(path), length, crc) != (file_name(then), length_then, crc_then) {
                return Err(refused(format!(
                    "the file {} of the scene has changed since the checkpoint",
                    path.display()
                )));
            }
        }
        restore_state(world, &self.state).map_err(|why| {
            refused(format!("the checkpoint does not fit this program: {why}"))
                .help("resume it with the program that wrote it, with the same plugins")
        })?;
        let is_another_end = end_time != self.about.end_time;
        if is_another_end && world.resource::<Clock>().is_cut_by(end_time) {
            let message = format!("the checkpoint is of t = {} s, too late for a run to {end_time} s", self.about.time);
            return Err(refused(message).help("choose a later end, or start a new run"));
        }
        let reopened = reopen_log(world, log, self.about.mark);
        let told = reopened.and_then(|()| if is_another_end { log_program(world, end_time) } else { Ok(()) });
        told.map_err(|error| refused(error.to_string()))
    }
}
