//! Shear stress in a phase.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::{box_inside, phase};
use super::{Probe, SeriesField, State};
use crate::scene::geometry::Shape;
use crate::scene::{Invalid, Resolution};

/// Shear stress `τ = μ γ̇` (√(½ τ:τ) of the viscous stress τ = 2μD) of a phase (Pa): its `mean` over the volume, `Σ V τ / Σ V`,
/// its `least` and its `greatest` value.
///
/// Nearer to an interface than the kernel reaches, γ̇ is smeared over both sides: keep `within` as far away.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShearStress {
    /// Name of the phase.
    pub phase: String,
    /// The part of it that counts (m); `None` for all of it.
    #[serde(default)]
    #[schemars(extend("unit" = "m", "derived" = "all of it"))]
    pub within: Option<Shape>,
    #[serde(skip)]
    index: u32,
}

impl Probe for ShearStress {
    fn description(&self) -> String {
        format!("shear stress μ γ̇ of the phase `{}`", self.phase)
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![
            SeriesField::new("mean", "Pa", "mean shear stress; no number where the phase is not"),
            SeriesField::new("least", "Pa", "least shear stress of a particle"),
            SeriesField::new("greatest", "Pa", "greatest shear stress of a particle"),
        ]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        self.index = phase(world, &self.phase)?;
        let dimension = world.resource::<Resolution>().dimension;
        let Some(shape) = &self.within else { return Ok(()) };
        shape.check(dimension).map_err(|invalid| invalid.under("within"))?;
        box_inside(world, "within", shape.bounds())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let fluid = &state.fluid;
        let (mut sum, mut volume) = (0.0, 0.0);
        let (mut least, mut greatest) = (f64::NAN, f64::NAN);
        for i in fluid.rows_of(self.index) {
            if self.within.as_ref().is_some_and(|shape| shape.signed_distance(fluid.position[i].0) > 0.0) {
                continue;
            }
            let stress = fluid.viscosity[i].0 * fluid.shear_rate[i].0;
            sum += fluid.volume(i) * stress;
            volume += fluid.volume(i);
            (least, greatest) = (stress.min(least), stress.max(greatest));
        }
        row.copy_from_slice(&[sum / volume, least, greatest]);
    }
}

#[cfg(test)]
mod tests {
    use bevy_ecs::prelude::*;

    use crate::particles::{Fluid, Position, ShearRate, Viscosity};
    use crate::probes::test_support::{TANK, complaint, opened, scene};

    #[test]
    fn the_mean_is_taken_over_the_part_that_counts() {
        let probes = r#"probes: {
            "all": ShearStress(phase: "water"),
            "low": ShearStress(phase: "water", within: Box(min: (0, 0), max: (0.4, 0.3))),
            "none": ShearStress(phase: "water", within: Box(min: (0, 0), max: (0.4, 0.1))),
        },"#;
        let mut app = opened(&scene(TANK, probes));
        let world = app.0.world_mut();
        let mut fluid = world.query_filtered::<(&Position, &mut Viscosity, &mut ShearRate), With<Fluid>>();
        for (x, mut mu, mut rate) in fluid.iter_mut(world) {
            // A stress of 2 Pa below y = 0.3 m and of 6 Pa above it, whatever μ is.
            mu.0 = 1.0 + x.0.x;
            rate.0 = if x.0.y < 0.3 { 2.0 } else { 6.0 } / mu.0;
        }
        app.measure();
        // The lower half is a little denser, and its particles as much heavier.
        app.assert("all.mean", 4.0, 1e-9);
        app.assert("all.least", 2.0, 1e-12);
        app.assert("all.greatest", 6.0, 1e-12);
        app.assert("low.mean", 2.0, 1e-12);
        assert!(app.value("none.mean").is_some_and(f64::is_nan));
    }

    #[test]
    fn a_part_outside_the_scene_is_refused() {
        for within in ["min: (5, 0), max: (6, 1)", "min: (0, -3), max: (0.4, -2)"] {
            let probe = format!(r#"probes: {{"s": ShearStress(phase: "water", within: Box({within}))}},"#);
            let said = complaint(&scene(TANK, &probe));
            assert!(said.contains("lies outside the scene"), "{said}");
        }
    }

    #[test]
    fn shapes_of_another_dimension_are_refused() {
        let probe = r#"probes: {"s": ShearStress(phase: "water", within: Sphere(center: (0, 0, 0), radius: 1))},"#;
        assert!(complaint(&scene(TANK, probe)).contains("3D shape"));
    }
}
