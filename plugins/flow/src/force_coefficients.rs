//! Drag and lift coefficients.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use storegga::boundary::{Body, Structure};
use storegga::phases::Phase;
use storegga::probes::{Probe, SeriesField, State};
use storegga::scene::geometry::{Point, coordinates};
use storegga::scene::{Invalid, Resolution, unknown};

/// Force of the fluid on a structure, without dimension: `C = F/(½ ρ U² A)`, with the frontal area A = D × length of the
/// structure in 2D (1 m where it has none): `drag`, `lift`, and their parts `pressure_drag`, `viscous_drag`, `pressure_lift`,
/// `viscous_lift`. With a `phase` also `reynolds`, the number Re = ρU²/τ of a fluid that need not be Newtonian (in 2D), with the stress τ that its
/// flow curve has at the shear rate U/D: the force is then drawn over it as in laws for pipes hit by slides.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ForceCoefficients {
    /// Name of the structure.
    pub structure: String,
    /// Velocity U (m/s) of the flow; drag is along it, lift across it (to its left in 2D; in 3D all that is not drag).
    #[schemars(extend("unit" = "m/s"))]
    pub velocity: Point,
    /// Density ρ (kg/m³) of the fluid.
    #[schemars(extend("unit" = "kg/m³", "exclusiveMinimum" = 0.0))]
    pub density: f64,
    /// Frontal width D (m) in 2D, frontal area A (m²) in 3D.
    #[schemars(extend("unit" = "m; m² in 3D", "exclusiveMinimum" = 0.0))]
    pub frontal: f64,
    /// Phase that flows past, for the Reynolds number.
    #[serde(default)]
    #[schemars(extend("derived" = "no Reynolds number"))]
    pub phase: Option<String>,
    #[serde(skip)]
    reynolds: Option<f64>,
}

impl Probe for ForceCoefficients {
    fn description(&self) -> String {
        format!("force coefficients of the structure `{}`", self.structure)
    }

    fn fields(&self) -> Vec<SeriesField> {
        let coefficients = [
            ("drag", "force along the flow over ½ρU²A"),
            ("lift", "force across the flow over ½ρU²A"),
            ("pressure_drag", "part of the drag from the pressure"),
            ("viscous_drag", "part of the drag from the viscous stress"),
            ("pressure_lift", "part of the lift from the pressure"),
            ("viscous_lift", "part of the lift from the viscous stress"),
        ]
        .map(|(name, meaning)| SeriesField::new(name, "", meaning));
        let reynolds =
            self.phase.as_ref().map(|_| SeriesField::new("reynolds", "", "ρU²/τ, τ the stress at the shear rate U/D"));
        coefficients.into_iter().chain(reynolds).collect()
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        let dimension = world.resource::<Resolution>().dimension;
        coordinates(self.velocity, dimension).map_err(|wrong| wrong.under("velocity"))?;
        if self.velocity.position() == DVec3::ZERO {
            return Err(Invalid::new("velocity", "must not be the null vector"));
        }
        let area = if dimension == 2 { "m" } else { "m²" };
        for (name, value, unit) in [("density", self.density, "kg/m³"), ("frontal", self.frontal, area)] {
            if value <= 0.0 {
                return Err(Invalid::new(name, format!("must be greater than 0, got {value} {unit}")));
            }
        }
        let mut bodies = world.query_filtered::<&Body, With<Structure>>();
        let known: Vec<&str> = bodies.iter(world).map(|body| body.name.as_str()).collect();
        if !known.contains(&self.structure.as_str()) {
            return Err(unknown("structure", "structure", &self.structure, known));
        }
        let Some(name) = &self.phase else { return Ok(()) };
        if dimension == 3 {
            return Err(Invalid::new("phase", "in 3D there is a frontal area and no width: leave `phase` out"));
        }
        let speed = self.velocity.position().length();
        let stress = stress(world, name, speed / self.frontal)?;
        self.reynolds = Some(self.density * speed * speed / stress);
        Ok(())
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let Some((_, structure, load)) = state.structures.iter().find(|(body, ..)| body.name == self.structure) else {
            return;
        };
        let (u, plane) = (self.velocity.position(), state.resolution.dimension == 2);
        let along = u.normalize();
        let scale = 0.5 * self.density * u.length_squared() * self.frontal * structure.length;
        let drag = |force: DVec3| force.dot(along) / scale;
        // The lift of a part is its component along the lift of the whole, so that the parts add up.
        let across = if plane { DVec3::Z.cross(along) } else { load.force().reject_from(along).normalize_or_zero() };
        let lift = |force: DVec3| force.dot(across) / scale;
        let (pressure, viscous) = (load.pressure_force, load.viscous_force);
        let coefficients =
            [drag(load.force()), lift(load.force()), drag(pressure), drag(viscous), lift(pressure), lift(viscous)];
        row.iter_mut().zip(coefficients.into_iter().chain(self.reynolds)).for_each(|(place, value)| *place = value);
    }
}

/// τ = μ(γ̇) γ̇ (Pa) of the phase `name` at the shear rate `rate` (1/s) and no pressure.
fn stress(world: &mut World, name: &str, rate: f64) -> Result<f64, Invalid> {
    let mut phases = world.query::<(EntityRef<'_>, &Phase)>();
    let Some((entity, phase)) = phases.iter(world).find(|(_, phase)| phase.name == name) else {
        let known: Vec<&str> = phases.iter(world).map(|(_, phase)| phase.name.as_str()).collect();
        return Err(unknown("phase", "phase", name, known));
    };
    let viscosity = phase.rheology.curve.and_then(|curve| curve(entity, rate, 0.0));
    match viscosity.map(|viscosity| viscosity * rate) {
        Some(stress) if stress > 0.0 => Ok(stress),
        _ => Err(Invalid::new("phase", format!("the rheology of `{name}` has no stress of its own at a shear rate"))),
    }
}
