//! Kick–drift–kick.
//!
//! `v ← v + ½Δt a;  x ← x + Δt v;  … new a …;  v ← v + ½Δt a`

use bevy_ecs::prelude::*;
use rayon::prelude::*;

use crate::clock::Clock;
use crate::particles::{Acceleration, Fluid, GRAIN, PIECE, Position, Velocity};

/// `v ← v + ½Δt a`, before the drift and again after the forces.
pub(super) fn kick(clock: Res<Clock>, mut fluid: Query<(&mut Velocity, &Acceleration), With<Fluid>>) -> Result {
    let half_step = 0.5 * clock.time_step;
    for (mut velocity, acceleration) in fluid.contiguous_iter_mut()? {
        (velocity.bypass_change_detection(), acceleration)
            .into_par_iter()
            .with_min_len(GRAIN)
            .with_max_len(PIECE)
            .for_each(|(v, a)| v.0 += half_step * a.0);
    }
    Ok(())
}

/// `x ← x + Δt v`.
pub fn drift(clock: Res<Clock>, mut fluid: Query<(&mut Position, &Velocity), With<Fluid>>) -> Result {
    let dt = clock.time_step;
    for (mut position, velocity) in fluid.contiguous_iter_mut()? {
        (position.bypass_change_detection(), velocity)
            .into_par_iter()
            .with_min_len(GRAIN)
            .with_max_len(PIECE)
            .for_each(|(x, v)| x.0 += dt * v.0);
    }
    Ok(())
}
