//! Density and pressure, Eqs. 7–9.
//!
//! `p = ρ0 c² (β − 1) + χ`, β = ρ/ρ0. The bulk modulus `B = ρ0 c²` is one number for all phases (Eq. 9), so p and β are
//! continuous where phases touch. Each phase asks for `c ≥ 10 max(√(p_max/ρ0), v_max)` (Eq. 8); the largest B asked
//! for is taken, and each phase gets `c = √(B/ρ0)`.

use bevy_ecs::prelude::*;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::clock::Clock;
use crate::particles::{Density, DensityRate, Fluid, GRAIN, PIECE, Pressure, ReferenceDensity};
use crate::scene::SceneSettings;

/// Equation of state, Eqs. 7–9: section `equation_of_state` of a scene.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StateSettings {
    /// Greatest pressure p_max (Pa) expected; `None` for an estimate from the depth of the fluids.
    #[schemars(range(min = 0.0), extend("unit" = "Pa", "derived" = "follows from the depth of the fluids"))]
    pub max_pressure: Option<f64>,
    /// Greatest speed v_max (m/s) expected; `None` for an estimate: the greatest of a dam break's, 2√(gH),
    /// of the fluids' at the start, and of walls and structures that move.
    #[schemars(range(min = 0.0), extend("unit" = "m/s", "derived" = "follows: the greatest of a dam break's, 2√(gH), of the fluids' at the start and of moving bodies"))]
    pub max_speed: Option<f64>,
    /// Ratio of the sound speed to the greater of √(p_max/ρ0) and v_max (Eq. 8).
    #[schemars(range(min = 1.0), extend("unit" = "1"))]
    pub sound_speed_ratio: f64,
    /// Background pressure χ (Pa); above 0 only where there is no free surface.
    #[schemars(range(min = 0.0), extend("unit" = "Pa"))]
    pub background_pressure: f64,
}

impl Default for StateSettings {
    fn default() -> Self {
        Self { max_pressure: None, max_speed: None, sound_speed_ratio: 10.0, background_pressure: 0.0 }
    }
}

impl SceneSettings for StateSettings {
    const NAME: &'static str = "equation_of_state";
}

/// The equation of state of the run.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct EquationOfState {
    /// Bulk modulus B = ρ0 c² (Pa), the same for every phase.
    pub bulk_modulus: f64,
    /// Background pressure χ (Pa).
    pub background_pressure: f64,
    /// p_max (Pa) that entered Eq. 8.
    pub max_pressure: f64,
    /// v_max (m/s) that entered Eq. 8.
    pub max_speed: f64,
}

impl EquationOfState {
    /// Eq. 8 for phases with these reference densities (kg/m³), with p_max (Pa) and v_max (m/s).
    #[must_use]
    pub fn new(reference_densities: &[f64], settings: &StateSettings, max_pressure: f64, max_speed: f64) -> Self {
        let asked = reference_densities.iter().map(|rho0| {
            let c = settings.sound_speed_ratio * (max_pressure / rho0).sqrt().max(max_speed);
            rho0 * c * c
        });
        let background_pressure = settings.background_pressure;
        Self { bulk_modulus: asked.fold(0.0, f64::max), background_pressure, max_pressure, max_speed }
    }

    /// p (Pa) of Eq. 7 at density `rho` of a phase with reference density `rho0` (kg/m³).
    #[inline(always)]
    #[must_use]
    pub fn pressure(&self, rho: f64, rho0: f64) -> f64 {
        self.bulk_modulus * (rho / rho0 - 1.0) + self.background_pressure
    }

    /// β = ρ/ρ0 at pressure p (Pa): the inverse of Eq. 7.
    #[inline(always)]
    #[must_use]
    pub fn compression(&self, pressure: f64) -> f64 {
        1.0 + (pressure - self.background_pressure) / self.bulk_modulus
    }

    /// Energy of compression `e = ∫ p dρ/ρ²` per mass (J/kg) at density `rho` of a phase with reference density `rho0`
    /// (kg/m³), from ρ0 on: `(B/ρ0) (ln β + 1/β − 1) + (χ/ρ0) (1 − 1/β)`.
    #[inline(always)]
    #[must_use]
    pub fn compression_energy(&self, rho: f64, rho0: f64) -> f64 {
        let strain = rho / rho0 - 1.0;
        (self.bulk_modulus * quadratic_energy(strain) + self.background_pressure * strain / (1.0 + strain)) / rho0
    }

    /// c = √(B/ρ0) (m/s).
    #[inline(always)]
    #[must_use]
    pub fn sound_speed(&self, rho0: f64) -> f64 {
        (self.bulk_modulus / rho0).sqrt()
    }
}

/// `ln β + 1/β − 1` at `strain` s = β − 1. Where that is small, as in weakly compressible fluid, it is what is left of two numbers that
/// cancel; so there by its series `Σ_{n≥2} (−1)ⁿ (1 − 1/n) sⁿ`, even and odd powers apart.
#[inline(always)]
fn quadratic_energy(strain: f64) -> f64 {
    /// |s| up to which the terms after s⁹ are below half a unit in the last place.
    const SMALL: f64 = 0.009;
    if strain.abs() > SMALL {
        return strain.ln_1p() - strain / (1.0 + strain);
    }
    let squared = strain * strain;
    let series = |terms: [f64; 4]| terms.into_iter().rev().fold(0.0, |sum, n| (1.0 - 1.0 / n) + squared * sum);
    let (even, odd) = (series([2.0, 4.0, 6.0, 8.0]), series([3.0, 5.0, 7.0, 9.0]));
    squared * (even - strain * odd)
}

/// `ρ ← ρ + Δt dρ/dt`, then Eq. 7.
pub(super) fn advance_state(
    clock: Res<Clock>,
    state: Res<EquationOfState>,
    mut fluid: Query<(&DensityRate, &ReferenceDensity, &mut Density, &mut Pressure), With<Fluid>>,
) -> Result {
    for (rate, rho0, mut rho, mut p) in fluid.contiguous_iter_mut()? {
        (rate, rho0, rho.bypass_change_detection(), p.bypass_change_detection())
            .into_par_iter()
            .with_min_len(GRAIN)
            .with_max_len(PIECE)
            .for_each(|(rate, rho0, rho, p)| {
                rho.0 += clock.time_step * rate.0;
                p.0 = state.pressure(rho.0, rho0.0);
            });
    }
    Ok(())
}
