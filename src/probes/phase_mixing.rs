//! Mixing of phases at the scale of the particles.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Probe, SeriesField, State};

/// `isolated`: number of particles that other phases have cut off from their own: those whose own phase makes up less than a tenth of
/// the fluid around them, `Σ_own V_j |r_ij·∇_iW_ij| < ⅒ Σ_fluid V_j |r_ij·∇_iW_ij|`. On a flat interface it is more than a half, in a
/// sheet one particle thick a quarter, for a single particle in another phase nothing. NaN before the first step.
#[derive(Component, Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PhaseMixing {}

/// Share of the own phase below which a particle is cut off.
pub(crate) const LEAST_SHARE: f64 = 0.1;

impl Probe for PhaseMixing {
    fn description(&self) -> String {
        "particles cut off from their own phase".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![SeriesField::new("isolated", "", "particles with less than a tenth of their own phase around them")]
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        if state.neighbours.builds > 0 {
            row[0] = state.fluid.rows().filter(|&i| is_isolated(state, i)).count() as f64;
        }
    }
}

fn is_isolated(state: &State<'_>, i: usize) -> bool {
    let (fluid, rows) = (&state.fluid, &state.neighbours.rows);
    let (mut own, mut all) = (0.0, 0.0);
    for row in state.neighbours.fluid.of(i).fluid.iter() {
        let j = rows.source(row);
        let mut gradient = [fluid.position[i].0.distance_squared(fluid.position[j].0 + rows.shift(row))];
        let r_squared = gradient[0];
        state.kernel.0.gradients(&mut gradient);
        let share = -fluid.volume(j) * gradient[0] * r_squared;
        all += share;
        own += if fluid.phase[j] == fluid.phase[i] { share } else { 0.0 };
    }
    own < LEAST_SHARE * all
}

#[cfg(test)]
mod tests {
    use crate::particles::{Fluid, PhaseIndex, Position};
    use crate::probes::test_support::{TANK, opened, scene};
    use crate::schedule::Step;

    /// Puts the particles at places that `other` picks into the other phase, and counts.
    fn isolated(other: impl Fn(i64, i64) -> bool) -> Option<f64> {
        let mut app = opened(&scene(TANK, "probes: {\"mixing\": PhaseMixing()},"));
        let world = app.0.world_mut();
        for (x, mut phase) in world.query::<(&Position, &mut PhaseIndex)>().iter_mut(world) {
            if other((x.0.x / 0.02).floor() as i64, (x.0.y / 0.02).floor() as i64) {
                phase.0 = 1 - phase.0;
            }
        }
        assert!(world.query_filtered::<(), bevy_ecs::prelude::With<Fluid>>().iter(world).count() == 400);
        world.run_schedule(Step);
        app.measure();
        app.value("mixing.isolated")
    }

    #[test]
    fn layers_and_sheets_are_whole_and_strays_are_counted() {
        assert_eq!(isolated(|_, _| false), Some(0.0));
        assert_eq!(isolated(|_, row| row == 4), Some(0.0));
        assert_eq!(isolated(|column, row| (column, row) == (7, 3) || (column, row) == (12, 15)), Some(2.0));
    }
}
