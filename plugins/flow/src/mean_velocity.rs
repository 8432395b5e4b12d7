//! Mean velocity in a shape.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use storegga::probes::{Probe, SeriesField, State, box_inside};
use storegga::scene::geometry::Shape;
use storegga::scene::{Invalid, Resolution};

/// Mean velocity `Σ V v / Σ V` of the fluid in a shape: `x`, `y`, `z` (m/s). In a piece of channel from wall to wall, the component along it is
/// the discharge over the cross-section.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeanVelocity {
    /// Where (m).
    #[schemars(extend("unit" = "m"))]
    pub shape: Shape,
}

impl Probe for MeanVelocity {
    fn description(&self) -> String {
        "mean velocity of the fluid in a shape".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        ["x", "y", "z"].map(|axis| SeriesField::new(axis, "m/s", "mean velocity, weighted by volume")).into()
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.shape.check(world.resource::<Resolution>().dimension).map_err(|wrong| wrong.under("shape"))?;
        box_inside(world, "shape", self.shape.bounds())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let (mut volume, mut flow) = (0.0, DVec3::ZERO);
        for i in state.fluid.rows().filter(|&i| self.shape.contains(state.fluid.position[i].0)) {
            volume += state.fluid.volume(i);
            flow += state.fluid.velocity[i].0 * state.fluid.volume(i);
        }
        // Where there is no fluid, there is no number.
        row.copy_from_slice(&(flow / volume).to_array());
    }
}
