//! How even particles lie, and how noisy their pressure is.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Probe, SeriesField, State};

/// Whether particles clump, and whether their pressures scatter. `closest`: least distance of two fluid particles, in spacings.
/// `clumped`: share of the fluid particles that have another nearer than half a spacing. `pressure_noise`: root mean square of
/// `p_i − Σ_j V_j W_ij p_j / Σ_j V_j W_ij` (Pa), j over the fluid around i, for particles whose neighbourhood fluid fills to nine tenths: a
/// pressure that varies evenly has next to none. `lowest_pressure` (Pa): of any fluid particle, the background pressure left out. NaN before the
/// first step.
#[derive(Component, Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ParticleDisorder {}

/// Distance (spacings) below which a particle is clumped with another.
pub(crate) const CLUMPED: f64 = 0.5;

/// φ, of fluid alone, from which on a particle counts for the noise of pressure.
pub(crate) const FULL: f64 = 0.9;

impl Probe for ParticleDisorder {
    fn description(&self) -> String {
        "clumping of particles and scatter of their pressures".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![
            SeriesField::new("closest", "spacings", "least distance of two fluid particles"),
            SeriesField::new("clumped", "", "share of particles with another nearer than half a spacing"),
            SeriesField::new("pressure_noise", "Pa", "root mean square of p less its mean over the neighbours"),
            SeriesField::new("lowest_pressure", "Pa", "least pressure of a fluid particle"),
        ]
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        if state.neighbours.builds == 0 {
            return;
        }
        let (mut closest, mut clumped, mut lowest) = (f64::INFINITY, 0, f64::INFINITY);
        let (mut squares, mut counted) = (0.0, 0);
        for i in state.fluid.rows() {
            let around = Around::of(state, i);
            closest = closest.min(around.nearest);
            clumped += usize::from(around.nearest < CLUMPED * state.resolution.spacing);
            lowest = lowest.min(state.fluid.pressure[i].0);
            if around.filled >= FULL {
                squares += (state.fluid.pressure[i].0 - around.pressure).powi(2);
                counted += 1;
            }
        }
        row[0] = closest / state.resolution.spacing;
        row[1] = clumped as f64 / state.fluid.rows().len() as f64;
        row[2] = (squares / f64::from(counted)).sqrt();
        row[3] = lowest - state.equation_of_state.background_pressure;
    }
}

/// The fluid around a particle.
struct Around {
    /// Distance (m) of the nearest other.
    nearest: f64,
    /// φ of fluid.
    filled: f64,
    /// Mean pressure (Pa), its own included.
    pressure: f64,
}

impl Around {
    fn of(state: &State<'_>, i: usize) -> Self {
        let (fluid, rows, kernel) = (&state.fluid, &state.neighbours.rows, &state.kernel);
        let (mut nearest, mut filling, mut weight, mut pressure) = (f64::INFINITY, 0.0, 0.0, 0.0);
        for row in state.neighbours.fluid.of(i).fluid.iter() {
            let j = rows.source(row);
            let r_squared = fluid.position[i].0.distance_squared(fluid.position[j].0 + rows.shift(row));
            let mut gradient = [r_squared];
            kernel.0.gradients(&mut gradient);
            filling -= fluid.volume(j) * gradient[0] * r_squared;
            let share = fluid.volume(j) * kernel.value(r_squared.sqrt());
            weight += share;
            pressure += share * fluid.pressure[j].0;
            // A particle is among what is near it; its images beyond periodic sides are others.
            if j != i || r_squared > 0.0 {
                nearest = nearest.min(r_squared.sqrt());
            }
        }
        Self { nearest, filled: filling / state.resolution.dimension as f64, pressure: pressure / weight }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::particles::{Density, Fluid, Position};
    use crate::probes::test_support::{TANK, TestApp, opened, scene};
    use crate::schedule::Step;

    fn tank(change: impl FnOnce(&mut TestApp)) -> TestApp {
        let mut app = opened(&scene(TANK, "probes: {\"disorder\": ParticleDisorder()},"));
        change(&mut app);
        app.0.world_mut().run_schedule(Step);
        app.measure();
        app
    }

    /// The tank's spacing is 20 mm, and it holds 400 particles.
    #[test]
    fn a_pair_that_is_near_is_found() {
        let app = &mut tank(|app| {
            app.move_fluid(|x| if x.distance(DVec3::new(0.11, 0.11, 0.0)) < 0.005 { x + 0.015 * DVec3::X } else { x })
        });
        app.assert("disorder.closest", 0.25, 1e-9);
        app.assert("disorder.clumped", 2.0 / 400.0, 1e-12);
    }

    #[test]
    fn a_column_at_rest_has_no_noise_and_a_checkerboard_its_amplitude() {
        let rest = tank(|_| {}).value("disorder.pressure_noise").unwrap_or(f64::NAN);
        let amplitude = 1e-3;
        let mut app = opened(&scene(TANK, "probes: {\"disorder\": ParticleDisorder()},"));
        let world = app.0.world_mut();
        let mut fluid = world.query_filtered::<(&Position, &mut Density), bevy_ecs::prelude::With<Fluid>>();
        for (x, mut rho) in fluid.iter_mut(world) {
            let cell = (x.0.x / 0.02).floor() as i64 + (x.0.y / 0.02).floor() as i64;
            rho.0 *= 1.0 + if cell % 2 == 0 { amplitude } else { -amplitude };
        }
        world.run_schedule(Step);
        app.measure();
        let bulk_modulus = app.0.world().resource::<crate::physics::EquationOfState>().bulk_modulus;
        let noise = app.value("disorder.pressure_noise").unwrap_or(f64::NAN);
        assert!(rest < 0.02 * noise, "{rest} Pa at rest, {noise} Pa");
        // Its own weight makes a third of the mean, with neighbours of the other sign: the mean is all but null.
        assert!((noise / (amplitude * bulk_modulus) - 1.0).abs() < 0.1, "{noise} Pa");
    }
}
