//! Prescribed motion of walls and structures.
//!
//! A point that was at x0 is at `x = c + R(θ) (x0 − c) + d`, with velocity `v_w = θ' e × (x − c − d) + d'` and
//! acceleration `a_w = θ'' e × (x − c − d) + θ'² e × (e × (x − c − d)) + d''`; d(t) is the displacement, θ(t) the angle
//! about the axis e through c.

use bevy_ecs::prelude::*;
use bevy_ecs::query::ArchetypeFilter;
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Body;
use crate::clock::Clock;
use crate::particles::{
    BodyIndex, GRAIN, PIECE, Position, RestPosition, Solid, Wall, WallAcceleration, WallAngularVelocity, WallVelocity,
};
use crate::scene::Invalid;
use crate::scene::geometry::{Point, check_axis, coordinates, corners, unit_axis};

/// How a body moves.
#[derive(Component, Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Motion {
    /// Not at all.
    #[default]
    Still,
    /// With a constant velocity between two times.
    Translation {
        /// Velocity (m/s).
        #[schemars(extend("unit" = "m/s"))]
        velocity: Point,
        /// Start (s).
        #[serde(default)]
        #[schemars(range(min = 0.0), extend("unit" = "s"))]
        from: f64,
        /// End (s); `None` for never.
        #[serde(default)]
        #[schemars(extend("unit" = "s", "derived" = "for ever"))]
        until: Option<f64>,
    },
    /// With a constant rate about an axis.
    Rotation {
        /// A point of the axis (m).
        #[schemars(extend("unit" = "m"))]
        center: Point,
        /// Direction of the axis; in 2D always (0, 0, 1), out of the plane.
        #[serde(default)]
        #[schemars(extend("unit" = "1", "derived" = "out of the plane in 2D; required in 3D"))]
        axis: Option<Point>,
        /// Rate (rad/s), counter-clockwise about the axis.
        #[schemars(extend("unit" = "rad/s"))]
        rate: f64,
    },
    /// Through a table of displacements and angles, joined smoothly (cubic Hermite, slopes from the neighbouring rows).
    Table {
        /// A point of the axis of rotation (m).
        #[schemars(extend("unit" = "m"))]
        center: Point,
        /// Direction of the axis; in 2D always (0, 0, 1), out of the plane.
        #[serde(default)]
        #[schemars(extend("unit" = "1", "derived" = "out of the plane in 2D; required in 3D"))]
        axis: Option<Point>,
        /// Rows in the order of time; before the first and after the last the body rests.
        rows: Vec<TableRow>,
    },
}

/// One row of a tabulated motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableRow {
    /// Time (s).
    #[schemars(extend("unit" = "s"))]
    pub time: f64,
    /// Displacement (m).
    #[schemars(extend("unit" = "m"))]
    pub displacement: Point,
    /// Angle (rad).
    #[serde(default)]
    #[schemars(extend("unit" = "rad"))]
    pub angle: f64,
}

/// Displacement and angle of a body with their first and second derivatives in time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Kinematics {
    /// Point c of the axis (m).
    pub center: DVec3,
    /// Unit vector e of the axis.
    pub axis: DVec3,
    /// d, d', d'' (m, m/s, m/s²).
    pub displacement: [DVec3; 3],
    /// θ, θ', θ'' (rad, rad/s, rad/s²).
    pub angle: [f64; 3],
}

/// From where the points of a body are to where they were at rest, `x0 = c + R(−θ) (x − c − d)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseMotion {
    rotation: DMat3,
    center: DVec3,
    displacement: DVec3,
}

impl InverseMotion {
    /// Where the point that is at `position` (m) was at rest.
    #[must_use]
    pub fn rest_of(&self, position: DVec3) -> DVec3 {
        self.center + self.rotation * (position - self.center - self.displacement)
    }
}

impl Kinematics {
    /// Position, velocity and acceleration of the point that was at `rest` (m).
    #[must_use]
    pub fn of(&self, rest: DVec3) -> (DVec3, DVec3, DVec3) {
        self.of_turned(self.rotation(), rest)
    }

    /// R(θ).
    fn rotation(&self) -> DMat3 {
        DMat3::from_axis_angle(self.axis, self.angle[0])
    }

    /// [`of`](Self::of) with R(θ) at hand: its sine and cosine are the same for all points of a body.
    fn of_turned(&self, rotation: DMat3, rest: DVec3) -> (DVec3, DVec3, DVec3) {
        let [d, d1, d2] = self.displacement;
        let [_, rate, acceleration] = self.angle;
        let arm = rotation * (rest - self.center);
        let turn = self.axis.cross(arm);
        (self.center + arm + d, rate * turn + d1, acceleration * turn + rate * rate * self.axis.cross(turn) + d2)
    }

    /// The way back, from where points are to where they were at rest.
    #[must_use]
    pub fn inverse(&self) -> InverseMotion {
        let [displacement, ..] = self.displacement;
        InverseMotion { rotation: self.rotation().transpose(), center: self.center, displacement }
    }

    /// Angular velocity θ' e (rad/s).
    #[must_use]
    pub fn angular_velocity(&self) -> DVec3 {
        self.angle[1] * self.axis
    }
}

impl Motion {
    /// Refuses motions that make no sense in `dimension` 2 or 3.
    ///
    /// # Errors
    /// The first wrong value.
    pub fn check(&self, dimension: usize) -> Result<(), Invalid> {
        match self {
            Self::Still => Ok(()),
            Self::Translation { velocity, from, until } => {
                coordinates(*velocity, dimension).map_err(|invalid| invalid.under("velocity"))?;
                if *from < 0.0 {
                    return Err(Invalid::new("from", format!("must not be negative, got {from} s")));
                }
                match until {
                    Some(until) if until <= from => {
                        Err(Invalid::new("until", format!("must be later than `from` ({from} s), got {until} s")))
                    }
                    _ => Ok(()),
                }
            }
            Self::Rotation { center, axis, .. } => {
                coordinates(*center, dimension).map_err(|invalid| invalid.under("center"))?;
                check_axis(*axis, dimension)
            }
            Self::Table { center, axis, rows } => {
                coordinates(*center, dimension).map_err(|invalid| invalid.under("center"))?;
                check_axis(*axis, dimension)?;
                if rows.len() < 2 {
                    return Err(Invalid::new("rows", "a table needs at least 2 rows"));
                }
                for (k, row) in rows.iter().enumerate() {
                    let path = format!("rows.{k}.displacement");
                    coordinates(row.displacement, dimension).map_err(|invalid| invalid.under(&path))?;
                }
                if let Some(k) = rows.windows(2).position(|pair| pair[1].time <= pair[0].time) {
                    return Err(Invalid::new(format!("rows.{}.time", k + 1), "times must increase from row to row"));
                }
                let ([start, ..], [angle, ..]) = table_at(rows, 0.0);
                if start != DVec3::ZERO || angle != 0.0 {
                    let message = "at t = 0 displacement and angle must be 0: the fluids are filled around the shape";
                    return Err(Invalid::new("rows", message));
                }
                Ok(())
            }
        }
    }

    /// Whether the body turns: it then does not fit into a scene that repeats itself.
    #[must_use]
    pub fn turns(&self) -> bool {
        match self {
            Self::Still | Self::Translation { .. } => false,
            Self::Rotation { .. } => true,
            Self::Table { rows, .. } => rows.iter().any(|row| row.angle != 0.0),
        }
    }

    /// Greatest speed (m/s) up to `end_time` (s) of any point in the box from `low` to `high` (m), which moves along: the
    /// greatest of its corners at the times that tell.
    #[must_use]
    pub fn greatest_speed(&self, bounds: (DVec3, DVec3), end_time: f64) -> f64 {
        let times = self.telling_times().into_iter().filter(|t| (0.0..=end_time).contains(t)).chain([end_time]);
        let speed = |moved: Kinematics| corners(bounds).map(|x| moved.of(x).1.length()).fold(0.0, f64::max);
        times.filter_map(|t| self.at(t)).map(speed).fold(0.0, f64::max)
    }

    /// Times (s) among which the body is fastest. Between two rows of a table d' and θ' are parabolas: each is greatest at a row or
    /// at its vertex, and where several add up, the times besides, 64 for each radian turned and at least 64, miss less than a thousandth.
    fn telling_times(&self) -> Vec<f64> {
        match self {
            Self::Still => Vec::new(),
            Self::Translation { from, .. } => vec![*from],
            Self::Rotation { .. } => vec![0.0],
            Self::Table { rows, .. } => (1..rows.len()).flat_map(|k| times_of_piece(rows, k - 1)).collect(),
        }
    }

    /// Where the body is at time t (s), or `None` if it never moves.
    #[must_use]
    pub fn at(&self, t: f64) -> Option<Kinematics> {
        match self {
            Self::Still => None,
            Self::Translation { velocity, from, until } => {
                let end = until.unwrap_or(f64::INFINITY);
                let travelled = (t.min(end) - from).max(0.0);
                let moving = if (*from..end).contains(&t) { 1.0 } else { 0.0 };
                let velocity = velocity.position();
                let displacement = [velocity * travelled, velocity * moving, DVec3::ZERO];
                Some(Kinematics { axis: DVec3::Z, displacement, ..Kinematics::default() })
            }
            Self::Rotation { center, axis, rate } => Some(Kinematics {
                center: center.position(),
                axis: unit_axis(*axis),
                angle: [rate * t, *rate, 0.0],
                ..Kinematics::default()
            }),
            Self::Table { center, axis, rows } => {
                let (displacement, angle) = table_at(rows, t);
                Some(Kinematics { center: center.position(), axis: unit_axis(*axis), displacement, angle })
            }
        }
    }
}

/// Angle (rad) between two rows up to which it counts in how finely the time between them is looked at.
const MOST_TURNED: f64 = 1e4;

/// Times (s) between the rows k and k + 1 of a table: evenly spread ones, and the vertices of d' and θ', where d'' and θ'', which
/// are straight lines, pass 0.
fn times_of_piece(rows: &[TableRow], k: usize) -> Vec<f64> {
    let turned = (rows[k + 1].angle - rows[k].angle).abs();
    let parts = (64.0 * turned.clamp(1.0, MOST_TURNED)).ceil() as u32;
    let (start, dt) = (rows[k].time, rows[k + 1].time - rows[k].time);
    let seconds = |s: f64| {
        let ([.., d], [.., angle]) = table_at(rows, start + s * dt);
        [d.x, d.y, d.z, angle]
    };
    // Within the piece: at its ends the second derivatives jump.
    let (low, high) = (seconds(0.25), seconds(0.75));
    let vertices = low.into_iter().zip(high).map(|(low, high)| 0.25 + 0.5 * low / (low - high));
    let even = (0..parts).map(|part| f64::from(part) / f64::from(parts));
    even.chain(vertices.filter(|s| (0.0..1.0).contains(s))).map(|s| start + s * dt).collect()
}

/// Displacement and angle, each with two derivatives, of a table at time t (s).
fn table_at(rows: &[TableRow], t: f64) -> ([DVec3; 3], [f64; 3]) {
    let value = |k: usize| (rows[k].displacement.position(), rows[k].angle);
    let last = rows.len() - 1;
    if t <= rows[0].time || t >= rows[last].time {
        let (d, angle) = value(if t <= rows[0].time { 0 } else { last });
        return ([d, DVec3::ZERO, DVec3::ZERO], [angle, 0.0, 0.0]);
    }
    let k = rows.partition_point(|row| row.time <= t) - 1;
    // Slopes vanish at both ends, where the body comes from rest and goes to rest.
    let slope = |k: usize| {
        if k == 0 || k == last {
            return (DVec3::ZERO, 0.0);
        }
        let ((d0, a0), (d1, a1)) = (value(k - 1), value(k + 1));
        let dt = rows[k + 1].time - rows[k - 1].time;
        ((d1 - d0) / dt, (a1 - a0) / dt)
    };
    let dt = rows[k + 1].time - rows[k].time;
    let s = (t - rows[k].time) / dt;
    let basis = hermite(s, dt);
    let ((d0, a0), (d1, a1), (m0, b0), (m1, b1)) = (value(k), value(k + 1), slope(k), slope(k + 1));
    (
        basis.map(|[p, q, u, w]| d0 * p + d1 * q + m0 * u + m1 * w),
        basis.map(|[p, q, u, w]| a0 * p + a1 * q + b0 * u + b1 * w),
    )
}

/// Weights of (start, end, start slope, end slope) in a cubic Hermite piece of duration dt (s) at s = 0…1, for the
/// value and its two derivatives in time.
fn hermite(s: f64, dt: f64) -> [[f64; 4]; 3] {
    let (s2, s3) = (s * s, s * s * s);
    [
        [2.0 * s3 - 3.0 * s2 + 1.0, 3.0 * s2 - 2.0 * s3, dt * (s3 - 2.0 * s2 + s), dt * (s3 - s2)],
        [(6.0 * s2 - 6.0 * s) / dt, (6.0 * s - 6.0 * s2) / dt, 3.0 * s2 - 4.0 * s + 1.0, 3.0 * s2 - 2.0 * s],
        [(12.0 * s - 6.0) / (dt * dt), (6.0 - 12.0 * s) / (dt * dt), (6.0 * s - 4.0) / dt, (6.0 * s - 2.0) / dt],
    ]
}

type Moved = (
    &'static BodyIndex,
    &'static RestPosition,
    &'static mut Position,
    &'static mut WallVelocity,
    &'static mut WallAcceleration,
    &'static mut WallAngularVelocity,
);

/// Puts the particles of every moving body where it is at the end of the step.
pub fn move_bodies(
    clock: Res<Clock>,
    bodies: Query<(&Body, &Motion, Has<super::Structure>)>,
    mut walls: Query<Moved, With<Wall>>,
    mut structures: Query<Moved, (With<Solid>, Without<Wall>)>,
) -> Result {
    for (body, motion, is_structure) in &bodies {
        let Some(kinematics) = motion.at(clock.time) else { continue };
        if is_structure {
            move_particles(body.index, &kinematics, &mut structures)?;
        } else {
            move_particles(body.index, &kinematics, &mut walls)?;
        }
    }
    Ok(())
}

/// Moves the particles of one body.
fn move_particles<F: ArchetypeFilter>(body: u32, kinematics: &Kinematics, particles: &mut Query<Moved, F>) -> Result {
    let (rotation, omega_w) = (kinematics.rotation(), kinematics.angular_velocity());
    for (index, rest, mut x, mut v, mut a, mut omega) in particles.contiguous_iter_mut()? {
        let moving = (x.bypass_change_detection(), v.bypass_change_detection(), a.bypass_change_detection());
        let columns = (index, rest, moving.0, moving.1, moving.2, omega.bypass_change_detection());
        let particles = columns.into_par_iter().with_min_len(GRAIN).with_max_len(PIECE);
        particles.for_each(|(index, rest, x, v, a, omega)| {
            if index.0 == body {
                (x.0, v.0, a.0) = kinematics.of_turned(rotation, rest.0);
                omega.0 = omega_w;
            }
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const BODY: (DVec3, DVec3) = (DVec3::new(-0.1, -0.2, 0.0), DVec3::new(0.1, 0.2, 0.0));

    fn table(rows: &[(f64, f64, f64)]) -> Motion {
        let row = |&(time, x, angle): &(f64, f64, f64)| TableRow { time, displacement: Point::plane(x, 0.0), angle };
        Motion::Table { center: Point::plane(0.0, 0.0), axis: None, rows: rows.iter().map(row).collect() }
    }

    #[test]
    fn the_fastest_moment_of_a_short_stroke_in_a_long_run_is_found() {
        // From rest to rest in one piece, d = D (3s² − 2s³): 1.5 D/T in the middle.
        let stroke = table(&[(5.001, 0.0, 0.0), (5.002, 0.003, 0.0)]);
        assert!((stroke.greatest_speed(BODY, 100.0) - 4.5).abs() < 1e-9);
        // The run ends before it.
        assert_eq!(stroke.greatest_speed(BODY, 5.0), 0.0);
        // A quarter of the way the speed is 6 (¼ − 1/16) D/T.
        assert!((stroke.greatest_speed(BODY, 5.00125) - 6.0 * 3.0 / 16.0 * 3.0).abs() < 1e-9);
        let push = Motion::Translation { velocity: Point::plane(3.0, 4.0), from: 5.001, until: Some(5.002) };
        assert_eq!(push.greatest_speed(BODY, 100.0), 5.0);
        let wheel = Motion::Rotation { center: Point::plane(0.0, 0.0), axis: None, rate: -2.0 };
        assert!((wheel.greatest_speed(BODY, 1.0) - 2.0 * 0.05_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn the_fastest_moment_of_a_turn_and_a_shift_together_is_found_to_a_thousandth() {
        let rows: Vec<_> = (0..6).map(f64::from).map(|t| (t, (2.0 * t).sin(), 0.3 * PI * t * t)).collect();
        let motion = table(&rows);
        let speed =
            |t: f64| corners(BODY).map(|x| motion.at(t).unwrap_or_default().of(x).1.length()).fold(0.0, f64::max);
        let sought = (0..=500_000).map(|k| speed(f64::from(k) * 1e-5)).fold(0.0, f64::max);
        let found = motion.greatest_speed(BODY, 10.0);
        assert!(found > 0.999 * sought && found < sought * (1.0 + 1e-9), "{found} m/s, sought {sought} m/s");
    }
}
