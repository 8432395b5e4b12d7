//! Forces that act on every particle by itself: gravity, and the damping of a settling phase.
//!
//! `dv_i/dt ← dv_i/dt + g(t)`; while the settling phase lasts, `v_i ← v_i e^(−kΔt)` once a step.

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::clock::Clock;
use crate::particles::{Acceleration, Fluid, GRAIN, PIECE, Velocity};
use crate::scene::SceneSettings;

/// Gravity, or whatever uniform acceleration the scene gives in its place.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Gravity {
    /// g (m/s²) of the scene.
    pub full: DVec3,
    /// g (m/s²) now: less during a ramp.
    pub now: DVec3,
}

/// How the fluids come to rest before anything is measured: section `settling` of a scene.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Settling {
    /// Not at all.
    #[default]
    Off,
    /// Velocities are damped for a while: dv/dt = … − rate·v.
    Damping {
        /// Time (s) until which the damping acts.
        #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0))]
        until: f64,
        /// Rate (1/s).
        #[schemars(extend("unit" = "1/s", "exclusiveMinimum" = 0.0))]
        rate: f64,
    },
    /// Gravity grows smoothly from nothing.
    GravityRamp {
        /// Time (s) from which gravity acts in full.
        #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0))]
        until: f64,
    },
}

impl SceneSettings for Settling {
    const NAME: &'static str = "settling";
}

impl Settling {
    /// Damping rate k (1/s) at time t (s).
    fn damping(&self, t: f64) -> f64 {
        match *self {
            Self::Damping { until, rate } if t < until => rate,
            _ => 0.0,
        }
    }

    /// Fraction of gravity that acts at time t (s): 3s² − 2s³ during a ramp.
    fn gravity_fraction(&self, t: f64) -> f64 {
        match *self {
            Self::GravityRamp { until } if t < until => {
                let s = t / until;
                s * s * (3.0 - 2.0 * s)
            }
            _ => 1.0,
        }
    }
}

/// Sets g for the step in progress.
pub(super) fn ramp_gravity(clock: Res<Clock>, settling: Res<Settling>, mut gravity: ResMut<Gravity>) {
    gravity.now = gravity.full * settling.gravity_fraction(clock.time);
}

/// Adds g(t), and damps the velocity: exact over a step of any length, and stable for any rate.
pub(super) fn apply_body_force(
    clock: Res<Clock>,
    settling: Res<Settling>,
    gravity: Res<Gravity>,
    mut fluid: Query<(&mut Velocity, &mut Acceleration), With<Fluid>>,
) -> Result {
    // The step began before its time: its middle decides whether the settling phase still lasts.
    let dt = clock.time_step;
    let left = (-settling.damping(clock.time - 0.5 * dt) * dt).exp();
    for (mut velocity, mut acceleration) in fluid.contiguous_iter_mut()? {
        (velocity.bypass_change_detection(), acceleration.bypass_change_detection())
            .into_par_iter()
            .with_min_len(GRAIN)
            .with_max_len(PIECE)
            .for_each(|(v, a)| {
                a.0 += gravity.now;
                v.0 *= left;
            });
    }
    Ok(())
}
