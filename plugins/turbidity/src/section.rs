//! What a scene says: `turbidity: (diffusivity: 1e-4, fractions: {"slide": 0.2})`.

use std::collections::BTreeMap;

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use storegga::particles::{Fluid, PhaseIndex};
use storegga::phases::phases;
use storegga::scene::{Invalid, SceneSection, SectionError, unknown};

use crate::FineSediment;
use crate::channel;

/// Section `turbidity`: fine sediment at the start, and how fast it spreads.
#[derive(Resource, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TurbiditySection {
    /// Diffusivity κ (m²/s), that of turbulence too small to be seen.
    #[schemars(range(min = 0.0), extend("unit" = "m²/s"))]
    pub diffusivity: f64,
    /// Mass fraction (0 to 1) in each phase at the start; phases that are not named have none.
    pub fractions: BTreeMap<String, f64>,
}

impl SceneSection for TurbiditySection {
    const NAME: &'static str = "turbidity";

    fn when_absent() -> Option<Self> {
        Some(Self { diffusivity: 0.0, fractions: BTreeMap::new() })
    }

    fn check(&self, _: &World) -> Result<(), Invalid> {
        if self.diffusivity < 0.0 {
            let message = format!("must not be negative, got {} m²/s", self.diffusivity);
            return Err(Invalid::new("diffusivity", message));
        }
        for (phase, fraction) in &self.fractions {
            if !(0.0..=1.0).contains(fraction) {
                let message = format!("must lie between 0 and 1, got {fraction}");
                return Err(Invalid::new(format!("fractions.{phase}"), message));
            }
        }
        Ok(())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        if self.fractions.is_empty() {
            return Ok(());
        }
        let known = phases(world);
        let mut start = vec![0.0; known.len()];
        for (name, fraction) in &self.fractions {
            let Some((phase, _)) = known.iter().find(|(phase, _)| phase.name == *name) else {
                let names = known.iter().map(|(phase, _)| phase.name.as_str());
                return Err(unknown("fractions", "phase", name, names).into());
            };
            start[phase.index as usize] = *fraction;
        }
        let mut fluid = world.query_filtered::<(&PhaseIndex, &mut FineSediment), With<Fluid>>();
        for (phase, mut sediment) in fluid.iter_mut(world) {
            sediment.0 = start[phase.0 as usize];
        }
        world.spawn(channel::series());
        world.insert_resource(self);
        Ok(())
    }
}
