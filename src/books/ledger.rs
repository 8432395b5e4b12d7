//! The entries of the books, and the system that makes them at the end of each step.

use std::ops::AddAssign;

use bevy_ecs::prelude::*;
use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::Books;
use super::sums::{Before, BodySums, KINDS, Kind, PairForces, Worksheet, sum_blocks};
use crate::clock::Clock;
use crate::neighbours::PeriodicSides;
use crate::particles::{
    Acceleration, Density, DensityRate, Fluid, Mass, Position, Pressure, ReferenceDensity, Velocity, columns,
};
use crate::physics::{EquationOfState, ForceSums, Gravity, ShiftedMass, Shifting, TensileForces};

/// Energies and works (J; J/m in 2D) and impulses (N s; N s/m) since the start.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Ledger {
    /// What the last step left for the next one; `None` before the first.
    last: Option<StepSums>,
    /// K + U + C at the start.
    pub start: f64,
    /// Σ m v at the start.
    pub start_momentum: DVec3,
    pub walls: f64,
    /// Work of each kind of force, less what walls and structures do by it.
    pub of_kind: [f64; KINDS],
    pub damping: f64,
    pub diffusion: f64,
    pub resets: f64,
    pub shifting: f64,
    pub turnover: f64,
    /// Impulse of gravity and whatever else accelerates besides pair forces.
    pub body_impulse: DVec3,
    pub wall_impulse: DVec3,
    pub structure_impulse: DVec3,
    /// Momentum changed otherwise than by kicks.
    pub damping_impulse: DVec3,
    /// ∫ (|F_body| + |F_walls| + |F_structures|) dt.
    pub impulse_turnover: f64,
}

/// Sums over the fluid between the evaluation of the forces and the second kick.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct StepSums {
    /// Δt (s) of the step.
    time_step: f64,
    /// K.
    kinetic: f64,
    /// C before and after the step's change of density, and the parts of the diffusion and of resets in it.
    compression: [f64; 2],
    diffusion: f64,
    resets: f64,
    /// Σ m v.
    momentum: DVec3,
    /// U.
    potential: f64,
    /// P of all forces together and of each kind.
    power: f64,
    power_of: [f64; KINDS],
    /// Q of all forces together and of each kind.
    product: f64,
    product_of: [f64; KINDS],
    /// Σ m a, and its part from other than pair forces.
    force: DVec3,
    body_force: DVec3,
    bodies: BodySums,
}

impl AddAssign for StepSums {
    fn add_assign(&mut self, other: Self) {
        self.kinetic += other.kinetic;
        self.compression[0] += other.compression[0];
        self.compression[1] += other.compression[1];
        self.diffusion += other.diffusion;
        self.resets += other.resets;
        self.momentum += other.momentum;
        self.potential += other.potential;
        self.power += other.power;
        self.product += other.product;
        for kind in 0..KINDS {
            self.power_of[kind] += other.power_of[kind];
            self.product_of[kind] += other.product_of[kind];
        }
        self.force += other.force;
        self.body_force += other.body_force;
    }
}

type FluidState = (
    &'static Position,
    &'static Velocity,
    &'static Acceleration,
    &'static Mass,
    &'static Density,
    &'static Pressure,
    &'static DensityRate,
    &'static ReferenceDensity,
);
type FluidColumns<'a> = (
    &'a [Position],
    &'a [Velocity],
    &'a [Acceleration],
    &'a [Mass],
    &'a [Density],
    &'a [Pressure],
    &'a [DensityRate],
    &'a [ReferenceDensity],
);

/// Enters the step in progress, just before its second kick.
pub(super) fn close_step(
    clock: Res<Clock>,
    state: Res<EquationOfState>,
    gravity: Res<Gravity>,
    periodic: Res<PeriodicSides>,
    (mut sheet, pair_forces, tensile): (ResMut<Worksheet>, Res<ForceSums>, Res<TensileForces>),
    mut blocks: Local<Vec<StepSums>>,
    fluid: Query<FluidState, With<Fluid>>,
    mut ledger: ResMut<Ledger>,
    mut books: Query<&mut Books>,
) {
    let dt = clock.time_step;
    let g = gravity_with_height(&gravity, &periodic);
    let (x, v, a, m, rho, p, rate, rho0): FluidColumns<'_> = columns(&fluid);
    let Worksheet { before, forces, bodies, .. } = &mut *sheet;
    let add_particle = |sum: &mut StepSums, i: usize| {
        let (x, v, a, m, rho, rho0) = (x[i].0, v[i].0, a[i].0, m[i].0, rho[i].0, rho0[i].0);
        let before = before[i];
        let [compression, now] = [before.density, rho].map(|rho| m * state.compression_energy(rho, rho0));
        let integrated = rho == before.density + dt * rate[i].0;
        let diffused = dt * (rate[i].0 - before.continuity);
        let PairForces { viscous, impact, ghosts, volumes } = forces[i];
        let body = m * a - pair_forces.forces[i];
        let tensile = tensile.0.get(i).copied().unwrap_or_default();
        let of_kind = [viscous, impact, ghosts, volumes, tensile, body - tensile - m * g];
        sum.kinetic += 0.5 * m * v.length_squared();
        sum.compression[0] += compression;
        sum.compression[1] += now;
        if integrated {
            sum.diffusion += m * mean_slope(&state, before.density, rho, rho0) * diffused;
        } else {
            sum.resets += now - compression - dt * m * before.taken_up(p[i].0, rho);
        }
        sum.momentum += m * v;
        sum.potential -= m * g.dot(x);
        sum.power += m * a.dot(v);
        sum.product += m * a.dot(a);
        for (kind, force) in of_kind.into_iter().enumerate() {
            sum.power_of[kind] += force.dot(v);
            sum.product_of[kind] += force.dot(a);
        }
        sum.force += m * a;
        sum.body_force += body;
    };
    let mut now = sum_blocks(&mut blocks, x.len(), add_particle);
    (now.time_step, now.bodies) = (dt, *bodies);
    ledger.enter(&now);
    books.iter_mut().for_each(|mut books| books.ledger = *ledger);
}

/// Enters the height that particles gained when they were shifted.
pub(super) fn enter_shift(
    setting: Res<Shifting>,
    shifted: Res<ShiftedMass>,
    gravity: Res<Gravity>,
    periodic: Res<PeriodicSides>,
    mut ledger: ResMut<Ledger>,
    mut books: Query<&mut Books>,
) {
    if *setting != Shifting::Off {
        ledger.shifting -= gravity_with_height(&gravity, &periodic).dot(shifted.0);
        books.iter_mut().for_each(|mut books| books.ledger = *ledger);
    }
}

/// The scene's g (m/s²) without its components along periodic axes, where there is no height.
pub(super) fn gravity_with_height(gravity: &Gravity, periodic: &PeriodicSides) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| if periodic.0[axis].is_some() { 0.0 } else { gravity.full[axis] }))
}

impl Before {
    /// What compression would have taken up (W/kg), had the density followed Eq. 5: half of it at the pressure before, half at
    /// the `pressure` (Pa) and `density` (kg/m³) that it was given.
    fn taken_up(&self, pressure: f64, density: f64) -> f64 {
        0.5 * (self.pressure / self.density + pressure / density) * self.continuity / self.density
    }
}

/// Mean of de/dρ = p/ρ² between two densities (kg/m³): the secant of e.
fn mean_slope(state: &EquationOfState, from: f64, to: f64, rho0: f64) -> f64 {
    let middle = 0.5 * (from + to);
    // By Simpson's rule, all but exact over a step: the difference of two values of e would cancel.
    let slope = |rho: f64| state.pressure(rho, rho0) / (rho * rho);
    (slope(from) + 4.0 * slope(middle) + slope(to)) / 6.0
}

impl Ledger {
    fn enter(&mut self, now: &StepSums) {
        let Some(last) = self.last.replace(*now) else {
            self.start = now.kinetic + now.potential + now.compression[1];
            self.start_momentum = now.momentum;
            self.turnover = now.kinetic;
            return;
        };
        let (dt, last_dt) = (now.time_step, last.time_step);
        // From v before the last step's second kick on, and from v now on.
        let kicks = [(&last, 0.5 * dt, 0.5 * last_dt + 0.25 * dt), (now, 0.5 * dt, 0.25 * dt)];
        let mut external = 0.0;
        for (sums, duration, lag) in kicks {
            let bodies = &sums.bodies;
            let walls = duration * bodies.power;
            self.walls += walls;
            external += walls.abs();
            for kind in 0..KINDS {
                let work = duration * (sums.power_of[kind] + lag * sums.product_of[kind] - bodies.of_kind[kind]);
                self.of_kind[kind] += work;
                if kind == Kind::Body as usize {
                    external += work.abs();
                }
            }
            self.body_impulse += duration * sums.body_force;
            self.wall_impulse += duration * bodies.walls;
            self.structure_impulse += duration * bodies.structures;
            self.impulse_turnover +=
                duration * (sums.body_force.length() + bodies.walls.length() + bodies.structures.length());
        }
        // What v would be now if only kicks had changed it: by those of the last step and of this one.
        let (duration, lag) = (0.5 * (last_dt + dt), 0.25 * (last_dt + dt));
        self.damping += now.kinetic - last.kinetic - duration * (last.power + lag * last.product);
        self.damping_impulse += now.momentum - last.momentum - duration * last.force;
        self.resets += now.compression[0] - last.compression[1] + now.resets;
        self.diffusion += now.diffusion;
        self.turnover += external + (now.potential - last.potential).abs();
    }
}
