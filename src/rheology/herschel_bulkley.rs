//! Herschel–Bulkley, Eq. 13.
//!
//! `μ = η γ̇^(K−1) + τ_y/γ̇`, singular at rest, and for K < 1 twice so. The yield term is [regularised](Regularisation)
//! by name, and capped either way: `μ ← min(μ, μ_max)`.

use bevy_ecs::prelude::Component;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::power_law::power_viscosity;
use super::{Bound, FlowCurve, Regularisation, Rheology, check_bounds};
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

impl Rheology for HerschelBulkley {
    fn check(&self) -> Result<(), Invalid> {
        check_bounds(&[
            ("consistency", self.consistency, Bound::NotNegative, "Pa s^K"),
            ("exponent", self.exponent, Bound::Positive, ""),
            ("yield_stress", self.yield_stress, Bound::NotNegative, "Pa"),
            ("max_viscosity", self.max_viscosity, Bound::Positive, "Pa s"),
        ])?;
        self.regularisation.check()
    }

    /// The cap, or what the curve of a fluid with K = 1 comes to at rest, where it is greatest: η + m τ_y, and η without a
    /// yield stress.
    fn greatest_viscosity(&self) -> f64 {
        if self.exponent == 1.0 { self.viscosity(0.0, 0.0) } else { self.max_viscosity }
    }
}

impl FlowCurve for HerschelBulkley {
    #[inline]
    fn viscosity(&self, shear_rate: f64, _: f64) -> f64 {
        let viscous = power_viscosity(self.consistency, self.exponent, shear_rate);
        let plastic = self.regularisation.yield_viscosity(self.yield_stress, shear_rate);
        (viscous + plastic).min(self.max_viscosity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rheology::test_support::{assert_greatest_viscosity, refused};

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
            assert_greatest_viscosity(&mud);
        }
        let plastic = HerschelBulkley { consistency: 0.0, yield_stress: 0.0, ..MUD };
        assert_eq!(plastic.viscosity(0.0, 0.0), 0.0);
    }

    #[test]
    fn parameters_that_make_no_sense_are_refused() {
        assert_eq!(MUD.check(), Ok(()));
        for value in [-1.0, f64::NAN] {
            let mud = HerschelBulkley { consistency: value, ..MUD };
            assert_eq!(refused(&mud), "consistency: must not be negative");
            assert_eq!(refused(&HerschelBulkley { yield_stress: value, ..MUD }), "yield_stress: must not be negative");
        }
        for value in [-1.0, 0.0, f64::NAN] {
            assert_eq!(refused(&HerschelBulkley { exponent: value, ..MUD }), "exponent: must be greater than 0");
            let mud = HerschelBulkley { max_viscosity: value, ..MUD };
            assert_eq!(refused(&mud), "max_viscosity: must be greater than 0");
        }
    }
}
