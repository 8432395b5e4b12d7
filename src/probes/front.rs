//! Front of a phase.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::{direction, phase};
use super::{Probe, SeriesField, State};
use crate::neighbours::PeriodicSides;
use crate::scene::Invalid;
use crate::scene::geometry::Point;

/// The foremost particle of a phase: `position` max x·n (m) and `velocity` v·n (m/s) along the
/// unit vector n.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Front {
    /// Name of the phase.
    pub phase: String,
    /// Direction in which the phase advances; its length does not matter.
    #[schemars(extend("unit" = "1"))]
    pub direction: Point,
    #[serde(skip)]
    resolved: (u32, DVec3),
}

impl Probe for Front {
    fn description(&self) -> String {
        format!("foremost particle of the phase `{}`", self.phase)
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![
            SeriesField::new("position", "m", "its coordinate along the direction"),
            SeriesField::new("velocity", "m/s", "its velocity along the direction"),
        ]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.resolved = (phase(world, &self.phase)?, direction(world, self.direction)?);
        let sides = world.resource::<PeriodicSides>().0;
        match (0..3).find(|&axis| sides[axis].is_some() && self.resolved.1[axis] != 0.0) {
            Some(_) => Err(Invalid::new("direction", "there is no front along a periodic axis")),
            None => Ok(()),
        }
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let (phase, n) = self.resolved;
        let fluid = &state.fluid;
        let along = |i: usize| fluid.position[i].0.dot(n);
        // Of two that are level the one with the lower identity: rows change places.
        let foremost = fluid
            .rows_of(phase)
            .max_by(|&a, &b| along(a).total_cmp(&along(b)).then_with(|| fluid.id[b].cmp(&fluid.id[a])));
        if let Some(i) = foremost {
            (row[0], row[1]) = (along(i), fluid.velocity[i].0.dot(n));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::probes::test_support::{CHANNEL, TANK, complaint, opened, scene};

    #[test]
    fn the_foremost_particle_is_found_along_a_slope() {
        let mut app = opened(&scene(TANK, "probes: {\"front\": Front(phase: \"brine\", direction: (3, 4))},"));
        app.set_fluid(|x, v, _, _| *v = DVec3::new(x.x, 2.0 * x.y, 0.0));
        app.measure();
        // The brine's corner particle lies at (0.39, 0.19).
        app.assert("front.position", 0.6 * 0.39 + 0.8 * 0.19, 1e-12);
        app.assert("front.velocity", 0.6 * 0.39 + 0.8 * 0.38, 1e-12);
    }

    #[test]
    fn a_front_along_a_periodic_axis_is_refused() {
        let probes = "probes: {\"front\": Front(phase: \"mud\", direction: (1, 0))},";
        assert!(complaint(&scene(CHANNEL, probes)).contains("periodic"));
        let probes = "probes: {\"front\": Front(phase: \"mud\", direction: (0, 0))},";
        assert!(complaint(&scene(CHANNEL, probes)).contains("null vector"));
    }
}
