//! How many particles a scene may have.

use glam::DVec3;

use super::{Invalid, Resolution};

/// More particles than this are a mistake in the scene rather than a case that a machine of today runs.
const MOST_PARTICLES: f64 = 5e7;

/// Refuses a box that would need too many particles, before any is made.
pub(crate) fn limit_particles((min, max): (DVec3, DVec3), resolution: &Resolution) -> Result<(), Invalid> {
    let cells = |spacing: f64| {
        let lengths = (max - min).to_array();
        lengths[..resolution.dimension].iter().map(|length| (length / spacing).ceil().max(1.0)).product::<f64>()
    };
    // NaN and infinity are too many as well.
    if cells(resolution.spacing) <= MOST_PARTICLES {
        return Ok(());
    }
    let mut fits = resolution.spacing.max(f64::MIN_POSITIVE);
    while cells(fits) > MOST_PARTICLES && fits.is_finite() {
        fits *= 2.0;
    }
    Err(Invalid::new(
        "",
        format!(
            "needs up to {:.1e} particles at a spacing of {} m, more than the {MOST_PARTICLES:.0e} that are allowed: a \
             spacing of {fits:.3e} m would do",
            cells(resolution.spacing),
            resolution.spacing,
        ),
    ))
}
