//! One mode of the thickness of a layer.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::phase;
use super::{Probe, SeriesField, State};
use crate::particles::{Fluid, PhaseIndex, Position};
use crate::physics::Gravity;
use crate::scene::geometry::{Axis, axis_exists};
use crate::scene::{Invalid, Resolution, vertical};

/// `amplitude` (m) of one mode of the thickness of a layer, `a = (2/A) Σ_f V_f cos k(x_f − x_0)` over the particles of a phase.
///
/// If the layer is `H + a cos k(x − x_0)` thick over its length, a whole number of half wavelengths, `∫∫ cos k(x − x_0)` over
/// it is a A/2, A being its horizontal area (length in 2D) at the start. The sum sees all of the layer and so no noise of
/// single particles; a lattice of particles at rest gives 0.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LayerMode {
    /// Name of the phase.
    pub phase: String,
    /// Horizontal axis along which the thickness varies.
    pub along: Axis,
    /// Coordinate (m) of a crest on that axis, x_0.
    #[schemars(extend("unit" = "m"))]
    pub crest: f64,
    /// Wavelength 2π/k (m).
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub wavelength: f64,
    #[serde(skip)]
    index: u32,
    /// Horizontal area A (m²; m in 2D).
    #[serde(skip)]
    area: f64,
}

impl Probe for LayerMode {
    fn description(&self) -> String {
        format!("mode of {} m in the thickness of the layer of the phase `{}`", self.wavelength, self.phase)
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![SeriesField::new("amplitude", "m", "amplitude of the mode: thickness at the crest less the mean one")]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.index = phase(world, &self.phase)?;
        if self.wavelength <= 0.0 {
            return Err(Invalid::new("wavelength", format!("must be greater than 0, got {} m", self.wavelength)));
        }
        let resolution = *world.resource::<Resolution>();
        axis_exists(self.along, resolution.dimension).map_err(|wrong| wrong.under("along"))?;
        let gravity = world.resource::<Gravity>().full;
        let (up, _) = vertical(gravity).ok_or_else(|| Invalid::new("", "a layer needs a gravity along an axis"))?;
        if up == self.along.index() {
            return Err(Invalid::new("along", "a layer lies across gravity, not along it"));
        }
        let mut fluid = world.query_filtered::<(&PhaseIndex, &Position), With<Fluid>>();
        let own = fluid.iter(world).filter(|(phase, _)| phase.0 == self.index).map(|(_, x)| x.0);
        let bounds = own.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let extent = bounds.1 - bounds.0 + resolution.spacing;
        self.area = (0..resolution.dimension).filter(|axis| *axis != up).map(|axis| extent[axis]).product();
        Ok(())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let (k, axis) = (std::f64::consts::TAU / self.wavelength, self.along.index());
        let fluid = &state.fluid;
        let moment: f64 = fluid
            .rows_of(self.index)
            .map(|i| fluid.volume(i) * (k * (fluid.position[i].0[axis] - self.crest)).cos())
            .sum();
        row[0] = 2.0 * moment / self.area;
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use crate::probes::test_support::{TANK, complaint, measured, scene};

    const PROBES: &str = "probes: {\"brine\": LayerMode(phase: \"brine\", along: X, crest: 0, wavelength: 0.8)},";

    #[test]
    fn a_layer_that_is_stretched_has_the_amplitude_of_its_wave() {
        let mut app = measured(&scene(TANK, PROBES));
        app.assert("brine.amplitude", 0.0, 1e-6);
        // What is ξ = −b sin kx ahead is H(1 + kb cos kx) thick to first order; k is π/0.4 m, H 0.2 m.
        let (k, b) = (PI / 0.4, 1e-4);
        app.move_fluid(|mut x| {
            x.x -= b * (k * x.x).sin();
            x
        });
        app.measure();
        app.assert("brine.amplitude", 0.2 * k * b, 0.005 * 0.2 * k * b);
    }

    #[test]
    fn a_layer_along_gravity_is_refused() {
        let probes = PROBES.replace("along: X", "along: Y");
        assert!(complaint(&scene(TANK, &probes)).contains("across gravity"));
        let probes = PROBES.replace("along: X", "along: Z");
        assert!(complaint(&scene(TANK, &probes)).contains("no z axis"));
    }
}
