//! Seismic shaking from a tabulated accelerogram.
//!
//! The scene is seen from the ground, which moves with the acceleration a(t). In this frame every fluid particle feels the
//! inertial force −a(t) per mass, so that gravity is `g(t) = g − a(t)` wherever it stands in the equations: in the momentum
//! equation, in the pressure of ghosts (Eq. 15) and in the hydrostatic correction of the diffusion of density. A closed tank that
//! has come to rest relative to the ground so has the pressure ∇p = ρ (g − a), and a particle that touches nothing falls
//! with x'' = g − a(t). Walls and structures that do not move are fixed to the ground; motions that they have are relative
//! to it.
//!
//! `a(t) = scale Σ_k a_k(t) e_k`: each column of the file goes along a direction e_k (a unit vector), linear in time between
//! its rows; before the first row and after the last the ground is not accelerated.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use storegga::clock::Clock;
use storegga::expect::CsvTable;
use storegga::physics::Gravity;
use storegga::scene::geometry::{Point, coordinates};
use storegga::scene::{Invalid, Resolution, SceneInfo, SceneSection, SectionError, scene_file};

/// How the ground shakes: section `shaking` of a scene.
///
/// The scene is seen from the ground, whose acceleration is a(t): the fluid feels −a(t) per mass, so that gravity is g − a(t) in the
/// momentum equation, in the pressure of walls and structures and in the diffusion of density, and motions of bodies are
/// relative to the ground. Between its rows a(t) is linear; before the first and after the last it is 0. p_max and v_max of
/// Eq. 8 do not know of the shaking: give them in `equation_of_state` where it may pass them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Shaking {
    /// Not at all.
    #[default]
    Off,
    /// As recorded.
    Accelerogram {
        /// CSV file, seen from the file of the scene: a line of names, then a row a time; lines that begin with `#` are skipped.
        file: String,
        /// Name of the column of times (s).
        time: String,
        /// Columns of acceleration (m/s²) with their directions; several are added.
        columns: Vec<AccelerogramColumn>,
        /// Factor by which accelerations are multiplied: 9.81 for a file in units of g.
        #[serde(default = "one")]
        #[schemars(extend("unit" = "1"))]
        scale: f64,
    },
}

fn one() -> f64 {
    1.0
}

/// A column of an accelerogram.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AccelerogramColumn {
    /// Its name.
    pub name: String,
    /// Direction of the ground's acceleration; only its direction counts.
    #[schemars(extend("unit" = "1"))]
    pub direction: Point,
}

/// Acceleration a(t) of the ground: columns with their unit vectors, and the factor.
#[derive(Resource, Debug, Clone, Default, PartialEq)]
pub struct Accelerogram {
    columns: Vec<(DVec3, CsvTable)>,
    scale: f64,
}

impl SceneSection for Shaking {
    const NAME: &'static str = "shaking";

    fn when_absent() -> Option<Self> {
        Some(Self::Off)
    }

    fn check(&self, world: &World) -> Result<(), Invalid> {
        let Self::Accelerogram { columns, .. } = self else { return Ok(()) };
        if columns.is_empty() {
            return Err(Invalid::new("columns", "name at least one column of acceleration"));
        }
        let dimension = world.resource::<Resolution>().dimension;
        columns.iter().enumerate().try_for_each(|(k, column)| {
            let path = format!("columns.{k}.direction");
            coordinates(column.direction, dimension).map_err(|wrong| wrong.under(&path))?;
            match column.direction.position().try_normalize() {
                Some(_) => Ok(()),
                None => Err(Invalid::new(path, "must not be the null vector")),
            }
        })
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let Self::Accelerogram { file, time, columns, scale } = self else { return Ok(()) };
        let file = scene_file(world, &file)?;
        let end_time = world.resource::<SceneInfo>().end_time;
        let read = |(k, column): (usize, AccelerogramColumn)| {
            let table = CsvTable::read(&file, &time, &column.name).map_err(|wrong| match wrong.path.as_str() {
                "value" => Invalid { path: format!("columns.{k}.name"), ..wrong },
                _ => wrong,
            })?;
            covers_run(&table, end_time)?;
            Ok((column.direction.position().normalize(), table))
        };
        let columns = columns.into_iter().enumerate().map(read).collect::<Result<_, Invalid>>()?;
        world.insert_resource(Accelerogram { columns, scale });
        Ok(())
    }
}

/// Refuses a record of which nothing falls into the run, from 0 to `end_time` (s): the ground would rest.
fn covers_run(table: &CsvTable, end_time: f64) -> Result<(), Invalid> {
    match table.rows() {
        [(first, _), .., (last, _)] if *first < end_time && *last > 0.0 => Ok(()),
        rows => {
            let at = |row: Option<&(f64, f64)>| row.map_or(0.0, |(time, _)| *time);
            let (first, last) = (at(rows.first()), at(rows.last()));
            let message = format!(
                "its rows from {first} s to {last} s shake nothing in the run of the scene, which ends at {end_time} s"
            );
            Err(Invalid::new("file", message))
        }
    }
}

impl Accelerogram {
    /// a (m/s²) at time t (s).
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.columns.iter().map(|(direction, table)| *direction * linear(table.rows(), t)).sum::<DVec3>() * self.scale
    }
}

/// Value at time t of rows (time, value) joined by straight lines; 0 before the first and after the last.
fn linear(rows: &[(f64, f64)], t: f64) -> f64 {
    let k = rows.partition_point(|(time, _)| *time < t);
    match (k.checked_sub(1).and_then(|k| rows.get(k)), rows.get(k)) {
        (_, Some(&(t1, a1))) if t1 == t => a1,
        (Some(&(t0, a0)), Some(&(t1, a1))) => a0 + (a1 - a0) * (t - t0) / (t1 - t0),
        _ => 0.0,
    }
}

/// Takes the acceleration of the ground from the gravity of the step in progress.
pub fn shake(clock: Res<Clock>, accelerogram: Res<Accelerogram>, mut gravity: ResMut<Gravity>) {
    gravity.now -= accelerogram.at(clock.time);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_joined_by_lines_and_the_ground_rests_outside() {
        let rows = [(1.0, 2.0), (2.0, -2.0), (4.0, 6.0)];
        for (t, a) in [(0.999, 0.0), (1.0, 2.0), (1.5, 0.0), (2.0, -2.0), (2.5, 0.0), (4.0, 6.0), (4.001, 0.0)] {
            assert!((linear(&rows, t) - a).abs() < 1e-14, "at {t}");
        }
    }
}
