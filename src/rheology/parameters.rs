//! Checks that the parameters of rheologies share.

use super::Regularisation;
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

/// Refuses a parameter `(name, value)` without unit that is greater than `most`, for this `reason`.
///
/// # Errors
/// The parameter, with its value.
pub(super) fn check_at_most((name, value): (&str, f64), most: f64, reason: &str) -> Result<(), Invalid> {
    if value > most {
        return Err(Invalid::new(name, format!("must not be greater than {most} ({reason}), got {value}")));
    }
    Ok(())
}

/// Checks a fluid whose viscosity falls from the cap μ_max (Pa s), because of a yield stress τ_y (Pa), to `lowest`
/// (name, Pa s).
///
/// # Errors
/// The first parameter that makes no sense.
pub(super) fn check_plastic(
    lowest: (&str, f64),
    yield_stress: f64,
    max_viscosity: f64,
    regularisation: Regularisation,
) -> Result<(), Invalid> {
    check_bounds(&[
        (lowest.0, lowest.1, Bound::NotNegative, "Pa s"),
        ("yield_stress", yield_stress, Bound::NotNegative, "Pa"),
        ("max_viscosity", max_viscosity, Bound::Positive, "Pa s"),
    ])?;
    check_order(lowest, ("max_viscosity", max_viscosity), "Pa s")?;
    regularisation.check()
}
