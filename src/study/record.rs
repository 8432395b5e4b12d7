//! What a log does not hold of a run: how long it took, and what it was run from. It stands beside the log.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::checkpoint::program_checksum;
use crate::error::UserError;
use crate::replace::replace;

/// The record of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// How it ended: the word of `storegga run --json`.
    pub end: String,
    /// Duration (s), that of all its parts if it was resumed; none if one of them was killed.
    pub wall_s: Option<f64>,
    /// Why it diverged; empty otherwise.
    pub reason: String,
    /// Files that its scene read, with the length and the CRC-32 of each.
    pub files: Vec<(PathBuf, u64, u32)>,
    /// CRC-32 of the program.
    pub program: Option<u32>,
}

impl Record {
    /// The record of a run that printed `told` at its end, after an earlier part of `before` (s).
    #[must_use]
    pub fn new(told: &Value, before: Option<f64>, files: &[(PathBuf, u64, u32)]) -> Self {
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        Self {
            end: text(&told["end"]),
            wall_s: told["wall_s"].as_f64().zip(before).map(|(wall, before)| wall + before),
            reason: text(&told["divergence"]["reason"]),
            files: files.to_vec(),
            program: program_checksum(),
        }
    }

    /// The record beside `log`, if there is one that can be read.
    #[must_use]
    pub fn read(log: &Path) -> Option<Self> {
        fs::read(record_of(log)).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok())
    }

    /// The record of a run whose log says `how` it ended. One that tells of another end is that of an earlier part, from where the run was
    /// resumed by itself: how long that took, nobody knows.
    #[must_use]
    pub fn of_run_that_ended(self, how: &str) -> Self {
        let wall_s = self.wall_s.filter(|_| self.end == how);
        Self { wall_s, ..self }
    }

    /// Writes the record beside `log`.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, log: &Path) -> Result<(), UserError> {
        let path = record_of(log);
        let written = serde_json::to_vec_pretty(self).map_err(Into::into).and_then(|bytes| replace(&path, &bytes));
        written.map_err(|error| UserError::plain(format!("cannot write {}: {error}", path.display())))
    }

    /// Removes the record beside `log`: its run goes on, or starts anew.
    pub fn remove(log: &Path) {
        let _ = fs::remove_file(record_of(log));
    }
}

/// `a.json` of `a.mcap`.
fn record_of(log: &Path) -> PathBuf {
    log.with_extension("json")
}
