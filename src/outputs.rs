//! When outputs are due.

use bevy_ecs::prelude::*;

/// Which outputs there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputKind {
    /// Particles, walls, structures: large, seldom.
    Frames,
    /// Probes, loads, energy: small, often.
    Series,
}

/// An output every so many seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Every {
    interval: f64,
    /// The next one is due at `count · interval`: no sum of intervals, which would drift.
    count: u64,
    due: bool,
}

impl Every {
    fn next(&self) -> f64 {
        // An infinite interval has its first output at t = 0, too.
        if self.count == 0 { 0.0 } else { self.count as f64 * self.interval }
    }
}

/// The output times of a run.
#[derive(Resource, Debug, Clone, PartialEq)]
pub struct OutputTimes {
    frames: Every,
    series: Every,
}

impl Default for OutputTimes {
    fn default() -> Self {
        Self::new(f64::INFINITY, f64::INFINITY)
    }
}

impl OutputTimes {
    /// Frames and series at these intervals (s), from t = 0 on.
    #[must_use]
    pub fn new(frames: f64, series: f64) -> Self {
        let every = |interval| Every { interval, count: 0, due: false };
        Self { frames: every(frames), series: every(series) }
    }

    /// The next time (s) at which anything is due.
    #[must_use]
    pub fn next(&self) -> f64 {
        self.frames.next().min(self.series.next())
    }

    /// Whether `kind` is due now; outputs ask this in the output schedule.
    #[must_use]
    pub fn due(&self, kind: OutputKind) -> bool {
        match kind {
            OutputKind::Frames => self.frames.due,
            OutputKind::Series => self.series.due,
        }
    }

    /// Interval (s) of `kind`.
    #[must_use]
    pub fn interval(&self, kind: OutputKind) -> f64 {
        match kind {
            OutputKind::Frames => self.frames.interval,
            OutputKind::Series => self.series.interval,
        }
    }

    /// About how many outputs of `kind` a run to `end_time` (s) makes, to make room for; a million at most.
    #[must_use]
    pub fn expected(&self, kind: OutputKind, end_time: f64) -> usize {
        (end_time / self.interval(kind)).clamp(0.0, 1e6) as usize + 4
    }

    /// Marks what is due at `time` (s); whether anything is.
    pub(crate) fn begin(&mut self, time: f64) -> bool {
        for every in [&mut self.frames, &mut self.series] {
            every.due = time >= every.next();
        }
        self.frames.due || self.series.due
    }

    /// Sets the next times after `time` (s).
    pub(crate) fn finish(&mut self, time: f64) {
        for every in [&mut self.frames, &mut self.series] {
            every.due = false;
            if time >= every.next() {
                every.count = ((time / every.interval).floor() as u64).max(every.count) + 1;
            }
        }
    }
}
