//! Where the checkpoint of a log lies, and what becomes of one that lies there already.

use std::fs;
use std::path::{Path, PathBuf};

use super::Checkpoint;
use super::file::{MAGIC, to_bytes};
use crate::error::UserError;
use crate::log::is_being_written;
use crate::replace::replace;

/// The checkpoint of the run that writes `log`: `a.checkpoint` of `a.mcap`, `a.log.checkpoint` of `a.log`.
#[must_use]
pub fn checkpoint_of(log: &Path) -> PathBuf {
    let is_mcap = log.extension().is_some_and(|extension| extension == "mcap");
    let stem = if is_mcap { log.with_extension("") } else { log.to_owned() };
    stem.with_added_extension("checkpoint")
}

/// Refuses to write the checkpoints of the run that writes `log` at `path` if something would be lost.
///
/// # Errors
/// `path` is the log, or holds something else than a checkpoint, or that of another log.
pub fn refuse_to_overwrite(path: &Path, log: &Path) -> Result<(), UserError> {
    let refused = |what: &str| {
        let error = UserError::plain(format!("{} {what}", path.display()));
        Err(error.help("the checkpoint lies beside the log: choose another log with --out"))
    };
    let is_log = fs::canonicalize(path).is_ok_and(|path| fs::canonicalize(log).is_ok_and(|log| path == log));
    if path == log || is_log {
        return refused("cannot be both the log and the checkpoint");
    }
    let Ok(bytes) = fs::read(path) else { return Ok(()) };
    if !bytes.is_empty() && !bytes.starts_with(&MAGIC) {
        return refused("exists and is not a checkpoint: it would be lost");
    }
    match Checkpoint::parse(&bytes) {
        Ok(old) if !old.is_of(log) => refused(&format!(
            "is the checkpoint of a run that writes {}: it would be lost",
            old.about.origin.log.display()
        )),
        Err(why) if why.is_of_another_version() => refused(OF_ANOTHER_VERSION),
        _ => Ok(()),
    }
}

/// What cannot be told whether it is of a run that has ended.
const OF_ANOTHER_VERSION: &str =
    "is a checkpoint of another version of the program, of a run that may not have ended: it would be lost";

impl Checkpoint {
    /// Whether it is of the run that wrote `log`, a file in the same folder.
    fn is_of(&self, log: &Path) -> bool {
        self.about.origin.log.file_name() == log.file_name()
    }
}

/// Before a new run writes `log`: what was there of a run that has not ended is put out of its way, checkpoint and log, and still
/// can go on. Returns what to tell the user then.
///
/// # Errors
/// It cannot be put out of the way, or is of another version of the program.
pub fn keep_unfinished(log: &Path) -> Result<Option<String>, UserError> {
    let path = checkpoint_of(log);
    let mut old = match fs::read(&path).map(|bytes| Checkpoint::parse(&bytes)) {
        Ok(Ok(old)) => old,
        Ok(Err(why)) if why.is_of_another_version() && log.is_file() => {
            let message = format!("{} {OF_ANOTHER_VERSION}", path.display());
            return Err(UserError::plain(message).help("choose another log with --out, or remove the checkpoint"));
        }
        _ => return Ok(None),
    };
    let (time, end_time) = (old.about.time, old.about.end_time);
    let can_go_on = old.about.step > 0 && !old.about.is_done && old.is_of(log) && log.is_file();
    // A log that is still written is refused when it is opened.
    if !can_go_on || is_being_written(log) {
        return Ok(None);
    }
    let kept_log = aside(log);
    let kept = checkpoint_of(&kept_log);
    let fail = |why: String| {
        let message = format!("cannot keep the run that {} is of: {why}", path.display());
        UserError::plain(message).help("choose another log with --out")
    };
    // Whenever this is interrupted, one of the two checkpoints has the name that the log has.
    if let Some(name) = kept_log.file_name() {
        old.about.origin.log.set_file_name(name);
    }
    let bytes = to_bytes(&old.about, &old.state).map_err(fail)?;
    let moved = replace(&kept, &bytes).and_then(|()| fs::rename(log, &kept_log)).and_then(|()| fs::remove_file(&path));
    moved.map_err(|error| fail(error.to_string()))?;
    Ok(Some(format!(
        "{} was of a run that has not ended (t = {time} s of {end_time} s). It is kept, with its log: `storegga resume {}` goes on \
         with it",
        path.display(),
        kept.display()
    )))
}

/// A name beside that of a log that nothing has: `a.unfinished.mcap`, `a.unfinished-2.mcap` and so on.
fn aside(log: &Path) -> PathBuf {
    let extension = log.extension().filter(|extension| *extension == "mcap");
    let stem = if extension.is_some() { log.with_extension("") } else { log.to_owned() };
    let mut number = 1_u64;
    loop {
        let name = if number == 1 { "unfinished".to_owned() } else { format!("unfinished-{number}") };
        let mut path = stem.with_added_extension(name);
        if let Some(extension) = extension {
            path.add_extension(extension);
        }
        if !path.exists() && !checkpoint_of(&path).exists() {
            return path;
        }
        number += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_has_the_name_of_its_log_and_is_another_file() {
        for (log, checkpoint) in [
            ("runs/submarine_slide.mcap", "runs/submarine_slide.checkpoint"),
            ("runs/tank.v2.mcap", "runs/tank.v2.checkpoint"),
            ("z.log", "z.log.checkpoint"),
            ("small.checkpoint", "small.checkpoint.checkpoint"),
            ("z", "z.checkpoint"),
        ] {
            assert_eq!(checkpoint_of(Path::new(log)), Path::new(checkpoint));
        }
        let refused = refuse_to_overwrite(Path::new("z.mcap"), Path::new("z.mcap"));
        assert!(refused.is_err_and(|error| error.message().contains("both the log and the checkpoint")));
    }
}
