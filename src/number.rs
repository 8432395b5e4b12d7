//! Numbers for people.

/// A number with all its digits, in the notation that does not take hundreds of them.
pub(crate) fn plain(value: f64) -> String {
    let is_short = value == 0.0 || !value.is_finite() || (1e-5..1e16).contains(&value.abs());
    if is_short { value.to_string() } else { format!("{value:e}") }
}

/// A number with four significant digits, in the notation that is easier to read.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        return "0".to_owned(); // -0, too
    }
    if !value.is_finite() {
        return value.to_string();
    }
    if !(1e-3..1e6).contains(&size) {
        return trimmed(&format!("{value:.3e}"));
    }
    let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
    trimmed(&format!("{value:.decimals$}"))
}

/// The number without zeros at the end of its fraction.
fn trimmed(text: &str) -> String {
    let (digits, exponent) = text.split_once('e').map_or((text, ""), |(digits, _)| (digits, &text[digits.len()..]));
    let digits = if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits };
    format!("{digits}{exponent}")
}

/// A count with thin groups of three digits: `12 345`.
pub(crate) fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut grouped = String::with_capacity(digits.len() + digits.len() / 3);
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    grouped
}

/// A duration (s): `8.5 s`, `4 min 05 s`, `3 h 20 min`.
pub(crate) fn duration(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "unknown".to_owned();
    }
    let whole = seconds.max(0.0).round() as u64;
    match whole {
        0..10 => format!("{seconds:.1} s"),
        10..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        3600..172_800 => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
        _ => format!("{} days", whole / 86_400),
    }
}

/// A number of bytes: `12.3 MB`.
pub(crate) fn bytes(bytes: f64) -> String {
    let (scaled, unit) = [(1e9, "GB"), (1e6, "MB"), (1e3, "kB")]
        .into_iter()
        .find(|(size, _)| bytes >= *size)
        .map_or((bytes, "B"), |(size, unit)| (bytes / size, unit));
    format!("{} {unit}", short((scaled * 10.0).round() / 10.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_numbers_keep_their_digits_and_stay_short() {
        for (value, text) in [(0.0, "0"), (0.1, "0.1"), (-1500.0, "-1500"), (1e300, "1e300"), (-2.5e-300, "-2.5e-300")]
        {
            assert_eq!(plain(value), text);
        }
    }

    #[test]
    fn numbers_keep_four_digits() {
        for (value, shown) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.5, "1.5"),
            (0.004, "0.004"),
            (12_345.678, "12346"),
            (0.000_123_456, "1.235e-4"),
            (-9.81, "-9.81"),
            (1e7, "1e7"),
            (1000.0, "1000"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short(value), shown);
        }
    }

    #[test]
    fn counts_durations_and_sizes_read_well() {
        assert_eq!((count(0), count(999), count(1_234_567)), ("0".into(), "999".into(), "1 234 567".into()));
        assert_eq!((duration(8.46), duration(245.0)), ("8.5 s".into(), "4 min 05 s".into()));
        assert_eq!((duration(12_000.0), duration(1e6)), ("3 h 20 min".into(), "11 days".into()));
        assert_eq!((bytes(12_345_678.0), bytes(10.0)), ("12.3 MB".into(), "10 B".into()));
    }
}
