//! Round numbers along an axis.

/// Round numbers from `least` to `greatest`, about `count` of them: multiples of 1, 2 or 5 times a power of ten.
pub(super) fn ticks(least: f64, greatest: f64, count: usize) -> Vec<f64> {
    let span = greatest - least;
    if !span.is_finite() || span <= 0.0 {
        return vec![least];
    }
    let rough = span / count.max(1) as f64;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|times| times * power).into_iter().find(|step| *step >= rough * 0.999);
    let step = step.unwrap_or(10.0 * power);
    let first = (least / step - 1e-9).ceil() as i64;
    let last = (greatest / step + 1e-9).floor() as i64;
    (first..=last).map(|k| k as f64 * step).collect()
}

/// Round numbers along a logarithmic axis, about `count` of them: powers of ten, or 1, 2 and 5 times these; within a decade as on any
/// axis.
pub(super) fn log_ticks(least: f64, greatest: f64, count: usize) -> Vec<f64> {
    if greatest < 10.0 * least {
        return ticks(least, greatest, count);
    }
    let powers = || (least.log10().floor() as i32..=greatest.log10().ceil() as i32).map(|power| 10_f64.powi(power));
    let with = |times: &[f64]| -> Vec<f64> {
        let all = powers().flat_map(|power| times.iter().map(move |times| times * power));
        all.filter(|value| (least * (1.0 - 1e-9)..=greatest * (1.0 + 1e-9)).contains(value)).collect()
    };
    let sparse = with(&[1.0]);
    if sparse.len() > count / 2 { sparse } else { with(&[1.0, 2.0, 5.0]) }
}

/// A tick's number, with as many digits as tell it from the others.
pub(super) fn tick_label(value: f64, all: &[f64]) -> String {
    let step = all.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(f64::INFINITY, f64::min);
    let greatest = all.iter().fold(0.0_f64, |greatest, value| greatest.max(value.abs()));
    if !step.is_finite() {
        return crate::number::short(value);
    }
    let digits = -(step * 1.001).log10().floor();
    if !(1e-3..1e6).contains(&greatest) || digits > 6.0 {
        let text = format!("{value:.1e}").replace(".0e", "e");
        return if value.abs() < 1e-6 * step { "0".to_owned() } else { text };
    }
    let decimals = digits.max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    // Not −0.
    if text.trim_start_matches('-').chars().all(|digit| matches!(digit, '0' | '.')) {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_lie_between_the_ends() {
        assert_eq!(ticks(0.0, 1.0, 5), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(ticks(-3.0, 17.0, 4), [0.0, 5.0, 10.0, 15.0]);
        assert_eq!(ticks(2.0, 2.0, 4), [2.0]);
    }

    #[test]
    fn logarithmic_ticks_are_powers_and_what_lies_between_if_there_are_few() {
        assert_eq!(log_ticks(0.001, 0.02, 6), [0.001, 0.002, 0.005, 0.01, 0.02]);
        assert_eq!(log_ticks(1e-3, 1e4, 6).len(), 8);
        assert_eq!(log_ticks(2.0, 8.0, 3), [2.0, 4.0, 6.0, 8.0]);
    }

    #[test]
    fn labels_have_the_digits_they_need() {
        let all = [-0.05, 0.0, 0.05];
        assert_eq!(all.map(|value| tick_label(value, &all)), ["-0.05", "0.00", "0.05"]);
        let all = [0.0, 5000.0, 10000.0];
        assert_eq!(all.map(|value| tick_label(value, &all)), ["0", "5000", "10000"]);
        let all = [0.0, 2e6];
        assert_eq!(all.map(|value| tick_label(value, &all)), ["0", "2e6"]);
    }
}
