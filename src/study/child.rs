//! A run as a process of its own: whatever becomes of it, the study goes on.

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use super::{Plan, Task};
use crate::checkpoint::checkpoint_of;

/// Where the files of a study lie, and how its runs are started.
#[derive(Debug, Clone)]
pub struct Place {
    /// The folder.
    pub folder: PathBuf,
    /// Threads of each run.
    pub threads: usize,
    /// Interval (s of the clock on the wall) of checkpoints.
    pub checkpoint_every: f64,
}

impl Place {
    /// The log of run number `k`.
    #[must_use]
    pub fn log(&self, plan: &Plan, k: usize) -> PathBuf {
        self.folder.join(&plan.runs[k].name).with_added_extension("mcap")
    }

    /// Starts a task as a process of this program. It ends when its standard input does.
    ///
    /// # Errors
    /// It cannot be started.
    pub(super) fn start(&self, plan: &Plan, task: &Task) -> io::Result<Child> {
        let mut command = Command::new(std::env::current_exe()?);
        command.args(self.arguments(plan, task)).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn()
    }

    fn arguments(&self, plan: &Plan, task: &Task) -> Vec<OsString> {
        let log = self.log(plan, task.run);
        let mut arguments: Vec<OsString> =
            [if task.goes_on { "resume" } else { "run" }, "--json", "--quiet"].map(OsString::from).into();
        arguments.extend(["--stop-at-end-of-input".into(), format!("--threads={}", self.threads).into()]);
        if task.goes_on {
            arguments.extend(["--".into(), checkpoint_of(&log).into()]);
            return arguments;
        }
        let run = &plan.runs[task.run];
        arguments.extend(run.overrides.iter().map(|pair| format!("--set={pair}").into()));
        arguments.extend(plan.study.until.map(|until| format!("--until={until}").into()));
        if run.can_be_saved {
            arguments.push(format!("--checkpoint-every-wall={}", self.checkpoint_every).into());
        }
        arguments.extend(["--out".into(), log.into(), "--".into(), plan.study.scene.clone().into()]);
        arguments
    }
}

/// Removes the checkpoint of a run that has ended: nothing goes on from it any more.
pub(super) fn remove_checkpoint(log: &Path) {
    let _ = std::fs::remove_file(checkpoint_of(log));
}
