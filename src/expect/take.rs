//! One value of a series.

use std::borrow::Cow;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fit::{Oscillation, growth_rate};
use crate::scene::Invalid;

/// Which value of a series counts. Between its samples a series is taken as linear.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Take {
    /// The last sample.
    #[default]
    Last,
    /// The value at a time (s).
    #[schemars(extend("unit" = "s"))]
    At(f64),
    /// The mean over a time.
    Mean {
        /// Start (s).
        #[schemars(extend("unit" = "s"))]
        from: f64,
        /// End (s).
        #[schemars(extend("unit" = "s"))]
        to: f64,
    },
    /// The integral over a time: of a force, its impulse.
    Integral {
        /// Start (s).
        #[schemars(extend("unit" = "s"))]
        from: f64,
        /// End (s).
        #[schemars(extend("unit" = "s"))]
        to: f64,
    },
    /// The greatest sample.
    Max,
    /// The least sample.
    Min,
    /// The greatest value in a time.
    MaxIn {
        /// Start (s).
        #[schemars(extend("unit" = "s"))]
        from: f64,
        /// End (s).
        #[schemars(extend("unit" = "s"))]
        to: f64,
    },
    /// The value at one time less that at an earlier one.
    Change {
        /// Earlier time (s).
        #[schemars(extend("unit" = "s"))]
        from: f64,
        /// Later time (s).
        #[schemars(extend("unit" = "s"))]
        to: f64,
    },
    /// The time (s) at which the series first reaches a value, from whichever side it starts.
    #[schemars(extend("unit" = "that of the series"))]
    Reaches(f64),
    /// Frequency ω (rad/s) of the damped oscillation `y_0 + e^(−γt) (a cos ωt + b sin ωt)` that fits best in a time.
    Frequency {
        /// Start (s).
        #[schemars(extend("unit" = "s"))]
        from: f64,
        /// End (s).
        #[schemars(extend("unit" = "s"))]
        to: f64,
    },
    /// Decay rate γ (1/s) of that oscillation.
    Decay {
        /// Start (s).
        #[schemars(extend("unit" = "s"))]
        from: f64,
        /// End (s).
        #[schemars(extend("unit" = "s"))]
        to: f64,
    },
    /// Rate σ (1/s) of the exponential `y_0 e^(σt)` that fits best in a time: the slope of ln |y|.
    Growth {
        /// Start (s).
        #[schemars(extend("unit" = "s"))]
        from: f64,
        /// End (s).
        #[schemars(extend("unit" = "s"))]
        to: f64,
    },
}

/// A time and the value at it.
pub(super) type Sample = (f64, f64);

/// Times count as equal if they differ by less than this (s) per second.
const SAME_TIME: f64 = 1e-9;

impl Take {
    /// Refuses windows that end before they start.
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        match self.window() {
            Some((from, to)) if from >= to => {
                Err(Invalid::new("to", format!("must lie after `from`, got {from} and {to} s")))
            }
            _ => Ok(()),
        }
    }

    /// The time (s) in which it looks at the series, if it is not the whole run.
    fn window(&self) -> Option<(f64, f64)> {
        match *self {
            Self::Mean { from, to }
            | Self::Integral { from, to }
            | Self::MaxIn { from, to }
            | Self::Change { from, to }
            | Self::Frequency { from, to }
            | Self::Decay { from, to }
            | Self::Growth { from, to } => Some((from, to)),
            Self::Last | Self::At(_) | Self::Max | Self::Min | Self::Reaches(_) => None,
        }
    }

    /// Unit of the value, for a series in `unit`.
    pub(crate) fn unit<'a>(&self, unit: &'a str) -> Cow<'a, str> {
        match self {
            Self::Reaches(_) => "s".into(),
            Self::Frequency { .. } => "rad/s".into(),
            Self::Decay { .. } | Self::Growth { .. } => "1/s".into(),
            Self::Integral { .. } => format!("{unit} s").trim_start().to_owned().into(),
            _ => unit.into(),
        }
    }

    /// Refuses times at which a run from 0 to `end_time` (s) measures nothing.
    pub(crate) fn check_times(&self, end_time: f64) -> Result<(), Invalid> {
        if let Self::At(t) = *self {
            return in_run("", t, end_time);
        }
        self.window().map_or(Ok(()), |(from, to)| {
            in_run("from", from, end_time)?;
            in_run("to", to, end_time)
        })
    }

    /// The value, or why there is none.
    pub(crate) fn of(&self, samples: &[Sample]) -> Result<f64, String> {
        let values = || samples.iter().map(|(_, value)| *value);
        match *self {
            Self::Last => values().next_back().ok_or_else(|| "nothing was measured".to_owned()),
            Self::At(t) => at(samples, t),
            Self::Mean { from, to } => Ok(integral(&window(samples, from, to)?) / (to - from)),
            Self::Integral { from, to } => Ok(integral(&window(samples, from, to)?)),
            Self::Max => Ok(values().fold(f64::NAN, f64::max)),
            Self::Min => Ok(values().fold(f64::NAN, f64::min)),
            Self::MaxIn { from, to } => {
                Ok(window(samples, from, to)?.into_iter().map(|(_, value)| value).fold(f64::NAN, f64::max))
            }
            Self::Change { from, to } => Ok(at(samples, to)? - at(samples, from)?),
            Self::Reaches(value) => reaches(samples, value),
            Self::Frequency { from, to } => Oscillation::fit(&window(samples, from, to)?).map(|fit| fit.frequency),
            Self::Decay { from, to } => Oscillation::fit(&window(samples, from, to)?).map(|fit| fit.decay),
            Self::Growth { from, to } => growth_rate(&window(samples, from, to)?),
        }
    }
}

/// Refuses a time `t` (s), at `path`, that is not in a run from 0 to `end_time` (s).
pub(super) fn in_run(path: &str, t: f64, end_time: f64) -> Result<(), Invalid> {
    let slack = SAME_TIME * end_time.max(1.0);
    if (-slack..=end_time + slack).contains(&t) {
        return Ok(());
    }
    Err(Invalid::new(path, format!("{t} s lies outside the run, which goes from 0 to {end_time} s")))
}

/// The value at time `t` (s) by linear interpolation, or why there is none.
pub(super) fn at(samples: &[Sample], t: f64) -> Result<f64, String> {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return Err("nothing was measured".to_owned());
    };
    let slack = SAME_TIME * t.abs().max(1.0);
    if t < first.0 - slack || t > last.0 + slack {
        return Err(format!("it was measured from {} to {} s only, which leaves out {t} s", first.0, last.0));
    }
    let k = samples.partition_point(|(time, _)| *time <= t);
    let (Some(&(t0, v0)), Some(&(t1, v1))) = (k.checked_sub(1).and_then(|k| samples.get(k)), samples.get(k)) else {
        return Ok(if k == 0 { first.1 } else { last.1 });
    };
    Ok(if t == t0 { v0 } else { v0 + (v1 - v0) * (t - t0) / (t1 - t0) })
}

/// The time (s) at which the series first reaches `value`; samples that are no numbers are left out.
fn reaches(samples: &[Sample], value: f64) -> Result<f64, String> {
    let numbers: Vec<Sample> = samples.iter().copied().filter(|(_, y)| !y.is_nan()).collect();
    let (Some(first), Some(last)) = (numbers.first(), numbers.last()) else {
        return Err("nothing was measured".to_owned());
    };
    let rises = first.1 < value;
    let there = |y: f64| if rises { y >= value } else { y <= value };
    match numbers.windows(2).find(|pair| there(pair[1].1)) {
        _ if first.1 == value => Ok(first.0),
        Some(pair) => {
            let ((t0, y0), (t1, y1)) = (pair[0], pair[1]);
            Ok(t0 + (t1 - t0) * (value - y0) / (y1 - y0))
        }
        None => Err(format!("it did not reach {value} up to {} s", last.0)),
    }
}

/// The samples from `from` to `to` (s), both ends interpolated.
fn window(samples: &[Sample], from: f64, to: f64) -> Result<Vec<Sample>, String> {
    let (start, end) = (at(samples, from)?, at(samples, to)?);
    let inside = samples.iter().copied().filter(|(t, _)| from < *t && *t < to);
    Ok([(from, start)].into_iter().chain(inside).chain([(to, end)]).collect())
}

/// Integral over time of a series that is linear between its samples.
fn integral(samples: &[Sample]) -> f64 {
    samples.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// t² at uneven times.
    const SAMPLES: [Sample; 5] = [(0.0, 0.0), (1.0, 1.0), (1.5, 2.25), (3.0, 9.0), (4.0, 16.0)];

    fn take(take: Take) -> f64 {
        take.of(&SAMPLES).unwrap_or(f64::NAN)
    }

    #[test]
    fn values_are_those_of_the_broken_line() {
        assert_eq!(take(Take::Last), 16.0);
        assert_eq!(take(Take::At(1.0)), 1.0);
        assert_eq!(take(Take::At(2.0)), 2.25 + 6.75 / 3.0);
        assert_eq!((take(Take::Max), take(Take::Min)), (16.0, 0.0));
        assert_eq!(take(Take::MaxIn { from: 0.0, to: 3.5 }), 12.5);
        assert_eq!(take(Take::Change { from: 1.0, to: 4.0 }), 15.0);
        // Trapezia: (0.5 + 0.8125 + 8.4375 + 12.5)/4, and one piece of one of them.
        assert!((take(Take::Mean { from: 0.0, to: 4.0 }) - 22.25 / 4.0).abs() < 1e-12);
        assert!((take(Take::Mean { from: 3.25, to: 3.75 }) - 12.5).abs() < 1e-12);
        assert!((take(Take::Integral { from: 0.0, to: 4.0 }) - 22.25).abs() < 1e-12);
        assert!((take(Take::Integral { from: 3.25, to: 3.75 }) - 6.25).abs() < 1e-12);
        assert_eq!((&*Take::Integral { from: 0.0, to: 1.0 }.unit("N"), &*Take::Max.unit("N")), ("N s", "N"));
    }

    #[test]
    fn the_time_of_a_value_is_that_of_the_broken_line() {
        assert_eq!(take(Take::Reaches(1.625)), 1.25);
        assert_eq!(take(Take::Reaches(0.0)), 0.0);
        assert!(Take::Reaches(16.5).of(&SAMPLES).is_err_and(|why| why.contains("up to 4 s")));
        let falls = [(0.0, f64::NAN), (1.0, 3.0), (2.0, 1.0), (3.0, 5.0)];
        assert_eq!(Take::Reaches(2.0).of(&falls), Ok(1.5));
    }

    #[test]
    fn fitted_rates_are_those_of_the_window() {
        let samples: Vec<Sample> = (0..200)
            .map(|k| 0.05 * f64::from(k))
            .map(|t| (t, if t < 2.0 { 9.0 } else { (-0.1 * t).exp() * (4.0 * t).sin() }))
            .collect();
        let of = |take: Take| take.of(&samples).unwrap_or(f64::NAN);
        assert!((of(Take::Frequency { from: 2.0, to: 9.0 }) - 4.0).abs() < 1e-3);
        assert!((of(Take::Decay { from: 2.0, to: 9.0 }) - 0.1).abs() < 1e-3);
        assert!(of(Take::Growth { from: 0.0, to: 1.5 }).abs() < 1e-12);
        assert_eq!(&*Take::Growth { from: 0.0, to: 1.0 }.unit("m"), "1/s");
    }

    #[test]
    fn a_time_that_was_not_reached_has_no_value() {
        for take in [Take::At(4.1), Take::Mean { from: 3.0, to: 5.0 }, Take::Change { from: -1.0, to: 2.0 }] {
            assert!(take.of(&SAMPLES).is_err_and(|why| why.contains("from 0 to 4 s")), "{take:?}");
        }
        assert!(Take::Last.of(&[]).is_err());
    }

    #[test]
    fn times_must_lie_in_the_run() {
        let refused = |take: Take| take.check_times(0.3).err().map(|invalid| invalid.path);
        for take in [Take::Last, Take::At(0.0), Take::At(0.1 + 0.2), Take::Mean { from: 0.1, to: 0.3 }] {
            assert_eq!(refused(take), None, "{take:?}");
        }
        assert_eq!(refused(Take::At(-0.1)).as_deref(), Some(""));
        assert_eq!(refused(Take::MaxIn { from: -0.1, to: 0.2 }).as_deref(), Some("from"));
        assert_eq!(refused(Take::Change { from: 0.1, to: 0.301 }).as_deref(), Some("to"));
    }

    #[test]
    fn rounding_does_not_lose_the_last_sample() {
        assert_eq!(at(&[(0.0, 1.0), (0.3, 2.0)], 0.1 + 0.2), Ok(2.0));
    }

    #[test]
    fn samples_without_a_number_do_not_hide_the_extremes() {
        let samples = [(0.0, f64::NAN), (1.0, 3.0), (2.0, 1.0)];
        assert_eq!((Take::Max.of(&samples), Take::Min.of(&samples)), (Ok(3.0), Ok(1.0)));
    }
}
