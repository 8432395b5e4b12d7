//! Conservation of mass, Eq. 5.
//!
//! `dρ_i/dt = ρ_i Σ_j V_j v_ij·∇_iW_ij`, j over fluid, walls and structures; the velocity of a wall is that with which
//! it moves, v_w.
//!
//! Velocities are those of the middle of the drift, so r_ij and ∇_iW_ij are taken there too: `r_ij − ½Δt v_ij`, r_ij that of the
//! end. Over the step |r_ij|² changes by exactly `2 Δt v_ij·(r_ij − ½Δt v_ij)`. (With r_ij of the end a rotation with the
//! rate ω would thin the fluid: `dρ/dt = −Δt ω² ρ`; and what the pressure force does would match what
//! the density takes up to first order in Δt only.)

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;

use super::MidwaySums;
use super::midway::{position_midway, velocity_midway};
use crate::clock::Clock;
use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields};
use crate::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{
    Density, DensityRate, Fluid, Gathered, Mass, PIECE, Position, Solid, Vector, Velocity, Volume, Wall,
    WallAcceleration, WallVelocity, Workspace, columns,
};

fields! {
    /// What the continuity equation needs of a particle.
    pub struct Flux<D> {
        pub(super) velocity: Vector<D>,
        pub(super) volume: f64,
    }
}

/// `Σ_j V_j v_ij·∇_iW_ij` (1/s), axis by axis: over fluid it is −tr L_i (Eq. 14), which another sum may know already.
pub(super) struct Continuity;

impl<const D: usize> PairTerm<D> for Continuity {
    type State = Flux<D>;
    type Sum = Vector<D>;

    #[inline(always)]
    fn fluid<R: Real>(&self, sum: &mut Vector<D, R>, i: &Flux<D, R>, j: &Flux<D, R>, pair: &Pair<D, R>) {
        let v_ij = i.velocity - j.velocity;
        sum.add_each_product(v_ij, pair.r_ij * (pair.gradient * j.volume));
    }
}

type Ghosts = (&'static Position, &'static WallVelocity, &'static WallAcceleration, &'static Volume);
type GhostColumns<'a> = (&'a [Position], &'a [WallVelocity], &'a [WallAcceleration], &'a [Volume]);

/// Computes dρ/dt of every fluid particle.
pub fn density_rate<const D: usize>(
    clock: Res<Clock>,
    sums: Res<MidwaySums>,
    neighbours: Res<Neighbours>,
    kernel: Res<SmoothingKernel>,
    mut workspace: ResMut<Workspace>,
    mut fluid: Query<(&Position, &Velocity, &Mass, &Density, &mut DensityRate), With<Fluid>>,
    walls: Query<Ghosts, With<Wall>>,
    structures: Query<Ghosts, With<Solid>>,
) -> Result {
    if sums.are_made() {
        return Ok(());
    }
    let half_step = 0.5 * clock.time_step;
    let midway = |x: Position, velocity: DVec3, volume| Gathered {
        position: position_midway(half_step, x, velocity),
        state: Flux { velocity: velocity.into(), volume },
    };
    let [walls, structures] = [columns(&walls), columns(&structures)].map(|(x, v, a, volume): GhostColumns<'_>| {
        move |b: usize| midway(x[b], velocity_midway(half_step, v[b], a[b]), volume[b].0)
    });
    for (x, v, m, rho, mut rate) in fluid.contiguous_iter_mut()? {
        let records = workspace.gather::<D, Flux<D>>(
            &neighbours.rows,
            |i| midway(x[i], v[i].0, m[i].0 / rho[i].0),
            walls,
            structures,
        );
        let sweep = Sweep::new(&neighbours, &*kernel.0, records, Continuity);
        rate.bypass_change_detection().par_chunks_mut(PIECE).enumerate().for_each(|(piece, rate)| {
            let first = piece * PIECE;
            sweep.sum(first, rate.len(), |k, sum| rate[k].0 = rho[first + k].0 * sum.total());
        });
    }
    Ok(())
}
