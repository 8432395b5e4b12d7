//! Strain softening: a yield stress that falls with the shear strain that a particle has been through (Einav & Randolph
//! 2005, Int. J. Numer. Meth. Eng. 63, 501–525).
//!
//! `τ_y(ξ) = [δ_rem + (1 − δ_rem) e^(−3 ξ/ξ_95)] τ_peak`,  `δ_rem = 1/S_t`
//!
//! S_t, the sensitivity, is the peak over the remoulded strength; at the accumulated strain ξ = ξ_95, 95 % of what can be
//! lost is lost. With this τ_y the fluid is Herschel–Bulkley (Eq. 13).
//!
//! `dξ/dt = γ̇` while the material yields: from the shear rate on at which the regularised curve, starting as it does at
//! rest, would come to τ_y (`γ̇ = τ_y/μ_max` if it is capped, 1/m with Papanastasiou's regularisation). What creeps below
//! it is only as soft as the regularisation makes it, and does not soften. ξ is a column of the particles; its Δt is that
//! of the [`Clock`].

use bevy_ecs::prelude::*;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use storegga::clock::Clock;
use storegga::particles::{Fluid, GRAIN, PIECE, PhaseIndex, ShearRate, Viscosity};
use storegga::phases::Phase;
use storegga::rheology::{Bound, FlowCurve, HerschelBulkley, Regularisation, Rheology, check_bounds, models_by_phase};
use storegga::scene::Invalid;

/// Sensitive clay: Herschel–Bulkley whose yield stress `τ_y(ξ) = [1/S_t + (1 − 1/S_t) e^(−3 ξ/ξ_95)] τ_peak` falls with the
/// shear strain ξ that a particle has been through while it yielded (Einav & Randolph 2005).
#[derive(Component, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StrainSoftening {
    /// Consistency η (Pa s^K).
    #[schemars(range(min = 0.0), extend("unit" = "Pa s^K"))]
    pub consistency: f64,
    /// Power-law exponent K (dimensionless).
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub exponent: f64,
    /// Yield stress τ_peak (Pa) of undisturbed material.
    #[schemars(range(min = 0.0), extend("unit" = "Pa"))]
    pub peak_yield_stress: f64,
    /// Sensitivity S_t (dimensionless): peak over remoulded yield stress, at least 1.
    #[schemars(range(min = 1.0), extend("unit" = "1"))]
    pub sensitivity: f64,
    /// Accumulated plastic shear strain ξ_95 (dimensionless, 1 = 100 %) at which 95 % of the difference is lost.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub strain_95: f64,
    /// Cap μ_max (Pa s) of the viscosity; it enters the time step (Eq. 19).
    #[schemars(extend("unit" = "Pa s", "exclusiveMinimum" = 0.0))]
    pub max_viscosity: f64,
    /// How the yield stress is regularised at rest.
    #[serde(default)]
    pub regularisation: Regularisation,
}

/// Accumulated plastic shear strain ξ (dimensionless) of a particle; 0 in phases that do not soften.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct AccumulatedStrain(pub f64);

impl StrainSoftening {
    /// Yield stress τ_y (Pa) after the strain ξ.
    #[inline]
    #[must_use]
    pub fn yield_stress(&self, strain: f64) -> f64 {
        let remoulded = 1.0 / self.sensitivity;
        (remoulded + (1.0 - remoulded) * (-3.0 * strain / self.strain_95).exp()) * self.peak_yield_stress
    }

    /// The flow curve of material with this yield stress (Pa).
    fn with_yield_stress(&self, yield_stress: f64) -> HerschelBulkley {
        HerschelBulkley {
            consistency: self.consistency,
            exponent: self.exponent,
            yield_stress,
            max_viscosity: self.max_viscosity,
            regularisation: self.regularisation,
        }
    }

    /// Whether material with this yield stress (Pa) yields at shear rate γ̇ (1/s).
    fn yields(&self, yield_stress: f64, shear_rate: f64) -> bool {
        let at_rest = self.regularisation.yield_viscosity(yield_stress, 0.0).min(self.max_viscosity);
        shear_rate * at_rest >= yield_stress
    }
}

impl Rheology for StrainSoftening {
    fn check(&self) -> Result<(), Invalid> {
        check_bounds(&[
            ("consistency", self.consistency, Bound::NotNegative, "Pa s^K"),
            ("exponent", self.exponent, Bound::Positive, ""),
            ("peak_yield_stress", self.peak_yield_stress, Bound::NotNegative, "Pa"),
            ("sensitivity", self.sensitivity, Bound::Positive, ""),
            ("strain_95", self.strain_95, Bound::Positive, ""),
            ("max_viscosity", self.max_viscosity, Bound::Positive, "Pa s"),
        ])?;
        if self.sensitivity < 1.0 {
            let message = format!("must be at least 1 (peak over remoulded strength), got {}", self.sensitivity);
            return Err(Invalid::new("sensitivity", message));
        }
        self.regularisation.check()
    }

    /// That of undisturbed material.
    fn greatest_viscosity(&self) -> f64 {
        self.with_yield_stress(self.peak_yield_stress).greatest_viscosity()
    }
}

type Columns = (&'static PhaseIndex, &'static ShearRate, &'static mut AccumulatedStrain, &'static mut Viscosity);

/// Adds the strain of the step and writes the viscosity, for the particles of every phase that softens.
pub(crate) fn soften(
    mut models: Local<Vec<Option<StrainSoftening>>>,
    clock: Res<Clock>,
    phases: Query<(&Phase, Option<&StrainSoftening>)>,
    mut fluid: Query<Columns, With<Fluid>>,
) -> Result {
    let models = models_by_phase(&mut models, &phases);
    let dt = clock.time_step;
    for (phase, shear_rate, mut strain, mut viscosity) in fluid.contiguous_iter_mut()? {
        (phase, shear_rate, strain.bypass_change_detection(), viscosity.bypass_change_detection())
            .into_par_iter()
            .with_min_len(GRAIN)
            .with_max_len(PIECE)
            .for_each(|(phase, shear_rate, strain, viscosity)| {
                let Some(model) = &models[phase.0 as usize] else { return };
                if model.yields(model.yield_stress(strain.0), shear_rate.0) {
                    strain.0 += dt * shear_rate.0;
                }
                let curve = model.with_yield_stress(model.yield_stress(strain.0));
                viscosity.0 = curve.viscosity(shear_rate.0, 0.0);
            });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quick clay.
    const CLAY: StrainSoftening = StrainSoftening {
        consistency: 20.0,
        exponent: 1.0,
        peak_yield_stress: 6000.0,
        sensitivity: 5.0,
        strain_95: 10.0,
        max_viscosity: 1e6,
        regularisation: Regularisation::Capped,
    };

    #[test]
    fn the_yield_stress_falls_from_its_peak_to_its_remoulded_value() {
        assert_eq!(CLAY.yield_stress(0.0), 6000.0);
        assert!((CLAY.yield_stress(1e3) - 1200.0).abs() < 1e-9);
        let lost = (6000.0 - CLAY.yield_stress(10.0)) / 4800.0;
        assert!((lost - 0.95).abs() < 5e-4, "{lost}");
    }

    #[test]
    fn without_sensitivity_it_is_herschel_bulkley() {
        let tough = StrainSoftening { sensitivity: 1.0, ..CLAY };
        for strain in [0.0, 0.3, 100.0] {
            assert_eq!(tough.yield_stress(strain), 6000.0);
        }
        assert_eq!(tough.greatest_viscosity(), 1e6);
    }

    #[test]
    fn it_yields_where_the_regularised_curve_comes_to_the_yield_stress() {
        assert!(!CLAY.yields(6000.0, 0.0059) && CLAY.yields(6000.0, 0.0061));
        let smooth = StrainSoftening { regularisation: Regularisation::Papanastasiou { m: 10.0 }, ..CLAY };
        assert!(!smooth.yields(6000.0, 0.09) && smooth.yields(6000.0, 0.11));
        assert_eq!(smooth.greatest_viscosity(), 20.0 + 60_000.0);
    }

    #[test]
    fn parameters_that_make_no_sense_are_refused() {
        assert_eq!(CLAY.check(), Ok(()));
        for (clay, path) in [
            (StrainSoftening { consistency: -1.0, ..CLAY }, "consistency"),
            (StrainSoftening { exponent: 0.0, ..CLAY }, "exponent"),
            (StrainSoftening { peak_yield_stress: f64::NAN, ..CLAY }, "peak_yield_stress"),
            (StrainSoftening { sensitivity: 0.5, ..CLAY }, "sensitivity"),
            (StrainSoftening { sensitivity: f64::NAN, ..CLAY }, "sensitivity"),
            (StrainSoftening { strain_95: 0.0, ..CLAY }, "strain_95"),
            (StrainSoftening { max_viscosity: 0.0, ..CLAY }, "max_viscosity"),
            (StrainSoftening { regularisation: Regularisation::Papanastasiou { m: -1.0 }, ..CLAY }, "regularisation.m"),
        ] {
            assert_eq!(clay.check().err().map(|invalid| invalid.path).as_deref(), Some(path));
        }
    }
}
