//! Bingham (1922): a solid up to its yield stress, a Newtonian fluid beyond it.
//!
//! `τ = τ_y + μ_p γ̇`,  `μ = μ_p + τ_y/γ̇`: Herschel–Bulkley (Eq. 13) with K = 1. The yield term is
//! [regularised](Regularisation) by name, and capped either way: `μ ← min(μ, μ_max)`.

use bevy_ecs::prelude::Component;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::check_plastic;
use super::{FlowCurve, Regularisation, Rheology};
use crate::scene::Invalid;

/// `μ = μ_p + τ_y/γ̇`, regularised.
#[derive(Component, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bingham {
    /// Plastic viscosity μ_p (Pa s): the slope of the flow curve.
    #[schemars(range(min = 0.0), extend("unit" = "Pa s"))]
    pub plastic_viscosity: f64,
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

impl Rheology for Bingham {
    fn check(&self) -> Result<(), Invalid> {
        let lowest = ("plastic_viscosity", self.plastic_viscosity);
        check_plastic(lowest, self.yield_stress, self.max_viscosity, self.regularisation)
    }

    /// The viscosity at rest.
    fn greatest_viscosity(&self) -> f64 {
        self.viscosity(0.0, 0.0)
    }
}

impl FlowCurve for Bingham {
    #[inline]
    fn viscosity(&self, shear_rate: f64, _: f64) -> f64 {
        let plastic = self.regularisation.yield_viscosity(self.yield_stress, shear_rate);
        (self.plastic_viscosity + plastic).min(self.max_viscosity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rheology::HerschelBulkley;
    use crate::rheology::test_support::{assert_greatest_viscosity, refused};

    const CLAY: Bingham = Bingham {
        plastic_viscosity: 3.0,
        yield_stress: 20.0,
        max_viscosity: 1e4,
        regularisation: Regularisation::Capped,
    };
    const SMOOTH: Bingham = Bingham { regularisation: Regularisation::Papanastasiou { m: 10.0 }, ..CLAY };

    #[test]
    fn stress_is_a_line_that_begins_at_the_yield_stress() {
        for (shear_rate, stress) in [(0.01, 20.03), (1.0, 23.0), (100.0, 320.0)] {
            assert!((CLAY.viscosity(shear_rate, 0.0) * shear_rate - stress).abs() < 1e-12 * stress);
        }
        assert!((SMOOTH.viscosity(7.0, 0.0) * 7.0 - 41.0).abs() < 1e-12);
    }

    #[test]
    fn it_is_herschel_bulkley_with_exponent_1() {
        for clay in [CLAY, SMOOTH, Bingham { yield_stress: 0.0, ..CLAY }] {
            let mud = HerschelBulkley {
                consistency: clay.plastic_viscosity,
                exponent: 1.0,
                yield_stress: clay.yield_stress,
                max_viscosity: clay.max_viscosity,
                regularisation: clay.regularisation,
            };
            for shear_rate in [0.0, 1e-9, 1e-4, 0.3, 50.0] {
                assert_eq!(clay.viscosity(shear_rate, 0.0), mud.viscosity(shear_rate, 0.0));
            }
            assert_eq!(clay.greatest_viscosity(), mud.greatest_viscosity());
            assert_greatest_viscosity(&clay);
        }
    }

    #[test]
    fn parameters_that_make_no_sense_are_refused() {
        assert_eq!((CLAY.check(), SMOOTH.check()), (Ok(()), Ok(())));
        for value in [-1.0, f64::NAN] {
            assert_eq!(refused(&Bingham { yield_stress: value, ..CLAY }), "yield_stress: must not be negative");
            let clay = Bingham { plastic_viscosity: value, ..CLAY };
            assert_eq!(refused(&clay), "plastic_viscosity: must not be negative");
        }
        for value in [-1.0, 0.0, f64::NAN] {
            assert_eq!(refused(&Bingham { max_viscosity: value, ..CLAY }), "max_viscosity: must be greater than 0");
            let clay = Bingham { regularisation: Regularisation::Papanastasiou { m: value }, ..CLAY };
            assert_eq!(refused(&clay), "regularisation.m: must be greater than 0");
        }
        let low = Bingham { max_viscosity: 2.0, ..CLAY };
        assert_eq!(refused(&low), "plastic_viscosity: must not be greater than `max_viscosity`");
    }
}
