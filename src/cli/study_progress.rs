//! Progress of a study: a bar on a terminal, and a line for every run that ends.

use std::io::{self, IsTerminal};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::exit::complain;
use super::number::duration;
use crate::study::{Plan, Task, time_left};

/// Shows on standard error how far a study has come.
pub(super) struct StudyProgress<'a> {
    plan: &'a Plan,
    jobs: usize,
    /// None where it is not shown.
    bar: Option<ProgressBar>,
    is_quiet: bool,
    /// Runs that have ended: their estimated and measured duration (s).
    ended: Vec<(f64, f64)>,
    /// Runs that go on, and how long so far (s).
    running: Vec<(usize, f64)>,
    /// Runs that wait.
    waiting: Vec<usize>,
    /// All runs of this start.
    all: usize,
}

impl<'a> StudyProgress<'a> {
    /// So many runs at once are to be done.
    pub fn new(plan: &'a Plan, tasks: &[Task], jobs: usize, is_quiet: bool) -> Self {
        let bar = (!is_quiet && io::stderr().is_terminal()).then(|| {
            let style = ProgressStyle::with_template("{bar:16} {pos} of {len} runs, {msg}");
            let bar = ProgressBar::new(tasks.len() as u64);
            bar.enable_steady_tick(Duration::from_millis(500));
            bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        let waiting: Vec<usize> = tasks.iter().map(|task| task.run).collect();
        Self { plan, jobs, bar, is_quiet, ended: Vec::new(), running: Vec::new(), all: waiting.len(), waiting }
    }

    /// A run starts.
    pub fn start(&mut self, run: usize) {
        self.waiting.retain(|waiting| *waiting != run);
        self.running.push((run, 0.0));
        self.show();
    }

    /// A run that started has to start anew.
    pub fn wait(&mut self, run: usize) {
        self.running.retain(|(running, _)| *running != run);
        self.waiting.push(run);
    }

    /// Time passes.
    pub fn pass(&mut self, running: &[(usize, f64)]) {
        self.running = running.to_vec();
        self.show();
    }

    /// A run has ended as `what`, which took `wall` (s) if that is known.
    pub fn end(&mut self, run: usize, what: &str, wall: Option<f64>) {
        let so_far = self.running.iter().find(|(running, _)| *running == run).map_or(0.0, |(_, so_far)| *so_far);
        self.running.retain(|(running, _)| *running != run);
        self.ended.push((self.plan.runs[run].duration, wall.unwrap_or(so_far)));
        let took = wall.map_or_else(String::new, |wall| format!(" in {}", duration(wall)));
        let name = &self.plan.runs[run].name;
        self.tell(&format!("[{}/{}] {name}: {what}{took}; {}", self.ended.len(), self.all, self.left()));
        if let Some(bar) = &self.bar {
            bar.set_position(self.ended.len() as u64);
        }
        self.show();
    }

    /// Prints a line.
    pub fn tell(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.println(line),
            None if self.is_quiet => {}
            None => complain(&format!("{line}\n")),
        }
    }

    fn show(&self) {
        if let Some(bar) = &self.bar {
            bar.set_message(format!("{} at once, {}", self.running.len(), self.left()));
        }
    }

    fn left(&self) -> String {
        if self.running.is_empty() && self.waiting.is_empty() {
            return "none left".to_owned();
        }
        let estimate = |run: usize| self.plan.runs[run].duration;
        let running: Vec<_> = self.running.iter().map(|(run, so_far)| (estimate(*run), *so_far)).collect();
        let waiting: Vec<f64> = self.waiting.iter().map(|run| estimate(*run)).collect();
        format!("about {} left", duration(time_left(&self.ended, &running, &waiting, self.jobs)))
    }

    /// The study ends.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
