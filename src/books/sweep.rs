//! The pair forces of a step, told apart: what [`momentum`](crate::physics::momentum) adds up, and `N_ij` and `G_ib`.

use std::marker::PhantomData;

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;

use super::sums::{BLOCK, BodySums, KINDS, Kind, PairForces, Worksheet, sum};
use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields};
use crate::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{Fluid, Gathered, Records, Solid, Vector, Wall, WallVelocity, Workspace, columns};
use crate::physics::{
    FluidColumns, FluidState, GhostColumns, GhostState, Momentum, MomentumSettings, PressureAverage, ViscousForce,
    impact_force, mean_viscosity, pair_forces as pair_forces_of, with_forms,
};

fields! {
    /// What the books need of a particle.
    pub(super) struct Account<D> {
        momentum: Momentum<D>,
        /// p^w of a fluid particle.
        impact: f64,
        /// V.
        volume: f64,
        /// v_w of a ghost.
        wall_velocity: Vector<D>,
        /// 1 of a structure, else 0.
        structure: f64,
    }
}

fields! {
    /// Forces on a fluid particle, and what walls and structures do with those that are theirs.
    pub(super) struct ForceSums<D> {
        all: Vector<D>,
        viscous: Vector<D>,
        impact: Vector<D>,
        ghosts: Vector<D>,
        volumes: Vector<D>,
        /// Σ_b F_ib of structures.
        structures: Vector<D>,
        /// Σ_b F_ib of walls and structures.
        bodies: Vector<D>,
        /// Σ_b F_ib·v_w of all forces, the viscous force, the impact, and of what ghosts take up.
        power: [f64; 4],
    }
}

/// The forces of a step, of the chosen forms, told apart.
struct Apart<P, V>(PhantomData<fn() -> (P, V)>);

impl<const D: usize, P: PressureAverage, V: ViscousForce> PairTerm<D> for Apart<P, V> {
    type State = Account<D>;
    type Sum = ForceSums<D>;

    #[inline(always)]
    fn fluid<R: Real>(&self, sum: &mut ForceSums<D, R>, own: &Account<D, R>, other: &Account<D, R>, pair: &Pair<D, R>) {
        let (i, j) = (&own.momentum, &other.momentum);
        let mu_ij = mean_viscosity(i.viscosity, j.viscosity);
        let (pressure, viscous) = pair_forces_of::<D, R, P, V>(mu_ij, i, j, pair);
        let compression = (i.pressure + j.pressure) * own.volume * other.volume;
        sum.all += pressure + viscous;
        sum.viscous += viscous;
        sum.volumes += pressure + pair.grad_w() * compression;
    }

    #[inline(always)]
    fn ghost<R: Real>(&self, sum: &mut ForceSums<D, R>, own: &Account<D, R>, body: &Account<D, R>, pair: &Pair<D, R>) {
        let (i, b) = (&own.momentum, &body.momentum);
        let (pressure, viscous) = pair_forces_of::<D, R, P, V>(i.viscosity * b.viscosity, i, b, pair);
        let impact = impact_force(own.impact, i, b, pair);
        let ghost = pressure + pair.grad_w() * (i.pressure * own.volume * body.volume);
        let force = pressure + viscous + impact;
        sum.all += force;
        sum.viscous += viscous;
        sum.impact += impact;
        sum.ghosts += ghost;
        sum.bodies += force;
        sum.structures.add_product(force, body.structure);
        for (power, force) in sum.power.iter_mut().zip([force, viscous, impact, ghost]) {
            *power = force.dot_plus(body.wall_velocity, *power);
        }
    }
}

/// The records of walls or of structures.
fn ghosts<'a, const D: usize>(
    structure: f64,
    ((x, v, volume, rho, p, slip), v_w): (GhostColumns<'a>, &'a [WallVelocity]),
) -> impl Fn(usize) -> Gathered<D, Account<D>> + Sync + Send + use<'a, D> {
    move |b: usize| {
        let momentum = Momentum::ghost(v[b], volume[b], rho[b], p[b], slip[b]);
        let state = Account { momentum, impact: 0.0, volume: volume[b].0, wall_velocity: v_w[b].0.into(), structure };
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
    let (walls, structures) = (ghosts(0.0, columns(&walls)), ghosts(1.0, columns(&structures)));
    let (x, v, m, rho, p, mu, impact): FluidColumns<'_> = columns(&fluid);
    let own = |i: usize| {
        let momentum = Momentum::fluid(v[i], m[i], rho[i], p[i], mu[i]);
        let volume = m[i].0 / rho[i].0;
        let state = Account { momentum, impact: impact[i].0, volume, wall_velocity: Vector::ZERO, structure: 0.0 };
        Gathered { position: x[i].0.into(), state }
    };
    let records = workspace.gather::<D, Account<D>>(&neighbours.rows, own, walls, structures);
    let sheet = &mut *sheet;
    sheet.forces.resize(x.len(), PairForces::default());
    sheet.body_blocks.resize(x.len().div_ceil(BLOCK), BodySums::default());
    let out = (&mut sheet.forces[..], &mut sheet.body_blocks[..]);
    with_forms!(settings, tell_apart::<D>(&neighbours, &kernel, records, out));
    sheet.bodies = sum(sheet.body_blocks.iter().copied());
}

fn tell_apart<const D: usize, P: PressureAverage, V: ViscousForce>(
    neighbours: &Neighbours,
    kernel: &SmoothingKernel,
    records: Records<'_, D, Account<D>>,
    (forces, blocks): (&mut [PairForces], &mut [BodySums]),
) {
    let sweep = Sweep::new(neighbours, &*kernel.0, records, Apart::<P, V>(PhantomData));
    forces.par_chunks_mut(BLOCK).zip(blocks).enumerate().for_each(|(block, (forces, bodies))| {
        *bodies = BodySums::default();
        sweep.sum(block * BLOCK, forces.len(), |k, sums| {
            *bodies += sums.of_bodies();
            forces[k] = sums.into();
        });
    });
}

impl<const D: usize> ForceSums<D> {
    fn of_bodies(&self) -> BodySums {
        let [power, viscous, impact, ghosts] = self.power;
        let mut of_kind = [0.0; KINDS];
        of_kind[Kind::Viscous as usize] = viscous;
        of_kind[Kind::Impact as usize] = impact;
        of_kind[Kind::Ghosts as usize] = ghosts;
        let structures = self.structures.into();
        BodySums { power, of_kind, walls: DVec3::from(self.bodies) - structures, structures }
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
