//! What is known about a run that left the range of the model.

use std::fmt;

use bevy_ecs::prelude::*;
use glam::DVec3;
use serde::Serialize;

use super::Advice;
use crate::clock::Limit;
use crate::number::short;

/// The limit that a run broke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BrokenLimit {
    /// A value is not a number, or infinite.
    NotFinite {
        /// Which quantity.
        quantity: &'static str,
    },
    /// A particle is as fast as sound.
    Speed {
        /// Its speed (m/s).
        value: f64,
        /// Sound speed c (m/s) of its phase.
        sound: f64,
    },
    /// A density is too far from its reference density.
    Density {
        /// The density (kg/m³).
        value: f64,
        /// Least and greatest density (kg/m³) of the phase.
        range: (f64, f64),
    },
    /// The time step fell below its least.
    TimeStep {
        /// The stable time step (s) of Eq. 19.
        value: f64,
        /// The least (s) that is allowed.
        least: f64,
        /// Which term of Eq. 19 asks for it.
        by: Limit,
    },
}

impl BrokenLimit {
    /// `not_finite`, `speed`, `density` or `time_step`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::NotFinite { .. } => "not_finite",
            Self::Speed { .. } => "speed",
            Self::Density { .. } => "density",
            Self::TimeStep { .. } => "time_step",
        }
    }

    /// The value that broke the limit, its unit, and the limit, in the same unit; NaN where a value is no number.
    #[must_use]
    pub fn value_and_limit(&self) -> (f64, &'static str, f64) {
        match *self {
            Self::NotFinite { .. } => (f64::NAN, "", f64::NAN),
            Self::Speed { value, sound } => (value, "m/s", sound),
            Self::Density { value, range: (least, greatest) } => {
                (value, "kg/m³", if value < greatest { least } else { greatest })
            }
            Self::TimeStep { value, least, .. } => (value, "s", least),
        }
    }
}

impl fmt::Display for BrokenLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite { quantity } => write!(f, "its {quantity} is no longer a number"),
            Self::Speed { value, sound } => {
                write!(
                    f,
                    "its speed {} m/s is not below the sound speed {} m/s of its phase",
                    short(value),
                    short(sound)
                )
            }
            Self::Density { value, range: (least, greatest) } => write!(
                f,
                "its density {} kg/m³ is not between {} and {} kg/m³",
                short(value),
                short(least),
                short(greatest)
            ),
            Self::TimeStep { value, least, by } => write!(
                f,
                "it asks for a time step of {} s (Eq. 19, {by}), less than the least allowed, {} s",
                short(value),
                short(least)
            ),
        }
    }
}

/// Neighbours of one kind, nearer than the kernel reaches.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NeighbourGroup {
    /// `fluid`, `wall` or `structure`.
    pub kind: &'static str,
    /// Name of the phase, wall or structure.
    pub name: String,
    /// How many there are.
    pub count: usize,
    /// Distance of the nearest (in spacings).
    pub nearest: f64,
    /// Mean density (kg/m³).
    pub density: f64,
    /// Mean speed (m/s).
    pub speed: f64,
    /// Greatest speed (m/s).
    pub greatest_speed: f64,
}

/// The particle at which a run left the range of the model, what is around it, and what to try.
#[derive(Debug, Clone, PartialEq)]
pub struct DivergenceReport {
    /// Time (s).
    pub time: f64,
    /// Step.
    pub step: u64,
    /// Length Δt (s) of the step.
    pub time_step: f64,
    /// The limit that was broken.
    pub broken: BrokenLimit,
    /// Identity of the particle.
    pub particle: u32,
    /// Name of its phase.
    pub phase: String,
    /// Position (m).
    pub position: DVec3,
    /// Velocity (m/s).
    pub velocity: DVec3,
    /// Acceleration (m/s²).
    pub acceleration: DVec3,
    /// Density (kg/m³).
    pub density: f64,
    /// Reference density (kg/m³) of its phase.
    pub reference_density: f64,
    /// Pressure (Pa).
    pub pressure: f64,
    /// Dynamic viscosity (Pa s).
    pub viscosity: f64,
    /// What is around it, kind by kind.
    pub neighbours: Vec<NeighbourGroup>,
    /// Neighbours that a particle has in the midst of a fluid, about.
    pub full_neighbourhood: usize,
    /// What may have caused it, and what to try; the likeliest first.
    pub advice: Vec<Advice>,
}

/// Set when a run has diverged.
#[derive(Resource, Debug, Clone, Default)]
pub struct Divergence(pub Option<DivergenceReport>);

impl fmt::Display for DivergenceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, step, time_step, broken, particle, phase, .. } = self;
        writeln!(
            f,
            "the run diverged at t = {} s, in step {step} of {} s\n  particle {particle} of phase `{phase}`: {broken}",
            short(*time),
            short(*time_step)
        )?;
        writeln!(
            f,
            "  position {} m, velocity {} m/s, acceleration {} m/s²\n  \
             density {} kg/m³ ({} of the reference density), pressure {} Pa, viscosity {} Pa s",
            triple(self.position),
            triple(self.velocity),
            triple(self.acceleration),
            short(self.density),
            short(self.density / self.reference_density),
            short(self.pressure),
            short(self.viscosity),
        )?;
        self.write_neighbours(f)?;
        f.write_str("  What to try, the likeliest first:")?;
        self.advice.iter().try_for_each(|advice| write!(f, "\n    {}", advice.text))
    }
}

impl DivergenceReport {
    fn write_neighbours(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.neighbours.is_empty() {
            return writeln!(f, "  no neighbours (about {} in the midst of a fluid)", self.full_neighbourhood);
        }
        writeln!(f, "  neighbours (about {} in the midst of a fluid):", self.full_neighbourhood)?;
        for group in &self.neighbours {
            writeln!(
                f,
                "    {:>4} of {} `{}`: nearest {} spacings, mean density {} kg/m³, speed {} m/s, at most {} m/s",
                group.count,
                group.kind,
                group.name,
                short(group.nearest),
                short(group.density),
                short(group.speed),
                short(group.greatest_speed),
            )?;
        }
        Ok(())
    }
}

fn triple(v: DVec3) -> String {
    format!("({})", v.to_array().map(short).join(", "))
}
