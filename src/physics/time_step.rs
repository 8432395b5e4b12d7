//! The next time step, Eq. 19, and the watch over divergence.
//!
//! `Δt = min( C_s h/(c + |v|_max), C_ν h²/max(μ_i/ρ_i), C_a min √(h/|a_i|) )`, with 0.25, 0.125 and 0.25. (The paper
//! prints 1.25 for the first, which is unstable.) What the watch is for stands in [`divergence`](super::divergence).

use bevy_ecs::prelude::*;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::EquationOfState;
use super::divergence::{GREATEST_COMPRESSION, OutOfRange};
use crate::clock::{Clock, Limit};
use crate::particles::{
    Acceleration, Density, Fluid, GRAIN, PIECE, Position, ReferenceDensity, Solid, Velocity, Viscosity, Wall,
    WallVelocity,
};
use crate::scene::{Resolution, SceneSettings};

/// Coefficients of Eq. 19: section `time_step` of a scene.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TimeStepSettings {
    /// C_s of the sound limit (dimensionless).
    #[schemars(range(max = 2.0), extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub sound: f64,
    /// C_ν of the viscous limit (dimensionless).
    #[schemars(range(max = 2.0), extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub viscosity: f64,
    /// C_a of the acceleration limit (dimensionless).
    #[schemars(range(max = 2.0), extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub acceleration: f64,
    /// A run whose stable time step falls below this has diverged; `None` for a hundredth of the least that sound and
    /// viscosity can ask for, or the end time over 10¹¹ if that is longer.
    #[schemars(range(min = 0.0), extend("unit" = "s", "derived" = "follows: a hundredth of the least that sound and viscosity can ask for, or the end time over 10¹¹ if that is longer"))]
    pub least: Option<f64>,
}

impl Default for TimeStepSettings {
    fn default() -> Self {
        Self { sound: 0.25, viscosity: 0.125, acceleration: 0.25, least: None }
    }
}

impl SceneSettings for TimeStepSettings {
    const NAME: &'static str = "time_step";
}

impl TimeStepSettings {
    /// Eq. 19: the greatest stable Δt (s) and what limits it, for a smoothing length h (m), sound speed c and speed
    /// |v|_max (m/s), kinematic viscosity max(μ/ρ) (m²/s) and acceleration |a|_max (m/s²).
    #[must_use]
    pub fn stable_step(
        &self,
        h: f64,
        sound_and_speed: f64,
        kinematic_viscosity: f64,
        acceleration: f64,
    ) -> (f64, Limit) {
        let limits = [
            (self.sound * h / sound_and_speed, Limit::Sound),
            (self.viscosity * h * h / kinematic_viscosity, Limit::Viscosity),
            (self.acceleration * (h / acceleration).sqrt(), Limit::Acceleration),
        ];
        limits
            .into_iter()
            .fold((f64::INFINITY, Limit::Sound), |least, limit| if limit.0 < least.0 { limit } else { least })
    }
}

/// Greatest values over the fluid.
#[derive(Clone, Copy)]
struct Extremes {
    speed_squared: f64,
    acceleration_squared: f64,
    kinematic_viscosity: f64,
    within_range: bool,
}

impl Extremes {
    const NONE: Self =
        Self { speed_squared: 0.0, acceleration_squared: 0.0, kinematic_viscosity: 0.0, within_range: true };

    fn and(self, other: Self) -> Self {
        Self {
            speed_squared: self.speed_squared.max(other.speed_squared),
            acceleration_squared: self.acceleration_squared.max(other.acceleration_squared),
            kinematic_viscosity: self.kinematic_viscosity.max(other.kinematic_viscosity),
            within_range: self.within_range && other.within_range,
        }
    }
}

/// Finds the next stable Δt, and whether the run has left the model's range.
pub fn next_time_step(
    settings: Res<TimeStepSettings>,
    resolution: Res<Resolution>,
    state: Res<EquationOfState>,
    mut clock: ResMut<Clock>,
    mut out_of_range: ResMut<OutOfRange>,
    fluid: Query<(&Position, &Velocity, &Acceleration, &Density, &ReferenceDensity, &Viscosity), With<Fluid>>,
    ghosts: Query<&WallVelocity, Or<(With<Wall>, With<Solid>)>>,
) -> Result {
    let mut extremes = Extremes::NONE;
    let mut least_reference_density = f64::INFINITY;
    for (x, v, a, rho, rho0, mu) in fluid.contiguous_iter()? {
        let each = (x, v, a, rho, rho0, mu).into_par_iter().with_min_len(GRAIN).with_max_len(PIECE).map(
            |(x, v, a, rho, rho0, mu)| {
                let speed_squared = v.0.length_squared();
                let acceleration_squared = a.0.length_squared();
                let within_range = speed_squared * rho0.0 < state.bulk_modulus
                    && acceleration_squared.is_finite()
                    && x.0.is_finite()
                    && rho.0 * GREATEST_COMPRESSION > rho0.0
                    && rho.0 < rho0.0 * GREATEST_COMPRESSION;
                let each =
                    Extremes { speed_squared, acceleration_squared, kinematic_viscosity: mu.0 / rho.0, within_range };
                (each, rho0.0)
            },
        );
        let (found, lightest) = each.reduce(|| (Extremes::NONE, f64::INFINITY), |a, b| (a.0.and(b.0), a.1.min(b.1)));
        (extremes, least_reference_density) = (extremes.and(found), least_reference_density.min(lightest));
    }
    for v_w in ghosts.contiguous_iter()? {
        let speeds = v_w.par_iter().with_min_len(GRAIN).with_max_len(PIECE).map(|v_w| v_w.0.length_squared());
        extremes.speed_squared = extremes.speed_squared.max(speeds.reduce(|| 0.0, f64::max));
    }
    clock.greatest_speed = extremes.speed_squared.sqrt();
    clock.greatest_acceleration = extremes.acceleration_squared.sqrt();
    let signal_speed = state.sound_speed(least_reference_density) + clock.greatest_speed;
    (clock.stable_time_step, clock.stable_limit) = settings.stable_step(
        resolution.smoothing_length,
        signal_speed,
        extremes.kinematic_viscosity,
        clock.greatest_acceleration,
    );
    let is_long_enough = settings.least.is_none_or(|least| clock.stable_time_step >= least);
    out_of_range.0 = !(extremes.within_range && is_long_enough);
    Ok(())
}
