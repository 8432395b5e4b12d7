//! Pressure at a point.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::{inside, place};
use super::{Probe, SeriesField, State};
use crate::boundary::{Body, Motion};
use crate::scene::geometry::Point;
use crate::scene::{Invalid, unknown};

/// `pressure` (Pa) at a place x by the formula for ghosts (Eq. 15; Adami et al. 2012):
///
/// `p = [Σ_f p_f W_f + g·Σ_f ρ_f (x − x_f) W_f] / Σ_f W_f`
///
/// At rest it is exact up to the curvature of p over a kernel, on a wall and off it. While no particle is within 1.5 spacings, the
/// place is dry, and the pressure of the fluid below or before it is not its own: there is no number then, or that of `dry`.
///
/// What is averaged over is the kernel's reach, whatever the size of the sensor that it stands for.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressurePoint {
    /// The place (m); at the start, if it moves.
    #[schemars(extend("unit" = "m"))]
    pub at: Point,
    /// Name of the wall or structure with which it moves, as a sensor in a turning drum does.
    #[serde(default)]
    #[schemars(extend("derived" = "stays where it is"))]
    pub moves_with: Option<String>,
    /// What it reads while it is dry (Pa): a sensor in a wall reads the pressure of the air, 0.
    #[serde(default)]
    #[schemars(extend("unit" = "Pa", "derived" = "no number"))]
    pub dry: Option<f64>,
    #[serde(skip)]
    motion: Motion,
}

/// Distance (in spacings) of the nearest particle beyond which a place is dry.
pub(crate) const DRY: f64 = 1.5;

impl Probe for PressurePoint {
    fn description(&self) -> String {
        "pressure at a point, Eq. 15".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![SeriesField::new("pressure", "Pa", "pressure; no number, or that of `dry`, while it is dry")]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        let x = place(world, "at", self.at)?;
        if let Some(name) = &self.moves_with {
            let mut query = world.query::<(&Body, &Motion)>();
            let bodies: Vec<_> = query.iter(world).collect();
            let Some((_, motion)) = bodies.iter().find(|(body, _)| body.name == *name) else {
                return Err(unknown(
                    "moves_with",
                    "wall or structure",
                    name,
                    bodies.iter().map(|(body, _)| &*body.name),
                ));
            };
            self.motion = (*motion).clone();
        }
        inside(world, "at", x, DVec3::ZERO)
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let (mut sum_pw, mut sum_rho_r_w, mut sum_w) = (0.0, DVec3::ZERO, 0.0);
        let mut nearest = f64::INFINITY;
        let start = self.at.position();
        let place = self.motion.at(state.clock.time).map_or(start, |moved| moved.of(start).0);
        for (f, r, w) in state.around(place) {
            sum_pw += state.fluid.pressure[f].0 * w;
            sum_rho_r_w += r * (state.fluid.density[f].0 * w);
            sum_w += w;
            nearest = nearest.min(r.length());
        }
        if nearest <= DRY * state.resolution.spacing {
            row[0] = (sum_pw + state.gravity.now.dot(sum_rho_r_w)) / sum_w;
        } else if let Some(dry) = self.dry {
            row[0] = dry;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::clock::Clock;
    use crate::probes::test_support::{TANK, complaint, measured, opened, scene};

    #[test]
    fn a_column_at_rest_is_exact_on_the_floor_and_inside() {
        let probes = r#"probes: {
            "floor_pressure": PressurePoint(at: (0.2, 0)),
            "side": PressurePoint(at: (0, 0.1)),
            "above": PressurePoint(at: (0.2, 0.9)),
            "little_above": PressurePoint(at: (0.2, 0.42)),
            "in_air": PressurePoint(at: (0.2, 0.42), dry: 0.0),
            "just_above": PressurePoint(at: (0.2, 0.416)),
        },"#;
        let mut app = opened(&scene(TANK, probes));
        // Incompressible on purpose: then the pressure is linear and the formula has no error.
        app.set_fluid(|x, _, p, rho| {
            *rho = if x.y < 0.2 { 1200.0 } else { 1000.0 };
            *p = 9.81 * (1000.0 * (0.4 - x.y).min(0.2) + 1200.0 * (0.2 - x.y).max(0.0));
        });
        app.measure();
        app.assert("floor_pressure.pressure", 9.81 * (200.0 + 240.0), 1e-9);
        app.assert("side.pressure", 9.81 * (200.0 + 120.0), 1e-9);
        assert!(app.value("above.pressure").is_some_and(f64::is_nan));
        // The highest particles, at (0.2 ± 0.01, 0.39), are 0.028 and 0.032 m away: within 0.03 m and not.
        app.assert("just_above.pressure", -9.81 * 16.0, 1e-9);
        assert!(app.value("little_above.pressure").is_some_and(f64::is_nan));
        app.assert("in_air.pressure", 0.0, 0.0);
    }

    /// A sensor in the side of a box that has turned by half: it lies where the other side was.
    #[test]
    fn a_sensor_moves_with_its_body() {
        let text = |sensor: &str| {
            format!(
                r#"Scene(
            dimension: 2, spacing: 0.02, gravity: (0.0, 0.0), end_time: 2.0, equation_of_state: (max_speed: 1.0),
            phases: {{ "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)) }},
            fluids: [(phase: "water", shape: Box(min: (-0.4, -0.1), max: (0.4, 0.1)), pressure: Uniform(0.0))],
            walls: {{ "drum": (
                shape: Box(min: (-0.4, -0.1), max: (0.4, 0.1)),
                motion: Rotation(center: (0.0, 0.0), rate: 1.5707963267948966)) }},
            probes: {{ "p": PressurePoint(at: (0.2, 0.0), moves_with: "{sensor}") }},
        )"#
            )
        };
        let mut app = opened(&text("drum"));
        app.set_fluid(|x, _, p, _| *p = 100.0 * x.x);
        app.measure();
        app.assert("p.pressure", 20.0, 1e-9);
        app.0.world_mut().resource_mut::<Clock>().time = 2.0;
        app.measure();
        app.assert("p.pressure", -20.0, 1e-9);
        let told = complaint(&text("drun"));
        assert!(told.contains("moves_with") && told.contains("did you mean `drum`?"), "{told}");
    }

    #[test]
    fn the_start_of_a_run_is_hydrostatic() {
        let mut app = measured(&scene(TANK, "probes: {\"p\": PressurePoint(at: (0.2, 0))},"));
        app.assert("p.pressure", 9.81 * (200.0 + 240.0), 0.01 * 4316.0);
    }
}
