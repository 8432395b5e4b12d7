//! Energy, mass and momentum of the fluid.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Probe, SeriesField, State};
use crate::physics::EquationOfState;

/// Energies (J; J/m in 2D) of the fluid:
///
/// - kinetic `½ Σ m v²`, potential `−Σ m g·x` with the g of the moment;
/// - compression: the work `∫ p dρ/ρ²` per mass, with p = B (β − 1) of Eq. 7 above χ, done since β = ρ/ρ0 was 1:
///   `Σ (m/ρ0) B (ln β + 1/β − 1)`.
///
/// A series of every run, `energy`.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Energy;

impl Probe for Energy {
    fn description(&self) -> String {
        "energy, mass and momentum of the fluid (per metre of length in 2D)".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        let mut fields = vec![
            SeriesField::new("kinetic", "J", "kinetic energy"),
            SeriesField::new(
                "potential",
                "J",
                "potential energy in the gravity of the moment, without its part along periodic axes",
            ),
            SeriesField::new("compression", "J", "energy of compression"),
            SeriesField::new("total", "J", "sum of the three"),
            SeriesField::new("mass", "kg", "mass"),
        ];
        let momentum = ["x", "y", "z"].map(|axis| SeriesField::new(format!("momentum_{axis}"), "kg m/s", "momentum"));
        fields.extend(momentum);
        fields
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let fluid = &state.fluid;
        // Along a periodic axis there is no height.
        let g = DVec3::from_array([0, 1, 2].map(|axis| match state.periodic.0[axis] {
            Some(_) => 0.0,
            None => state.gravity.now[axis],
        }));
        let (mut kinetic, mut potential, mut compression, mut mass) = (0.0, 0.0, 0.0, 0.0);
        let above_chi = EquationOfState { background_pressure: 0.0, ..*state.equation_of_state };
        let mut momentum = DVec3::ZERO;
        for i in fluid.rows() {
            let (m, v, rho0) = (fluid.mass[i].0, fluid.velocity[i].0, fluid.reference_density[i].0);
            kinetic += 0.5 * m * v.length_squared();
            potential -= m * g.dot(fluid.position[i].0);
            compression += m * above_chi.compression_energy(fluid.density[i].0, rho0);
            mass += m;
            momentum += m * v;
        }
        row[..5].copy_from_slice(&[kinetic, potential, compression, kinetic + potential + compression, mass]);
        row[5..].copy_from_slice(&momentum.to_array());
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::probes::test_support::{TANK, opened, scene};

    #[test]
    fn compression_energy_is_the_work_of_the_pressure() {
        for (background_pressure, rho) in [(0.0, 990.0), (0.0, 1010.0), (0.0, 1100.0), (5e3, 990.0), (5e3, 1010.0)] {
            let state = EquationOfState { bulk_modulus: 6e5, background_pressure, max_pressure: 0.0, max_speed: 0.0 };
            let count = 10_000;
            let step = (rho - 1000.0) / f64::from(count);
            let middle = |k: i32| 1000.0 + (f64::from(k) + 0.5) * step;
            let work: f64 = (0..count).map(|k| state.pressure(middle(k), 1000.0) / middle(k).powi(2) * step).sum();
            let energy = state.compression_energy(rho, 1000.0);
            assert!((energy / work - 1.0).abs() < 1e-6, "{energy} {work}");
        }
    }

    #[test]
    fn compression_energy_of_a_tiny_strain_has_all_its_digits() {
        let state = EquationOfState { bulk_modulus: 6e5, background_pressure: 0.0, max_pressure: 0.0, max_speed: 0.0 };
        // ρ/ρ0 − 1 without rounding; the next term of the series is −4s⁵/5.
        let strain = 0.5_f64.powi(20);
        for strain in [strain, -strain] {
            let expected = 600.0 * strain * strain * (0.5 - strain * (2.0 / 3.0 - 0.75 * strain));
            let energy = state.compression_energy(1000.0 * (1.0 + strain), 1000.0);
            assert!((energy / expected - 1.0).abs() < 1e-14, "{energy} {expected}");
        }
        // Where the series ends, it meets the logarithm.
        for strain in [0.00899, 0.00901, -0.00899, -0.00901_f64] {
            let energy = state.compression_energy(1000.0 * (1.0 + strain), 1000.0);
            let expected = 600.0 * (strain.ln_1p() - strain / (1.0 + strain));
            assert!((energy / expected - 1.0).abs() < 1e-13, "{energy} {expected}");
        }
    }

    #[test]
    fn energies_of_a_tank_in_uniform_motion() {
        let mut app = opened(&scene(TANK, ""));
        app.set_fluid(|_, v, _, _| *v = DVec3::new(3.0, 4.0, 0.0));
        app.measure();
        let mass = app.value("energy.mass").unwrap_or_default();
        // Hydrostatic compression adds less than a hundredth to 0.4 m · 0.2 m · (1000 + 1200) kg/m³.
        assert!(mass > 176.0 && mass < 177.76, "{mass}");
        app.assert("energy.kinetic", 12.5 * mass, 1e-9);
        app.assert("energy.momentum_x", 3.0 * mass, 1e-9);
        app.assert("energy.momentum_y", 4.0 * mass, 1e-9);
        let potential = 9.81 * 0.4 * 0.2 * (1200.0 * 0.1 + 1000.0 * 0.3);
        app.assert("energy.potential", potential, 0.01 * potential);
    }
}
