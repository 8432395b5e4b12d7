//! The arithmetic of pair terms.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use pulp::{Arch, Simd, WithSimd};

/// A real number, or several of them side by side, one for each particle that a loop works on at once.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
    + SubAssign
{
    /// How many numbers stand side by side: 1, 2 or 4.
    const LANES: usize;

    /// `self · factor + addend` with one rounding.
    #[must_use]
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// Adds `a · b` with one rounding.
    #[inline(always)]
    fn add_product(&mut self, a: Self, b: Self) {
        *self = a.mul_add(b, *self);
    }

    /// Subtracts `a · b` with one rounding.
    #[inline(always)]
    fn subtract_product(&mut self, a: Self, b: Self) {
        *self = (-a).mul_add(b, *self);
    }

    /// `value` in every lane.
    #[must_use]
    fn like(self, value: f64) -> Self;

    /// The first [`LANES`](Self::LANES) values of a slice.
    #[must_use]
    fn read(self, values: &[f64]) -> Self;

    /// Writes every lane to the start of a slice.
    fn write(self, out: &mut [f64]);
}

impl Real for f64 {
    const LANES: usize = 1;

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        f64::mul_add(self, factor, addend)
    }

    #[inline(always)]
    fn like(self, value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn read(self, values: &[f64]) -> Self {
        values[0]
    }

    #[inline(always)]
    fn write(self, out: &mut [f64]) {
        out[0] = self;
    }
}

/// Numbers side by side in one register of the instruction set `S`.
#[derive(Debug, Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(crate) fn zero(simd: S) -> Self {
        Self { simd, values: simd.splat_f64s(0.0) }
    }
}

impl<S: Simd> Real for Lanes<S> {
    const LANES: usize = S::F64_LANES;

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self { simd: self.simd, values: self.simd.mul_add_f64s(self.values, factor.values, addend.values) }
    }

    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Self { simd: self.simd, values: self.simd.splat_f64s(value) }
    }

    #[inline(always)]
    fn read(self, values: &[f64]) -> Self {
        Self { simd: self.simd, values: S::as_simd_f64s(values).0[0] }
    }

    #[inline(always)]
    fn write(self, out: &mut [f64]) {
        S::as_mut_simd_f64s(out).0[0] = self.values;
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $simd:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { simd: self.simd, values: self.simd.$simd(self.values, other.values) }
            }
        }

        impl<S: Simd> $trait<f64> for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(self.like(other))
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { simd: self.simd, values: self.simd.neg_f64s(self.values) }
    }
}

impl<S: Simd> AddAssign for Lanes<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Simd> SubAssign for Lanes<S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// Runs `work`, written for one particle at a time, with the processor's instructions: where it can add a product with one
/// rounding, [`Real::mul_add`] calls no function.
#[inline]
pub(crate) fn one_by_one(work: impl FnOnce()) {
    Arch::new().dispatch(work);
}

/// Runs `work` with the lanes that the processor has, four at most: more would put particles side by side that have fewer
/// neighbours in common.
pub(crate) fn vectorised<W: WithSimd>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = pulp::x86::V4::try_new() {
        return avx512.vectorize(
            #[inline(always)]
            || work.with_simd(*avx512),
        );
    }
    Arch::new().dispatch(work)
}
