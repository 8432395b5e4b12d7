//! The books as a probe.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::ledger::{Ledger, gravity_with_height};
use super::sums::Kind;
use crate::probes::{Probe, SeriesField, State};

/// Books of energy, momentum and mass: energies, works and impulses since the start, and what is left (`residual`,
/// `relative_residual`, `momentum_residual`). The page `docs/books.md` has every field; it makes a step a quarter to a third longer.
#[derive(Component, Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Books {
    #[serde(skip)]
    pub(super) ledger: Ledger,
}

/// Fields in J (J/m in 2D): energies of the moment, works on the fluid since the start, what is left.
const ENERGY_FIELDS: [(&str, &str); 16] = [
    ("kinetic", "K"),
    ("potential", "U, in the gravity of the scene, without its part along periodic axes"),
    ("compression", "C, of the whole pressure of Eq. 7"),
    ("walls", "work of walls and structures that move"),
    ("body", "work of other accelerations than by pair forces and the gravity of the scene"),
    ("damping", "kinetic energy changed otherwise than by forces"),
    ("viscous", "work of the viscous force, less that of walls: dissipated"),
    ("impact", "work of the impact pressure of walls, less that of walls: dissipated"),
    ("tensile", "work of the control of tension"),
    ("diffusion", "compression changed by the diffusion of density"),
    ("resets", "densities set anew: compression changed otherwise than by their rate of change"),
    ("shifting", "height gained by particles that were shifted"),
    ("ghosts", "pressure of ghosts, less the work of walls and the fluid's compression by them"),
    ("volumes", "what the pressure force does and the continuity equation does not take up, between fluid particles"),
    ("residual", "K + U + C less its value at the start and less all works"),
    ("turnover", "energy that gravity, walls and body forces have put to work, and K at the start"),
];

/// Impulses (N s; N s/m in 2D), a field for each axis.
const IMPULSE_FIELDS: [(&str, &str); 4] = [
    ("impulse_body", "impulse of gravity and of other accelerations than by pair forces"),
    ("impulse_walls", "impulse of walls"),
    ("impulse_structures", "impulse of structures"),
    ("impulse_damping", "momentum changed otherwise than by forces"),
];

impl Probe for Books {
    fn description(&self) -> String {
        "books of energy, momentum and mass (per metre of length in 2D)".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        let mut fields: Vec<SeriesField> =
            ENERGY_FIELDS.iter().map(|(name, meaning)| SeriesField::new(*name, "J", *meaning)).collect();
        fields.push(SeriesField::new("relative_residual", "", "residual over turnover; 0 before anything moves"));
        fields.push(SeriesField::new("mass", "kg", "mass of the fluid"));
        fields.push(SeriesField::new("volume", "m³", "volume of the fluid (m² in 2D)"));
        for (name, meaning) in IMPULSE_FIELDS {
            fields.extend(["x", "y", "z"].map(|axis| SeriesField::new(format!("{name}_{axis}"), "N s", meaning)));
        }
        let residual = "greatness of the momentum less its value at the start and less all impulses";
        fields.push(SeriesField::new("momentum_residual", "N s", residual));
        let relative = "the same over the time integral of all forces; 0 without any";
        fields.push(SeriesField::new("relative_momentum_residual", "", relative));
        fields
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        let fluid = &state.fluid;
        let g = gravity_with_height(state.gravity, state.periodic);
        let [mut kinetic, mut potential, mut compression, mut mass, mut volume] = [0.0; 5];
        let mut momentum = DVec3::ZERO;
        for i in fluid.rows() {
            let (m, v) = (fluid.mass[i].0, fluid.velocity[i].0);
            let (rho, rho0) = (fluid.density[i].0, fluid.reference_density[i].0);
            kinetic += 0.5 * m * v.length_squared();
            potential -= m * g.dot(fluid.position[i].0);
            compression += m * state.equation_of_state.compression_energy(rho, rho0);
            mass += m;
            volume += fluid.volume(i);
            momentum += m * v;
        }
        let books = &self.ledger;
        let of = |kind: Kind| books.of_kind[kind as usize];
        let works = [
            books.walls,
            of(Kind::Body),
            books.damping,
            of(Kind::Viscous),
            of(Kind::Impact),
            of(Kind::Tensile),
            books.diffusion,
            books.resets,
            books.shifting,
            of(Kind::Ghosts),
            of(Kind::Volumes),
        ];
        let residual = kinetic + potential + compression - books.start - works.iter().sum::<f64>();
        let impulses = [books.body_impulse, books.wall_impulse, books.structure_impulse, books.damping_impulse];
        let unexplained = (momentum - books.start_momentum - impulses.iter().sum::<DVec3>()).length();
        let values = [kinetic, potential, compression]
            .into_iter()
            .chain(works)
            .chain([residual, books.turnover, ratio(residual, books.turnover), mass, volume])
            .chain(impulses.iter().flat_map(DVec3::to_array))
            .chain([unexplained, ratio(unexplained, books.impulse_turnover)]);
        row.iter_mut().zip(values).for_each(|(place, value)| *place = value);
    }
}

/// `part/whole`, 0 without a whole.
fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}
