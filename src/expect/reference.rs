//! What a value should be: numbers, closed forms that follow from the scene, and measured series.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::displaced::{buoyancy, column, structure};
use super::section::find;
use super::table::CsvTable;
use crate::particles::{Fluid, Mass};
use crate::physics::{EquationOfState, Gravity};
use crate::scene::geometry::{Point, coordinates};
use crate::scene::{Invalid, Resolution, SceneInfo, scene_file, vertical};

/// The field `is` of an expectation.
///
/// Weights and forces are components along the axis of gravity: with gravity (0, −9.81) the weight of the fluid, and the
/// force with which it presses on a floor, are negative, and a buoyancy is positive, as in `force_y`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Reference {
    /// A number, in the unit of the series.
    #[schemars(extend("unit" = "that of the series"))]
    Number(f64),
    /// Anything from the first number to the second.
    #[schemars(extend("unit" = "that of the series"))]
    Between(f64, f64),
    /// Weight `Σ m g` of all fluid at the start (N; N/m in 2D).
    FluidWeight,
    /// Buoyancy of a structure: the weight `∫ ρ0 g dV` of the fluid that it displaces, with its sign turned (N; N/m in
    /// 2D where the structure has no length). Fluid counts with its reference density; compression adds p/B, below 1 %.
    DisplacedWeight {
        /// Name of the structure.
        structure: String,
        /// A point (m) of the vertical on which the layers of the start are taken, beside the structure; `None` for the
        /// left end of the fluids.
        #[serde(default)]
        #[schemars(extend("unit" = "m", "derived" = "the left end of the fluids"))]
        beside: Option<Point>,
    },
    /// Pressure (Pa) of the model's compressible fluid at rest, in the layers of the start.
    HydrostaticPressure {
        /// The place (m).
        #[schemars(extend("unit" = "m"))]
        at: Point,
    },
    /// Exact area (m²; 2D) or volume (m³) of a structure.
    ShapeMeasure {
        /// Name of the structure.
        structure: String,
    },
    /// Another number of the run, `<series>.<field>`, taken in the same way.
    SameAs(String),
    /// A series in a CSV file: columns parted by `,`, a line of names, then a row a time; lines that begin with `#` are skipped. Every row is
    /// compared, and the value is the relative L2 difference `√(Σ (y_k − ŷ(t_k))² / Σ y_k²)` of the series ŷ from the rows
    /// y_k or, if the tolerance is `Absolute`, the root mean square of y_k − ŷ(t_k).
    Csv {
        /// The file, seen from the file of the scene.
        file: String,
        /// Name of the column of times (s).
        time: String,
        /// Name of the column of values.
        value: String,
    },
}

/// What a value is compared with, once known.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Target {
    /// One number.
    Number(f64),
    /// A range.
    Between(f64, f64),
    /// A field of another series, and what the scene calls it.
    Series(Entity, usize, String),
    /// A series and the name of its file.
    Table(CsvTable, String),
}

impl Reference {
    /// Works the reference out, at the start of the run.
    ///
    /// # Errors
    /// What does not exist or makes no sense.
    pub(super) fn resolve(&self, world: &mut World) -> Result<Target, Invalid> {
        let number = match self {
            Self::Number(number) => Ok(*number),
            Self::Between(least, greatest) if least > greatest => {
                Err(Invalid::new("", format!("the first number is the lower one, got {least} and {greatest}")))
            }
            Self::Between(least, greatest) => return Ok(Target::Between(*least, *greatest)),
            Self::FluidWeight => fluid_weight(world),
            Self::DisplacedWeight { structure, beside } => buoyancy(world, structure, *beside),
            Self::HydrostaticPressure { at } => hydrostatic_pressure(world, *at),
            Self::ShapeMeasure { structure } => shape_measure(world, structure),
            Self::SameAs(of) => {
                let (series, field) = find(world, of).map_err(|invalid| Invalid::new("", invalid.message))?;
                return Ok(Target::Series(series, field, of.clone()));
            }
            Self::Csv { file, time, value } => {
                let table = CsvTable::read(&scene_file(world, file)?, time, value)?;
                table.check_times(world.resource::<SceneInfo>().end_time)?;
                return Ok(Target::Table(table, file.clone()));
            }
        };
        number.map(Target::Number)
    }
}

/// Σ m g (N; N/m in 2D) along the axis of gravity.
fn fluid_weight(world: &mut World) -> Result<f64, Invalid> {
    let gravity = world.resource::<Gravity>().full;
    let (axis, _) = vertical(gravity).ok_or_else(|| Invalid::new("", "a weight needs a gravity along an axis"))?;
    let mass: f64 = world.query_filtered::<&Mass, With<Fluid>>().iter(world).map(|mass| mass.0).sum();
    Ok(mass * gravity[axis])
}

/// Pressure (Pa) at a place, of the layers of the start.
fn hydrostatic_pressure(world: &World, at: Point) -> Result<f64, Invalid> {
    let dimension = world.resource::<Resolution>().dimension;
    coordinates(at, dimension).map_err(|invalid| invalid.under("at"))?;
    let (column, up) = column(world, at.position()).map_err(|invalid| invalid.under("at"))?;
    let state = world.resource::<EquationOfState>();
    Ok(column.compressible(at.position().dot(up), state.bulk_modulus, state.background_pressure))
}

/// Exact area or volume of a structure.
fn shape_measure(world: &mut World, name: &str) -> Result<f64, Invalid> {
    let dimension = world.resource::<Resolution>().dimension;
    let (shape, _) = structure(world, name)?;
    let message = "its shape is put together from others: give the number instead";
    shape.measure(dimension).ok_or_else(|| Invalid::new("structure", message))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probes::test_support::{TANK, opened, scene};

    fn resolved(reference: &Reference) -> Result<Target, Invalid> {
        reference.resolve(opened(&scene(TANK, "")).0.world_mut())
    }

    fn number(reference: &Reference) -> f64 {
        match resolved(reference) {
            Ok(Target::Number(number)) => number,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_weight_points_down() {
        let weight = number(&Reference::FluidWeight);
        let incompressible = -9.81 * 0.4 * 0.2 * (1000.0 + 1200.0);
        // Compressed by at most 1 %, a filled place holds a little more.
        assert!(weight < incompressible && weight > 1.01 * incompressible, "{weight}");
    }

    #[test]
    fn pressure_and_area_are_the_exact_ones() {
        let pressure = number(&Reference::HydrostaticPressure { at: Point::plane(0.2, 0.0) });
        let incompressible = 9.81 * (0.2 * 1000.0 + 0.2 * 1200.0);
        assert!(pressure > incompressible && pressure < 1.01 * incompressible, "{pressure}");
        let area = number(&Reference::ShapeMeasure { structure: "floor".to_owned() });
        assert!((area - 0.06).abs() < 1e-12);
    }

    #[test]
    fn what_does_not_exist_is_refused() {
        let structure = Reference::ShapeMeasure { structure: "flor".to_owned() };
        assert!(resolved(&structure).is_err_and(|invalid| invalid.message.contains("`floor`")));
        let place = Reference::HydrostaticPressure { at: Point::plane(7.0, 0.0) };
        assert!(resolved(&place).is_err_and(|invalid| invalid.path == "at"));
        assert!(resolved(&Reference::Between(2.0, 1.0)).is_err());
    }
}
