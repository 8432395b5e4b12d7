//! Velocities that a relaxation zone drives the fluid to.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use storegga::scene::Invalid;
use storegga::scene::geometry::{Axis, Point, axis_exists, coordinates};

/// A velocity that depends on the place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Profile {
    /// The same everywhere; `(0, 0)` makes the zone a sponge that absorbs waves.
    Uniform {
        /// Velocity (m/s).
        #[schemars(extend("unit" = "m/s"))]
        velocity: Point,
    },
    /// Developed flow of a Newtonian fluid between two plates: `v(s) = 6 U s (1 − s)`, s = 0…1 from wall to wall, 0 beyond.
    Parabolic {
        /// Mean velocity U (m/s); the greatest is 1.5 U.
        #[schemars(extend("unit" = "m/s"))]
        mean: Point,
        /// Axis across the channel.
        across: Axis,
        /// Coordinates (m) of the two walls on that axis.
        #[schemars(extend("unit" = "m"))]
        walls: (f64, f64),
    },
    /// Rows joined by straight lines; before the first and after the last the velocity is theirs.
    Table {
        /// Axis along which the velocity changes.
        across: Axis,
        /// Rows in the order of their places, at least one.
        rows: Vec<ProfileRow>,
    },
}

/// One row of a tabulated profile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProfileRow {
    /// Coordinate (m).
    #[schemars(extend("unit" = "m"))]
    pub at: f64,
    /// Velocity (m/s).
    #[schemars(extend("unit" = "m/s"))]
    pub velocity: Point,
}

/// Component of `x` along an axis.
fn component(axis: Axis, x: DVec3) -> f64 {
    match axis {
        Axis::X => x.x,
        Axis::Y => x.y,
        Axis::Z => x.z,
    }
}

impl Profile {
    /// Refuses profiles that make no sense in `dimension` 2 or 3.
    pub(crate) fn check(&self, dimension: usize) -> Result<(), Invalid> {
        match self {
            Self::Uniform { velocity } => coordinates(*velocity, dimension).map_err(|wrong| wrong.under("velocity")),
            Self::Parabolic { mean, across, walls: (from, to) } => {
                axis_exists(*across, dimension).map_err(|wrong| wrong.under("across"))?;
                coordinates(*mean, dimension).map_err(|wrong| wrong.under("mean"))?;
                if from >= to {
                    let message = format!("the first must lie below the second, got {from} and {to} m");
                    return Err(Invalid::new("walls", message));
                }
                Ok(())
            }
            Self::Table { across, rows } => {
                axis_exists(*across, dimension).map_err(|wrong| wrong.under("across"))?;
                if rows.is_empty() {
                    return Err(Invalid::new("rows", "a profile needs at least one row"));
                }
                for (k, row) in rows.iter().enumerate() {
                    coordinates(row.velocity, dimension)
                        .map_err(|wrong| wrong.under("velocity").under(&format!("rows.{k}")))?;
                }
                match rows.windows(2).position(|pair| pair[1].at <= pair[0].at) {
                    Some(k) => Err(Invalid::new(format!("rows.{}.at", k + 1), "places must increase from row to row")),
                    None => Ok(()),
                }
            }
        }
    }

    /// Velocity (m/s) at the place `x` (m).
    #[must_use]
    pub fn at(&self, x: DVec3) -> DVec3 {
        match self {
            Self::Uniform { velocity } => velocity.position(),
            Self::Parabolic { mean, across, walls: (from, to) } => {
                let s = ((component(*across, x) - from) / (to - from)).clamp(0.0, 1.0);
                6.0 * s * (1.0 - s) * mean.position()
            }
            Self::Table { across, rows } => {
                let at = component(*across, x);
                let k = rows.partition_point(|row| row.at <= at).clamp(1, rows.len().max(2) - 1);
                let (low, high) = (rows[k - 1], rows[k.min(rows.len() - 1)]);
                let s = if high.at > low.at { ((at - low.at) / (high.at - low.at)).clamp(0.0, 1.0) } else { 0.0 };
                low.velocity.position().lerp(high.velocity.position(), s)
            }
        }
    }

    /// Greatest speed (m/s) of the profile.
    #[must_use]
    pub fn greatest_speed(&self) -> f64 {
        match self {
            Self::Uniform { velocity } => velocity.position().length(),
            Self::Parabolic { mean, .. } => 1.5 * mean.position().length(),
            Self::Table { rows, .. } => rows.iter().map(|row| row.velocity.position().length()).fold(0.0, f64::max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(rows: &[(f64, f64)]) -> Profile {
        let row = |&(at, u): &(f64, f64)| ProfileRow { at, velocity: Point::plane(u, 0.0) };
        Profile::Table { across: Axis::Y, rows: rows.iter().map(row).collect() }
    }

    #[test]
    fn a_parabola_has_its_mean_and_sticks_to_the_walls() {
        let profile = Profile::Parabolic { mean: Point::plane(0.2, 0.0), across: Axis::Y, walls: (0.1, 0.5) };
        let u = |y: f64| profile.at(DVec3::new(7.0, y, 0.0)).x;
        assert_eq!((u(0.1), u(0.5), u(0.0), u(0.6)), (0.0, 0.0, 0.0, 0.0));
        assert!((u(0.3) - profile.greatest_speed()).abs() < 1e-15);
        let mean = (0..1000).map(|k| u(0.1 + 0.4 * (f64::from(k) + 0.5) / 1000.0)).sum::<f64>() / 1000.0;
        assert!((mean - 0.2).abs() < 1e-6, "{mean}");
    }

    #[test]
    fn a_table_is_a_broken_line() {
        let profile = rows(&[(0.0, 1.0), (1.0, 3.0), (3.0, 0.0)]);
        for (y, u) in [(-1.0, 1.0), (0.0, 1.0), (0.25, 1.5), (1.0, 3.0), (2.0, 1.5), (3.0, 0.0), (9.0, 0.0)] {
            assert!((profile.at(DVec3::new(0.0, y, 0.0)).x - u).abs() < 1e-15, "at {y}");
        }
        assert_eq!(rows(&[(2.0, 4.0)]).at(DVec3::ZERO).x, 4.0);
        assert_eq!(profile.greatest_speed(), 3.0);
    }

    #[test]
    fn what_is_no_profile_is_refused_in_its_place() {
        let place = |profile: Profile| profile.check(2).err().map(|wrong| wrong.path);
        assert_eq!(place(rows(&[(0.0, 1.0), (1.0, 3.0)])), None);
        assert_eq!(place(rows(&[])).as_deref(), Some("rows"));
        assert_eq!(place(rows(&[(0.0, 1.0), (1.0, 1.0), (1.0, 2.0)])).as_deref(), Some("rows.2.at"));
        let velocity = Point::space(1.0, 0.0, 0.0);
        assert_eq!(place(Profile::Uniform { velocity }).as_deref(), Some("velocity"));
        let mean = Point::plane(1.0, 0.0);
        let upside_down = Profile::Parabolic { mean, across: Axis::Y, walls: (1.0, 0.0) };
        assert_eq!(place(upside_down).as_deref(), Some("walls"));
        let out_of_plane = Profile::Parabolic { mean, across: Axis::Z, walls: (0.0, 1.0) };
        assert_eq!(place(out_of_plane).as_deref(), Some("across"));
    }
}
