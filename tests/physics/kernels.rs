//! Kernels: ∫ W = 1, (dW/dr)/r is the derivative of W, and the support is where they say.

use std::f64::consts::PI;

use storegga::kernels::{CubicSpline, Kernel, KernelRegistry, QuinticSpline, SmoothingKernel, WendlandC2, WendlandC4};

const H: f64 = 0.37;

fn kernels(dimension: usize) -> Vec<(&'static str, SmoothingKernel)> {
    let mut registry = KernelRegistry::default();
    registry.register("QuinticSpline", QuinticSpline);
    registry.register("CubicSpline", CubicSpline);
    registry.register("WendlandC2", WendlandC2);
    registry.register("WendlandC4", WendlandC4);
    ["QuinticSpline", "CubicSpline", "WendlandC2", "WendlandC4"]
        .into_iter()
        .map(|name| (name, registry.scaled(name, H, dimension).expect("registered above")))
        .collect()
}

#[test]
fn integral_is_one() {
    for dimension in [2, 3] {
        for (name, kernel) in kernels(dimension) {
            // Midpoint rule in shells; the error falls with the square of the step.
            let (cells, radius) = (20_000, kernel.0.radius());
            let dr = radius / f64::from(cells);
            let integral: f64 = (0..cells)
                .map(|k| {
                    let r = (f64::from(k) + 0.5) * dr;
                    let shell = if dimension == 2 { 2.0 * PI * r } else { 4.0 * PI * r * r };
                    kernel.value(r) * shell * dr
                })
                .sum();
            assert!((integral - 1.0).abs() < 1e-7, "{name} in {dimension}D: {integral}");
        }
    }
}

/// The splines have one shape in every dimension; scenes have no use for the first.
#[test]
fn splines_have_a_normalisation_in_one_dimension_too() {
    for (name, kernel) in [("QuinticSpline", &QuinticSpline as &dyn Kernel), ("CubicSpline", &CubicSpline)] {
        let (cells, alpha) = (20_000, kernel.normalisation(1));
        let dq = kernel.support() / f64::from(cells);
        let integral: f64 = (0..cells).map(|k| 2.0 * alpha * kernel.w((f64::from(k) + 0.5) * dq) * dq).sum();
        assert!((integral - 1.0).abs() < 1e-7, "{name}: {integral}");
    }
}

#[test]
fn gradient_is_the_derivative() {
    for dimension in [2, 3] {
        for (name, kernel) in kernels(dimension) {
            for k in 1..60 {
                let r = f64::from(k) * kernel.0.radius() / 60.0;
                let dr = 1e-5 * H;
                let slope = (kernel.value(r + dr) - kernel.value(r - dr)) / (2.0 * dr);
                let mut gradient = [r * r];
                kernel.0.gradients(&mut gradient);
                let scale = kernel.value(0.0) / H;
                assert!((gradient[0] * r - slope).abs() < 1e-8 * scale, "{name} in {dimension}D at r = {r}");
            }
        }
    }
}

#[test]
fn nothing_beyond_the_support() {
    for (name, kernel) in kernels(2) {
        let r = 1.0001 * kernel.0.radius();
        let mut gradient = [r * r, 0.0];
        kernel.0.gradients(&mut gradient);
        assert_eq!((kernel.value(r), gradient[0]), (0.0, 0.0), "{name}");
        // Two particles in one place: (dW/dr)/r has its limit, which is finite, so that ∇W = r (dW/dr)/r has no
        // direction and there is no force. (Near 0 w'(q) is a small difference of large terms.)
        let near = 1e-3 * H;
        let mut limit = [near * near];
        kernel.0.gradients(&mut limit);
        assert!((gradient[1] / limit[0] - 1.0).abs() < 0.01, "{name}: {} at r = 0, limit {}", gradient[1], limit[0]);
    }
}
