//! The cubic spline.

use std::f64::consts::PI;

use schemars::JsonSchema;

use super::{Kernel, positive_part};

/// Cubic spline M₄ (Schoenberg 1946; in SPH: Monaghan & Lattanzio 1985), support 2h:
///
/// `w(q) = ¼ (2−q)₊³ − (1−q)₊³`, `W = α_d w(q) / h^d`, `α_1 = 2/3`, `α_2 = 10/(7π)`, `α_3 = 1/π`.
///
/// Its slope is greatest at q = 2/3: particles nearer than that are pushed apart less the nearer they come, and tend to pair.
#[derive(Debug, Clone, Copy, Default, JsonSchema)]
pub struct CubicSpline;

impl Kernel for CubicSpline {
    fn support(&self) -> f64 {
        2.0
    }

    fn normalisation(&self, dimension: usize) -> f64 {
        match dimension {
            1 => 2.0 / 3.0,
            2 => 10.0 / (7.0 * PI),
            _ => 1.0 / PI,
        }
    }

    #[inline(always)]
    fn w(&self, q: f64) -> f64 {
        let (a, b) = (positive_part(2.0 - q), positive_part(1.0 - q));
        0.25 * (a * a * a) - b * b * b
    }

    #[inline(always)]
    fn dw_dq(&self, q: f64) -> f64 {
        let (a, b) = (positive_part(2.0 - q), positive_part(1.0 - q));
        -0.75 * (a * a) + 3.0 * (b * b)
    }
}
