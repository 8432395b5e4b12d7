//! When outputs are due.

use bevy_ecs::prelude::*;
use serde::{Deserialize, Serialize};

/// Which outputs there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputKind {
    /// Particles, walls, structures: large, seldom.
    Frames,
    /// Probes, loads, energy: small, often.
    Series,
}

/// An output every so many seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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

    /// Whether `time` (s) has reached the next output. 70 · 0.005 is a little more than 0.35: a run to 0.35 s must not miss
    /// its last output by rounding.
    fn is_reached(&self, time: f64) -> bool {
        time >= self.next() * (1.0 - ROUNDING)
    }
}

/// Outputs nearer to one another than this, relative to the time, are one.
const ROUNDING: f64 = 1e-12;

/// The output times of a run.
#[derive(Resource, Debug, Clone, PartialEq, Serialize, Deserialize)]
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
            every.due = every.is_reached(time);
        }
        self.frames.due || self.series.due
    }

    /// Sets the next times after `time` (s).
    pub(crate) fn finish(&mut self, time: f64) {
        for every in [&mut self.frames, &mut self.series] {
            every.due = false;
            if every.is_reached(time) {
                let passed = (time / every.interval * (1.0 + ROUNDING)).floor() as u64;
                every.count = passed.max(every.count).saturating_add(1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Clock;

    /// Times of the series outputs of a run with time steps of at most `stable` (s).
    fn times(interval: f64, end: f64, stable: f64) -> Vec<f64> {
        let mut outputs = OutputTimes::new(f64::INFINITY, interval);
        let mut clock = Clock { stable_time_step: stable, ..Clock::default() };
        let mut times = Vec::new();
        loop {
            if outputs.begin(clock.time) {
                if outputs.due(OutputKind::Series) {
                    times.push(clock.time);
                }
                outputs.finish(clock.time);
            }
            if clock.time >= end {
                return times;
            }
            let before = clock.time;
            clock.begin_step(outputs.next().min(end));
            assert!(clock.time > before && clock.time_step <= stable && clock.time <= end);
        }
    }

    #[test]
    fn every_output_is_met_exactly_and_the_last_one_too() {
        for (interval, end, rows) in
            [(0.005, 0.35, 71), (0.01, 0.35, 36), (0.05, 0.15, 4), (0.1, 1.0, 11), (0.3, 1.0, 4)]
        {
            for stable in [1.7e-4, 3.3e-3, 0.02] {
                let times = times(interval, end, stable);
                assert_eq!(times.len(), rows, "interval {interval} s to {end} s");
                for (k, time) in times.iter().enumerate() {
                    assert!((time - k as f64 * interval).abs() <= 1e-12 * end);
                }
            }
        }
    }
}
