//! Centre of mass of a phase.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::{direction, phase};
use super::{Probe, SeriesField, State};
use crate::neighbours::PeriodicSides;
use crate::particles::{Fluid, Mass, PhaseIndex, Position};
use crate::scene::Invalid;
use crate::scene::geometry::Point;

/// Centre of mass `Σ m x / Σ m` of a phase: `x`, `y`, `z` (m), its velocity `Σ m v / Σ m`: `vx`, `vy`, `vz` (m/s), how far it
/// has gone since the start: `displacement` (m), and its mass: `mass` (kg, in 2D of a metre across the plane).
///
/// Along a periodic axis, where particles re-enter, only the velocity means something: displacements leave it out.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CenterOfMass {
    /// Name of the phase.
    pub phase: String,
    /// Direction along which the displacement counts; its length does not matter. `None` for its magnitude.
    #[serde(default)]
    #[schemars(extend("unit" = "1", "derived" = "the magnitude of the displacement"))]
    pub direction: Option<Point>,
    #[serde(skip)]
    index: u32,
    #[serde(skip)]
    start: DVec3,
    #[serde(skip)]
    along: Option<DVec3>,
    /// 1 for an axis along which the displacement counts, 0 for a periodic one.
    #[serde(skip)]
    counted: DVec3,
}

impl Probe for CenterOfMass {
    fn description(&self) -> String {
        format!("centre of mass of the phase `{}`", self.phase)
    }

    fn fields(&self) -> Vec<SeriesField> {
        let position = ["x", "y", "z"].map(|axis| SeriesField::new(axis, "m", format!("{axis} of the centre of mass")));
        let velocity = ["vx", "vy", "vz"].map(|axis| SeriesField::new(axis, "m/s", "velocity of the centre of mass"));
        let displacement = SeriesField::new("displacement", "m", "way from the start (along the direction, if given)");
        let mass = SeriesField::new("mass", "kg", "mass of the phase (in 2D of a metre across the plane)");
        position.into_iter().chain(velocity).chain([displacement, mass]).collect()
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.index = phase(world, &self.phase)?;
        self.along = self.direction.map(|point| direction(world, point)).transpose()?;
        let periodic = world.resource::<PeriodicSides>().0.map(|sides| sides.is_some());
        if (0..3).any(|axis| periodic[axis] && self.along.is_some_and(|n| n[axis] != 0.0)) {
            return Err(Invalid::new("direction", "there is no displacement along a periodic axis"));
        }
        self.counted = DVec3::from_array(periodic.map(|is_periodic| if is_periodic { 0.0 } else { 1.0 }));
        let mut fluid = world.query_filtered::<(&PhaseIndex, &Mass, &Position), With<Fluid>>();
        let own = fluid.iter(world).filter(|(phase, ..)| phase.0 == self.index);
        let (mass, moment) = own.fold((0.0, DVec3::ZERO), |(mass, moment), (_, m, x)| (mass + m.0, moment + m.0 * x.0));
        if mass == 0.0 {
            return Err(Invalid::new("phase", format!("no fluid is of the phase `{}`", self.phase)));
        }
        self.start = moment / mass;
        Ok(())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let fluid = &state.fluid;
        let (mut mass, mut moment, mut momentum) = (0.0, DVec3::ZERO, DVec3::ZERO);
        for i in fluid.rows_of(self.index) {
            let m = fluid.mass[i].0;
            mass += m;
            moment += m * fluid.position[i].0;
            momentum += m * fluid.velocity[i].0;
        }
        let (x, v) = (moment / mass, momentum / mass);
        let way = (x - self.start) * self.counted;
        row[..3].copy_from_slice(&x.to_array());
        row[3..6].copy_from_slice(&v.to_array());
        row[6] = self.along.map_or(way.length(), |n| way.dot(n));
        row[7] = mass;
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::probes::test_support::{CHANNEL, TANK, complaint, opened, scene};

    #[test]
    fn a_phase_moved_as_a_whole_has_moved_so_far() {
        let probes = r#"probes: {
            "c": CenterOfMass(phase: "water"), "d": CenterOfMass(phase: "water", direction: (0, 2)),
        },"#;
        let mut app = opened(&scene(TANK, probes));
        app.move_fluid(|x| x + DVec3::new(0.03, -0.04, 0.0));
        app.set_fluid(|_, v, _, _| *v = DVec3::new(1.0, 2.0, 0.0));
        app.measure();
        app.assert("c.x", 0.23, 1e-12);
        app.assert("c.vx", 1.0, 1e-12);
        app.assert("c.vy", 2.0, 1e-12);
        app.assert("c.displacement", 0.05, 1e-12);
        app.assert("d.displacement", -0.04, 1e-12);
        // 0.4 m times 0.2 m of water, compressed by 1 % at most.
        app.assert("c.mass", 80.0, 0.8);
        // Compressed by its own weight, the water is a little heavier below the middle.
        let y = app.value("c.y").unwrap_or_default();
        assert!(y < 0.26 && y > 0.259, "{y}");
    }

    #[test]
    fn there_is_no_displacement_along_a_periodic_axis() {
        let probe = |more: &str| format!(r#"probes: {{ "c": CenterOfMass(phase: "mud"{more}) }},"#);
        assert!(complaint(&scene(CHANNEL, &probe(", direction: (1, 0)"))).contains("periodic"));
        let mut app = opened(&scene(CHANNEL, &probe("")));
        app.move_fluid(|x| x + DVec3::new(0.03, 0.001, 0.0));
        app.measure();
        app.assert("c.displacement", 0.001, 1e-12);
    }

    #[test]
    fn a_phase_without_fluid_has_no_centre() {
        let fields = TANK.replace("(phase: \"brine\"", "(phase: \"water\"");
        assert!(complaint(&scene(&fields, "probes: {\"c\": CenterOfMass(phase: \"brine\")},")).contains("no fluid is"));
    }
}
