//! Outlines and reproducible random numbers for the tests of this part.

use super::Point;

/// A tank with a berm and a 45° slope, in metres; the corner of the berm is reflex.
pub(super) const SLOPE_TANK: [(f64, f64); 6] = [(0.0, 1.5), (1.0, 1.5), (2.5, 0.0), (4.0, 0.0), (4.0, 2.0), (0.0, 2.0)];

/// An L with one reflex corner, in metres.
pub(super) const L_SHAPE: [(f64, f64); 6] = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];

/// Corners as a shape stores them.
pub(super) fn corners(outline: &[(f64, f64)]) -> Vec<Point> {
    outline.iter().map(|&(x, y)| Point::plane(x, y)).collect()
}

/// A linear congruential generator (Knuth's MMIX constants): the same numbers on every machine.
pub(super) struct Dice(u64);

impl Dice {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Evenly distributed between `low` and `high`.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let unit = (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
        low + unit * (high - low)
    }
}
