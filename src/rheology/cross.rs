//! Cross (1965, J. Colloid Sci. 20, 417–437): a fluid whose bonds break with the shear rate, between two Newtonian ends.
//!
//! `μ = μ_∞ + (μ_0 − μ_∞)/(1 + (λ γ̇)^m)`. Finite everywhere, so nothing is regularised.

use bevy_ecs::prelude::Component;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::check_at_most;
use super::{Bound, FlowCurve, Rheology, check_bounds, check_order};
use crate::scene::Invalid;

/// `μ = μ_∞ + (μ_0 − μ_∞)/(1 + (λ γ̇)^m)`.
#[derive(Component, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cross {
    /// Viscosity μ_0 (Pa s) at rest, the greatest.
    #[schemars(extend("unit" = "Pa s", "exclusiveMinimum" = 0.0))]
    pub zero_shear_viscosity: f64,
    /// Viscosity μ_∞ (Pa s) at great shear rates.
    #[schemars(range(min = 0.0), extend("unit" = "Pa s"))]
    pub infinite_shear_viscosity: f64,
    /// Relaxation time λ (s): at the shear rate 1/λ half of the bonds are broken.
    #[schemars(range(min = 0.0), extend("unit" = "s"))]
    pub relaxation_time: f64,
    /// Exponent m (dimensionless), at most 1: between the two ends the stress grows as γ̇^(1−m).
    #[schemars(range(max = 1.0), extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub exponent: f64,
}

impl Rheology for Cross {
    fn check(&self) -> Result<(), Invalid> {
        check_bounds(&[
            ("zero_shear_viscosity", self.zero_shear_viscosity, Bound::Positive, "Pa s"),
            ("infinite_shear_viscosity", self.infinite_shear_viscosity, Bound::NotNegative, "Pa s"),
            ("relaxation_time", self.relaxation_time, Bound::NotNegative, "s"),
            ("exponent", self.exponent, Bound::Positive, ""),
        ])?;
        check_at_most(("exponent", self.exponent), 1.0, "the stress would fall with the shear rate")?;
        let infinite = ("infinite_shear_viscosity", self.infinite_shear_viscosity);
        check_order(infinite, ("zero_shear_viscosity", self.zero_shear_viscosity), "Pa s")
    }

    fn greatest_viscosity(&self) -> f64 {
        self.zero_shear_viscosity
    }
}

impl FlowCurve for Cross {
    #[inline]
    fn viscosity(&self, shear_rate: f64, _: f64) -> f64 {
        let (mu_0, mu_inf) = (self.zero_shear_viscosity, self.infinite_shear_viscosity);
        mu_inf + (mu_0 - mu_inf) / (1.0 + (self.relaxation_time * shear_rate).powf(self.exponent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rheology::test_support::{assert_greatest_viscosity, refused};

    const SLURRY: Cross =
        Cross { zero_shear_viscosity: 50.0, infinite_shear_viscosity: 2.0, relaxation_time: 0.1, exponent: 0.7 };

    #[test]
    fn both_ends_are_newtonian_and_half_way_half_of_the_bonds_are_broken() {
        assert_eq!(SLURRY.viscosity(0.0, 0.0), 50.0);
        assert!((SLURRY.viscosity(10.0, 0.0) - 26.0).abs() < 1e-12);
        assert!((SLURRY.viscosity(1e15, 0.0) - 2.0).abs() < 1e-8);
        assert_greatest_viscosity(&SLURRY);
    }

    #[test]
    fn between_them_the_stress_is_a_power_of_the_shear_rate() {
        let thin = Cross { infinite_shear_viscosity: 0.0, ..SLURRY };
        let stress = |shear_rate: f64| thin.viscosity(shear_rate, 0.0) * shear_rate;
        assert!(((stress(1e11) / stress(1e10)).log10() - 0.3).abs() < 1e-6);
    }

    #[test]
    fn parameters_that_make_no_sense_are_refused() {
        assert_eq!(SLURRY.check(), Ok(()));
        for value in [-1.0, 0.0, f64::NAN] {
            let slurry = Cross { zero_shear_viscosity: value, ..SLURRY };
            assert_eq!(refused(&slurry), "zero_shear_viscosity: must be greater than 0");
            assert_eq!(refused(&Cross { exponent: value, ..SLURRY }), "exponent: must be greater than 0");
        }
        for value in [-1.0, f64::NAN] {
            let slurry = Cross { infinite_shear_viscosity: value, ..SLURRY };
            assert_eq!(refused(&slurry), "infinite_shear_viscosity: must not be negative");
            assert_eq!(refused(&Cross { relaxation_time: value, ..SLURRY }), "relaxation_time: must not be negative");
        }
        let steep = Cross { exponent: 1.2, ..SLURRY };
        assert!(refused(&steep).starts_with("exponent: must not be greater than 1"));
        let turned = Cross { infinite_shear_viscosity: 60.0, ..SLURRY };
        assert_eq!(refused(&turned), "infinite_shear_viscosity: must not be greater than `zero_shear_viscosity`");
    }
}
