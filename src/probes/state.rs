//! The state as probes see it: columns and resources, to be read and not to be written.

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use glam::DVec3;

use crate::boundary::{Body, Load, Structure};
use crate::clock::Clock;
use crate::kernels::SmoothingKernel;
use crate::neighbours::{Neighbours, PeriodicSides};
use crate::particles::{
    Density, Fluid, Mass, ParticleId, PhaseIndex, Position, Pressure, ReferenceDensity, ShearRate, Velocity, Viscosity,
    columns,
};
use crate::physics::{EquationOfState, Gravity};
use crate::scene::Resolution;

type FluidData = (
    &'static ParticleId,
    &'static PhaseIndex,
    &'static Position,
    &'static Velocity,
    &'static Mass,
    &'static Density,
    &'static ReferenceDensity,
    &'static Pressure,
    &'static Viscosity,
    &'static ShearRate,
);

/// Structures with their loads.
pub type Structures<'w, 's> = Query<'w, 's, (&'static Body, &'static Structure, &'static Load)>;

/// What the system of a probe borrows from the world.
#[derive(SystemParam)]
pub struct StateParam<'w, 's> {
    clock: Res<'w, Clock>,
    resolution: Res<'w, Resolution>,
    equation_of_state: Res<'w, EquationOfState>,
    gravity: Res<'w, Gravity>,
    kernel: Res<'w, SmoothingKernel>,
    periodic: Res<'w, PeriodicSides>,
    neighbours: Res<'w, Neighbours>,
    fluid: Query<'w, 's, FluidData, With<Fluid>>,
    structures: Structures<'w, 's>,
}

/// The fluid particles, one slice a quantity; a particle has the same row in each.
#[derive(Debug, Clone, Copy)]
pub struct FluidColumns<'a> {
    /// Identities.
    pub id: &'a [ParticleId],
    /// Phases.
    pub phase: &'a [PhaseIndex],
    /// Positions x (m).
    pub position: &'a [Position],
    /// Velocities v (m/s).
    pub velocity: &'a [Velocity],
    /// Masses m (kg; kg/m in 2D).
    pub mass: &'a [Mass],
    /// Densities ρ (kg/m³).
    pub density: &'a [Density],
    /// Reference densities ρ0 (kg/m³).
    pub reference_density: &'a [ReferenceDensity],
    /// Pressures p (Pa).
    pub pressure: &'a [Pressure],
    /// Dynamic viscosities μ (Pa s).
    pub viscosity: &'a [Viscosity],
    /// Shear rates γ̇ (1/s).
    pub shear_rate: &'a [ShearRate],
}

impl<'a> FluidColumns<'a> {
    /// Rows of all particles.
    #[must_use]
    pub fn rows(&self) -> std::ops::Range<usize> {
        0..self.position.len()
    }

    /// Rows of the particles of the phase with this index.
    pub fn rows_of(&self, phase: u32) -> impl Iterator<Item = usize> + use<'a> {
        let phases = self.phase;
        self.rows().filter(move |&i| phases[i].0 == phase)
    }

    /// Volume V = m/ρ (m³; m² in 2D) of the particle in row `i`.
    #[must_use]
    pub fn volume(&self, i: usize) -> f64 {
        self.mass[i].0 / self.density[i].0
    }
}

/// The state at the time of an output.
pub struct State<'a> {
    /// Simulated time.
    pub clock: &'a Clock,
    /// Dimension, spacing, smoothing length.
    pub resolution: &'a Resolution,
    /// Bulk modulus and background pressure.
    pub equation_of_state: &'a EquationOfState,
    /// Gravity.
    pub gravity: &'a Gravity,
    /// The kernel of the run.
    pub kernel: &'a SmoothingKernel,
    /// Periodic sides.
    pub periodic: &'a PeriodicSides,
    /// Neighbour lists and kernels of the last step; none before the first one.
    pub neighbours: &'a Neighbours,
    /// The fluid.
    pub fluid: FluidColumns<'a>,
    /// The structures.
    pub structures: &'a Structures<'a, 'a>,
}

impl StateParam<'_, '_> {
    /// The state, as slices.
    pub(super) fn view(&self) -> State<'_> {
        let (id, phase, position, velocity, mass, density, reference_density, pressure, viscosity, shear_rate) =
            columns(&self.fluid);
        State {
            clock: &self.clock,
            resolution: &self.resolution,
            equation_of_state: &self.equation_of_state,
            gravity: &self.gravity,
            kernel: &self.kernel,
            periodic: &self.periodic,
            neighbours: &self.neighbours,
            fluid: FluidColumns {
                id,
                phase,
                position,
                velocity,
                mass,
                density,
                reference_density,
                pressure,
                viscosity,
                shear_rate,
            },
            structures: &self.structures,
        }
    }
}

impl State<'_> {
    /// `(row, x − x_f, W)` of every fluid particle f whose kernel reaches the place `x` (m), through periodic sides too.
    pub fn around(&self, x: DVec3) -> impl Iterator<Item = (usize, DVec3, f64)> + '_ {
        let radius_squared = self.kernel.0.radius().powi(2);
        self.fluid.rows().filter_map(move |f| {
            let r = self.periodic.separation(x, self.fluid.position[f].0);
            let distance_squared = r.length_squared();
            (distance_squared < radius_squared).then(|| (f, r, self.kernel.value(distance_squared.sqrt())))
        })
    }
}
