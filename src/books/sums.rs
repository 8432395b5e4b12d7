//! What the books note during a step, and sums that do not depend on the number of threads.

use std::ops::AddAssign;

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::particles::{Density, DensityRate, Fluid, Pressure, columns};

/// Particles whose contributions are added up by one thread; the sums of blocks are added in their order.
pub(super) const BLOCK: usize = 512;

/// Kinds of force whose work is counted apart.
pub(super) const KINDS: usize = 6;

/// Work of the viscous force, of the impact pressure, of what ghosts and unequal volumes take up, of the
/// control of tension, of everything else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Viscous,
    Impact,
    Ghosts,
    Volumes,
    Tensile,
    Body,
}

/// Forces on a fluid particle (N; N/m in 2D).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PairForces {
    pub viscous: DVec3,
    pub impact: DVec3,
    /// Σ_b G_ib.
    pub ghosts: DVec3,
    /// Σ_j N_ij.
    pub volumes: DVec3,
}

/// Forces of walls and structures on the fluid, and their power.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct BodySums {
    /// Σ F_ib·v_w (W) of all forces.
    pub power: f64,
    /// The same of each kind of force.
    pub of_kind: [f64; KINDS],
    /// Force (N) of walls.
    pub walls: DVec3,
    /// Force (N) of structures.
    pub structures: DVec3,
}

impl AddAssign for BodySums {
    fn add_assign(&mut self, other: Self) {
        self.power += other.power;
        self.of_kind.iter_mut().zip(other.of_kind).for_each(|(sum, value)| *sum += value);
        self.walls += other.walls;
        self.structures += other.structures;
    }
}

/// A particle before its density changes in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Before {
    /// dρ/dt (kg/m³/s) of Eq. 5, without the diffusion.
    pub continuity: f64,
    /// ρ (kg/m³).
    pub density: f64,
    /// p (Pa).
    pub pressure: f64,
}

/// Notes of the step in progress; rows are those of the fluid table.
#[derive(Resource, Default)]
pub(super) struct Worksheet {
    pub before: Vec<Before>,
    pub forces: Vec<PairForces>,
    pub bodies: BodySums,
    pub body_blocks: Vec<BodySums>,
}

/// Notes every particle before the diffusion adds to dρ/dt and ρ and p are new.
pub(super) fn note_before(
    mut sheet: ResMut<Worksheet>,
    fluid: Query<(&DensityRate, &Density, &Pressure), With<Fluid>>,
) {
    let (rates, rho, p): (&[DensityRate], &[Density], &[Pressure]) = columns(&fluid);
    let of_particle = |((rate, rho), p): ((&DensityRate, &Density), &Pressure)| Before {
        continuity: rate.0,
        density: rho.0,
        pressure: p.0,
    };
    sheet.before.clear();
    sheet.before.extend(rates.iter().zip(rho).zip(p).map(of_particle));
}

/// The sum of what `add_to(sum, i)` adds for each i of `0..count`, block by block.
pub(super) fn sum_blocks<T: Copy + Default + AddAssign + Send>(
    blocks: &mut Vec<T>,
    count: usize,
    add_to: impl Fn(&mut T, usize) + Sync,
) -> T {
    let block = |b: usize| {
        let mut sum = T::default();
        (b * BLOCK..count.min((b + 1) * BLOCK)).for_each(|i| add_to(&mut sum, i));
        sum
    };
    (0..count.div_ceil(BLOCK)).into_par_iter().map(block).collect_into_vec(blocks);
    sum(blocks.iter().copied())
}

/// The sum of `values`, in their order.
pub(super) fn sum<T: Default + AddAssign>(values: impl Iterator<Item = T>) -> T {
    values.fold(T::default(), |mut sum, value| {
        sum += value;
        sum
    })
}
