//! Checks that the parameters of rheologies share.

use crate::scene::Invalid;

/// Which values of a parameter make sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    /// Greater than 0.
    Positive,
    /// 0 or greater.
    NotNegative,
}

/// Refuses the first of the parameters `(name, value, bound, unit)` that breaks its bound; NaN breaks either.
///
/// # Errors
/// That parameter, with its value and unit.
pub fn check_bounds(parameters: &[(&str, f64, Bound, &str)]) -> Result<(), Invalid> {
    for (name, value, bound, unit) in parameters {
        let (holds, rule) = match bound {
            Bound::Positive => (*value > 0.0, "must be greater than 0"),
            Bound::NotNegative => (*value >= 0.0, "must not be negative"),
        };
        if !holds {
            return Err(Invalid::new(*name, format!("{rule}, got {value} {unit}").trim_end().to_owned()));
        }
    }
    Ok(())
}

/// Refuses a parameter `lower` that is greater than `upper`; each is (name, value), in `unit`.
///
/// # Errors
/// The lower one, with both values.
pub fn check_order(lower: (&str, f64), upper: (&str, f64), unit: &str) -> Result<(), Invalid> {
    if lower.1 <= upper.1 {
        return Ok(());
    }
    let message = format!("must not be greater than `{}`, got {} and {} {unit}", upper.0, lower.1, upper.1);
    Err(Invalid::new(lower.0, message.trim_end().to_owned()))
}
