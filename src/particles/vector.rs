//! Vectors of a pair loop: as many components as the scene has dimensions.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use glam::DVec3;

use crate::lanes::Real;

/// A vector with `D` components: positions, velocities and forces inside the pair loops.
///
/// Columns hold [`DVec3`] in both dimensions; a loop converts once when it gathers a particle, so that a 2D scene
/// pays for no third coordinate where it counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vector<const D: usize, R = f64>(pub [R; D]);

impl<const D: usize> Vector<D> {
    /// The null vector.
    pub const ZERO: Self = Self([0.0; D]);
}

impl<const D: usize, R: Real> Vector<D, R> {
    /// Scalar product a·b.
    #[inline(always)]
    #[must_use]
    pub fn dot(self, other: Self) -> R {
        let mut sum = self.0[0] * other.0[0];
        for k in 1..D {
            sum.add_product(self.0[k], other.0[k]);
        }
        sum
    }

    /// a·b + c.
    #[inline(always)]
    #[must_use]
    pub fn dot_plus(self, other: Self, mut addend: R) -> R {
        for k in 0..D {
            addend.add_product(self.0[k], other.0[k]);
        }
        addend
    }

    /// Adds the products whose sum is a·b, each to its own component.
    #[inline(always)]
    pub fn add_each_product(&mut self, a: Self, b: Self) {
        for k in 0..D {
            self.0[k].add_product(a.0[k], b.0[k]);
        }
    }

    /// The sum of the components.
    #[inline(always)]
    #[must_use]
    pub fn total(self) -> R {
        let mut sum = self.0[0];
        for k in 1..D {
            sum += self.0[k];
        }
        sum
    }

    /// Subtracts `other · factor`.
    #[inline(always)]
    pub fn subtract_product(&mut self, other: Self, factor: R) {
        for k in 0..D {
            self.0[k].subtract_product(other.0[k], factor);
        }
    }

    /// Adds `other · factor`.
    #[inline(always)]
    pub fn add_product(&mut self, other: Self, factor: R) {
        for k in 0..D {
            self.0[k].add_product(other.0[k], factor);
        }
    }
}

impl<const D: usize> From<DVec3> for Vector<D> {
    #[inline(always)]
    fn from(v: DVec3) -> Self {
        let components = v.to_array();
        Self(std::array::from_fn(
            #[inline(always)]
            |k| components[k],
        ))
    }
}

impl<const D: usize> From<Vector<D>> for DVec3 {
    #[inline(always)]
    fn from(v: Vector<D>) -> Self {
        let mut components = [0.0; 3];
        components[..D].copy_from_slice(&v.0);
        Self::from_array(components)
    }
}

impl<const D: usize, R: Real> Add for Vector<D, R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(
            #[inline(always)]
            |k| self.0[k] + other.0[k],
        ))
    }
}

impl<const D: usize, R: Real> AddAssign for Vector<D, R> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const D: usize, R: Real> Sub for Vector<D, R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(
            #[inline(always)]
            |k| self.0[k] - other.0[k],
        ))
    }
}

impl<const D: usize, R: Real> Mul<R> for Vector<D, R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        Self(std::array::from_fn(
            #[inline(always)]
            |k| self.0[k] * factor,
        ))
    }
}

impl<const D: usize, R: Real> Neg for Vector<D, R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(std::array::from_fn(
            #[inline(always)]
            |k| -self.0[k],
        ))
    }
}
