//! Estimates of what a run will take.

use bevy_ecs::prelude::*;

use crate::app::end_time;
use crate::clock::{Clock, Limit};
use crate::log::ParticleCounts;
use crate::neighbours::Neighbours;
use crate::outputs::{OutputKind, OutputTimes};
use crate::phases::phases;
use crate::physics::{EquationOfState, Gravity, TimeStepSettings};
use crate::scene::{Resolution, bytes_of};

/// Bytes of the program itself.
const PROGRAM: f64 = 12e6;

/// Time (s) of one thread for a pair that a sweep meets, in a step, all stages together.
const SECONDS_PER_PAIR: f64 = 8e-9;

/// Bytes of a fluid particle in a frame of the log, compressed.
const BYTES_PER_FRAME: f64 = 38.0;

/// What a run will take; times in s, memory in bytes.
pub(crate) struct Estimate {
    /// The limits of Eq. 19 with the greatest viscosity that the rheologies can give.
    pub limits: [(f64, Limit); 3],
    pub steps: f64,
    pub pairs_per_particle: f64,
    pub memory: f64,
    pub log: f64,
    pub updates_per_second: f64,
    pub duration: f64,
}

impl Estimate {
    /// The smallest limit.
    pub fn time_step(&self) -> (f64, Limit) {
        self.limits.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, Limit::Sound))
    }

    /// Estimates the run of a world at its start with this number of threads.
    pub fn of(world: &mut World, threads: usize) -> Self {
        let counts = ParticleCounts::of(world);
        let limits = limits(world);
        let time_step = limits.iter().map(|limit| limit.0).fold(f64::INFINITY, f64::min);
        let end_time = end_time(world);
        // Steps meet outputs exactly: so many whole steps fit between two of them.
        let times = world.resource::<OutputTimes>();
        let interval = times.interval(OutputKind::Series).min(times.interval(OutputKind::Frames)).min(end_time);
        let steps = (end_time / interval * (interval / time_step).ceil()).ceil();
        let neighbours = world.resource::<Neighbours>();
        let fluid_pairs = neighbours.fluid.len() as f64;
        let ghost_pairs = (neighbours.walls.len() + neighbours.structures.len()) as f64;
        let fluid = (counts.fluid as f64).max(1.0);
        let particles = (counts.fluid + counts.wall + counts.structure) as f64;
        let updates_per_second = threads as f64 * fluid / ((fluid_pairs + ghost_pairs) * SECONDS_PER_PAIR);
        let frames = end_time / world.resource::<OutputTimes>().interval(OutputKind::Frames) + 1.0;
        Self {
            limits,
            steps,
            pairs_per_particle: fluid_pairs / fluid,
            memory: PROGRAM + bytes_of(particles, fluid_pairs, ghost_pairs),
            log: frames * fluid * BYTES_PER_FRAME,
            updates_per_second,
            duration: steps * fluid / updates_per_second,
        }
    }
}

/// The three limits of Eq. 19 (s): sound and viscosity in the worst case, acceleration as it is at the start.
fn limits(world: &mut World) -> [(f64, Limit); 3] {
    let all = phases(world);
    let state = *world.resource::<EquationOfState>();
    let clock = *world.resource::<Clock>();
    let settings = *world.resource::<TimeStepSettings>();
    let h = world.resource::<Resolution>().smoothing_length;
    let sound_speed = all.iter().map(|(_, rho0)| state.sound_speed(*rho0)).fold(0.0, f64::max);
    let kinematic = all.iter().map(|(phase, rho0)| phase.rheology.greatest_viscosity / rho0).fold(0.0, f64::max);
    let acceleration = clock.greatest_acceleration.max(world.resource::<Gravity>().full.length());
    let limit = |sound, kinematic, acceleration| settings.stable_step(h, sound, kinematic, acceleration).0;
    [
        (limit(sound_speed + clock.greatest_speed.max(state.max_speed), 0.0, 0.0), Limit::Sound),
        (limit(0.0, kinematic, 0.0), Limit::Viscosity),
        (limit(0.0, 0.0, acceleration), Limit::Acceleration),
    ]
}
