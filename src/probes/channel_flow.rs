//! The exact steady flow of a Herschel–Bulkley fluid in a plane channel.

/// Steady plane channel flow of a Herschel–Bulkley fluid, driven by a force f = ρ0 g per volume along the channel.
///
/// The stress at the distance s from the mid-plane is `τ = f s`. Below `s0 = τ_y/f` the fluid moves as a plug; beyond it
/// `η γ̇^K + τ_y = f s`, so that with u = 0 at the wall, s = b,
///
/// `u(s) = K/(K+1) (f/η)^(1/K) [(b − s0)^(1+1/K) − (s − s0)₊^(1+1/K)]`
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ChannelFlow {
    /// Half width b (m).
    pub half_width: f64,
    /// Driving force f (N/m³).
    pub force: f64,
    /// Consistency η (Pa s^K).
    pub consistency: f64,
    /// Exponent K (dimensionless).
    pub exponent: f64,
    /// Yield stress τ_y (Pa).
    pub yield_stress: f64,
}

impl ChannelFlow {
    /// Half width s0 (m) of the plug.
    #[must_use]
    pub fn plug(&self) -> f64 {
        self.yield_stress / self.force
    }

    /// Velocity u (m/s) at the distance `s` (m) from the mid-plane; 0 in the walls.
    #[must_use]
    pub fn velocity(&self, s: f64) -> f64 {
        let (b, k) = (self.half_width, self.exponent);
        let beyond_plug = |s: f64| (s - self.plug()).max(0.0).powf(1.0 + 1.0 / k);
        let scale = k / (k + 1.0) * (self.force / self.consistency).powf(1.0 / k);
        scale * (beyond_plug(b) - beyond_plug(s.abs().min(b)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rheology::{FlowCurve, HerschelBulkley, Regularisation};

    /// Shear rate (1/s) at which the flow curve carries the stress, by bisection.
    fn shear_rate(fluid: &HerschelBulkley, stress: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1e4);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if fluid.viscosity(middle, 0.0) * middle > stress {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }

    #[test]
    fn velocity_is_the_integral_of_the_flow_curve() {
        for exponent in [0.5, 1.0, 2.0] {
            let flow = ChannelFlow { half_width: 0.05, force: 1000.0, consistency: 2.0, exponent, yield_stress: 15.0 };
            let fluid = HerschelBulkley {
                consistency: 2.0,
                exponent,
                yield_stress: 15.0,
                max_viscosity: 1e9,
                regularisation: Regularisation::Capped,
            };
            for s in [0.0, 0.01, 0.02, 0.04] {
                let count = 4000;
                let step = (flow.half_width - s) / f64::from(count);
                let midpoint = |k: i32| s + (f64::from(k) + 0.5) * step;
                let integral: f64 = (0..count).map(|k| shear_rate(&fluid, flow.force * midpoint(k)) * step).sum();
                let exact = flow.velocity(s);
                assert!((integral / exact - 1.0).abs() < 1e-4, "K = {exponent}, s = {s}: {integral} {exact}");
            }
        }
    }

    #[test]
    fn without_yield_stress_a_newtonian_fluid_flows_in_a_parabola() {
        let flow = ChannelFlow { half_width: 0.1, force: 50.0, consistency: 0.2, exponent: 1.0, yield_stress: 0.0 };
        for s in [0.0_f64, -0.03, 0.07, 0.1, 0.2] {
            let parabola = f64::max(50.0 / 0.4 * (0.01 - s * s), 0.0);
            assert!((flow.velocity(s) - parabola).abs() < 1e-12);
        }
    }
}
