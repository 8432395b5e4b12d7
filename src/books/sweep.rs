//! The pair forces of a step, told apart: what [`momentum`](crate::physics::momentum) adds up, `N_ij`, and what
//! [walls and structures](super::bodies) do to the fluid beside them.
//!
//! Their sum is left for that stage in [`ForceSums`], so that there is one sweep for both.

use std::marker::PhantomData;

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;

use super::bodies::{BodyColumns, NearBodies, near_bodies};
use super::sums::{BLOCK, BodySums, PairForces, Worksheet, sum};
use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields, one_by_one};
use crate::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{Fluid, Gathered, Position, Records, Solid, Vector, Wall, WallVelocity, Workspace, columns};
use crate::physics::{
    FluidColumns, FluidState, ForceSum, ForceSums, Forces, GhostState, ImpactPressures, Momentum, MomentumSettings,
    PressureAverage, ViscousForce, with_forms,
};

fields! {
    /// What the books need of a particle: in 2D, with its position, as many numbers as a line of the cache holds.
    pub(super) struct Account<D> {
        /// v, or v_b of a ghost (m/s).
        velocity: Vector<D>,
        /// V.
        pub volume: f64,
        /// ρ (kg/m³).
        density: f64,
        /// p (Pa).
        pub pressure: f64,
        /// μ of a fluid particle (Pa s), of a ghost as in [`Momentum`].
        viscosity: f64,
    }
}

impl<const D: usize> Account<D> {
    /// What `momentum` says of a particle, but V in the place of its square.
    pub fn new(momentum: Momentum<D>, volume: f64) -> Self {
        let Momentum { velocity, density, pressure, viscosity, .. } = momentum;
        Self { velocity, volume, density, pressure, viscosity }
    }
}

impl<const D: usize, R: Real> Account<D, R> {
    /// What the forces need of it.
    #[inline(always)]
    pub fn momentum(&self) -> Momentum<D, R> {
        let Self { velocity, volume, density, pressure, viscosity } = *self;
        Momentum { velocity, squared_volume: volume * volume, density, pressure, viscosity }
    }
}

fields! {
    /// Forces on a fluid particle.
    struct Parts<D> {
        force: ForceSum<D>,
        /// Σ_j N_ij.
        volumes: Vector<D>,
    }
}

/// The forces of a step, of the chosen forms, told apart.
struct Apart<P, V>(PhantomData<fn() -> (P, V)>);

impl<const D: usize, P: PressureAverage, V: ViscousForce> PairTerm<D> for Apart<P, V> {
    type State = Account<D>;
    type Sum = Parts<D>;

    #[inline(always)]
    fn fluid<R: Real>(&self, sum: &mut Parts<D, R>, own: &Account<D, R>, other: &Account<D, R>, pair: &Pair<D, R>) {
        let (i, j) = (own.momentum(), other.momentum());
        Forces::<P, V>::default().fluid(&mut sum.force, &i, &j, pair);
        let compression = (i.pressure + j.pressure) * own.volume * other.volume;
        sum.volumes.add_product(pair.r_ij, (compression - P::average(&i, &j)) * pair.gradient);
    }

    #[inline(always)]
    fn ghost<R: Real>(&self, sum: &mut Parts<D, R>, own: &Account<D, R>, body: &Account<D, R>, pair: &Pair<D, R>) {
        Forces::<P, V>::default().ghost(&mut sum.force, &own.momentum(), &body.momentum(), pair);
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
    let ghosts: [BodyColumns<'_>; 2] = [columns(&walls), columns(&structures)];
    let (x, v, m, rho, p, mu): FluidColumns<'_> = columns(&fluid);
    let own = |i: usize| Account::new(Momentum::fluid(v[i], m[i], rho[i], p[i], mu[i]), m[i].0 / rho[i].0);
    let of_fluid = |i: usize| Gathered { position: x[i].0.into(), state: own(i) };
    let [of_walls, of_structures] = ghosts.map(|((x, v, volume, rho, p, slip), _)| {
        move |b: usize| {
            let momentum = Momentum::ghost(v[b], volume[b], rho[b], p[b], slip[b]);
            Gathered { position: x[b].0.into(), state: Account::new(momentum, volume[b].0) }
        }
    });
    let records = workspace.gather::<D, Account<D>>(&neighbours.rows, of_fluid, of_walls, of_structures);
    let sheet = &mut *sheet;
    all.forces.resize(x.len(), DVec3::ZERO);
    all.are_new = true;
    sheet.forces.resize(x.len(), PairForces::default());
    sheet.body_blocks.resize(x.len().div_ceil(BLOCK), BodySums::default());
    let out = (&mut all.forces[..], &mut sheet.forces[..], &mut sheet.body_blocks[..]);
    let bodies = near_bodies(&kernel, &neighbours, ghosts);
    with_forms!(settings, tell_apart::<D>((&neighbours, &kernel), records, &bodies, (x, &own, &impact), out));
    sheet.bodies = sum(sheet.body_blocks.iter().copied());
}

fn tell_apart<const D: usize, P: PressureAverage, V: ViscousForce>(
    (neighbours, kernel): (&Neighbours, &SmoothingKernel),
    records: Records<'_, D, Account<D>>,
    bodies: &NearBodies<'_>,
    (x, own, impact): (&[Position], &(impl Fn(usize) -> Account<D> + Sync), &ImpactPressures),
    (all, forces, blocks): (&mut [DVec3], &mut [PairForces], &mut [BodySums]),
) {
    let sweep = Sweep::new(neighbours, &*kernel.0, records, Apart::<P, V>(PhantomData));
    let blocks = all.par_chunks_mut(BLOCK).zip(forces.par_chunks_mut(BLOCK)).zip(blocks);
    blocks.enumerate().for_each(|(block, ((all, forces), of_bodies))| {
        let first = block * BLOCK;
        sweep.sum(first, forces.len(), |k, Parts { force, volumes }| {
            let p_w = impact.of(first + k);
            all[k] = force.total(p_w).into();
            let (viscous, impact) = (force.viscous.into(), (force.of_unit_impact * p_w).into());
            forces[k] = PairForces { viscous, impact, ghosts: DVec3::ZERO, volumes: volumes.into() };
        });
        *of_bodies = BodySums::default();
        one_by_one(
            #[inline(always)]
            || {
                for (k, forces) in forces.iter_mut().enumerate() {
                    let i = first + k;
                    let near = neighbours.fluid.of(i).ghosts;
                    if !near.is_empty() {
                        let (x_i, own) = (x[i].0, own(i));
                        forces.ghosts = bodies.act::<D, P, V>(x_i, &own, impact.of(i), near, of_bodies);
                    }
                }
            },
        );
    });
}
