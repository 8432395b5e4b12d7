//! The pair forces of a step, told apart: what [`momentum`](crate::physics::momentum) adds up, and `N_ij` and `G_ib`.

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;

use super::sums::{BLOCK, BodySums, Kind, PairForces, Worksheet, sum};
use crate::kernels::SmoothingKernel;
use crate::lanes::fields;
use crate::neighbours::{Neighbours, sum_near};
use crate::particles::{Fluid, Gathered, Records, Solid, Vector, Wall, WallVelocity, Workspace, columns};
use crate::physics::{
    FluidColumns, FluidState, GhostColumns, GhostState, ImpactPressure, Momentum, MomentumSettings, PressureAverage,
    ViscousForce, impact_force, mean_viscosity, pair_forces as forces_of, with_forms,
};

fields! {
    /// What the books need of a particle.
    pub(super) struct Account<D> {
        momentum: Momentum<D>,
        /// V.
        volume: f64,
        /// v_w of a ghost.
        wall_velocity: Vector<D>,
        /// One of [`FLUID`], [`WALL`], [`STRUCTURE`].
        table: f64,
    }
}

const FLUID: f64 = 0.0;
const WALL: f64 = 1.0;
const STRUCTURE: f64 = 2.0;

/// The records of walls or of structures.
fn ghosts<'a, const D: usize>(
    table: f64,
    ((x, v, volume, rho, p, slip), v_w): (GhostColumns<'a>, &'a [WallVelocity]),
) -> impl Fn(usize) -> Gathered<D, Account<D>> + Sync + Send + use<'a, D> {
    move |b: usize| {
        let momentum = Momentum::ghost(v[b], volume[b], rho[b], p[b], slip[b]);
        let state = Account { momentum, volume: volume[b].0, wall_velocity: v_w[b].0.into(), table };
        Gathered { position: x[b].0.into(), state }
    }
}

/// Adds up the pair forces on every fluid particle, kind by kind.
pub(super) fn pair_forces<const D: usize>(
    settings: Res<MomentumSettings>,
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    mut sheet: ResMut<Worksheet>,
    fluid: Query<FluidState, With<Fluid>>,
    walls: Query<(GhostState, &WallVelocity), With<Wall>>,
    structures: Query<(GhostState, &WallVelocity), With<Solid>>,
) {
    let (walls, structures) = (ghosts(WALL, columns(&walls)), ghosts(STRUCTURE, columns(&structures)));
    let (x, v, m, rho, p, mu, impact): FluidColumns<'_> = columns(&fluid);
    let own = |i: usize| {
        let momentum = Momentum::fluid(v[i], m[i], rho[i], p[i], mu[i]);
        let state = Account { momentum, volume: m[i].0 / rho[i].0, wall_velocity: Vector::ZERO, table: FLUID };
        Gathered { position: x[i].0.into(), state }
    };
    let records = workspace.gather::<D, Account<D>>(&neighbours.rows, own, walls, structures);
    let sheet = &mut *sheet;
    sheet.forces.resize(x.len(), PairForces::default());
    sheet.body_blocks.resize(x.len().div_ceil(BLOCK), BodySums::default());
    let out = (&mut sheet.forces[..], &mut sheet.body_blocks[..]);
    with_forms!(settings, tell_apart::<D>(&neighbours, &kernel, records, impact, out));
    sheet.bodies = sum(sheet.body_blocks.iter().copied());
}

fn tell_apart<const D: usize, P: PressureAverage, V: ViscousForce>(
    neighbours: &Neighbours,
    kernel: &SmoothingKernel,
    records: Records<'_, D, Account<D>>,
    impact: &[ImpactPressure],
    (forces, blocks): (&mut [PairForces], &mut [BodySums]),
) {
    forces.par_chunks_mut(BLOCK).zip(blocks).enumerate().for_each(|(b, (forces, bodies))| {
        *bodies = BodySums::default();
        for (k, out) in forces.iter_mut().enumerate() {
            let row = b * BLOCK + k;
            let (own, impact) = (&records.get(row), impact[row].0);
            let i = &own.state.momentum;
            let mut sums = ForceSums::<D>::default();
            sum_near(
                own,
                neighbours.fluid.of(row),
                records,
                &*kernel.0,
                #[inline(always)]
                |other, pair| {
                    let j = &other.momentum;
                    let is_ghost = other.table != FLUID;
                    let mu_ij =
                        if is_ghost { i.viscosity * j.viscosity } else { mean_viscosity(i.viscosity, j.viscosity) };
                    let (pressure, viscous) = forces_of::<D, P, V>(mu_ij, i, j, pair);
                    let compression_of_i = i.pressure * own.state.volume * other.volume;
                    sums.viscous += viscous;
                    if !is_ghost {
                        let compression = compression_of_i + j.pressure * own.state.volume * other.volume;
                        sums.all += pressure + viscous;
                        sums.volumes += pressure + pair.grad_w() * compression;
                        return;
                    }
                    let impact = impact_force(impact, i, j, pair);
                    let ghost = pressure + pair.grad_w() * compression_of_i;
                    let force = pressure + viscous + impact;
                    sums.all += force;
                    sums.impact += impact;
                    sums.ghosts += ghost;
                    bodies.add(force, (viscous, impact, ghost), other);
                },
            );
            *out = sums.into();
        }
    });
}

/// [`PairForces`] while they are added up.
struct ForceSums<const D: usize> {
    all: Vector<D>,
    viscous: Vector<D>,
    impact: Vector<D>,
    ghosts: Vector<D>,
    volumes: Vector<D>,
}

impl<const D: usize> Default for ForceSums<D> {
    fn default() -> Self {
        let zero = Vector::ZERO;
        Self { all: zero, viscous: zero, impact: zero, ghosts: zero, volumes: zero }
    }
}

impl<const D: usize> From<ForceSums<D>> for PairForces {
    fn from(sums: ForceSums<D>) -> Self {
        Self {
            all: sums.all.into(),
            viscous: sums.viscous.into(),
            impact: sums.impact.into(),
            ghosts: sums.ghosts.into(),
            volumes: sums.volumes.into(),
        }
    }
}

impl BodySums {
    /// Adds the force of one ghost on a fluid particle, and its viscous part, its impact, and what the ghost takes up.
    fn add<const D: usize>(
        &mut self,
        force: Vector<D>,
        (viscous, impact, ghost): (Vector<D>, Vector<D>, Vector<D>),
        body: &Account<D>,
    ) {
        let v_w = body.wall_velocity;
        self.power += force.dot(v_w);
        self.of_kind[Kind::Viscous as usize] += viscous.dot(v_w);
        self.of_kind[Kind::Impact as usize] += impact.dot(v_w);
        self.of_kind[Kind::Ghosts as usize] += ghost.dot(v_w);
        let sum = if body.table == STRUCTURE { &mut self.structures } else { &mut self.walls };
        *sum += DVec3::from(force);
    }
}
