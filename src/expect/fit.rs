//! Laws fitted to a series: growth and damped oscillation.

use glam::{DMat3, DVec3};

use super::take::Sample;

/// Rate σ (1/s) of `y = y_0 e^(σt)`: the slope of the least-squares line through ln |y|; or why there is none.
pub(super) fn growth_rate(samples: &[Sample]) -> Result<f64, String> {
    let sign = samples.first().map_or(0.0, |(_, y)| y.signum());
    if samples.len() < 3 || samples.iter().any(|(_, y)| y * sign <= 0.0) {
        return Err("a growth rate needs three samples or more of one sign".to_owned());
    }
    let n = samples.len() as f64;
    let mean = |of: &dyn Fn(&Sample) -> f64| samples.iter().map(of).sum::<f64>() / n;
    let (t_mean, log_mean) = (mean(&|s| s.0), mean(&|s| s.1.abs().ln()));
    let covariance = mean(&|s| (s.0 - t_mean) * (s.1.abs().ln() - log_mean));
    Ok(covariance / mean(&|s| (s.0 - t_mean).powi(2)))
}

/// `y = y_0 + e^(−γt) (a cos ωt + b sin ωt)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Oscillation {
    /// ω (rad/s).
    pub(super) frequency: f64,
    /// γ (1/s); below 0 for one that grows.
    pub(super) decay: f64,
}

/// An oscillation must be seen for this many periods.
const LEAST_PERIODS: f64 = 1.0;

/// The residual must be below this fraction of the series' own departure from its mean.
const GREATEST_RESIDUAL: f64 = 0.5;

impl Oscillation {
    /// The oscillation that fits `samples` best in the least-squares sense, or why there is none.
    ///
    /// For a given ω and γ the other three are linear (variable projection, Golub & Pereyra 1973): ω is searched on a grid
    /// from one period up to a quarter of the samples, then both by a search with halving steps.
    pub(super) fn fit(samples: &[Sample]) -> Result<Self, String> {
        let n = samples.len();
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
            return Err("nothing was measured".to_owned());
        };
        let least = std::f64::consts::TAU / (last.0 - first.0);
        let from_start: Vec<Sample> = samples.iter().map(|(t, y)| (t - first.0, *y)).collect();
        let candidates = (0..n * 5).map(|k| least * (LEAST_PERIODS + 0.05 * k as f64));
        let residual = |fit: Self| fit.residual(&from_start);
        let best = candidates
            .map(|frequency| Self { frequency, decay: 0.0 })
            .min_by(|a, b| residual(*a).total_cmp(&residual(*b)))
            .ok_or("nothing was measured")?;
        let fit = best.refined(0.05 * least, residual);
        let mean = samples.iter().map(|s| s.1).sum::<f64>() / n as f64;
        let spread: f64 = samples.iter().map(|s| (s.1 - mean).powi(2)).sum();
        // NaN is not below anything either.
        if residual(fit) < GREATEST_RESIDUAL.powi(2) * spread {
            Ok(fit)
        } else {
            Err("no oscillation of at least one period stands out".to_owned())
        }
    }

    /// Walks downhill from here, first in steps of `step` (rad/s and 1/s), then in ever smaller ones.
    fn refined(self, mut step: f64, residual: impl Fn(Self) -> f64) -> Self {
        let (mut best, mut least) = (self, residual(self));
        while step > 1e-9 * self.frequency {
            let neighbours = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)]
                .map(|(d, e)| Self { frequency: best.frequency + d, decay: best.decay + e });
            match neighbours.into_iter().map(|fit| (fit, residual(fit))).find(|(_, found)| *found < least) {
                Some(better) => (best, least) = better,
                None => step *= 0.5,
            }
        }
        best
    }

    /// Sum of squares that remains with the best y_0, a and b.
    fn residual(self, samples: &[Sample]) -> f64 {
        let basis = |t: f64| {
            let (sin, cos) = (self.frequency * t).sin_cos();
            let envelope = (-self.decay * t).exp();
            DVec3::new(1.0, envelope * cos, envelope * sin)
        };
        let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for &(t, y) in samples {
            let b = basis(t);
            normal += DMat3::from_cols(b * b.x, b * b.y, b * b.z);
            right += b * y;
        }
        let coefficients = normal.inverse() * right;
        samples.iter().map(|&(t, y)| (y - basis(t).dot(coefficients)).powi(2)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(n: usize, dt: f64, y: impl Fn(f64) -> f64) -> Vec<Sample> {
        (0..n).map(|k| 0.3 + dt * k as f64).map(|t| (t, y(t))).collect()
    }

    #[test]
    fn an_exponential_has_its_rate() {
        let rate = growth_rate(&samples(20, 0.1, |t| -0.02 * (3.5 * t).exp()));
        assert!(rate.is_ok_and(|rate| (rate - 3.5).abs() < 1e-10));
        assert!(growth_rate(&samples(20, 0.1, |t| t - 1.0)).is_err());
    }

    #[test]
    fn a_damped_oscillation_has_its_frequency_and_decay() {
        for (periods, decay) in [(1.3, 0.0), (2.6, 0.4), (20.2, -0.05)] {
            let (n, dt) = (200, 0.02);
            let frequency = std::f64::consts::TAU * periods / (dt * (n - 1) as f64);
            let fit = Oscillation::fit(&samples(n, dt, |t| 0.7 + (-decay * t).exp() * (frequency * t + 0.5).cos()));
            let near = |fit: Oscillation| {
                (fit.frequency - frequency).abs() < 1e-5 * frequency && (fit.decay - decay).abs() < 1e-5 * frequency
            };
            assert!(fit.as_ref().is_ok_and(|fit| near(*fit)), "{fit:?} of {frequency} rad/s, {decay} 1/s");
        }
    }

    #[test]
    fn what_does_not_oscillate_is_refused() {
        assert!(Oscillation::fit(&samples(100, 0.1, |_| 2.0)).is_err());
        assert!(Oscillation::fit(&samples(100, 0.1, |t| f64::sin(1e6 * t * t))).is_err());
        assert!(Oscillation::fit(&[]).is_err());
    }
}
