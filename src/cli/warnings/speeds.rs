//! Speeds near that of sound, and viscosities that are nothing but their cap.

use bevy_ecs::prelude::*;

use crate::app::end_time;
use crate::boundary::{Body, BodyShape, Motion, Structure};
use crate::number::short;
use crate::particles::{Fluid, Position, ReferenceDensity, Velocity};
use crate::phases::{Phase, phases};
use crate::physics::EquationOfState;
use crate::rheology::{FlowCurve, HerschelBulkley};
use crate::scene::{FilledFluids, Invalid, Resolution};

/// A weakly compressible fluid is slower than this times its sound speed (Eq. 8).
const GREATEST_MACH: f64 = 0.1;

/// Fluids that start, and bodies that move, faster than a tenth of the sound speed.
pub(super) fn fast_starts(world: &mut World) -> Vec<Invalid> {
    let state = *world.resource::<EquationOfState>();
    let c = phases(world).iter().map(|(_, rho0)| state.sound_speed(*rho0)).fold(f64::INFINITY, f64::min);
    let end_time = end_time(world);
    let mut fastest: Vec<(String, f64)> = Vec::new();
    let fluids = world.resource::<FilledFluids>().fluids.clone();
    let mut particles = world.query_filtered::<(&Position, &Velocity), With<Fluid>>();
    for (k, (shape, _)) in fluids.iter().enumerate() {
        let own = particles.iter(world).filter(|(x, v)| v.0.length() > GREATEST_MACH * c && shape.contains(x.0));
        fastest.push((format!("fluids.{k}.velocity"), own.map(|(_, v)| v.0.length()).fold(0.0, f64::max)));
    }
    let mut bodies = world.query::<(&Body, &BodyShape, &Motion, Has<Structure>)>();
    let mut moving: Vec<_> = bodies.iter(world).collect();
    moving.sort_by_key(|(body, _, _, is_structure)| (*is_structure, body.index));
    for (body, shape, motion, is_structure) in moving {
        let section = if is_structure { "structures" } else { "walls" };
        let speed = motion.greatest_speed(shape.shape.bounds(), end_time);
        fastest.push((format!("{section}.{}.motion", body.name), speed));
    }
    // To rounding: c is ten times the greatest speed where nothing else is said.
    let fast = fastest.into_iter().filter(|(_, speed)| *speed > GREATEST_MACH * c * (1.0 + 1e-9));
    fast.map(|(path, speed)| {
        let message = format!(
            "{} m/s is {} % of the sound speed {} m/s, and above 10 % the density errs by more than 1 %: raise \
             `equation_of_state.max_speed`",
            short(speed),
            short(100.0 * speed / c),
            short(c)
        );
        Invalid::new(path, message)
    })
    .collect()
}

/// Herschel–Bulkley fluids whose cap is below their curve at every shear rate that can occur, up to c/(10 dp): no speed above
/// c/10 is expected (Eq. 8), nor a shear layer thinner than a particle.
pub(super) fn constant_viscosities(world: &mut World) -> Vec<Invalid> {
    let (state, spacing) = (*world.resource::<EquationOfState>(), world.resource::<Resolution>().spacing);
    let mut query = world.query::<(&Phase, &ReferenceDensity, &HerschelBulkley)>();
    let mut found: Vec<(u32, Invalid)> = Vec::new();
    for (phase, rho0, fluid) in query.iter(world) {
        let greatest_rate = GREATEST_MACH * state.sound_speed(rho0.0) / spacing;
        // A Newtonian one has nothing to cap.
        if fluid.yield_stress == 0.0 && fluid.exponent == 1.0 && fluid.consistency < fluid.max_viscosity {
            continue;
        }
        let rates = (0..=60).map(|k| greatest_rate * 10_f64.powf(-0.1 * f64::from(k)));
        if rates.into_iter().all(|rate| fluid.viscosity(rate, 0.0) >= fluid.max_viscosity) {
            let message = format!(
                "the cap of {} Pa s is reached at every shear rate up to c/(10 dp) = {} 1/s: the fluid is Newtonian",
                short(fluid.max_viscosity),
                short(greatest_rate)
            );
            found.push((phase.index, Invalid::new(format!("phases.{}.rheology.max_viscosity", phase.name), message)));
        }
    }
    found.sort_by_key(|(index, _)| *index);
    found.into_iter().map(|(_, invalid)| invalid).collect()
}
