//! Axes, and rigid rotation about them.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Point, coordinates};
use crate::scene::Invalid;

/// A rigid rotation, `v = ω e × (x − c)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigidRotation {
    /// A point c of the axis (m).
    #[schemars(extend("unit" = "m"))]
    pub center: Point,
    /// Direction of the axis e; in 2D always (0, 0, 1), out of the plane.
    #[serde(default)]
    #[schemars(extend("unit" = "1", "derived" = "out of the plane in 2D; required in 3D"))]
    pub axis: Option<Point>,
    /// Rate ω (rad/s), counter-clockwise about the axis.
    #[schemars(extend("unit" = "rad/s"))]
    pub rate: f64,
}

impl RigidRotation {
    /// Velocity (m/s) at the position `x` (m).
    #[must_use]
    pub fn velocity(&self, x: DVec3) -> DVec3 {
        self.rate * unit_axis(self.axis).cross(x - self.center.position())
    }

    /// Distance (m) of the position `x` (m) from the axis.
    #[must_use]
    pub fn radius(&self, x: DVec3) -> f64 {
        (x - self.center.position()).reject_from_normalized(unit_axis(self.axis)).length()
    }

    /// Refuses what makes no sense in `dimension` 2 or 3.
    pub(crate) fn check(&self, dimension: usize) -> Result<(), Invalid> {
        coordinates(self.center, dimension).map_err(|invalid| invalid.under("center"))?;
        check_axis(self.axis, dimension)
    }
}

/// Unit vector of an axis; without one it is out of the plane.
pub(crate) fn unit_axis(axis: Option<Point>) -> DVec3 {
    axis.map_or(DVec3::Z, |axis| axis.position().normalize())
}

/// Refuses an axis in 2D, a missing one in 3D, and one without a direction.
pub(crate) fn check_axis(axis: Option<Point>, dimension: usize) -> Result<(), Invalid> {
    match axis {
        Some(_) if dimension == 2 => Err(Invalid::new("axis", "in 2D the axis is (0, 0, 1): leave it out")),
        Some(axis) if axis.position().try_normalize().is_none() => {
            Err(Invalid::new("axis", "must be a vector of finite length greater than 0"))
        }
        None if dimension == 3 => Err(Invalid::new("", "a rotation in 3D needs an `axis`")),
        _ => Ok(()),
    }
}

/// The eight corners (m) of the box from `low` to `high` (m).
pub(crate) fn corners((low, high): (DVec3, DVec3)) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |k| DVec3::select(glam::BVec3::new(k & 1 != 0, k & 2 != 0, k & 4 != 0), high, low))
}
