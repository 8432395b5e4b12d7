//! Progress of a run: a bar on a terminal, now and then a line elsewhere.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::exit::complain;
use super::number::{count, duration, short};
use crate::clock::Clock;

/// Pieces that the bar is divided into.
const PIECES: u64 = 1000;

/// Two lines, each shorter than a terminal of 80 columns whatever the numbers are.
const TEMPLATE: &str = "{bar:16} {percent:>3} %  {prefix}\n{msg}";

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
    /// Time (s) and step from which the run goes on.
    from: (f64, u64),
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
        Self { display, fluid: 0, end_time: 0.0, from: (0.0, 0), started: now, shown: now }
    }

    /// A run of so many fluid particles starts, or goes on, from `first` to `end_time` (s).
    pub fn start(&mut self, fluid: usize, end_time: f64, first: &Clock) {
        (self.fluid, self.end_time) = (fluid, end_time);
        self.from = (first.time, first.step);
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
        let elapsed = now.duration_since(self.started).as_secs_f64();
        let (place, pace, left) = (self.place(clock), self.pace(clock, elapsed), self.left(clock, elapsed));
        match &self.display {
            Display::Hidden => {}
            Display::Bar(bar) => {
                bar.set_position((clock.time / self.end_time * PIECES as f64) as u64);
                bar.set_prefix(format!("{place}, {left}"));
                bar.set_message(pace);
            }
            Display::Lines => complain(&format!("{place}, {pace}, {left}\n")),
        }
    }

    /// How far the run has come.
    fn place(&self, clock: &Clock) -> String {
        format!("t {} / {} s", short(clock.time), short(self.end_time))
    }

    /// How large its steps are and how fast they are done.
    fn pace(&self, clock: &Clock, elapsed: f64) -> String {
        format!(
            "step {}, Δt {} s ({}), {} M updates/s",
            count(clock.step),
            short(clock.stable_time_step),
            clock.stable_limit,
            short(self.fluid as f64 * (clock.step - self.from.1) as f64 / elapsed * 1e-6),
        )
    }

    /// How long it will go on.
    fn left(&self, clock: &Clock, elapsed: f64) -> String {
        format!("{} left", duration(elapsed * (self.end_time - clock.time) / (clock.time - self.from.0)))
    }

    /// The run has ended.
    pub fn finish(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template(TEMPLATE);
    ProgressBar::new(PIECES).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Limit;

    #[test]
    fn the_pieces_say_where_the_run_stands() {
        let mut progress = Progress::new(true);
        progress.start(1000, 2.0, &Clock::default());
        let clock = Clock { time: 0.5, step: 2000, stable_time_step: 2.5e-4, ..Clock::default() };
        assert_eq!(progress.place(&clock), "t 0.5 / 2 s");
        assert_eq!(progress.pace(&clock, 4.0), "step 2 000, Δt 2.5e-4 s (sound), 0.5 M updates/s");
        assert_eq!(progress.left(&clock, 4.0), "12 s left");
        // A run that goes on from 0.25 s is half as fast.
        progress.start(1000, 2.0, &Clock { time: 0.25, step: 1000, ..Clock::default() });
        assert!(progress.pace(&clock, 4.0).ends_with("0.25 M updates/s"));
        assert_eq!(progress.left(&clock, 4.0), "24 s left");
    }

    #[test]
    fn both_lines_fit_80_columns_with_the_longest_numbers() {
        let mut progress = Progress::new(true);
        progress.start(50_000_000, 1.2345e-10, &Clock::default());
        let (time, stable_time_step) = (1.2345e-20, 1.2345e-10);
        let step = 123_456_789_012;
        let clock = Clock { time, step, stable_time_step, stable_limit: Limit::Acceleration, ..Clock::default() };
        let head = TEMPLATE.lines().next().unwrap_or_default().replace("{bar:16}", &"█".repeat(16));
        let place = format!("{}, {}", progress.place(&clock), progress.left(&clock, 1e5));
        let first = head.replace("{percent:>3}", "100").replace("{prefix}", &place);
        let second = progress.pace(&clock, 1e25);
        for line in [first, second] {
            assert!(line.chars().count() < 80, "{} columns: {line}", line.chars().count());
        }
    }
}
