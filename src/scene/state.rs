//! Eq. 8, with p_max and v_max of the scene or estimated from it.

use bevy_ecs::prelude::*;

use super::columns::Depths;
use super::{Invalid, SceneDocument, SceneFacts, SceneInfo, SceneSection, SectionError};
use crate::boundary::{BodyShape, Motion};
use crate::neighbours::PeriodicSides;
use crate::phases::phases;
use crate::physics::{EquationOfState, Gravity, StateSettings};

/// The equation of state of a scene whose fluids reach `depths`, and at the start are no faster than `start_speed` (m/s).
pub(super) fn choose_state(
    world: &mut World,
    depths: Option<&Depths>,
    start_speed: f64,
) -> Result<EquationOfState, SectionError> {
    let settings = *world.resource::<StateSettings>();
    let densities: Vec<f64> = phases(world).into_iter().map(|(_, rho0)| rho0).collect();
    let (depth_pressure, height) = depths.map_or((0.0, 0.0), Depths::extremes);
    let wall_speed = greatest_wall_speed(world);
    let dam_break_speed = 2.0 * (world.resource::<Gravity>().full.length() * height).sqrt();
    let max_pressure = settings.max_pressure.unwrap_or(depth_pressure);
    let max_speed = settings.max_speed.unwrap_or(dam_break_speed.max(start_speed).max(wall_speed));
    let state = EquationOfState::new(&densities, &settings, max_pressure, max_speed);
    if state.bulk_modulus > 0.0 && state.bulk_modulus.is_finite() {
        let mut facts = world.resource_mut::<SceneFacts>();
        for (field, given, value, unit) in [
            ("max_pressure", settings.max_pressure, max_pressure, "Pa"),
            ("max_speed", settings.max_speed, max_speed, "m/s"),
        ] {
            if given.is_none() {
                facts.resolve(&format!("{}.{field}", StateSettings::NAME), format!("{value} {unit}, estimated"));
            }
        }
        return Ok(state);
    }
    let document = &world.resource::<SceneDocument>().0;
    let (gravity, sides) = (world.resource::<Gravity>().full, world.resource::<PeriodicSides>().0);
    if let Some(axis) = (0..3).find(|axis| depths.is_none() && sides[*axis].is_some() && gravity[*axis] != 0.0) {
        let message = "gravity acts along this axis, so that there is no depth to take p_max and v_max of Eq. 8 from: give \
             `equation_of_state.max_speed` (m/s), or leave these sides open";
        return Err(document.invalid(&Invalid::new(format!("periodic.{}", ["x", "y", "z"][axis]), message)).into());
    }
    let message = "the sound speed comes out as 0 or infinite: give `max_speed` (m/s) or `max_pressure` (Pa)";
    Err(document.invalid(&Invalid::new(StateSettings::NAME, message)).into())
}

/// Greatest speed (m/s) that any body is prescribed.
fn greatest_wall_speed(world: &mut World) -> f64 {
    let end_time = world.resource::<SceneInfo>().end_time;
    let mut bodies = world.query::<(&BodyShape, &Motion)>();
    bodies.iter(world).map(|(body, motion)| motion.greatest_speed(body.shape.bounds(), end_time)).fold(0.0, f64::max)
}
