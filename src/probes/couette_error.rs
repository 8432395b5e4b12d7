//! Error of the velocity of layers between two plates.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parameters::{flow_law, phase, plane};
use super::{CouetteFlow, CouetteLayer, Probe, SeriesField, State};
use crate::scene::Invalid;
use crate::scene::geometry::Axis;

/// Relative L2 error, `l2`: `√( Σ V (u − û)² / Σ V û² )` of the velocity u of layers between two plates against the exact steady
/// flow û ([`CouetteFlow`]) that the plates' motion drives. Beside it,
/// `exact_stress` (Pa) is its shear stress. The layers are Newtonian or Herschel–Bulkley, or one of their special cases.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CouetteError {
    /// Axis of the flow.
    pub along: Axis,
    /// Axis across the layers.
    pub across: Axis,
    /// Names of the phases of the layers, up the axis across.
    pub layers: Vec<String>,
    /// Coordinates (m) on that axis of the first plate, of the interfaces, and of the second plate.
    #[schemars(extend("unit" = "m"))]
    pub bounds: Vec<f64>,
    /// Velocities (m/s) of the two plates.
    #[schemars(extend("unit" = "m/s"))]
    pub speeds: (f64, f64),
    #[serde(skip)]
    flow: CouetteFlow,
}

impl Probe for CouetteError {
    fn description(&self) -> String {
        "velocity of layers between two plates against the exact Couette flow".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![
            SeriesField::new("l2", "", "relative L2 error of the velocity along the plates"),
            SeriesField::new("exact_stress", "Pa", "exact shear stress, the same in every layer"),
        ]
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        plane(world, self.along, self.across)?;
        if self.layers.is_empty() {
            return Err(Invalid::new("layers", "needs the phase of at least one layer"));
        }
        if self.bounds.len() != self.layers.len() + 1 || self.bounds.windows(2).any(|pair| pair[0] >= pair[1]) {
            let expected = self.layers.len() + 1;
            let message = format!("expected {expected} coordinates in m, up the axis: plate, interfaces, plate");
            return Err(Invalid::new("bounds", message));
        }
        if self.speeds.0 == self.speeds.1 {
            return Err(Invalid::new("speeds", "the plates must differ in speed: nothing flows otherwise"));
        }
        let mut layers = Vec::with_capacity(self.layers.len());
        for (k, (name, bounds)) in self.layers.iter().zip(self.bounds.windows(2)).enumerate() {
            let path = |mut invalid: Invalid| {
                invalid.path = format!("layers.{k}");
                invalid
            };
            let law = phase(world, name).and_then(|index| flow_law(world, index)).map_err(path)?;
            layers.push(CouetteLayer {
                thickness: bounds[1] - bounds[0],
                consistency: law.consistency,
                exponent: law.exponent,
                yield_stress: law.yield_stress,
            });
        }
        self.flow = CouetteFlow::new(layers, self.speeds);
        Ok(())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let fluid = &state.fluid;
        let (along, across) = (self.along.index(), self.across.index());
        let (mut error, mut norm) = (0.0, 0.0);
        for i in fluid.rows() {
            let exact = self.flow.velocity(fluid.position[i].0[across] - self.bounds[0]);
            error += fluid.volume(i) * (fluid.velocity[i].0[along] - exact).powi(2);
            norm += fluid.volume(i) * exact * exact;
        }
        row.copy_from_slice(&[(error / norm).sqrt(), self.flow.stress]);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::probes::test_support::{complaint, opened, scene};

    const LAYERS: &str = r#"
        dimension: 2, spacing: 0.005, gravity: (0, 0), end_time: 1.0, periodic: (x: (0, 0.1)),
        equation_of_state: (max_speed: 1.0),
        phases: {
            "mud": (reference_density: 1000.0, rheology: PowerLaw(consistency: 2, exponent: 0.5, max_viscosity: 9)),
            "oil": (reference_density: 1000.0, rheology: Newtonian(viscosity: 1)),
            "gel": (reference_density: 1000.0, rheology: Casson(infinite_shear_viscosity: 1, yield_stress: 1,
                max_viscosity: 9)),
        },
        fluids: [
            (phase: "mud", shape: Box(min: (0, 0), max: (0.1, 0.05)), pressure: Uniform(0)),
            (phase: "oil", shape: Box(min: (0, 0.05), max: (0.1, 0.1)), pressure: Uniform(0)),
        ],
        walls: {"plates": (shape: Box(min: (-1, 0), max: (1, 0.1)))},
    "#;
    const ERROR: &str = r#"probes: {"error": CouetteError(along: X, across: Y, layers: ["mud", "oil"],
        bounds: [0, 0.05, 0.1], speeds: (0, 0.3))},"#;

    #[test]
    fn the_exact_flow_has_no_error_and_a_tenth_more_has_a_tenth() {
        // 2 √γ̇ = τ in the mud and γ̇ = τ in the oil: at τ = 4 Pa both are sheared at 4/s, which makes 0.4 m/s.
        for (factor, error) in [(1.0, 0.0), (1.1, 0.1)] {
            let mut app = opened(&scene(LAYERS, &ERROR.replace("(0, 0.3)", "(0, 0.4)")));
            app.set_fluid(|x, v, _, _| *v = factor * 4.0 * x.y * DVec3::X);
            app.measure();
            app.assert("error.l2", error, 1e-12);
            app.assert("error.exact_stress", 4.0, 1e-12);
        }
    }

    #[test]
    fn layers_that_make_no_sense_are_refused() {
        for (what, with, word) in [
            ("across: Y", "across: X", "another axis"),
            ("[0, 0.05, 0.1]", "[0, 0.1]", "expected 3 coordinates"),
            ("[0, 0.05, 0.1]", "[0, 0.15, 0.1]", "expected 3 coordinates"),
            ("(0, 0.3)", "(0.3, 0.3)", "differ in speed"),
            (r#"["mud", "oil"]"#, "[]", "at least one layer"),
            (r#""oil"], "#, r#""oyl"], "#, "`oil`"),
            (r#""oil"], "#, r#""gel"], "#, "must be"),
        ] {
            let said = complaint(&scene(LAYERS, &ERROR.replace("],\n", "], ").replace(what, with)));
            assert!(said.contains(word), "{with}: {said}");
        }
    }
}
