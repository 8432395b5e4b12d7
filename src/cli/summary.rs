//! What a run came to, in words.

use std::fs;
use std::path::Path;

use super::number::{bytes, count, duration, short};
use super::simulate::Outcome;
use super::table::Table;
use crate::app::End;
use crate::expect::Check;
use crate::physics::DivergenceReport;

/// The summary of a run.
pub(super) fn summary(scene: &Path, log: &Path, outcome: &Outcome) -> String {
    let (clock, particles, resolution) = (&outcome.clock, &outcome.particles, &outcome.resolution);
    let ending = match outcome.end {
        End::Done => "done",
        End::Diverged(_) => "diverged",
        End::Interrupted => "interrupted",
        End::LogFailed(_) => "the log failed",
        End::Failed(_) => "failed",
    };
    let mean_step = if clock.step > 0 { clock.time / clock.step as f64 } else { 0.0 };
    let mut text = format!(
        "{}: {ending} at t = {} s\n  \
         particles  {} fluid, {} wall, {} structure ({}D, spacing {} m)\n  \
         steps      {}, mean time step {} s\n  \
         duration   {} on {}, {} M updates/s\n  \
         log        {}{}\n",
        scene.display(),
        short(clock.time),
        count(particles.fluid as u64),
        count(particles.wall as u64),
        count(particles.structure as u64),
        resolution.dimension,
        short(resolution.spacing),
        count(clock.step),
        short(mean_step),
        duration(outcome.wall),
        threads(outcome.threads),
        short(outcome.updates_per_second() * 1e-6),
        log.display(),
        fs::metadata(log).map(|data| format!(", {}", bytes(data.len() as f64))).unwrap_or_default(),
    );
    match &outcome.checks {
        Some(checks) if !checks.is_empty() => text += &checks_table(checks),
        None if outcome.has_expectations => {
            text += "  expectations are not checked: the run ended before the end of the scene\n";
        }
        _ => {}
    }
    text
}

/// `1 thread`, `2 threads`.
pub(super) fn threads(number: usize) -> String {
    if number == 1 { "1 thread".to_owned() } else { format!("{number} threads") }
}

/// The expectations of one scene and how they came out.
pub(super) fn checks_table(checks: &[Check]) -> String {
    let mut table = Table::new(["check", "value", "expected", "tolerance", ""]);
    checks.iter().for_each(|check| table.push(check_cells(check)));
    table.render()
}

/// `pass` or `FAIL`.
pub(super) fn verdict(pass: bool) -> &'static str {
    if pass { "pass" } else { "FAIL" }
}

/// What happened to a diverged run, and what to try.
pub(super) fn divergence(report: &DivergenceReport, log: &Path) -> String {
    format!("Error: {report}\n  The log {} is closed and readable; its last frame is the state above.\n", log.display())
}

/// Name, value, expected value, tolerance and verdict of a check. What is expected says the unit.
pub(super) fn check_cells(check: &Check) -> [String; 5] {
    let value = if check.note.is_empty() { short(check.value) } else { format!("none: {}", check.note) };
    [
        check.name.clone(),
        value,
        check.expected_text.clone(),
        check.tolerance_text.clone(),
        verdict(check.pass).to_owned(),
    ]
}
