//! Wendland's C4 kernel.

use std::f64::consts::PI;

use schemars::JsonSchema;

use super::{Kernel, positive_part};

/// Wendland C4 (Wendland 1995; in SPH: Dehnen & Aly 2012), support 2h:
///
/// `w(q) = (1 − q/2)₊⁶ (1 + 3q + 35/12 q²)`, `W = α_d w(q) / h^d`, `α_2 = 9/(4π)`, `α_3 = 495/(256π)`.
///
/// In one dimension the kernel of this smoothness is another polynomial; scenes have two or three.
#[derive(Debug, Clone, Copy, Default, JsonSchema)]
pub struct WendlandC4;

impl Kernel for WendlandC4 {
    fn support(&self) -> f64 {
        2.0
    }

    fn normalisation(&self, dimension: usize) -> f64 {
        match dimension {
            2 => 9.0 / (4.0 * PI),
            _ => 495.0 / (256.0 * PI),
        }
    }

    #[inline(always)]
    fn w(&self, q: f64) -> f64 {
        let a = positive_part(1.0 - 0.5 * q);
        let a3 = a * a * a;
        a3 * a3 * (1.0 + 3.0 * q + 35.0 / 12.0 * q * q)
    }

    #[inline(always)]
    fn dw_dq(&self, q: f64) -> f64 {
        let a = positive_part(1.0 - 0.5 * q);
        let a2 = a * a;
        -7.0 / 3.0 * q * (2.0 + 5.0 * q) * (a2 * a2 * a)
    }
}
