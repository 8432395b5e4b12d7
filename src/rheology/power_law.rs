//! Power law (Ostwald 1925, de Waele 1923): a fluid without yield stress that thins or thickens with the shear rate.
//!
//! `τ = η γ̇^K`,  `μ = η γ̇^(K−1)`, which diverges at rest for K < 1 and at great shear rates for K > 1, and is capped:
//! `μ ← min(μ, μ_max)`.

use bevy_ecs::prelude::Component;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Bound, FlowCurve, Rheology, check_bounds};
use crate::scene::Invalid;

/// `μ = η γ̇^(K−1)`, capped.
#[derive(Component, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PowerLaw {
    /// Consistency η (Pa s^K).
    #[schemars(range(min = 0.0), extend("unit" = "Pa s^K"))]
    pub consistency: f64,
    /// Exponent K (dimensionless); below 1 the fluid thins, above 1 it thickens.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub exponent: f64,
    /// Cap μ_max (Pa s) of the viscosity; it enters the time step (Eq. 19).
    #[schemars(extend("unit" = "Pa s", "exclusiveMinimum" = 0.0))]
    pub max_viscosity: f64,
}

/// η γ̇^(K−1) (Pa s), not capped.
#[inline]
pub(super) fn power_viscosity(consistency: f64, exponent: f64, shear_rate: f64) -> f64 {
    // K = 1 and K = 2 are common and `powf` is slow.
    match exponent - 1.0 {
        // 0 · ∞ for a plastic without consistency at rest.
        _ if consistency == 0.0 => 0.0,
        0.0 => consistency,
        1.0 => consistency * shear_rate,
        power => consistency * shear_rate.powf(power),
    }
}

impl Rheology for PowerLaw {
    fn check(&self) -> Result<(), Invalid> {
        check_bounds(&[
            ("consistency", self.consistency, Bound::NotNegative, "Pa s^K"),
            ("exponent", self.exponent, Bound::Positive, ""),
            ("max_viscosity", self.max_viscosity, Bound::Positive, "Pa s"),
        ])
    }

    /// The cap, or η of a Newtonian fluid (K = 1).
    fn greatest_viscosity(&self) -> f64 {
        let bound = if self.exponent == 1.0 { self.consistency } else { self.max_viscosity };
        bound.min(self.max_viscosity)
    }
}

impl FlowCurve for PowerLaw {
    #[inline]
    fn viscosity(&self, shear_rate: f64, _: f64) -> f64 {
        power_viscosity(self.consistency, self.exponent, shear_rate).min(self.max_viscosity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rheology::test_support::{assert_greatest_viscosity, refused};

    const THIN: PowerLaw = PowerLaw { consistency: 3.0, exponent: 0.5, max_viscosity: 1e4 };

    #[test]
    fn stress_grows_with_a_power_of_the_shear_rate() {
        for exponent in [0.5, 1.0, 1.3, 2.0] {
            let fluid = PowerLaw { exponent, ..THIN };
            let ratio = fluid.viscosity(8.0, 0.0) * 8.0 / (fluid.viscosity(2.0, 0.0) * 2.0);
            assert!((ratio - 4.0_f64.powf(exponent)).abs() < 1e-12, "K = {exponent}: {ratio}");
            assert!((fluid.viscosity(1.0, 0.0) - 3.0).abs() < 1e-12);
            assert_greatest_viscosity(&fluid);
        }
    }

    #[test]
    fn viscosity_is_capped_at_rest_and_at_great_rates() {
        assert_eq!(THIN.viscosity(0.0, 0.0), 1e4);
        let thick = PowerLaw { exponent: 2.0, ..THIN };
        assert_eq!((thick.viscosity(0.0, 0.0), thick.viscosity(1e9, 0.0)), (0.0, 1e4));
        assert_eq!(PowerLaw { consistency: 0.0, ..THIN }.viscosity(0.0, 0.0), 0.0);
    }

    #[test]
    fn parameters_that_make_no_sense_are_refused() {
        assert_eq!(THIN.check(), Ok(()));
        for value in [-0.5, 0.0, f64::NAN] {
            assert_eq!(refused(&PowerLaw { exponent: value, ..THIN }), "exponent: must be greater than 0");
            assert_eq!(refused(&PowerLaw { max_viscosity: value, ..THIN }), "max_viscosity: must be greater than 0");
        }
        for value in [-0.5, f64::NAN] {
            assert_eq!(refused(&PowerLaw { consistency: value, ..THIN }), "consistency: must not be negative");
        }
    }
}
