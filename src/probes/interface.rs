//! Flatness of a phase's upper surface.

use std::collections::HashMap;

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::phase;
use super::{Probe, SeriesField, State};
use crate::physics::Gravity;
use crate::scene::{Invalid, vertical};

/// Highest and lowest place of a phase's upper surface, `highest` and `lowest` (m), which in each column of width dp lies dp/2 above the highest
/// particle. Heights count along −g from the origin.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Interface {
    /// Name of the phase.
    pub phase: String,
    #[serde(skip)]
    index: u32,
    /// Axis of gravity, and whether it points up (+1) or down (−1).
    #[serde(skip)]
    vertical: (usize, f64),
    /// Height (m) of the highest particle in each column.
    #[serde(skip)]
    columns: HashMap<[i64; 3], f64>,
}

impl Probe for Interface {
    fn description(&self) -> String {
        format!("upper surface of the phase `{}`", self.phase)
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![
            SeriesField::new("highest", "m", "height of the surface where it is highest"),
            SeriesField::new("lowest", "m", "height of the surface where it is lowest"),
        ]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.index = phase(world, &self.phase)?;
        let gravity = world.resource::<Gravity>().full;
        self.vertical =
            vertical(gravity).ok_or_else(|| Invalid::new("", "an upper surface needs a gravity along an axis"))?;
        Ok(())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let (axis, up) = self.vertical;
        let spacing = state.resolution.spacing;
        self.columns.clear();
        for i in state.fluid.rows_of(self.index) {
            let x = state.fluid.position[i].0;
            let mut column = (x / spacing).to_array().map(|cell| cell.floor() as i64);
            column[axis] = 0;
            let highest = self.columns.entry(column).or_insert(f64::NEG_INFINITY);
            *highest = highest.max(up * x[axis]);
        }
        if !self.columns.is_empty() {
            row[0] = self.columns.values().copied().fold(f64::NEG_INFINITY, f64::max) + 0.5 * spacing;
            row[1] = self.columns.values().copied().fold(f64::INFINITY, f64::min) + 0.5 * spacing;
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::probes::test_support::{TANK, measured, scene};

    #[test]
    fn a_filled_layer_is_flat_and_a_dent_shows() {
        let mut app = measured(&scene(TANK, "probes: {\"top\": Interface(phase: \"brine\")},"));
        app.assert("top.highest", 0.2, 1e-12);
        app.assert("top.lowest", 0.2, 1e-12);
        app.move_fluid(|x| match x.x {
            x0 if x0 < 0.02 => x - 0.013 * DVec3::Y,
            x0 if x0 > 0.38 => x + 0.007 * DVec3::Y,
            _ => x,
        });
        app.measure();
        app.assert("top.highest", 0.207, 1e-12);
        app.assert("top.lowest", 0.187, 1e-12);
    }
}
