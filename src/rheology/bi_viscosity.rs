//! Bi-viscosity (after O'Donovan & Tanner 1984, J. Non-Newton. Fluid Mech. 15, 75–83): two Newtonian fluids in one, very
//! viscous below the yield stress and less so above it.
//!
//! `τ = μ_u γ̇` up to the yield stress, which it reaches at `γ̇_y = τ_y/μ_u`;  `τ = τ_y + μ_p (γ̇ − γ̇_y)` beyond. So
//! `μ = μ_u` and `μ = μ_p + (μ_u − μ_p) γ̇_y/γ̇`: finite everywhere, and τ_y is the stress at the kink itself. (A
//! [`Bingham`](super::Bingham) fluid that is capped has its kink above τ_y, where the cap meets the line.)

use bevy_ecs::prelude::Component;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Bound, FlowCurve, Rheology, check_bounds, check_order};
use crate::scene::Invalid;

/// `μ = μ_u` below the yield stress, `μ = μ_p + (μ_u − μ_p) γ̇_y/γ̇` above, `γ̇_y = τ_y/μ_u`.
#[derive(Component, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BiViscosity {
    /// Viscosity μ_u (Pa s) of the unyielded fluid; it enters the time step (Eq. 19).
    #[schemars(extend("unit" = "Pa s", "exclusiveMinimum" = 0.0))]
    pub unyielded_viscosity: f64,
    /// Plastic viscosity μ_p (Pa s): the slope of the flow curve above the yield stress.
    #[schemars(range(min = 0.0), extend("unit" = "Pa s"))]
    pub plastic_viscosity: f64,
    /// Yield stress τ_y (Pa).
    #[schemars(range(min = 0.0), extend("unit" = "Pa"))]
    pub yield_stress: f64,
}

impl Rheology for BiViscosity {
    fn check(&self) -> Result<(), Invalid> {
        check_bounds(&[
            ("unyielded_viscosity", self.unyielded_viscosity, Bound::Positive, "Pa s"),
            ("plastic_viscosity", self.plastic_viscosity, Bound::NotNegative, "Pa s"),
            ("yield_stress", self.yield_stress, Bound::NotNegative, "Pa"),
        ])?;
        let plastic = ("plastic_viscosity", self.plastic_viscosity);
        check_order(plastic, ("unyielded_viscosity", self.unyielded_viscosity), "Pa s")
    }

    /// μ_u; μ_p of a fluid without yield stress.
    fn greatest_viscosity(&self) -> f64 {
        if self.yield_stress == 0.0 { self.plastic_viscosity } else { self.unyielded_viscosity }
    }
}

impl FlowCurve for BiViscosity {
    #[inline]
    fn viscosity(&self, shear_rate: f64, _: f64) -> f64 {
        let yield_rate = self.yield_stress / self.unyielded_viscosity;
        if shear_rate < yield_rate {
            return self.unyielded_viscosity;
        }
        // 0/0 for a fluid without yield stress at rest.
        let share = if yield_rate == 0.0 { 0.0 } else { yield_rate / shear_rate };
        self.plastic_viscosity + (self.unyielded_viscosity - self.plastic_viscosity) * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rheology::test_support::{assert_greatest_viscosity, refused};

    const CLAY: BiViscosity = BiViscosity { unyielded_viscosity: 500.0, plastic_viscosity: 2.0, yield_stress: 10.0 };

    #[test]
    fn stress_is_two_lines_that_meet_at_the_yield_stress() {
        // The kink is at 0.02/s and 10 Pa.
        for (shear_rate, stress) in [(0.01, 5.0), (0.02, 10.0), (0.52, 11.0), (5.02, 20.0)] {
            assert!((CLAY.viscosity(shear_rate, 0.0) * shear_rate - stress).abs() < 1e-12, "γ̇ = {shear_rate}");
        }
        assert_eq!(CLAY.viscosity(0.0, 0.0), 500.0);
        assert_greatest_viscosity(&CLAY);
    }

    #[test]
    fn without_a_yield_stress_or_with_one_viscosity_it_is_newtonian() {
        let thin = BiViscosity { yield_stress: 0.0, ..CLAY };
        let thick = BiViscosity { plastic_viscosity: 500.0, ..CLAY };
        for shear_rate in [0.0, 1e-9, 1.0, 1e6] {
            assert_eq!(thin.viscosity(shear_rate, 0.0), 2.0);
            assert_eq!(thick.viscosity(shear_rate, 0.0), 500.0);
        }
        assert_greatest_viscosity(&thin);
    }

    #[test]
    fn parameters_that_make_no_sense_are_refused() {
        assert_eq!(CLAY.check(), Ok(()));
        for value in [-1.0, f64::NAN] {
            let clay = BiViscosity { plastic_viscosity: value, ..CLAY };
            assert_eq!(refused(&clay), "plastic_viscosity: must not be negative");
            assert_eq!(refused(&BiViscosity { yield_stress: value, ..CLAY }), "yield_stress: must not be negative");
        }
        for value in [-1.0, 0.0, f64::NAN] {
            let clay = BiViscosity { unyielded_viscosity: value, ..CLAY };
            assert_eq!(refused(&clay), "unyielded_viscosity: must be greater than 0");
        }
        let turned = BiViscosity { unyielded_viscosity: 1.0, ..CLAY };
        assert_eq!(refused(&turned), "plastic_viscosity: must not be greater than `unyielded_viscosity`");
    }
}
