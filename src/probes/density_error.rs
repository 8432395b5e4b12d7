//! Compression of the fluid, and particles that went where no fluid goes.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Probe, SeriesField, State};
use crate::boundary::{BodyShape, InverseMotion, Motion};
use crate::scene::{FilledFluids, Invalid};

/// Compression |ρ/ρ0 − 1| of the fluid, the `greatest` and the root mean square `rms` over particles, and two counts of
/// particles:
///
/// - `lost`: more than half a spacing outside the box that bounds all walls, their openings, structures and fluids of the start;
/// - `inside_wall`: deeper than half a spacing in a wall or structure, wherever it has moved by then.
#[derive(Component, Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DensityError {
    #[serde(skip)]
    bounds: (DVec3, DVec3),
    #[serde(skip)]
    bodies: Vec<(BodyShape, Motion)>,
    #[serde(skip)]
    moved: Vec<Option<InverseMotion>>,
}

/// Depth (in spacings) in a body below which a particle counts as inside, and distance from the scene beyond which it counts as lost.
pub(crate) const DEPTH: f64 = 0.5;

impl Probe for DensityError {
    fn description(&self) -> String {
        "compression of the fluid and particles gone astray".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![
            SeriesField::new("greatest", "", "greatest |rho/rho0 - 1|"),
            SeriesField::new("rms", "", "root mean square of rho/rho0 - 1"),
            SeriesField::new("lost", "", "particles outside the bounds of the scene"),
            SeriesField::new("inside_wall", "", "particles deeper than half a spacing in a wall or structure"),
        ]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.bounds = world.resource::<FilledFluids>().bounds();
        let mut bodies = world.query::<(&BodyShape, &Motion)>();
        self.bodies = bodies.iter(world).map(|(body, motion)| (body.clone(), motion.clone())).collect();
        Ok(())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let fluid = &state.fluid;
        let (mut greatest, mut sum, mut lost, mut inside): (f64, f64, u32, u32) = (0.0, 0.0, 0, 0);
        self.moved.clear();
        self.moved.extend(self.bodies.iter().map(|(_, motion)| motion.at(state.clock.time).map(|now| now.inverse())));
        let depth = DEPTH * state.resolution.spacing;
        for i in fluid.rows() {
            let compression = fluid.density[i].0 / fluid.reference_density[i].0 - 1.0;
            greatest = greatest.max(compression.abs());
            sum += compression * compression;
            let x = state.periodic.wrap(fluid.position[i].0);
            lost += u32::from((x.clamp(self.bounds.0, self.bounds.1) - x).abs().max_element() > depth);
            let mut bodies = self.bodies.iter().zip(&self.moved);
            let is_in = |body: &BodyShape, moved: &Option<InverseMotion>| {
                body.clearance_moved(state.periodic, moved.as_ref(), x) < -depth
            };
            inside += u32::from(bodies.any(|((body, _), moved)| is_in(body, moved)));
        }
        let rms = (sum / fluid.rows().len() as f64).sqrt();
        row.copy_from_slice(&[greatest, rms, f64::from(lost), f64::from(inside)]);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::clock::Clock;
    use crate::probes::test_support::{TANK, opened, scene};

    #[test]
    fn compression_and_strays_are_counted() {
        let mut app = opened(&scene(TANK, "probes: {\"rho\": DensityError},"));
        app.set_fluid(|x, _, _, rho| *rho = if x.y < 0.2 { 1200.0 * 1.02 } else { 1000.0 * 0.99 });
        app.move_fluid(|x| match (x.x, x.y) {
            // Two particles through the side and one of them out of the scene; one into the floor.
            (x0, y0) if x0 > 0.38 && y0 > 0.38 => DVec3::new(0.45, 0.3, 0.0),
            (x0, y0) if x0 > 0.38 && y0 > 0.36 => DVec3::new(1.1, 0.3, 0.0),
            (x0, y0) if x0 < 0.02 && y0 < 0.02 => DVec3::new(0.1, -0.011, 0.0),
            _ => x,
        });
        app.measure();
        app.assert("rho.greatest", 0.02, 1e-12);
        app.assert("rho.rms", (0.5_f64 * (4e-4 + 1e-4)).sqrt(), 1e-12);
        app.assert("rho.lost", 1.0, 0.0);
        app.assert("rho.inside_wall", 3.0, 0.0);
    }

    /// A drum that has turned by a quarter has its long side where its short side was.
    #[test]
    fn bodies_are_looked_for_where_they_have_moved() {
        let text = r#"Scene(
            dimension: 2, spacing: 0.02, gravity: (0.0, 0.0), end_time: 1.0, equation_of_state: (max_speed: 1.0),
            phases: { "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)) },
            fluids: [(phase: "water", shape: Box(min: (-0.4, -0.1), max: (0.4, 0.1)), pressure: Uniform(0.0))],
            walls: { "drum": (
                shape: Box(min: (-0.4, -0.1), max: (0.4, 0.1)),
                motion: Rotation(center: (0.005, 0.0), rate: 1.5707963267948966)) },
            probes: { "rho": DensityError },
        )"#;
        let mut app = opened(text);
        app.measure();
        app.assert("rho.inside_wall", 0.0, 0.0);
        // One particle less than half a spacing beyond the wall's surface, one a little more.
        app.move_fluid(|x| match (x.x, x.y) {
            (x0, y0) if x0 > 0.38 && y0 > 0.08 => DVec3::new(0.409, y0, 0.0),
            (x0, y0) if x0 > 0.38 && y0 < -0.08 => DVec3::new(0.411, y0, 0.0),
            _ => x,
        });
        app.measure();
        app.assert("rho.lost", 1.0, 0.0);
        app.assert("rho.inside_wall", 1.0, 0.0);
        // A quarter of a turn later, with the fluid where it was: the drum is 0.2 m wide, and of 40 columns of 10 particles 11
        // are in it or no deeper than half a spacing in its wall.
        app.0.world_mut().resource_mut::<Clock>().time = 1.0;
        app.measure();
        app.assert("rho.inside_wall", 290.0, 0.0);
    }
}
