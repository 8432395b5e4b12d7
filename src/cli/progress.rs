//! Progress of a run: a bar on a terminal, now and then a line elsewhere.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::exit::complain;
use super::number::{count, duration, short};
use crate::clock::Clock;

/// Pieces that the bar is divided into.
const PIECES: u64 = 1000;

/// How often the bar changes.
const BAR_INTERVAL: Duration = Duration::from_millis(100);

/// How often a line is written where there is no terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// How a run is shown while it goes on.
enum Display {
    Hidden,
    Bar(ProgressBar),
    Lines,
}

/// Shows on standard error how far a run has come.
pub(super) struct Progress {
    display: Display,
    fluid: usize,
    end_time: f64,
    started: Instant,
    shown: Instant,
}

impl Progress {
    /// A bar if standard error is a terminal, else lines; nothing if `quiet`.
    pub fn new(quiet: bool) -> Self {
        let display = match (quiet, io::stderr().is_terminal()) {
            (true, _) => Display::Hidden,
            (false, true) => Display::Bar(bar()),
            (false, false) => Display::Lines,
        };
        let now = Instant::now();
        Self { display, fluid: 0, end_time: 0.0, started: now, shown: now }
    }

    /// A run of so many fluid particles starts that ends at `end_time` (s).
    pub fn start(&mut self, fluid: usize, end_time: f64) {
        (self.fluid, self.end_time) = (fluid, end_time);
        self.started = Instant::now();
        self.shown = self.started;
    }

    /// A step was done.
    pub fn step(&mut self, clock: &Clock) {
        let interval = match self.display {
            Display::Hidden => return,
            Display::Bar(_) => BAR_INTERVAL,
            Display::Lines => LINE_INTERVAL,
        };
        let now = Instant::now();
        if now.duration_since(self.shown) < interval {
            return;
        }
        self.shown = now;
        let text = self.line(clock, now.duration_since(self.started).as_secs_f64());
        match &self.display {
            Display::Hidden => {}
            Display::Bar(bar) => {
                bar.set_position((clock.time / self.end_time * PIECES as f64) as u64);
                bar.set_message(text);
            }
            Display::Lines => complain(&format!("{text}\n")),
        }
    }

    fn line(&self, clock: &Clock, elapsed: f64) -> String {
        let left = elapsed * (self.end_time - clock.time) / clock.time;
        format!(
            "t {} / {} s, step {}, Δt {} s ({}), {} M updates/s, {} left",
            short(clock.time),
            short(self.end_time),
            count(clock.step),
            short(clock.stable_time_step),
            clock.stable_limit,
            short(self.fluid as f64 * clock.step as f64 / elapsed * 1e-6),
            duration(left),
        )
    }

    /// The run has ended.
    pub fn finish(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:24} {percent:>3} %  {wide_msg}");
    ProgressBar::new(PIECES).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_where_the_run_stands() {
        let mut progress = Progress::new(true);
        progress.start(1000, 2.0);
        let clock = Clock { time: 0.5, step: 2000, stable_time_step: 2.5e-4, ..Clock::default() };
        let line = progress.line(&clock, 4.0);
        assert_eq!(line, "t 0.5 / 2 s, step 2 000, Δt 2.5e-4 s (sound), 0.5 M updates/s, 12 s left");
    }
}
