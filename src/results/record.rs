//! Records of a force over time, as engineers judge them.

use biquad::{Biquad, Coefficients, DirectForm2Transposed, Hertz, Q_BUTTERWORTH_F64, Type};

/// A quantity over time, sampled at equal intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Time (s) of the first sample.
    pub start: f64,
    /// Interval (s) between samples.
    pub interval: f64,
    /// Samples.
    pub values: Vec<f64>,
}

impl Record {
    /// The broken line through `points` (time in s, value), which are in order, sampled as often as they are on average. Points without a
    /// number are left out.
    ///
    /// # Errors
    /// There are fewer than two points.
    pub fn of(points: &[(f64, f64)]) -> Result<Self, String> {
        let points: Vec<_> = points.iter().filter(|(_, value)| value.is_finite()).collect();
        let (Some((start, _)), Some((end, _))) = (points.first(), points.last()) else {
            return Err("there are no samples".to_owned());
        };
        let intervals = points.len() - 1;
        if intervals == 0 || end <= start {
            return Err("there is one sample only".to_owned());
        }
        let interval = (end - start) / intervals as f64;
        let mut after = 1;
        let values = (0..=intervals).map(|k| {
            let time = start + k as f64 * interval;
            while after < intervals && points[after].0 < time {
                after += 1;
            }
            let ((t0, y0), (t1, y1)) = (points[after - 1], points[after]);
            let share = if t1 > t0 { ((time - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { 1.0 };
            y0 + share * (y1 - y0)
        });
        Ok(Self { start: *start, interval, values: values.collect() })
    }

    /// Without what is faster than `cutoff` (Hz): a Butterworth filter of second order run forward and backward, so of fourth order in
    /// all and without lag, as the channel classes of SAE J211 ask for. At the cutoff half of an oscillation is left (−6 dB),
    /// `|H| = 1/(1 + (f/f_c)⁴)`. Beyond its ends the record goes on as its image turned about the end.
    ///
    /// # Errors
    /// The cutoff is not between 0 and half the rate of sampling.
    pub fn filtered(&self, cutoff: f64) -> Result<Self, String> {
        let rate = 1.0 / self.interval;
        let hertz = |frequency: f64| Hertz::from_hz(frequency).ok();
        let coefficients = hertz(rate).zip(hertz(cutoff).filter(|_| cutoff > 0.0)).and_then(|(rate, cutoff)| {
            Coefficients::<f64>::from_params(Type::LowPass, rate, cutoff, Q_BUTTERWORTH_F64).ok()
        });
        let Some(coefficients) = coefficients else {
            return Err(format!("the cutoff must lie between 0 and {} Hz, half the rate of sampling", rate / 2.0));
        };
        let n = self.values.len();
        let room = ((PERIODS * rate / cutoff).ceil() as usize).min(n - 1);
        let (first, last) = (self.values[0], self.values[n - 1]);
        let before = (1..=room).rev().map(|k| 2.0 * first - self.values[k]);
        let after = (1..=room).map(|k| 2.0 * last - self.values[n - 1 - k]);
        let mut values: Vec<f64> = before.chain(self.values.iter().copied()).chain(after).collect();
        for _ in 0..2 {
            pass(coefficients, &mut values);
            values.reverse();
        }
        Ok(Self { values: values[room..room + n].to_vec(), ..*self })
    }

    /// Time (s) of sample `k`.
    #[must_use]
    pub fn time(&self, k: usize) -> f64 {
        self.start + k as f64 * self.interval
    }

    /// Time (s) and value of the sample from `from` to `to` (s) that is farthest from 0; none if there is no sample.
    #[must_use]
    pub fn peak(&self, from: f64, to: f64) -> Option<(f64, f64)> {
        let samples = self.values.iter().enumerate().map(|(k, value)| (self.time(k), *value));
        // Times are sums: one that is meant by its decimals may be off by some of their last digits.
        let (from, to) = (from - SAME_TIME * self.interval, to + SAME_TIME * self.interval);
        samples.filter(|(time, _)| (from..=to).contains(time)).max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
    }

    /// `∫ y dt` from `from` to `to` (s), as far as the record reaches: the impulse of a force.
    #[must_use]
    pub fn integral(&self, from: f64, to: f64) -> f64 {
        let piece = |k: usize| {
            let (t0, t1) = (self.time(k), self.time(k + 1));
            let (a, b) = (from.max(t0), to.min(t1));
            let at = |t: f64| self.values[k] + (t - t0) / self.interval * (self.values[k + 1] - self.values[k]);
            if a < b { 0.5 * (at(a) + at(b)) * (b - a) } else { 0.0 }
        };
        (0..self.values.len() - 1).map(piece).sum()
    }

    /// Time (s) of the last sample.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.time(self.values.len() - 1)
    }

    /// Mean from `from` to `to` (s), as far as the record reaches.
    #[must_use]
    pub fn mean(&self, from: f64, to: f64) -> f64 {
        let (from, to) = (from.max(self.start), to.min(self.end()));
        self.integral(from, to) / (to - from)
    }
}

/// Times that differ by less than this, in intervals, are the same.
const SAME_TIME: f64 = 1e-6;

/// Periods of the cutoff by which the record is continued at its ends: what the filter remembers.
const PERIODS: f64 = 3.0;

/// Runs the filter over `values`, as if the first had been there for ever.
fn pass(coefficients: Coefficients<f64>, values: &mut [f64]) {
    let mut filter = DirectForm2Transposed::<f64>::new(coefficients);
    let start = values[0];
    for value in values {
        *value = start + filter.run(*value - start);
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn sampled(of: impl Fn(f64) -> f64) -> Record {
        let points: Vec<_> = (0..=4000).map(|k| 1.0 + k as f64 / 1000.0).map(|t| (t, of(t))).collect();
        Record::of(&points).expect("two points and more")
    }

    /// |H| of the filter at `frequency`, and how far its phase is off (of the part in quadrature), with a cutoff of 10 Hz.
    fn response(frequency: f64) -> (f64, f64) {
        let filtered = sampled(|t| (TAU * frequency * t).sin()).filtered(10.0).expect("below half the rate");
        let over = |wave: fn(f64) -> f64| {
            let products = (1000..3000).map(|k| filtered.values[k] * wave(TAU * frequency * filtered.time(k)));
            products.sum::<f64>() / 1000.0
        };
        (over(f64::sin), over(f64::cos))
    }

    #[test]
    fn the_filter_has_the_response_of_a_butterworth_filter_and_no_lag() {
        for frequency in [2.0, 5.0, 10.0, 20.0] {
            let (gain, quadrature) = response(frequency);
            let exact = 1.0 / (1.0 + (frequency / 10.0_f64).powi(4));
            // The bilinear transform bends frequencies by (π f/f_s)²/3.
            assert!(
                (gain - exact).abs() < 2e-3 && quadrature.abs() < 1e-6,
                "{frequency} Hz: {gain} {exact} {quadrature}"
            );
        }
    }

    #[test]
    fn a_ramp_passes_up_to_its_ends() {
        let ramp = sampled(|t| 3.0 + 2.0 * t);
        let filtered = ramp.filtered(5.0).expect("below half the rate");
        assert!(ramp.values.iter().zip(&filtered.values).all(|(a, b)| (a - b).abs() < 1e-6));
        assert!(ramp.filtered(500.1).is_err() && ramp.filtered(0.0).is_err() && ramp.filtered(f64::NAN).is_err());
    }

    #[test]
    fn integrals_and_means_are_those_of_the_broken_line() {
        let record = sampled(|t| t * t);
        // ∫ t² dt from 1.5005 to 3, and the broken line's error, h²/12 of the change of slope.
        let exact = (27.0 - 1.5005_f64.powi(3)) / 3.0;
        assert!((record.integral(1.5005, 3.0) - exact).abs() < 1e-6);
        assert!((record.mean(0.0, 9.0) - (125.0 - 1.0) / 12.0).abs() < 1e-6);
        assert_eq!(record.peak(0.0, 9.0), Some((5.0, 25.0)));
        let near_two = |(time, value): (f64, f64)| (time - 2.0).abs() < 1e-9 && (value - 4.0).abs() < 1e-6;
        assert!(record.peak(1.5, 2.0005).is_some_and(near_two));
        assert_eq!(record.peak(6.0, 7.0), None);
        // 0.001 is in no binary fraction.
        let decimals = Record { start: 0.0, interval: 0.001, values: vec![0.0; 1000] };
        assert!((1..1000).map(|k| f64::from(k) / 1000.0).all(|t| decimals.peak(t, t).is_some()));
    }

    #[test]
    fn samples_at_unequal_intervals_are_joined_linearly() {
        let record = Record::of(&[(0.0, 0.0), (1.0, f64::NAN), (1.0, 10.0), (4.0, 40.0)]).expect("three points");
        assert_eq!(record.values, [0.0, 20.0, 40.0]);
        assert!(Record::of(&[(1.0, 2.0)]).is_err() && Record::of(&[(1.0, f64::NAN), (2.0, 1.0)]).is_err());
    }
}
