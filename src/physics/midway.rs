//! What is summed in the middle of the drift, in one sweep: ∇v (Eq. 14), dρ/dt (Eq. 5), the diffusion of density (Eqs. 10, 11)
//! and how much of each neighbourhood is filled.
//!
//! During the drift particles move by `Δt v`; v is the velocity of its middle, and so what follows from v is summed over the
//! positions of the middle, `x − ½Δt v`. All of it needs the same neighbours and the same ∇W, and to find these takes longer than to
//! add up. So the sums are made together, ahead of the stages that they belong to. Their terms stand in the files of
//! those stages, and here is only what puts them together. Two of them need no sums of their own for fluid: they are the traces of L and K.
//!
//! Each stage can still be replaced alone: it takes its sum from here if there is one, and makes it by itself if not (in a scene
//! with plain loops, or where another system stands in for [`Stage::StrainRate`](crate::schedule::Stage)). The bits are the same.

use std::array::from_fn;

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;

use super::continuity::{Continuity, Flux};
use super::diffusion::{Compression, Diffusion, Strength};
use super::free_surface::{CLEAR_FILLING, Filling};
use super::strain_rate::{Flow, GhostColumns, Ghosts, Matrix, VelocityGradient, flow_volume};
use super::{CompressionGradients, DensityDiffusion, EquationOfState, Gravity, StrainSettings};
use crate::clock::Clock;
use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields};
use crate::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{
    Density, DensityRate, Fluid, Gathered, Mass, PIECE, Position, ReferenceDensity, ShearRate, Solid, Vector, Velocity,
    Wall, WallAcceleration, WallVelocity, Workspace, columns,
};

/// What waits for its stages; empty where each stage makes its own sums.
#[derive(Resource, Default)]
pub struct MidwaySums {
    /// `Σ_j V_j ψ_ij (r_ij·∇_iW_ij)/r²` (1/m²) of each fluid particle.
    diffusion: Vec<f64>,
    /// Whether φ_i leaves no doubt that the particle is not detached.
    is_clear: Vec<bool>,
}

impl MidwaySums {
    /// Whether ∇v and dρ/dt are those of this step already.
    #[must_use]
    pub fn are_made(&self) -> bool {
        !self.diffusion.is_empty()
    }

    /// Forgets the sums: stages make their own until there are new ones.
    pub fn clear(&mut self) {
        self.diffusion.clear();
        self.is_clear.clear();
    }

    pub(super) fn diffusion(&self) -> Option<&[f64]> {
        self.are_made().then_some(&self.diffusion)
    }

    pub(super) fn is_clear(&self) -> Option<&[bool]> {
        self.are_made().then_some(&self.is_clear)
    }
}

/// Velocity of a ghost in the middle of a drift that took twice `half_step` (s).
pub(super) fn velocity_midway(half_step: f64, v_w: WallVelocity, a_w: WallAcceleration) -> DVec3 {
    v_w.0 - half_step * a_w.0
}

/// Position in the middle of the drift, of what is at `x` after it.
pub(super) fn position_midway<const D: usize>(half_step: f64, x: Position, velocity: DVec3) -> Vector<D> {
    (x.0 - half_step * velocity).into()
}

fields! {
    /// What the sums need of a particle: with its position eight numbers in 2D, 64 bytes.
    pub struct Midway<D> {
        /// v; of a ghost v_w.
        velocity: Vector<D>,
        volume: f64,
        /// β of fluid; of a ghost, which does not diffuse, its volume in ∇v.
        beta_or_volume: f64,
        /// Half the slope of β of fluid that does not diffuse; of a ghost v_b, Eq. 16.
        half_slope_or_velocity: Vector<D>,
    }
}

impl<const D: usize, R: Real> Midway<D, R> {
    #[inline(always)]
    fn flow(&self) -> Flow<D, R> {
        Flow { velocity: self.velocity, volume: self.volume }
    }

    #[inline(always)]
    fn ghost_flow(&self) -> Flow<D, R> {
        Flow { velocity: self.half_slope_or_velocity, volume: self.beta_or_volume }
    }

    #[inline(always)]
    fn flux(&self) -> Flux<D, R> {
        Flux { velocity: self.velocity, volume: self.volume }
    }

    #[inline(always)]
    fn compression(&self) -> Compression<D, R> {
        Compression { beta: self.beta_or_volume, half_slope: self.half_slope_or_velocity, volume: self.volume }
    }
}

fields! {
    /// The sums of a particle.
    pub struct Sums<D> {
        gradient: (Matrix<D>, Matrix<D>),
        /// `Σ_j V_j v_ij·∇_iW_ij`, axis by axis.
        flux: Vector<D>,
        diffusion: f64,
        /// `Σ_j V_j r_ij·∇_iW_ij`, axis by axis.
        filling: Vector<D>,
    }
}

/// All the terms.
struct Terms;

impl<const D: usize> PairTerm<D> for Terms {
    type State = Midway<D>;
    type Sum = Sums<D>;

    #[inline(always)]
    fn fluid<R: Real>(&self, sum: &mut Sums<D, R>, i: &Midway<D, R>, j: &Midway<D, R>, pair: &Pair<D, R>) {
        VelocityGradient.fluid(&mut sum.gradient, &i.flow(), &j.flow(), pair);
        Diffusion.fluid(&mut sum.diffusion, &i.compression(), &j.compression(), pair);
    }

    /// Over fluid `Σ_j V_j v_ij·∇_iW_ij = −tr L_i` and `Σ_j V_j r_ij·∇_iW_ij = −tr K_i`, to the bit: the same products in the same order.
    /// (Minus taken from 0, so that a sum to which nothing was added stays +0.)
    #[inline(always)]
    fn after_fluid<R: Real>(&self, Sums { gradient: (l, k), flux, filling, .. }: &mut Sums<D, R>) {
        *flux = Vector(from_fn(
            #[inline(always)]
            |a| l[a][a].like(0.0) - l[a][a],
        ));
        *filling = Vector(from_fn(
            #[inline(always)]
            |a| k[a][a].like(0.0) - k[a][a],
        ));
    }

    #[inline(always)]
    fn ghost<R: Real>(&self, sum: &mut Sums<D, R>, i: &Midway<D, R>, b: &Midway<D, R>, pair: &Pair<D, R>) {
        VelocityGradient.ghost(&mut sum.gradient, &i.flow(), &b.ghost_flow(), pair);
        Continuity.ghost(&mut sum.flux, &i.flux(), &b.flux(), pair);
        Filling.ghost(&mut sum.filling, &i.volume, &b.volume, pair);
    }
}

type FluidState = (
    &'static Position,
    &'static Velocity,
    &'static Mass,
    &'static Density,
    &'static ReferenceDensity,
    &'static mut ShearRate,
    &'static mut DensityRate,
);
/// Makes the sums, and from them γ̇ and dρ/dt (the diffusion not included) of every fluid particle.
pub fn midway_sums<const D: usize>(
    clock: Res<Clock>,
    settings: Res<StrainSettings>,
    (diffusion, gravity, state): (Res<DensityDiffusion>, Res<Gravity>, Res<EquationOfState>),
    gradients: Res<CompressionGradients>,
    (kernel, neighbours): (Res<SmoothingKernel>, Res<Neighbours>),
    mut workspace: ResMut<Workspace>,
    mut sums: ResMut<MidwaySums>,
    mut fluid: Query<FluidState, With<Fluid>>,
    walls: Query<Ghosts, With<Wall>>,
    structures: Query<Ghosts, With<Solid>>,
) -> Result {
    sums.clear();
    if neighbours.has_plain_loops() {
        return Ok(());
    }
    let half_step = 0.5 * clock.time_step;
    let [walls, structures] =
        [columns(&walls), columns(&structures)].map(|(x, v_w, a_w, v_b, volume, slip): GhostColumns<'_>| {
            move |b: usize| {
                let velocity = velocity_midway(half_step, v_w[b], a_w[b]);
                let state = Midway {
                    velocity: velocity.into(),
                    volume: volume[b].0,
                    beta_or_volume: flow_volume(volume[b], slip[b]),
                    half_slope_or_velocity: v_b[b].0.into(),
                };
                Gathered { position: position_midway(half_step, x[b], velocity), state }
            }
        });
    let strength = Strength::<D>::of(&diffusion, &gravity, &state);
    for (x, v, m, rho, rho0, mut shear_rate, mut rate) in fluid.contiguous_iter_mut()? {
        let own = |i: usize| {
            let Compression { beta, half_slope, volume } = strength.compression(m[i], rho[i], rho0[i], gradients.of(i));
            let velocity = v[i].0.into();
            let state = Midway { velocity, volume, beta_or_volume: beta, half_slope_or_velocity: half_slope };
            Gathered { position: position_midway(half_step, x[i], v[i].0), state }
        };
        let records = workspace.gather::<D, Midway<D>>(&neighbours.rows, own, walls, structures);
        let sweep = Sweep::new(&neighbours, &*kernel.0, records, Terms);
        let MidwaySums { diffusion, is_clear } = &mut *sums;
        diffusion.resize(x.len(), 0.0);
        is_clear.resize(x.len(), false);
        let out = (
            shear_rate.bypass_change_detection().par_chunks_mut(PIECE),
            rate.bypass_change_detection().par_chunks_mut(PIECE),
            diffusion.par_chunks_mut(PIECE),
            is_clear.par_chunks_mut(PIECE),
        );
        out.into_par_iter().enumerate().for_each(|(piece, (shear_rate, rate, diffusion, is_clear))| {
            let first = piece * PIECE;
            sweep.sum(first, rate.len(), |k, sum| {
                shear_rate[k].0 = settings.shear_rate(sum.gradient);
                rate[k].0 = rho[first + k].0 * sum.flux.total();
                diffusion[k] = sum.diffusion;
                is_clear[k] = -sum.filling.total() > CLEAR_FILLING * D as f64;
            });
        });
    }
    Ok(())
}
