//! Wendland's C2 kernel.

use std::f64::consts::PI;

use schemars::JsonSchema;

use super::{Kernel, positive_part};

/// Wendland C2 (Wendland 1995; in SPH: Dehnen & Aly 2012), support 2h:
///
/// `w(q) = (1 − q/2)₊⁴ (1 + 2q)`, `W = α_d w(q) / h^d`, `α_2 = 7/(4π)`, `α_3 = 21/(16π)`.
///
/// In one dimension the kernel of this smoothness is another polynomial; scenes have two or three.
#[derive(Debug, Clone, Copy, Default, JsonSchema)]
pub struct WendlandC2;

impl Kernel for WendlandC2 {
    fn support(&self) -> f64 {
        2.0
    }

    fn normalisation(&self, dimension: usize) -> f64 {
        match dimension {
            2 => 7.0 / (4.0 * PI),
            _ => 21.0 / (16.0 * PI),
        }
    }

    #[inline(always)]
    fn w(&self, q: f64) -> f64 {
        let a = positive_part(1.0 - 0.5 * q);
        let a2 = a * a;
        a2 * a2 * (1.0 + 2.0 * q)
    }

    #[inline(always)]
    fn dw_dq(&self, q: f64) -> f64 {
        let a = positive_part(1.0 - 0.5 * q);
        -5.0 * q * (a * a * a)
    }
}
