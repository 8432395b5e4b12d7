//! Height of the free surface.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::{inside, place, up};
use super::{Probe, SeriesField, State};
use crate::scene::Invalid;
use crate::scene::geometry::Point;

/// `height` (m) of the free surface on the vertical through a place: the highest one at which `Σ_f V_f W_f`, 1 inside the
/// fluid and 0 outside, passes ½. Samples dp/4 apart from the top down, joined linearly. Heights count along −g from
/// the origin.
///
/// Nearer to a wall than the kernel reaches, part of the sum is missing and the surface comes out too low.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceHeight {
    /// A point of the vertical (m); how high it lies does not matter.
    #[schemars(extend("unit" = "m"))]
    pub at: Point,
    #[serde(skip)]
    up: DVec3,
}

impl Probe for SurfaceHeight {
    fn description(&self) -> String {
        "height of the free surface on a vertical".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![SeriesField::new("height", "m", "height along -g from the origin; no number where there is no fluid")]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.up = up(world)?;
        let x = place(world, "at", self.at)?;
        inside(world, "at", x, self.up)
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let Some((bottom, top)) = self.fluid_on_the_vertical(state) else { return };
        let (step, reach) = (0.25 * state.resolution.spacing, state.kernel.0.radius());
        let (mut above, mut height) = (0.0, top + reach);
        while height >= bottom {
            let filling = self.filling(state, height);
            if filling >= 0.5 {
                row[0] = height + step * (filling - 0.5) / (filling - above);
                return;
            }
            (above, height) = (filling, height - step);
        }
    }
}

impl SurfaceHeight {
    /// The place on the vertical at `height` (m).
    fn at_height(&self, height: f64) -> DVec3 {
        let x = self.at.position();
        x + self.up * (height - x.dot(self.up))
    }

    /// Σ_f V_f W_f at `height` (m) on the vertical.
    fn filling(&self, state: &State<'_>, height: f64) -> f64 {
        state.around(self.at_height(height)).map(|(f, _, w)| state.fluid.volume(f) * w).sum()
    }

    /// Heights (m) of the lowest and the highest particle whose kernel reaches the vertical.
    fn fluid_on_the_vertical(&self, state: &State<'_>) -> Option<(f64, f64)> {
        let reach = state.kernel.0.radius();
        let mut heights: Option<(f64, f64)> = None;
        for x in state.fluid.position {
            let height = x.0.dot(self.up);
            if state.periodic.separation(x.0, self.at_height(height)).length() < reach {
                let (low, high) = heights.unwrap_or((height, height));
                heights = Some((low.min(height), high.max(height)));
            }
        }
        heights
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::probes::test_support::{TANK, measured, opened, scene};

    const GAUGE: &str = "probes: {\"gauge\": SurfaceHeight(at: (0.2, 0)), \"dry\": SurfaceHeight(at: (0.9, 0))},";

    #[test]
    fn still_water_stands_where_it_was_filled_to() {
        let mut app = measured(&scene(TANK, GAUGE));
        // The volume m/ρ of a particle is that of its cell: a hundredth of a spacing is the lattice's ripple.
        app.assert("gauge.height", 0.4, 0.03 * 0.02);
        assert!(app.value("dry.height").is_some_and(f64::is_nan));
    }

    #[test]
    fn a_rise_is_measured_to_a_fraction_of_the_spacing() {
        let mut app = measured(&scene(TANK, GAUGE));
        let before = app.value("gauge.height").unwrap_or(f64::NAN);
        app.move_fluid(|x| x + 0.0037 * DVec3::Y);
        app.measure();
        app.assert("gauge.height", before + 0.0037, 0.01 * 0.02);
    }

    #[test]
    fn the_highest_surface_counts() {
        let mut app = opened(&scene(TANK, GAUGE));
        app.move_fluid(|x| if x.y > 0.2 { x + 0.3 * DVec3::Y } else { x });
        app.measure();
        app.assert("gauge.height", 0.7, 0.03 * 0.02);
    }
}
