//! Herschel–Bulkley, Eq. 13.
//!
//! `μ = η γ̇^(K−1) + τ_y/γ̇`, singular at rest, and for K < 1 twice so. Regularised by name, and capped either way:
//!
//! - Papanastasiou (1987): `τ_y (1 − e^(−m γ̇))/γ̇`, → m τ_y at rest;
//! - capped: `μ ← min(μ, μ_max)`.

use bevy_ecs::prelude::Component;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FlowCurve, Rheology};
use crate::scene::Invalid;

/// `μ = η γ̇^(K−1) + τ_y/γ̇` (Eq. 13), regularised.
#[derive(Component, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HerschelBulkley {
    /// Consistency η (Pa s^K).
    #[schemars(range(min = 0.0), extend("unit" = "Pa s^K"))]
    pub consistency: f64,
    /// Power-law exponent K (dimensionless); below 1 the fluid thins, above 1 it thickens.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub exponent: f64,
    /// Yield stress τ_y (Pa).
    #[schemars(range(min = 0.0), extend("unit" = "Pa"))]
    pub yield_stress: f64,
    /// Cap μ_max (Pa s) of the viscosity; it enters the time step (Eq. 19).
    #[schemars(extend("unit" = "Pa s", "exclusiveMinimum" = 0.0))]
    pub max_viscosity: f64,
    /// How the yield stress is regularised at rest.
    #[serde(default)]
    pub regularisation: Regularisation,
}

/// How `τ_y/γ̇` is kept finite at rest.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Regularisation {
    /// By the cap μ_max alone (a bi-viscous fluid).
    #[default]
    Capped,
    /// `τ_y (1 − e^(−m γ̇))/γ̇`, and by the cap.
    Papanastasiou {
        /// Growth time m (s): the stress reaches τ_y at shear rates well above 1/m.
        #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0))]
        m: f64,
    },
}

impl HerschelBulkley {
    /// τ_y/γ̇, regularised but not capped.
    fn plastic_viscosity(&self, shear_rate: f64) -> f64 {
        match self.regularisation {
            // 0/0 for a fluid without yield stress at rest.
            Regularisation::Capped if self.yield_stress == 0.0 => 0.0,
            Regularisation::Capped => self.yield_stress / shear_rate,
            Regularisation::Papanastasiou { m } if m * shear_rate < f64::EPSILON => m * self.yield_stress,
            Regularisation::Papanastasiou { m } => -self.yield_stress * (-m * shear_rate).exp_m1() / shear_rate,
        }
    }
}

impl Rheology for HerschelBulkley {
    fn check(&self) -> Result<(), Invalid> {
        let bounds = [
            ("consistency", self.consistency, self.consistency >= 0.0, "must not be negative", "Pa s^K"),
            ("exponent", self.exponent, self.exponent > 0.0, "must be greater than 0", ""),
            ("yield_stress", self.yield_stress, self.yield_stress >= 0.0, "must not be negative", "Pa"),
            ("max_viscosity", self.max_viscosity, self.max_viscosity > 0.0, "must be greater than 0", "Pa s"),
        ];
        if let Some((name, value, _, rule, unit)) = bounds.into_iter().find(|(_, _, holds, ..)| !holds) {
            return Err(Invalid::new(name, format!("{rule}, got {value} {unit}").trim_end().to_owned()));
        }
        match self.regularisation {
            Regularisation::Papanastasiou { m } if m <= 0.0 => {
                Err(Invalid::new("regularisation.m", format!("must be greater than 0, got {m} s")))
            }
            _ => Ok(()),
        }
    }

    /// The cap, or what the curve of a fluid with K = 1 comes to at rest, where it is greatest: η + m τ_y, and η without a
    /// yield stress.
    fn greatest_viscosity(&self) -> f64 {
        let at_rest = match self.regularisation {
            _ if self.exponent != 1.0 => self.max_viscosity,
            _ if self.yield_stress == 0.0 => self.consistency,
            Regularisation::Papanastasiou { m } => self.consistency + m * self.yield_stress,
            Regularisation::Capped => self.max_viscosity,
        };
        at_rest.min(self.max_viscosity)
    }
}

impl FlowCurve for HerschelBulkley {
    #[inline]
    fn viscosity(&self, shear_rate: f64, _: f64) -> f64 {
        // K = 1 and K = 2 are common and `powf` is slow.
        let viscous = match self.exponent - 1.0 {
            // 0 · ∞ for a plastic without consistency at rest.
            _ if self.consistency == 0.0 => 0.0,
            0.0 => self.consistency,
            1.0 => self.consistency * shear_rate,
            power => self.consistency * shear_rate.powf(power),
        };
        (viscous + self.plastic_viscosity(shear_rate)).min(self.max_viscosity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MUD: HerschelBulkley = HerschelBulkley {
        consistency: 3.0,
        exponent: 0.5,
        yield_stress: 20.0,
        max_viscosity: 1e4,
        regularisation: Regularisation::Capped,
    };

    #[test]
    fn stress_is_yield_stress_plus_power_law() {
        for exponent in [0.5, 1.0, 2.0, 1.3] {
            let mud = HerschelBulkley { exponent, ..MUD };
            for shear_rate in [0.1, 1.0, 7.0, 100.0] {
                let stress = mud.viscosity(shear_rate, 0.0) * shear_rate;
                let exact = 20.0 + 3.0 * f64::powf(shear_rate, exponent);
                assert!((stress - exact).abs() < 1e-12 * exact, "K = {exponent}, γ̇ = {shear_rate}: {stress} Pa");
            }
        }
    }

    #[test]
    fn viscosity_at_rest_is_finite() {
        for exponent in [0.5, 1.0, 2.0] {
            let capped = HerschelBulkley { exponent, ..MUD };
            assert_eq!(capped.viscosity(0.0, 0.0), 1e4);
            let smooth = HerschelBulkley { regularisation: Regularisation::Papanastasiou { m: 10.0 }, ..capped };
            let expected = if exponent < 1.0 {
                1e4
            } else if exponent == 1.0 {
                203.0
            } else {
                200.0
            };
            assert!((smooth.viscosity(0.0, 0.0) - expected).abs() < 1e-9);
        }
        let water = HerschelBulkley { yield_stress: 0.0, exponent: 1.0, ..MUD };
        assert_eq!(water.viscosity(0.0, 0.0), 3.0);
    }

    #[test]
    fn the_greatest_viscosity_is_that_of_the_curve() {
        let smooth = Regularisation::Papanastasiou { m: 10.0 };
        for (exponent, yield_stress, regularisation) in [
            (1.0, 20.0, Regularisation::Capped),
            (1.0, 20.0, smooth),
            (1.0, 0.0, Regularisation::Capped),
            (0.5, 20.0, smooth),
            (2.0, 20.0, smooth),
        ] {
            let mud = HerschelBulkley { exponent, yield_stress, regularisation, ..MUD };
            let sweep = (-300..=300).map(|k| mud.viscosity(10_f64.powi(k) * 0.999, 0.0));
            let found = sweep.fold(0.0, f64::max);
            let said = mud.greatest_viscosity();
            assert!(
                (found / said - 1.0).abs() < 1e-9,
                "K = {exponent}, τ_y = {yield_stress}: {found}, not {said} Pa s"
            );
        }
        let plastic = HerschelBulkley { consistency: 0.0, yield_stress: 0.0, ..MUD };
        assert_eq!(plastic.viscosity(0.0, 0.0), 0.0);
    }

    #[test]
    fn papanastasiou_joins_its_series_and_its_limit() {
        let mud = HerschelBulkley { exponent: 1.0, regularisation: Regularisation::Papanastasiou { m: 10.0 }, ..MUD };
        // (1 − e^(−x))/x = 1 − x/2 + x²/6 …
        let x = 1e-5;
        let series = 3.0 + 200.0 * (1.0 - x / 2.0 + x * x / 6.0);
        assert!((mud.viscosity(x / 10.0, 0.0) - series).abs() < 1e-9);
        let fast = mud.viscosity(50.0, 0.0) * 50.0;
        assert!((fast - (20.0 + 150.0)).abs() < 1e-9);
    }
}
