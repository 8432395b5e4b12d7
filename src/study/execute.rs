//! The runs of a study, as many at once as processors and memory allow.

use std::collections::VecDeque;
use std::process::{ChildStdin, ExitStatus, Output};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};
use std::{io, mem};

use super::child::remove_checkpoint;
use super::{Place, Plan, Record};
use crate::app::StopFlag;
use crate::error::UserError;

/// A run that is to be done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Task {
    /// Its number in the plan.
    pub run: usize,
    /// Whether it goes on from its checkpoint.
    pub goes_on: bool,
}

/// How much may go on at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Runs.
    pub jobs: usize,
    /// Memory (bytes) of them all. One run alone may need more.
    pub memory: f64,
}

/// What happens.
#[derive(Debug)]
pub enum Event<'a> {
    /// A run starts.
    Started(&'a Task),
    /// A run has ended.
    Ended(&'a Task, Ended),
    /// A run has something to say.
    Warned(&'a Task, &'a str),
    /// A run cannot go on from its checkpoint, and is started anew; why.
    Anew(&'a Task, String),
    /// Time passes: the runs that go on and the time (s) that each has taken so far.
    Passing(&'a [(usize, f64)]),
}

/// How the process of a run ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ended {
    /// The log says how: it is done, has diverged or was interrupted.
    ByItself,
    /// It failed: the exit code, if there is one, and why.
    Failed(Option<i32>, String),
}

/// Exit codes of a run whose log says how it ended: done, done without what its scene expects, diverged, interrupted.
const ENDED: [i32; 4] = [0, 1, 3, INTERRUPTED];

/// Exit code of a run that can go on.
const INTERRUPTED: i32 = 130;

/// Exit code of a run that was refused.
const REFUSED: i32 = 2;

/// How often is looked for a stop.
const INTERVAL: Duration = Duration::from_millis(50);

/// A run that goes on.
struct Running {
    task: Task,
    memory: f64,
    started: Instant,
    /// Duration (s) of what was done of it before, if it is known.
    before: Option<f64>,
    /// The run stops when this is dropped.
    input: Option<ChildStdin>,
}

/// What the threads that wait for processes tell: the number of the run, and how it ended.
type Told = (usize, io::Result<Output>);

/// Does all `tasks`, in their order as far as memory allows; `watch` hears what happens. When `stop` is set, none is started any
/// more, and those that go on are stopped.
///
/// # Errors
/// What `watch` says, or a record that cannot be written; the runs that go on are stopped then.
pub fn execute(
    plan: &Plan,
    tasks: impl IntoIterator<Item = Task>,
    place: &Place,
    limits: Limits,
    stop: &StopFlag,
    mut watch: impl FnMut(Event<'_>) -> Result<(), UserError>,
) -> Result<(), UserError> {
    let mut pool =
        Pool { plan, place, limits, waiting: tasks.into_iter().collect(), running: Vec::new(), line: channel() };
    loop {
        while !stop.is_set()
            && let Some(task) = pool.next()
        {
            watch(Event::Started(&task))?;
            pool.start(task);
        }
        if pool.running.is_empty() {
            return Ok(());
        }
        if stop.is_set() {
            pool.running.iter_mut().for_each(|running| running.input = None);
        }
        match pool.line.1.recv_timeout(INTERVAL) {
            Ok(told) => pool.end(told, &mut watch)?,
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
                let so_far =
                    pool.running.iter().map(|running| (running.task.run, running.started.elapsed().as_secs_f64()));
                watch(Event::Passing(&so_far.collect::<Vec<_>>()))?;
            }
        }
    }
}

struct Pool<'a> {
    plan: &'a Plan,
    place: &'a Place,
    limits: Limits,
    waiting: VecDeque<Task>,
    running: Vec<Running>,
    line: (Sender<Told>, Receiver<Told>),
}

impl Pool<'_> {
    /// Takes the next task that may be started now.
    fn next(&mut self) -> Option<Task> {
        let needs: Vec<f64> = self.waiting.iter().map(|task| self.plan.runs[task.run].memory).collect();
        let running: Vec<f64> = self.running.iter().map(|running| running.memory).collect();
        next_that_fits(&needs, &running, self.limits).and_then(|place| self.waiting.remove(place))
    }

    fn start(&mut self, task: Task) {
        let log = self.place.log(self.plan, task.run);
        let earlier = Record::read(&log);
        Record::remove(&log);
        let before = if task.goes_on { earlier.and_then(|record| record.wall_s) } else { Some(0.0) };
        let memory = self.plan.runs[task.run].memory;
        let mut running = Running { task, memory, started: Instant::now(), before, input: None };
        let (number, sender) = (running.task.run, self.line.0.clone());
        match self.place.start(self.plan, &running.task) {
            Ok(mut child) => {
                running.input = child.stdin.take();
                thread::spawn(move || sender.send((number, child.wait_with_output())));
            }
            // The receiver is there as long as this is.
            Err(error) => drop(sender.send((number, Err(error)))),
        }
        self.running.push(running);
    }

    /// A process has ended.
    fn end(
        &mut self,
        (number, output): Told,
        watch: &mut impl FnMut(Event<'_>) -> Result<(), UserError>,
    ) -> Result<(), UserError> {
        let Some(index) = self.running.iter().position(|running| running.task.run == number) else { return Ok(()) };
        let Running { mut task, before, .. } = self.running.swap_remove(index);
        let ended = match output {
            Ok(output) => {
                let said = String::from_utf8_lossy(&output.stderr);
                let mut warnings = said.lines().filter_map(|line| line.strip_prefix("Warning: "));
                warnings.try_for_each(|warning| watch(Event::Warned(&task, warning)))?;
                self.judge(&task, before, &output)?
            }
            Err(error) => Ended::Failed(None, format!("it cannot be started: {error}")),
        };
        match ended {
            Ended::Failed(Some(REFUSED), why) if mem::take(&mut task.goes_on) => {
                watch(Event::Anew(&task, why))?;
                self.waiting.push_front(task);
                Ok(())
            }
            ended => watch(Event::Ended(&task, ended)),
        }
    }

    /// How a process ended; what its log does not hold is recorded.
    fn judge(&self, task: &Task, before: Option<f64>, output: &Output) -> Result<Ended, UserError> {
        let told: Option<serde_json::Value> = serde_json::from_slice(&output.stdout).ok();
        let (Some(told), Some(code)) = (told, output.status.code().filter(|code| ENDED.contains(code))) else {
            return Ok(Ended::Failed(output.status.code(), why(output.status, &output.stderr)));
        };
        let log = self.place.log(self.plan, task.run);
        Record::new(&told, before, &self.plan.runs[task.run].files).write(&log)?;
        if code != INTERRUPTED {
            remove_checkpoint(&log);
        }
        Ok(Ended::ByItself)
    }
}

/// Why a process failed: the first line that it said, without what stands before every message.
fn why(status: ExitStatus, said: &[u8]) -> String {
    let said = String::from_utf8_lossy(said);
    let lines = || said.lines().map(str::trim).filter(|line| !line.is_empty());
    let error = lines().find_map(|line| line.strip_prefix("Error: ")).or_else(|| lines().next());
    error.map_or_else(|| format!("it ended with {status}"), str::to_owned)
}

/// Which of the waiting runs, of so many bytes each, may be started beside those that go on: the first that fits.
fn next_that_fits(waiting: &[f64], running: &[f64], limits: Limits) -> Option<usize> {
    if running.len() >= limits.jobs.max(1) {
        return None;
    }
    let used: f64 = running.iter().sum();
    waiting.iter().position(|needs| running.is_empty() || used + needs <= limits.memory)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_start_while_processors_and_memory_allow() {
        let limits = Limits { jobs: 3, memory: 10.0 };
        assert_eq!(next_that_fits(&[4.0, 1.0], &[], limits), Some(0));
        assert_eq!(next_that_fits(&[7.0, 4.0], &[5.0], limits), Some(1), "the first is too large now");
        assert_eq!(next_that_fits(&[1.0], &[1.0, 1.0, 1.0], limits), None, "three at once");
        assert_eq!(next_that_fits(&[6.0], &[5.0], limits), None);
        assert_eq!(next_that_fits(&[99.0], &[], limits), Some(0), "alone it may try");
        assert_eq!(next_that_fits(&[], &[], limits), None);
        assert_eq!(next_that_fits(&[1.0], &[], Limits { jobs: 0, ..limits }), Some(0));
    }
}
