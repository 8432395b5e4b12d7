//! How near a phase is to turning like a rigid body.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::phase;
use super::{Probe, SeriesField, State};
use crate::particles::{Fluid, PhaseIndex, Position};
use crate::scene::geometry::RigidRotation;
use crate::scene::{Invalid, Resolution};

/// Distance of a phase from the rigid rotation `v̂ = ω e × (x − c)`, r being the distance from its axis:
///
/// - `rate` (rad/s), the rate that has the phase's angular momentum: `e·Σ m (x − c) × v / Σ m r²`;
/// - `velocity`, the relative L2 error `√(Σ V |v − v̂|² / Σ V |v̂|²)`;
/// - `pressure`, the relative L2 error `√(Σ V (p − p̂)² / Σ V (½ ρ0 ω² r²)²)` against `p̂ = p_0 + ½ ρ0 ω² r²`; what p_0 is on the
///   axis the filling decides, so it is taken as the mean of `p − ½ ρ0 ω² r²`;
/// - `slip`, the mean of `e·(x − c) × v/(ω r²) − 1` over the outermost layer of particles, which lies within 1½ spacings of the one
///   that was outermost at the start.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigidRotationError {
    /// Name of the phase.
    pub phase: String,
    /// The rotation.
    pub rotation: RigidRotation,
    #[serde(skip)]
    index: u32,
    #[serde(skip)]
    rim: f64,
}

impl Probe for RigidRotationError {
    fn description(&self) -> String {
        format!("difference of the phase `{}` from a rigid rotation", self.phase)
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![
            SeriesField::new("rate", "rad/s", "rate that has the angular momentum of the phase"),
            SeriesField::new("velocity", "", "relative L2 error of the velocity"),
            SeriesField::new("pressure", "", "relative L2 error of the pressure but for a constant"),
            SeriesField::new("slip", "", "mean rate of the outermost layer over the rate of the rotation, less 1"),
        ]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.index = phase(world, &self.phase)?;
        let Resolution { dimension, spacing, .. } = *world.resource::<Resolution>();
        self.rotation.check(dimension).map_err(|invalid| invalid.under("rotation"))?;
        if self.rotation.rate == 0.0 {
            return Err(Invalid::new("rotation.rate", "must not be 0: errors are relative to it"));
        }
        let mut fluid = world.query_filtered::<(&PhaseIndex, &Position), With<Fluid>>();
        let own = fluid.iter(world).filter(|(phase, _)| phase.0 == self.index);
        self.rim = own.map(|(_, x)| self.rotation.radius(x.0)).fold(0.0, f64::max) - RIM * spacing;
        Ok(())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let fluid = &state.fluid;
        let omega = self.rotation.rate;
        let exact = |i: usize| {
            let r = self.rotation.radius(fluid.position[i].0);
            (r, 0.5 * fluid.reference_density[i].0 * (omega * r).powi(2))
        };
        let (mut volume, mut excess) = (0.0, 0.0);
        for i in fluid.rows_of(self.index) {
            volume += fluid.volume(i);
            excess += fluid.volume(i) * (fluid.pressure[i].0 - exact(i).1);
        }
        let p_0 = excess / volume;
        let (mut spin, mut inertia) = (0.0, 0.0);
        let (mut velocity, mut pressure, mut rim) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        for i in fluid.rows_of(self.index) {
            let (v, v_hat) = (fluid.velocity[i].0, self.rotation.velocity(fluid.position[i].0));
            let (r, p_hat) = exact(i);
            // e·(x − c) × v = v·v̂/ω.
            let turning = v.dot(v_hat) / omega;
            spin += fluid.mass[i].0 * turning;
            inertia += fluid.mass[i].0 * r * r;
            let weight = fluid.volume(i);
            velocity[0] += weight * v.distance_squared(v_hat);
            velocity[1] += weight * v_hat.length_squared();
            pressure[0] += weight * (fluid.pressure[i].0 - p_0 - p_hat).powi(2);
            pressure[1] += weight * p_hat * p_hat;
            if r > self.rim {
                rim[0] += turning / (omega * r * r) - 1.0;
                rim[1] += 1.0;
            }
        }
        let norm = |[error, norm]: [f64; 2]| (error / norm).sqrt();
        row.copy_from_slice(&[spin / inertia, norm(velocity), norm(pressure), rim[0] / rim[1]]);
    }
}

/// Depth (in spacings) of the outermost layer below the outermost particle of the start.
pub(crate) const RIM: f64 = 1.5;

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::probes::test_support::{TANK, complaint, opened, scene};

    const PROBE: &str =
        r#"probes: {"turn": RigidRotationError(phase: "water", rotation: (center: (0.1, 0.1), rate: -2))},"#;

    #[test]
    fn the_rotation_itself_has_no_error() {
        let mut app = opened(&scene(TANK, PROBE));
        let arm = |x: DVec3| x - DVec3::new(0.1, 0.1, 0.0);
        app.set_fluid(|x, v, p, rho| {
            *v = -2.0 * DVec3::Z.cross(arm(x));
            (*p, *rho) = (77.0 + 0.5 * 1000.0 * 4.0 * arm(x).length_squared(), 1000.0);
        });
        app.measure();
        for (field, value) in [("rate", -2.0), ("velocity", 0.0), ("pressure", 0.0), ("slip", 0.0)] {
            app.assert(&format!("turn.{field}"), value, 1e-12);
        }
    }

    #[test]
    fn a_tenth_too_fast_and_what_leaves_the_axis_are_errors() {
        let mut app = opened(&scene(TANK, PROBE));
        let arm = |x: DVec3| x - DVec3::new(0.1, 0.1, 0.0);
        app.set_fluid(|x, v, p, _| {
            *v = -2.2 * DVec3::Z.cross(arm(x)) + 0.2 * arm(x);
            *p = 0.0;
        });
        app.measure();
        // The part along the arm has no angular momentum: √(0.1² + 0.1²).
        for (field, value) in [("rate", -2.2), ("velocity", 0.02_f64.sqrt()), ("slip", 0.1)] {
            app.assert(&format!("turn.{field}"), value, 1e-12);
        }
        assert!(app.value("turn.pressure").is_some_and(|error| error > 0.1));
    }

    #[test]
    fn errors_relative_to_nothing_are_refused() {
        let still = PROBE.replace("rate: -2", "rate: 0");
        assert!(complaint(&scene(TANK, &still)).contains("must not be 0"));
    }
}
