//! The one JSON object of `storegga run --json`.

use std::path::Path;

use serde_json::{Value, json};

use super::simulate::Outcome;
use crate::app::End;
use crate::expect::Check;
use crate::physics::DivergenceReport;

/// What came out of a run. Units: m, s, 1/s; checks have that of their measure.
pub(super) fn object(scene: &Path, log: &Path, outcome: &Outcome) -> Value {
    let mut object = json!({
        "scene": scene.display().to_string(),
        "title": outcome.title,
        "dimension": outcome.resolution.dimension,
        "spacing": outcome.resolution.spacing,
        "particles": {
            "fluid": outcome.particles.fluid,
            "wall": outcome.particles.wall,
            "structure": outcome.particles.structure,
        },
        "end": outcome.end.word(),
        "steps": outcome.clock.step,
        "time": outcome.clock.time,
        "wall_s": outcome.wall,
        "updates_per_s": outcome.updates_per_second(),
        "threads": outcome.threads,
        "log": log.display().to_string(),
        "checks": outcome.checks.iter().flatten().map(check).collect::<Vec<_>>(),
    });
    if let End::Diverged(report) = &outcome.end {
        object["divergence"] = divergence(report);
    }
    object
}

/// Units: s, m, m/s, m/s², kg/m³, Pa, Pa s; distances of neighbours in spacings; the limit has its own.
fn divergence(report: &DivergenceReport) -> Value {
    let (value, unit, limit) = report.broken.value_and_limit();
    json!({
        "time": report.time,
        "step": report.step,
        "time_step": report.time_step,
        "particle": report.particle,
        "phase": report.phase,
        "position": report.position.to_array(),
        "velocity": report.velocity.to_array(),
        "acceleration": report.acceleration.to_array(),
        "density": report.density,
        "reference_density": report.reference_density,
        "pressure": report.pressure,
        "viscosity": report.viscosity,
        "limit": { "name": report.broken.name(), "value": value, "limit": limit, "unit": unit },
        "reason": report.broken.to_string(),
        "neighbours": report.neighbours,
        "full_neighbourhood": report.full_neighbourhood,
        "advice": report.advice,
    })
}

fn check(check: &Check) -> Value {
    json!({
        "name": check.name,
        "value": check.value,
        "expected": check.expected,
        "tolerance": check.tolerance,
        "unit": check.unit,
        "pass": check.pass,
        "note": check.note,
    })
}
