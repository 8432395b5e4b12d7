//! What earlier starts of a study left of a run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::{PlannedRun, Record};
use crate::checkpoint::{Checkpoint, changed_line, checkpoint_of};
use crate::log::{LogError, Piece, read_log};

/// What is left of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Left {
    /// It has ended, and would end in the same way again: it is done, or has diverged.
    Finished(Finished),
    /// It can go on from this checkpoint, which is of so many simulated seconds.
    Unfinished(PathBuf, f64),
    /// It has to be run from its start; why, if there is something of it.
    Nothing(Option<String>),
}

/// A run that has ended.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Finished {
    /// Whether it left the range of the model.
    pub has_diverged: bool,
    /// Simulated time (s) at its end.
    pub time: f64,
    /// Steps.
    pub steps: u64,
    /// What the log does not hold, if it is known.
    pub record: Option<Record>,
}

/// Looks at what is left of `run`, whose log is at `log`.
#[must_use]
pub fn look(run: &PlannedRun, log: &Path) -> Left {
    if !log.exists() {
        return Left::Nothing(None);
    }
    let told = match Told::read(log) {
        Ok(told) => told,
        Err(error) => return Left::Nothing(Some(error.to_string())),
    };
    let record = Record::read(log);
    if let Some(why) = told.is_of_another(run) {
        return Left::Nothing(Some(why));
    }
    match (told.is_whole, told.entry("end", "how")) {
        (true, Some(how @ ("done" | "diverged"))) => match files_differ(run, record.as_ref()) {
            Some(why) => Left::Nothing(Some(why)),
            None => Left::Finished(Finished {
                has_diverged: how == "diverged",
                time: told.entry("end", "time [s]").and_then(|time| time.parse().ok()).unwrap_or_default(),
                steps: told.entry("end", "step").and_then(|step| step.parse().ok()).unwrap_or_default(),
                record: record.map(|record| record.of_run_that_ended(how)),
            }),
        },
        (_, how) => unfinished(run, log).unwrap_or_else(|| {
            Left::Nothing(Some(match how {
                Some("interrupted") => "it was interrupted".to_owned(),
                Some("done" | "diverged") => "its log is damaged".to_owned(),
                Some(_) => "it failed".to_owned(),
                None => "its log is torn".to_owned(),
            }))
        }),
    }
}

/// The checkpoint of a run that can go on.
fn unfinished(run: &PlannedRun, log: &Path) -> Option<Left> {
    let path = checkpoint_of(log);
    let about = Checkpoint::read(&path).ok()?.about;
    let fits = about.text.as_str() == &*run.text && about.end_time == run.end_time && !about.is_done && about.step > 0;
    fits.then_some(Left::Unfinished(path, about.time))
}

/// Says which file is not the one that a run read, as far as its record tells. Of a run that goes on the checkpoint knows.
fn files_differ(run: &PlannedRun, record: Option<&Record>) -> Option<String> {
    let changed = run.files.iter().find(|file| !record.is_some_and(|record| record.files.contains(file)))?;
    Some(format!("the file {} that its scene reads is another one", changed.0.display()))
}

/// What a log says of its run.
#[derive(Debug, Default)]
struct Told {
    /// Whether the log is whole.
    is_whole: bool,
    /// The text of the scene, with overrides.
    scene: Option<String>,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
}

impl Told {
    fn read(log: &Path) -> Result<Self, LogError> {
        let mut told = Self::default();
        let ending = read_log(log, |piece| {
            match piece {
                // The scene is the first; a variant that changed it comes behind it.
                Piece::Attachment(file) if told.scene.is_none() => {
                    told.scene = Some(String::from_utf8_lossy(&file.data).into_owned());
                }
                Piece::Metadata(record) => drop(told.metadata.insert(record.name.clone(), record.metadata.clone())),
                _ => {}
            }
            Ok(())
        })?;
        told.is_whole = ending.whole;
        Ok(told)
    }

    fn entry(&self, record: &str, key: &str) -> Option<&str> {
        self.metadata.get(record)?.get(key).map(String::as_str)
    }

    /// Why it is not of `run`, if it is of another one.
    fn is_of_another(&self, run: &PlannedRun) -> Option<String> {
        let scene = self.scene.as_deref().filter(|scene| *scene != &*run.text);
        if let Some(scene) = scene {
            return Some(format!("the scene has changed: {}", changed_line(scene, &run.text)));
        }
        let (version, until) = (self.entry("program", "storegga"), self.entry("program", "until [s]"));
        if let Some(version) = version.filter(|version| *version != env!("CARGO_PKG_VERSION")) {
            return Some(format!("it was made by storegga {version}"));
        }
        let end = until.filter(|until| until.parse() != Ok(run.end_time));
        end.map(|end| format!("it went to {end} s, and shall go to {} s", run.end_time))
    }
}
