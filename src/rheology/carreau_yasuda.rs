//! Carreau–Yasuda (Carreau 1972, Trans. Soc. Rheol. 16, 99–127; Yasuda, Armstrong & Cohen 1981, Rheol. Acta 20, 163–178):
//! a fluid that is Newtonian at rest and at great shear rates, and thins by a power law between.
//!
//! `μ = μ_∞ + (μ_0 − μ_∞) [1 + (λ γ̇)^a]^((n−1)/a)`; a = 2 is Carreau's model. Finite everywhere, so nothing is
//! regularised.

use bevy_ecs::prelude::Component;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::check_at_most;
use super::{Bound, FlowCurve, Rheology, check_bounds, check_order};
use crate::scene::Invalid;

/// `μ = μ_∞ + (μ_0 − μ_∞) [1 + (λ γ̇)^a]^((n−1)/a)`.
#[derive(Component, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CarreauYasuda {
    /// Viscosity μ_0 (Pa s) at rest, the greatest.
    #[schemars(extend("unit" = "Pa s", "exclusiveMinimum" = 0.0))]
    pub zero_shear_viscosity: f64,
    /// Viscosity μ_∞ (Pa s) at great shear rates.
    #[schemars(range(min = 0.0), extend("unit" = "Pa s"))]
    pub infinite_shear_viscosity: f64,
    /// Relaxation time λ (s): the fluid thins at shear rates above 1/λ.
    #[schemars(range(min = 0.0), extend("unit" = "s"))]
    pub relaxation_time: f64,
    /// Exponent n (dimensionless) of the thinning, at most 1: between the two ends the stress grows as γ̇^n.
    #[schemars(range(max = 1.0), extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub exponent: f64,
    /// Yasuda's exponent a (dimensionless): how sharply the thinning sets in.
    #[serde(default = "carreau")]
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub transition: f64,
}

/// Carreau's a.
fn carreau() -> f64 {
    2.0
}

impl Rheology for CarreauYasuda {
    fn check(&self) -> Result<(), Invalid> {
        check_bounds(&[
            ("zero_shear_viscosity", self.zero_shear_viscosity, Bound::Positive, "Pa s"),
            ("infinite_shear_viscosity", self.infinite_shear_viscosity, Bound::NotNegative, "Pa s"),
            ("relaxation_time", self.relaxation_time, Bound::NotNegative, "s"),
            ("exponent", self.exponent, Bound::Positive, ""),
            ("transition", self.transition, Bound::Positive, ""),
        ])?;
        check_at_most(("exponent", self.exponent), 1.0, "the fluid thins")?;
        let infinite = ("infinite_shear_viscosity", self.infinite_shear_viscosity);
        check_order(infinite, ("zero_shear_viscosity", self.zero_shear_viscosity), "Pa s")
    }

    fn greatest_viscosity(&self) -> f64 {
        self.zero_shear_viscosity
    }
}

impl FlowCurve for CarreauYasuda {
    #[inline]
    fn viscosity(&self, shear_rate: f64, _: f64) -> f64 {
        let (mu_0, mu_inf) = (self.zero_shear_viscosity, self.infinite_shear_viscosity);
        let (a, n) = (self.transition, self.exponent);
        let thinning = (1.0 + (self.relaxation_time * shear_rate).powf(a)).powf((n - 1.0) / a);
        mu_inf + (mu_0 - mu_inf) * thinning
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rheology::test_support::{assert_greatest_viscosity, refused};

    const GEL: CarreauYasuda = CarreauYasuda {
        zero_shear_viscosity: 50.0,
        infinite_shear_viscosity: 0.5,
        relaxation_time: 2.0,
        exponent: 0.4,
        transition: 2.0,
    };

    #[test]
    fn both_ends_are_newtonian() {
        assert_eq!(GEL.viscosity(0.0, 0.0), 50.0);
        assert!((GEL.viscosity(1e-6, 0.0) / 50.0 - 1.0).abs() < 1e-9);
        assert!((GEL.viscosity(1e15, 0.0) / 0.5 - 1.0).abs() < 1e-6);
        assert_greatest_viscosity(&GEL);
    }

    #[test]
    fn between_them_the_stress_is_a_power_of_the_shear_rate() {
        for transition in [0.8, 2.0] {
            let gel = CarreauYasuda { infinite_shear_viscosity: 0.0, transition, ..GEL };
            let stress = |shear_rate: f64| gel.viscosity(shear_rate, 0.0) * shear_rate;
            assert!(((stress(1e9) / stress(1e8)).log10() - 0.4).abs() < 1e-6, "a = {transition}");
            // Half of the thinning that the power law would have: 2^((n − 1)/a) at λ γ̇ = 1.
            assert!((gel.viscosity(0.5, 0.0) - 50.0 * 2_f64.powf(-0.6 / transition)).abs() < 1e-12);
        }
    }

    #[test]
    fn with_exponent_1_or_no_relaxation_it_is_newtonian() {
        let models = [CarreauYasuda { exponent: 1.0, ..GEL }, CarreauYasuda { relaxation_time: 0.0, ..GEL }];
        for (model, shear_rate) in models.into_iter().zip([3.0, 1e6]) {
            assert!((model.viscosity(shear_rate, 0.0) - 50.0).abs() < 1e-12);
        }
    }

    #[test]
    fn parameters_that_make_no_sense_are_refused() {
        assert_eq!(GEL.check(), Ok(()));
        for value in [-1.0, 0.0, f64::NAN] {
            let gel = CarreauYasuda { zero_shear_viscosity: value, ..GEL };
            assert_eq!(refused(&gel), "zero_shear_viscosity: must be greater than 0");
            assert_eq!(refused(&CarreauYasuda { exponent: value, ..GEL }), "exponent: must be greater than 0");
            assert_eq!(refused(&CarreauYasuda { transition: value, ..GEL }), "transition: must be greater than 0");
        }
        for value in [-1.0, f64::NAN] {
            let gel = CarreauYasuda { infinite_shear_viscosity: value, ..GEL };
            assert_eq!(refused(&gel), "infinite_shear_viscosity: must not be negative");
            let gel = CarreauYasuda { relaxation_time: value, ..GEL };
            assert_eq!(refused(&gel), "relaxation_time: must not be negative");
        }
        let thick = CarreauYasuda { exponent: 1.5, ..GEL };
        assert_eq!(refused(&thick), "exponent: must not be greater than 1 (the fluid thins)");
        let turned = CarreauYasuda { infinite_shear_viscosity: 60.0, ..GEL };
        assert_eq!(refused(&turned), "infinite_shear_viscosity: must not be greater than `zero_shear_viscosity`");
    }
}
