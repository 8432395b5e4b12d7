//! Front of a phase.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::{direction, phase};
use super::{Probe, SeriesField, State};
use crate::neighbours::PeriodicSides;
use crate::particles::ParticleId;
use crate::scene::Invalid;
use crate::scene::geometry::Point;

/// Front of a phase along the unit vector n: of its foremost particle, `position` max x·n (m) and `velocity` v·n (m/s).
///
/// With a `share` such as 0.95 the foremost 5 % of the particles are its nose: `position` is where the rearmost of them is, `velocity` their mean
/// v·n. A single grain that is thrown ahead does not count much there.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Front {
    /// Name of the phase.
    pub phase: String,
    /// Direction in which the phase advances; its length does not matter.
    #[schemars(extend("unit" = "1"))]
    pub direction: Point,
    /// Part of the phase's particles that is behind the front; `None` for all but one.
    #[serde(default)]
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0, "derived" = "the foremost particle"))]
    pub share: Option<f64>,
    #[serde(skip)]
    resolved: (u32, DVec3),
    /// All particles of the phase, kept so that measuring allocates nothing.
    #[serde(skip)]
    order: Vec<Row>,
}

/// x·n (m), identity and row of a particle.
type Row = (f64, ParticleId, usize);

impl Probe for Front {
    fn description(&self) -> String {
        match self.share {
            Some(share) => format!("front of the phase `{}`, with {share} of it behind", self.phase),
            None => format!("foremost particle of the phase `{}`", self.phase),
        }
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![
            SeriesField::new("position", "m", "coordinate of the front along the direction"),
            SeriesField::new("velocity", "m/s", "velocity of the front along the direction"),
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
        self.order.clear();
        self.order.extend(fluid.rows_of(phase).map(|i| (along(i), fluid.id[i], i)));
        if self.order.is_empty() {
            return;
        }
        let ahead = self.share.map_or(0.0, |share| (1.0 - share) * self.order.len() as f64);
        let nose = (ahead.round() as usize).clamp(1, self.order.len());
        // Of two that are level the one with the lower identity: rows change places.
        let by_place = |a: &Row, b: &Row| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1));
        self.order.select_nth_unstable_by(nose - 1, by_place);
        let nose = &mut self.order[..nose];
        nose.sort_unstable_by(by_place);
        let velocities: f64 = nose.iter().map(|(.., i)| fluid.velocity[*i].0.dot(n)).sum();
        (row[0], row[1]) = (nose[nose.len() - 1].0, velocities / nose.len() as f64);
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

    /// 20 by 10 particles of brine: the foremost tenth are those of the last two columns.
    #[test]
    fn a_front_with_a_share_behind_is_a_nose() {
        let front =
            |share: &str| format!("probes: {{\"f\": Front(phase: \"brine\", direction: (1, 0), share: {share})}},");
        let mut app = opened(&scene(TANK, &front("0.9")));
        app.set_fluid(|x, v, _, _| *v = DVec3::new(x.x, 7.0, 0.0));
        app.measure();
        app.assert("f.position", 0.37, 1e-12);
        app.assert("f.velocity", 0.38, 1e-12);
        // A share of next to nothing: all of it is the nose, whose rear is the rear of the phase.
        let mut app = opened(&scene(TANK, &front("1e-9")));
        app.measure();
        app.assert("f.position", 0.01, 1e-12);
        assert!(complaint(&scene(TANK, &front("1.0"))).contains("between 0 and 1"));
    }

    #[test]
    fn a_front_along_a_periodic_axis_is_refused() {
        let probes = "probes: {\"front\": Front(phase: \"mud\", direction: (1, 0))},";
        assert!(complaint(&scene(CHANNEL, probes)).contains("periodic"));
        let probes = "probes: {\"front\": Front(phase: \"mud\", direction: (0, 0))},";
        assert!(complaint(&scene(CHANNEL, probes)).contains("null vector"));
    }
}
