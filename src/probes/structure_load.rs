//! Load on a structure, as a series.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Probe, SeriesField, State};

/// Force and moment of the fluid on a structure (Eqs. 17, 18), with their parts from pressure and from viscous stress, and
/// the area or volume that its particles fill. A series of every structure, under its name.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StructureLoad {
    structure: String,
}

/// Vectors of a row: prefix of the names, unit, meaning.
const VECTORS: [(&str, &str, &str); 6] = [
    ("force", "N", "force of the fluid"),
    ("pressure", "N", "force from the pressure"),
    ("viscous", "N", "force from the viscous stress"),
    ("moment", "N m", "moment of the fluid"),
    ("pressure_moment", "N m", "moment from the pressure"),
    ("viscous_moment", "N m", "moment from the viscous stress"),
];

impl StructureLoad {
    /// The load on the structure called `structure`.
    #[must_use]
    pub fn new(structure: &str) -> Self {
        Self { structure: structure.to_owned() }
    }
}

impl Probe for StructureLoad {
    fn description(&self) -> String {
        format!("load on the structure `{}` (in 2D per metre, unless it has a length)", self.structure)
    }

    fn fields(&self) -> Vec<SeriesField> {
        let components = VECTORS.into_iter().flat_map(|(prefix, unit, meaning)| {
            ["x", "y", "z"].map(|axis| SeriesField::new(format!("{prefix}_{axis}"), unit, meaning))
        });
        let volume = SeriesField::new("volume", "m³", "volume that its particles fill; in 2D the area in m²");
        let displaced =
            SeriesField::new("displaced", "m³", "volume that the fluids left free for it; in 2D the area in m²");
        components.chain([volume, displaced]).collect()
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let Some((_, structure, load)) = state.structures.iter().find(|(body, ..)| body.name == self.structure) else {
            return;
        };
        let vectors = [
            load.force(),
            load.pressure_force,
            load.viscous_force,
            load.moment(),
            load.pressure_moment,
            load.viscous_moment,
        ];
        for (out, vector) in row.chunks_exact_mut(3).zip(vectors) {
            out.copy_from_slice(&vector.to_array());
        }
        row[3 * VECTORS.len()] = structure.volume;
        row[3 * VECTORS.len() + 1] = structure.displaced;
    }
}

#[cfg(test)]
mod tests {
    use crate::probes::test_support::{TANK, measured, scene};

    #[test]
    fn the_floor_carries_the_weight_and_fills_its_area() {
        let mut app = measured(&scene(TANK, ""));
        let mass = app.value("energy.mass").unwrap_or_default();
        app.assert("floor.force_y", -9.81 * mass, 0.05 * 9.81 * mass);
        app.assert("floor.viscous_y", 0.0, 1e-9);
        app.assert("floor.volume", 0.06, 1e-9);
        let sum = app.value("floor.pressure_x").zip(app.value("floor.viscous_x")).map(|(p, v)| p + v);
        assert_eq!(app.value("floor.force_x"), sum);
    }
}
