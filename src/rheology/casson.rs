//! Casson (1959): suspensions whose particles stick together, such as fine mud, blood or paint.
//!
//! `√τ = √τ_y + √(μ_∞ γ̇)`,  `μ = (√μ_∞ + √(τ_y/γ̇))²`. The yield term τ_y/γ̇ below the root is
//! [regularised](Regularisation) by name as in the other models (some papers put Papanastasiou's exponential on its root
//! instead), and capped either way: `μ ← min(μ, μ_max)`.

use bevy_ecs::prelude::Component;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::check_plastic;
use super::{FlowCurve, Regularisation, Rheology};
use crate::scene::Invalid;

/// `μ = (√μ_∞ + √(τ_y/γ̇))²`, regularised.
#[derive(Component, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Casson {
    /// Viscosity μ_∞ (Pa s) at great shear rates.
    #[schemars(range(min = 0.0), extend("unit" = "Pa s"))]
    pub infinite_shear_viscosity: f64,
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

impl Rheology for Casson {
    fn check(&self) -> Result<(), Invalid> {
        let lowest = ("infinite_shear_viscosity", self.infinite_shear_viscosity);
        check_plastic(lowest, self.yield_stress, self.max_viscosity, self.regularisation)
    }

    /// The viscosity at rest.
    fn greatest_viscosity(&self) -> f64 {
        self.viscosity(0.0, 0.0)
    }
}

impl FlowCurve for Casson {
    #[inline]
    fn viscosity(&self, shear_rate: f64, _: f64) -> f64 {
        let plastic = self.regularisation.yield_viscosity(self.yield_stress, shear_rate);
        (self.infinite_shear_viscosity.sqrt() + plastic.sqrt()).powi(2).min(self.max_viscosity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rheology::test_support::{assert_greatest_viscosity, refused};

    const MUD: Casson = Casson {
        infinite_shear_viscosity: 4.0,
        yield_stress: 9.0,
        max_viscosity: 1e4,
        regularisation: Regularisation::Capped,
    };
    const SMOOTH: Casson = Casson { regularisation: Regularisation::Papanastasiou { m: 16.0 }, ..MUD };

    #[test]
    fn the_roots_of_the_stresses_add_up() {
        // √9 + √(4 γ̇) = 5, 7, 13 for γ̇ = 1, 4, 25.
        for (shear_rate, stress) in [(1.0, 25.0), (4.0, 49.0), (25.0, 169.0)] {
            for mud in [MUD, SMOOTH] {
                assert!((mud.viscosity(shear_rate, 0.0) * shear_rate - stress).abs() < 1e-4, "γ̇ = {shear_rate}");
            }
        }
    }

    #[test]
    fn without_a_yield_stress_it_is_newtonian() {
        for regularisation in [MUD.regularisation, SMOOTH.regularisation] {
            let fluid = Casson { yield_stress: 0.0, regularisation, ..MUD };
            for shear_rate in [0.0, 1e-9, 1.0, 1e6] {
                assert_eq!(fluid.viscosity(shear_rate, 0.0), 4.0);
            }
            assert_eq!(fluid.greatest_viscosity(), 4.0);
        }
    }

    #[test]
    fn viscosity_at_rest_is_finite_and_the_greatest() {
        assert_eq!(MUD.viscosity(0.0, 0.0), 1e4);
        // (√4 + √(16 · 9))²
        assert!((SMOOTH.viscosity(0.0, 0.0) - 196.0).abs() < 1e-9);
        assert_greatest_viscosity(&MUD);
        assert_greatest_viscosity(&SMOOTH);
    }

    #[test]
    fn parameters_that_make_no_sense_are_refused() {
        assert_eq!((MUD.check(), SMOOTH.check()), (Ok(()), Ok(())));
        for value in [-1.0, f64::NAN] {
            assert_eq!(refused(&Casson { yield_stress: value, ..MUD }), "yield_stress: must not be negative");
            let mud = Casson { infinite_shear_viscosity: value, ..MUD };
            assert_eq!(refused(&mud), "infinite_shear_viscosity: must not be negative");
        }
        for value in [-1.0, 0.0, f64::NAN] {
            assert_eq!(refused(&Casson { max_viscosity: value, ..MUD }), "max_viscosity: must be greater than 0");
            let mud = Casson { regularisation: Regularisation::Papanastasiou { m: value }, ..MUD };
            assert_eq!(refused(&mud), "regularisation.m: must be greater than 0");
        }
        let low = Casson { max_viscosity: 2.0, ..MUD };
        assert_eq!(refused(&low), "infinite_shear_viscosity: must not be greater than `max_viscosity`");
    }
}
