//! The yield term `τ_y/γ̇`, which yield-stress fluids share, kept finite at rest.
//!
//! - Papanastasiou (1987, J. Rheol. 31, 385–404): `τ_y (1 − e^(−m γ̇))/γ̇`, → m τ_y at rest;
//! - capped: `τ_y/γ̇`, and the model's own cap `μ ← min(μ, μ_max)`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Bound, check_bounds};
use crate::scene::Invalid;

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

impl Regularisation {
    /// τ_y/γ̇ (Pa s) at shear rate γ̇ (1/s), regularised but not capped: infinite at rest if `Capped`.
    #[inline]
    #[must_use]
    pub fn yield_viscosity(self, yield_stress: f64, shear_rate: f64) -> f64 {
        match self {
            // 0/0 for a fluid without yield stress at rest.
            Self::Capped if yield_stress == 0.0 => 0.0,
            Self::Capped => yield_stress / shear_rate,
            Self::Papanastasiou { m } if m * shear_rate < f64::EPSILON => m * yield_stress,
            Self::Papanastasiou { m } => -yield_stress * (-m * shear_rate).exp_m1() / shear_rate,
        }
    }

    /// Refuses a growth time that is not positive.
    ///
    /// # Errors
    /// It, with a path below the model's field `regularisation`.
    pub fn check(self) -> Result<(), Invalid> {
        match self {
            Self::Capped => Ok(()),
            Self::Papanastasiou { m } => check_bounds(&[("regularisation.m", m, Bound::Positive, "s")]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn papanastasiou_joins_its_series_and_its_limit() {
        let smooth = Regularisation::Papanastasiou { m: 10.0 };
        // (1 − e^(−x))/x = 1 − x/2 + x²/6 …, here with τ_y m = 200 Pa s.
        for x in [0.0, 1e-17, 1e-15, 1e-5] {
            let series = 200.0 * (1.0 - x / 2.0 + x * x / 6.0);
            assert!((smooth.yield_viscosity(20.0, x / 10.0) - series).abs() < 1e-9, "m γ̇ = {x}");
        }
        assert!((smooth.yield_viscosity(20.0, 50.0) * 50.0 - 20.0).abs() < 1e-9);
    }

    #[test]
    fn without_a_yield_stress_there_is_no_yield_term() {
        for regularisation in [Regularisation::Capped, Regularisation::Papanastasiou { m: 10.0 }] {
            for shear_rate in [0.0, 1e-300, 1.0] {
                assert_eq!(regularisation.yield_viscosity(0.0, shear_rate), 0.0);
            }
        }
    }
}
