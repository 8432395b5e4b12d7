//! The exact steady flow of layers of Herschel–Bulkley fluids between two plates, one of which moves.

/// Steady Couette flow of layers between two plates that differ in speed by ΔU.
///
/// The shear stress τ is the same everywhere. Layer k of thickness h_k is sheared at
/// `γ̇_k = ((τ − τ_y)₊/η)^(1/K)`, nothing if it is unyielded, and τ follows from `Σ_k h_k γ̇_k(τ) = |ΔU|`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CouetteFlow {
    /// The layers from the first plate to the second.
    pub layers: Vec<CouetteLayer>,
    /// Velocities (m/s) of the two plates.
    pub speeds: (f64, f64),
    /// Shear stress τ (Pa); set by [`CouetteFlow::new`].
    pub stress: f64,
}

/// One layer of a [`CouetteFlow`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CouetteLayer {
    /// Thickness h (m).
    pub thickness: f64,
    /// Consistency η (Pa s^K).
    pub consistency: f64,
    /// Exponent K (dimensionless).
    pub exponent: f64,
    /// Yield stress τ_y (Pa).
    pub yield_stress: f64,
}

impl CouetteLayer {
    /// γ̇ (1/s) under the shear stress τ (Pa).
    #[must_use]
    pub fn shear_rate(&self, stress: f64) -> f64 {
        ((stress - self.yield_stress).max(0.0) / self.consistency).powf(1.0 / self.exponent)
    }
}

impl CouetteFlow {
    /// The flow of `layers` between plates with these velocities (m/s).
    #[must_use]
    pub fn new(layers: Vec<CouetteLayer>, speeds: (f64, f64)) -> Self {
        let flow = Self { layers, speeds, stress: 0.0 };
        let difference = (speeds.1 - speeds.0).abs();
        // Bisection, from a stress that is too great.
        let (mut low, mut high) = (0.0, 1.0);
        while flow.speed_difference(high) < difference && high < f64::MAX / 2.0 {
            high *= 2.0;
        }
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if flow.speed_difference(middle) > difference { high = middle } else { low = middle }
        }
        Self { stress: 0.5 * (low + high), ..flow }
    }

    /// Σ_k h_k γ̇_k (m/s) under the shear stress τ (Pa).
    fn speed_difference(&self, stress: f64) -> f64 {
        self.layers.iter().map(|layer| layer.thickness * layer.shear_rate(stress)).sum()
    }

    /// Velocity (m/s) at the distance `s` (m) from the first plate.
    #[must_use]
    pub fn velocity(&self, s: f64) -> f64 {
        let sense = (self.speeds.1 - self.speeds.0).signum();
        let (mut velocity, mut left) = (self.speeds.0, s);
        for layer in &self.layers {
            velocity += sense * layer.shear_rate(self.stress) * left.clamp(0.0, layer.thickness);
            left -= layer.thickness;
        }
        velocity
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: CouetteLayer = CouetteLayer { thickness: 0.05, consistency: 0.1, exponent: 1.0, yield_stress: 0.0 };

    #[test]
    fn two_newtonian_layers_share_the_speed_as_their_fluidities() {
        let oil = CouetteLayer { thickness: 0.1, consistency: 0.4, ..WATER };
        let flow = CouetteFlow::new(vec![oil, WATER], (0.0, 3.0));
        // h/μ = 0.25 and 0.5 m/(Pa s).
        assert!((flow.stress - 4.0).abs() < 1e-12);
        for (s, velocity) in [(0.0, 0.0), (0.1, 1.0), (0.125, 2.0), (0.15, 3.0), (0.2, 3.0)] {
            assert!((flow.velocity(s) - velocity).abs() < 1e-12, "{s}");
        }
        let turned = CouetteFlow::new(vec![oil, WATER], (1.0, -2.0));
        assert!((turned.velocity(0.1) - 0.0).abs() < 1e-12 && (turned.stress - 4.0).abs() < 1e-12);
    }

    #[test]
    fn the_stress_is_that_of_every_layer_that_yields() {
        let mud = CouetteLayer { thickness: 0.05, consistency: 0.3, exponent: 0.5, yield_stress: 0.7 };
        let flow = CouetteFlow::new(vec![mud, WATER], (0.0, 2.0));
        let rate_of_mud = (flow.velocity(0.03) - flow.velocity(0.01)) / 0.02;
        let rate_of_water = (flow.velocity(0.09) - flow.velocity(0.07)) / 0.02;
        assert!((0.7 + 0.3 * rate_of_mud.sqrt() - flow.stress).abs() < 1e-9);
        assert!((0.1 * rate_of_water - flow.stress).abs() < 1e-9);
        assert!((flow.velocity(0.1) - 2.0).abs() < 1e-9 && rate_of_mud > 1.0);
    }

    #[test]
    fn a_layer_that_does_not_yield_stays_with_its_plate() {
        let clay = CouetteLayer { yield_stress: 10.0, ..WATER };
        let flow = CouetteFlow::new(vec![clay, WATER], (0.5, 2.5));
        assert!((flow.velocity(0.05) - 0.5).abs() < 1e-12);
        assert!((flow.stress - 0.1 * 2.0 / 0.05).abs() < 1e-12);
    }
}
