//! Simulated time, the time step, and what limits it.

use std::fmt;

use bevy_ecs::prelude::*;
use serde::{Deserialize, Serialize};

/// Which term of Eq. 19, or what else, set the time step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Limit {
    /// Sound and speed: h/(c + |v|).
    #[default]
    Sound,
    /// Viscous diffusion: h²/(μ/ρ).
    Viscosity,
    /// Acceleration: √(h/|a|).
    Acceleration,
    /// An output or the end was nearer than the stable step.
    Output,
    /// A term that a plugin brings: a system after [`Stage::TimeStep`](crate::schedule::Stage::TimeStep) that makes
    /// [`stable_time_step`](Clock::stable_time_step) smaller.
    Plugin,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Sound => "sound",
            Self::Viscosity => "viscosity",
            Self::Acceleration => "acceleration",
            Self::Output => "output",
            Self::Plugin => "plugin",
        })
    }
}

/// Where the run stands in simulated time.
#[derive(Resource, Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Clock {
    /// Time t (s) at the end of the step in progress.
    pub time: f64,
    /// Steps done, the one in progress included.
    pub step: u64,
    /// Δt (s) of the step in progress.
    pub time_step: f64,
    /// What limits the step in progress.
    pub limit: Limit,
    /// Greatest stable Δt (s) for the next step, Eq. 19.
    pub stable_time_step: f64,
    /// What limits it.
    pub stable_limit: Limit,
    /// Greatest speed (m/s) of any particle: of fluid, wall or structure.
    pub greatest_speed: f64,
    /// Greatest acceleration (m/s²) of any fluid particle.
    pub greatest_acceleration: f64,
}

impl Clock {
    /// Whether the next step is another one because of `target` (s).
    #[must_use]
    pub fn is_cut_by(&self, target: f64) -> bool {
        target - self.time < 2.0 * self.stable_time_step
    }

    /// Starts a step that is stable and does not pass `target` (s); the target is met exactly, and a step that would
    /// leave a sliver before it is halved instead.
    pub fn begin_step(&mut self, target: f64) {
        let left = target - self.time;
        self.step += 1;
        if left <= self.stable_time_step {
            (self.time_step, self.limit, self.time) = (left, Limit::Output, target);
        } else if self.is_cut_by(target) {
            (self.time_step, self.limit) = (0.5 * left, Limit::Output);
            self.time += self.time_step;
        } else {
            (self.time_step, self.limit) = (self.stable_time_step, self.stable_limit);
            self.time += self.time_step;
        }
    }
}
