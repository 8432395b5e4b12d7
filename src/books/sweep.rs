//! The pair forces of a step, told apart: what [`momentum`](crate::physics::momentum) adds up, and `N_ij` and `G_ib`.
//!
//! Their sum is left for that stage in [`ForceSums`], so that there is one sweep for both.

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
    FluidColumns, FluidState, ForceSum, ForceSums, Forces, GhostColumns, GhostState, ImpactPressures, Momentum,
    MomentumSettings, PressureAverage, ViscousForce, impact_force, mean_viscosity, pair_forces as pair_forces_of,
    with_forms,
};

fields! {
    /// What the books need of a particle.
    pub(super) struct Account<D> {
        momentum: Momentum<D>,
        /// p^w of fluid (Pa).
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
    pub(super) struct Parts<D> {
        all: ForceSum<D>,
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
    type Sum = Parts<D>;

    #[inline(always)]
    fn fluid<R: Real>(&self, sum: &mut Parts<D, R>, own: &Account<D, R>, other: &Account<D, R>, pair: &Pair<D, R>) {
        Forces::<P, V>::default().fluid(&mut sum.all, &own.momentum, &other.momentum, pair);
        let (i, j) = (&own.momentum, &other.momentum);
        let mu_ij = mean_viscosity(i.viscosity, j.viscosity);
        V::add_to(&mut sum.viscous, mu_ij, i, j, pair);
        let compression = (i.pressure + j.pressure) * own.volume * other.volume;
        sum.volumes.add_product(pair.r_ij, (compression - P::average(i, j)) * pair.gradient);
    }

    #[inline(always)]
    fn ghost<R: Real>(&self, sum: &mut Parts<D, R>, own: &Account<D, R>, body: &Account<D, R>, pair: &Pair<D, R>) {
        Forces::<P, V>::default().ghost(&mut sum.all, &own.momentum, &body.momentum, pair);
        let (i, b) = (&own.momentum, &body.momentum);
        let (pressure, viscous) = pair_forces_of::<D, R, P, V>(i.viscosity * b.viscosity, i, b, pair);
        let impact = impact_force(own.impact, i, b, pair);
        let ghost = pressure + pair.grad_w() * (i.pressure * own.volume * body.volume);
        let force = pressure + viscous + impact;
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
        let impact = 0.0;
        let state = Account { momentum, impact, volume: volume[b].0, wall_velocity: v_w[b].0.into(), structure };
        Gathered { position: x[b].0.into(), state }
    }
}

/// Adds up the pair forces on every fluid particle, kind by kind.
pub(super) fn pair_forces<const D: usize>(
    settings: Res<MomentumSettings>,
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    (mut sheet, mut all): (ResMut<Worksheet>, ResMut<ForceSums>),
    impact: Res<ImpactPressures>,
    fluid: Query<FluidState, With<Fluid>>,
    walls: Query<(GhostState, &WallVelocity), With<Wall>>,
    structures: Query<(GhostState, &WallVelocity), With<Solid>>,
) {
    let (walls, structures) = (ghosts(0.0, columns(&walls)), ghosts(1.0, columns(&structures)));
    let (x, v, m, rho, p, mu): FluidColumns<'_> = columns(&fluid);
    let own = |i: usize| {
        let momentum = Momentum::fluid(v[i], m[i], rho[i], p[i], mu[i]);
        let volume = m[i].0 / rho[i].0;
        let impact = impact.of(i);
        let state = Account { momentum, impact, volume, wall_velocity: Vector::ZERO, structure: 0.0 };
        Gathered { position: x[i].0.into(), state }
    };
    let records = workspace.gather::<D, Account<D>>(&neighbours.rows, own, walls, structures);
    let sheet = &mut *sheet;
    all.forces.resize(x.len(), DVec3::ZERO);
    all.are_new = true;
    sheet.forces.resize(x.len(), PairForces::default());
    sheet.body_blocks.resize(x.len().div_ceil(BLOCK), BodySums::default());
    let out = (&mut all.forces[..], &mut sheet.forces[..], &mut sheet.body_blocks[..]);
    with_forms!(settings, tell_apart::<D>(&neighbours, &kernel, records, &impact, out));
    sheet.bodies = sum(sheet.body_blocks.iter().copied());
}

fn tell_apart<const D: usize, P: PressureAverage, V: ViscousForce>(
    neighbours: &Neighbours,
    kernel: &SmoothingKernel,
    records: Records<'_, D, Account<D>>,
    impact: &ImpactPressures,
    (all, forces, blocks): (&mut [DVec3], &mut [PairForces], &mut [BodySums]),
) {
    let sweep = Sweep::new(neighbours, &*kernel.0, records, Apart::<P, V>(PhantomData));
    let blocks = all.par_chunks_mut(BLOCK).zip(forces.par_chunks_mut(BLOCK)).zip(blocks);
    blocks.enumerate().for_each(|(block, ((all, forces), bodies))| {
        *bodies = BodySums::default();
        sweep.sum(block * BLOCK, forces.len(), |k, sums| {
            *bodies += sums.of_bodies();
            all[k] = sums.all.total(impact.of(block * BLOCK + k)).into();
            forces[k] = sums.into();
        });
    });
}

impl<const D: usize> Parts<D> {
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

impl<const D: usize> From<Parts<D>> for PairForces {
    fn from(sums: Parts<D>) -> Self {
        Self {
            viscous: sums.viscous.into(),
            impact: sums.impact.into(),
            ghosts: sums.ghosts.into(),
            volumes: sums.volumes.into(),
        }
    }
}
