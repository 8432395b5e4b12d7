//! What may have caused a divergence, and what to try.

use serde::Serialize;

use super::{BrokenLimit, NeighbourGroup};
use crate::clock::Limit;
use crate::number::short;
use crate::physics::TimeStepSettings;

/// What may have caused a divergence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// A rheology, a plugin or a table gave a value that is no number.
    NotANumber,
    /// Two fluid particles lie almost on one another.
    Overlap,
    /// The particle lies almost on a particle of a wall or structure.
    InBody,
    /// So few neighbours that the density says little.
    Spray,
    /// The flow is too fast, or its pressure too great, for the sound speed.
    SoundSpeed,
    /// The time step is too long.
    TimeStep,
    /// The viscosity asks for too short a time step.
    Viscosity,
    /// The fluids of the start do not fit one another, their walls or the gravity.
    Start,
}

/// A cause, and what to try against it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Advice {
    /// What may be the cause.
    pub cause: Cause,
    /// What speaks for it, and what to try.
    pub text: String,
}

/// What the advice depends on.
pub(super) struct Circumstances<'a> {
    pub broken: BrokenLimit,
    pub phase: &'a str,
    pub viscosity: f64,
    /// ρ/ρ0 of the particle.
    pub compression: f64,
    pub reference_density: f64,
    pub speed: f64,
    pub neighbours: &'a [NeighbourGroup],
    pub full_neighbourhood: usize,
    pub step: u64,
    pub settings: TimeStepSettings,
    /// v_max of Eq. 8.
    pub max_speed: f64,
}

/// Particles nearer (in spacings) than this lie almost on one another.
const TOO_NEAR: f64 = 0.25;

/// Fewer neighbours than this part of a full neighbourhood are spray.
const SPARSE: f64 = 0.25;

/// Steps in which what goes wrong comes from the start.
const START: u64 = 100;

/// What to try, the likeliest first, once a cause.
pub(super) fn advice(at: &Circumstances<'_>) -> Vec<Advice> {
    let rules = [
        not_a_number(at),
        long_steps(at),
        viscosity(at),
        overlap(at),
        in_body(at),
        spray(at),
        sound_speed(at),
        short_steps(at),
        start(at),
    ];
    let mut advice: Vec<Advice> = Vec::new();
    for one in rules.into_iter().flatten() {
        if advice.iter().all(|known| known.cause != one.cause) {
            advice.push(one);
        }
    }
    advice
}

fn say(cause: Cause, text: String) -> Option<Advice> {
    Some(Advice { cause, text })
}

fn not_a_number(at: &Circumstances<'_>) -> Option<Advice> {
    let BrokenLimit::NotFinite { quantity } = at.broken else { return None };
    let text = format!(
        "the {quantity} is no number, and no particle broke another limit before: look at what gives it, such as the rheology \
         of `{}` (viscosity {} Pa s) or a plugin",
        at.phase,
        short(at.viscosity)
    );
    say(Cause::NotANumber, text)
}

/// Coefficients beyond those that are known to be stable.
fn long_steps(at: &Circumstances<'_>) -> Option<Advice> {
    let (given, usual) = (at.settings, TimeStepSettings::default());
    let coefficients = [
        ("sound", given.sound, usual.sound),
        ("viscosity", given.viscosity, usual.viscosity),
        ("acceleration", given.acceleration, usual.acceleration),
    ];
    let longer: Vec<String> = coefficients
        .iter()
        .filter(|(_, value, usual)| value > usual)
        .map(|(name, value, usual)| format!("--set time_step.{name}={} (it was {})", short(*usual), short(*value)))
        .collect();
    let text = format!("the usual time step, which is shorter: {}", longer.join(" "));
    if longer.is_empty() { None } else { say(Cause::TimeStep, text) }
}

fn viscosity(at: &Circumstances<'_>) -> Option<Advice> {
    let BrokenLimit::TimeStep { by: Limit::Viscosity, .. } = at.broken else { return None };
    let text = format!(
        "a smaller cap on the viscosity, `max_viscosity` of `{}`: the particle has {} Pa s; or a smaller --set time_step.least",
        at.phase,
        short(at.viscosity)
    );
    say(Cause::Viscosity, text)
}

fn overlap(at: &Circumstances<'_>) -> Option<Advice> {
    let group = at.neighbours.iter().find(|group| group.kind == "fluid" && group.nearest < TOO_NEAR)?;
    let text = format!(
        "a particle of `{}` is {} spacings away: fluids that lie in one another at the start, or a body that closes on the fluid?",
        group.name,
        short(group.nearest)
    );
    say(Cause::Overlap, text)
}

fn in_body(at: &Circumstances<'_>) -> Option<Advice> {
    let group = at.neighbours.iter().find(|group| group.kind != "fluid" && group.nearest < TOO_NEAR)?;
    let text = format!(
        "the {} `{}` is {} spacings away: does it move into the fluid, is it thinner than the kernel reaches, is `wall_impact` off?",
        group.kind,
        group.name,
        short(group.nearest)
    );
    say(Cause::InBody, text)
}

/// What is around the particle is about as far out of range as it is.
fn sound_speed(at: &Circumstances<'_>) -> Option<Advice> {
    let fluid: Vec<&NeighbourGroup> = at.neighbours.iter().filter(|group| group.kind == "fluid").collect();
    let count: usize = fluid.iter().map(|group| group.count).sum();
    let mean = |value: fn(&NeighbourGroup) -> f64| {
        fluid.iter().map(|group| group.count as f64 * value(group)).sum::<f64>() / count as f64
    };
    let together = match at.broken {
        BrokenLimit::Speed { value, .. } => count > 0 && mean(|group| group.speed) > 0.5 * value,
        BrokenLimit::Density { .. } => {
            // A quarter of the deviation that ends the run.
            count > 0 && (mean(|group| group.density) / at.reference_density - 1.0).abs() > 0.25
        }
        _ => false,
    };
    if !together {
        return None;
    }
    // A speed that has exploded says nothing about the flow.
    let seen = if at.speed < 100.0 * at.max_speed.max(1.0) { at.speed } else { 0.0 };
    let speed = short((2.0 * at.max_speed).max(1.0).max(seen));
    let text = format!(
        "a greater sound speed, as what is around it is like it (ρ/ρ0 = {} here): --set equation_of_state.max_speed={speed} (the \
         greatest speed expected, in m/s; it was {}), or equation_of_state.max_pressure",
        short(at.compression),
        short(at.max_speed)
    );
    say(Cause::SoundSpeed, text)
}

fn spray(at: &Circumstances<'_>) -> Option<Advice> {
    let count: usize = at.neighbours.iter().map(|group| group.count).sum();
    let is_sparse = (count as f64) < SPARSE * at.full_neighbourhood as f64;
    let text = format!(
        "spray: with {count} of about {} neighbours its density says little. A smaller spacing keeps it together; a greater sound \
         speed (equation_of_state.max_speed) lets it fly faster",
        at.full_neighbourhood
    );
    if is_sparse { say(Cause::Spray, text) } else { None }
}

fn short_steps(at: &Circumstances<'_>) -> Option<Advice> {
    if matches!(at.broken, BrokenLimit::TimeStep { by: Limit::Viscosity, .. }) {
        return None;
    }
    let sound = at.settings.sound;
    let text = format!("a shorter time step: --set time_step.sound={} (it was {})", short(0.5 * sound), short(sound));
    say(Cause::TimeStep, text)
}

fn start(at: &Circumstances<'_>) -> Option<Advice> {
    let text = "a smoother start: fluid that fits its walls (`storegga check`), or a `settling` phase".to_owned();
    if at.step <= START { say(Cause::Start, text) } else { None }
}
