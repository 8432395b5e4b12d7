//! Error of the velocity in a plane channel.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::{flow_law, phase, plane};
use super::{ChannelFlow, Probe, SeriesField, State};
use crate::physics::Gravity;
use crate::scene::Invalid;
use crate::scene::geometry::Axis;

/// Relative L2 error, `l2`: `√( Σ V (u − û)² / Σ V û² )` of the velocity u along a plane channel against the exact steady flow û
/// ([`ChannelFlow`]) that the gravity along it drives. The phase is Newtonian or Herschel–Bulkley, or one
/// of their special cases (Bingham, a power law).
///
/// The `plug_velocity` (m/s, beside the `exact_plug_velocity`) is the mean over particles nearer to the mid-plane than s0, or than one spacing if the plug is
/// thinner.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChannelError {
    /// Name of the phase.
    pub phase: String,
    /// Axis of the flow.
    pub along: Axis,
    /// Axis across the channel.
    pub across: Axis,
    /// Coordinates (m) of the two walls on that axis.
    #[schemars(extend("unit" = "m"))]
    pub walls: (f64, f64),
    #[serde(skip)]
    index: u32,
    /// +1 if the fluid flows up the axis, −1 if down.
    #[serde(skip)]
    sense: f64,
    #[serde(skip)]
    flow: ChannelFlow,
}

impl Probe for ChannelError {
    fn description(&self) -> String {
        format!("velocity of the phase `{}` against the exact plane channel flow", self.phase)
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![
            SeriesField::new("l2", "", "relative L2 error of the velocity along the channel"),
            SeriesField::new("plug_velocity", "m/s", "mean velocity of the plug, in the direction of gravity"),
            SeriesField::new("exact_plug_velocity", "m/s", "its exact value"),
        ]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.index = phase(world, &self.phase)?;
        let (from, to) = self.walls;
        if from >= to {
            return Err(Invalid::new("walls", format!("the first must lie below the second, got {from} and {to} m")));
        }
        plane(world, self.along, self.across)?;
        let gravity = world.resource::<Gravity>().full[self.along.index()];
        self.sense = gravity.signum();
        let law = flow_law(world, self.index)?;
        self.flow = ChannelFlow {
            half_width: 0.5 * (to - from),
            force: law.reference_density * gravity.abs(),
            consistency: law.consistency,
            exponent: law.exponent,
            yield_stress: law.yield_stress,
        };
        if self.flow.force * self.flow.half_width <= law.yield_stress {
            let message =
                "gravity along the channel is too weak: the stress at the walls does not pass the yield stress";
            return Err(Invalid::new("", message));
        }
        Ok(())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let fluid = &state.fluid;
        let (along, across) = (self.along.index(), self.across.index());
        let middle = 0.5 * (self.walls.0 + self.walls.1);
        let core = self.flow.plug().max(state.resolution.spacing);
        let (mut error, mut norm, mut plug, mut plug_volume) = (0.0, 0.0, 0.0, 0.0);
        for i in fluid.rows_of(self.index) {
            let s = (fluid.position[i].0[across] - middle).abs();
            let (volume, u, exact) = (fluid.volume(i), self.sense * fluid.velocity[i].0[along], self.flow.velocity(s));
            error += volume * (u - exact).powi(2);
            norm += volume * exact * exact;
            if s < core {
                plug += volume * u;
                plug_volume += volume;
            }
        }
        row.copy_from_slice(&[(error / norm).sqrt(), plug / plug_volume, self.flow.velocity(0.0)]);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::probes::ChannelFlow;
    use crate::probes::test_support::{CHANNEL, complaint, opened, scene};

    const ERROR: &str = "probes: {\"channel\": ChannelError(phase: \"mud\", along: X, across: Y, walls: (0, 0.1))},";
    const FLOW: ChannelFlow =
        ChannelFlow { half_width: 0.05, force: 500.0, consistency: 2.0, exponent: 0.5, yield_stress: 10.0 };

    #[test]
    fn the_exact_flow_has_no_error_and_a_tenth_more_has_a_tenth() {
        for (factor, error) in [(1.0, 0.0), (1.1, 0.1)] {
            let mut app = opened(&scene(CHANNEL, ERROR));
            app.set_fluid(|x, v, _, _| *v = factor * FLOW.velocity(x.y - 0.05) * DVec3::X);
            app.measure();
            app.assert("channel.l2", error, 1e-12);
            app.assert("channel.plug_velocity", factor * FLOW.velocity(0.0), 1e-12);
            app.assert("channel.exact_plug_velocity", FLOW.velocity(0.0), 1e-12);
        }
    }

    #[test]
    fn a_flow_down_the_axis_counts_along_gravity() {
        let mut app = opened(&scene(&CHANNEL.replace("(0.5, 0)", "(-0.5, 0)"), ERROR));
        app.set_fluid(|x, v, _, _| *v = -FLOW.velocity(x.y - 0.05) * DVec3::X);
        app.measure();
        app.assert("channel.l2", 0.0, 1e-12);
    }

    #[test]
    fn a_channel_that_does_not_flow_is_refused() {
        let stiff = CHANNEL.replace("yield_stress: 10", "yield_stress: 30");
        assert!(complaint(&scene(&stiff, ERROR)).contains("yield stress"));
        assert!(complaint(&scene(CHANNEL, &ERROR.replace("across: Y", "across: X"))).contains("another axis"));
    }
}
