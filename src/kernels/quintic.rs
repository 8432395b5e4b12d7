//! The quintic spline, Eq. 4.

use std::f64::consts::PI;

use schemars::JsonSchema;

use super::{Kernel, positive_part};

/// Quintic spline (Eq. 4; Morris 1996), support 3h:
///
/// `w(q) = (3−q)₊⁵ − 6 (2−q)₊⁵ + 15 (1−q)₊⁵`, `W = α_d w(q) / h^d`,
/// `α_1 = 1/120`, `α_2 = 7/(478 π)`, `α_3 = 1/(120 π)`.
///
/// The constants are exact. (3/(359 π), found for d = 3 in some papers, is 0.28 % too large.)
#[derive(Debug, Clone, Copy, Default, JsonSchema)]
pub struct QuinticSpline;

impl Kernel for QuinticSpline {
    fn support(&self) -> f64 {
        3.0
    }

    fn normalisation(&self, dimension: usize) -> f64 {
        match dimension {
            1 => 1.0 / 120.0,
            2 => 7.0 / (478.0 * PI),
            _ => 1.0 / (120.0 * PI),
        }
    }

    #[inline(always)]
    fn w(&self, q: f64) -> f64 {
        let (a, b, c) = (positive_part(3.0 - q), positive_part(2.0 - q), positive_part(1.0 - q));
        let (a2, b2, c2) = (a * a, b * b, c * c);
        a2 * a2 * a - 6.0 * (b2 * b2 * b) + 15.0 * (c2 * c2 * c)
    }

    #[inline(always)]
    fn dw_dq(&self, q: f64) -> f64 {
        let (a, b, c) = (positive_part(3.0 - q), positive_part(2.0 - q), positive_part(1.0 - q));
        let (a2, b2, c2) = (a * a, b * b, c * c);
        -5.0 * (a2 * a2 - 6.0 * (b2 * b2) + 15.0 * (c2 * c2))
    }
}
