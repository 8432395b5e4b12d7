//! Error of the pressure of a column at rest, Eqs. 20 and 21.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::{place, up};
use super::{Probe, SeriesField, State};
use crate::physics::{EquationOfState, Gravity};
use crate::scene::geometry::Point;
use crate::scene::{Column, FilledFluids, Invalid, Resolution};

/// Relative L2 error of the pressure over the fluid (Eqs. 20, 21), the integrals taken as sums over particles of volume
/// V = m/ρ:
///
/// `‖p − p̂‖/‖p̂‖ = √( Σ V (p − p̂)² / Σ V p̂² )`
///
/// against the layers that were filled, at rest: `compressible` with the model's own exact solution
/// `p̂ + B = (p̂_top + B) e^(ρ0 g depth/B)`, `incompressible` with the weight above, which differs from it by about p/(2B)
/// at any spacing. Pressures count from χ.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HydrostaticError {
    /// A point of the vertical (m) on which the layers are taken; `None` for the middle of the fluids.
    #[serde(default)]
    #[schemars(extend("unit" = "m", "derived" = "the middle of the fluids"))]
    pub at: Option<Point>,
    #[serde(skip)]
    column: Column,
    #[serde(skip)]
    up: DVec3,
}

impl Probe for HydrostaticError {
    fn description(&self) -> String {
        "relative L2 error of the pressure against layers at rest, Eq. 20".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![
            SeriesField::new("compressible", "", "error against the model's own compressible solution"),
            SeriesField::new("incompressible", "", "error against the weight above"),
        ]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.up = up(world)?;
        let filled = world.resource::<FilledFluids>();
        let at = match self.at {
            Some(point) => place(world, "at", point)?,
            None => middle(filled),
        };
        let chi = world.resource::<EquationOfState>().background_pressure;
        let (gravity, spacing) = (world.resource::<Gravity>().full, world.resource::<Resolution>().spacing);
        self.column = filled.column(at, gravity, spacing, chi);
        if self.column.layers.is_empty() {
            return Err(Invalid::new("", "no fluid lies on the vertical through `at`, or gravity is along no axis"));
        }
        Ok(())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let fluid = &state.fluid;
        let (bulk_modulus, chi) = (state.equation_of_state.bulk_modulus, state.equation_of_state.background_pressure);
        let (mut errors, mut norms) = ([0.0; 2], [0.0; 2]);
        for i in fluid.rows() {
            let (height, volume) = (fluid.position[i].0.dot(self.up), fluid.volume(i));
            let exact = [self.column.compressible(height, bulk_modulus, chi), self.column.incompressible(height)];
            for ((error, norm), exact) in errors.iter_mut().zip(&mut norms).zip(exact) {
                *error += volume * (fluid.pressure[i].0 - exact).powi(2);
                *norm += volume * (exact - chi).powi(2);
            }
        }
        for ((out, error), norm) in row.iter_mut().zip(errors).zip(norms) {
            *out = (error / norm).sqrt();
        }
    }
}

/// Middle of the bounds (m) of all fluids at the start.
fn middle(filled: &FilledFluids) -> DVec3 {
    let (low, high) = filled
        .fluids
        .iter()
        .map(|(shape, _)| shape.bounds())
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), (a, b)| (low.min(a), high.max(b)));
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use crate::physics::EquationOfState;
    use crate::probes::test_support::{TANK, measured, opened, scene};

    const ERROR: &str = "probes: {\"l2\": HydrostaticError()},";

    #[test]
    fn the_start_is_the_exact_compressible_solution() {
        let mut app = measured(&scene(TANK, ERROR));
        app.assert("l2.compressible", 0.0, 1e-12);
        let state = *app.0.world().resource::<EquationOfState>();
        let order = 9.81 * 440.0 / (2.0 * state.bulk_modulus);
        let incompressible = app.value("l2.incompressible").unwrap_or_default();
        assert!(incompressible > 0.5 * order && incompressible < order, "{incompressible} {order}");
    }

    #[test]
    fn a_pressure_too_high_by_a_tenth_is_an_error_of_a_tenth() {
        let mut app = opened(&scene(TANK, ERROR));
        app.set_fluid(|_, _, p, _| *p *= 1.1);
        app.measure();
        app.assert("l2.compressible", 0.1, 1e-12);
    }

    #[test]
    fn a_background_pressure_changes_nothing() {
        let more = format!("{ERROR} equation_of_state: (background_pressure: 500),");
        let mut app = opened(&scene(TANK, &more));
        app.set_fluid(|_, _, p, _| *p = 500.0 + 1.1 * (*p - 500.0));
        app.measure();
        app.assert("l2.compressible", 0.1, 1e-12);
    }
}
