//! Gradient of the compression β = ρ/ρ0, for the density diffusion of Antuono et al. 2010.
//!
//! `⟨∇β⟩_i = Σ_j V_j (β_j − β_i) ∇_iW_ij K_i⁻¹`, `K_i = Σ_j V_j (x_j − x_i) ⊗ ∇_iW_ij`, j over fluid particles of every phase:
//! exact for a linear β, at surfaces, walls and in corners too. K_i is a number times the unit matrix in a full neighbourhood; where its
//! determinant is less than a tenth of what that would be with the trace of K_i, neighbours lie on one side or in a row, and
//! the gradient stays as it is.

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;

use super::DensityDiffusion;
use super::strain_rate::{Matrix, subtract_outer, symmetric, times_inverse};
use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields};
use crate::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{
    Density, Fluid, Gathered, Mass, PIECE, Position, ReferenceDensity, Solid, Vector, Wall, Workspace, columns,
};

/// ⟨∇β⟩ (1/m) of every fluid particle, row by row, from its stage to the diffusion; empty where nobody asks for it.
#[derive(Resource, Debug, Default)]
pub struct CompressionGradients(pub Vec<DVec3>);

impl CompressionGradients {
    /// That of fluid particle `i`, or zero.
    #[inline(always)]
    pub(super) fn of(&self, i: usize) -> DVec3 {
        self.0.get(i).copied().unwrap_or_default()
    }
}

/// Least determinant of K over that of an isotropic one with the same trace.
pub(crate) const LEAST_RATIO: f64 = 0.1;

fields! {
    /// β and the volume of a particle.
    pub struct Filling<D> {
        beta: f64,
        volume: f64,
    }
}

/// `Σ_j V_j (β_j − β_i) ∇_iW_ij` and the upper triangle of K_i, which is symmetric.
struct Slope;

impl<const D: usize> PairTerm<D> for Slope {
    type State = Filling<D>;
    type Sum = ([[f64; D]; 1], Matrix<D>);

    #[inline(always)]
    fn fluid<R: Real>(
        &self,
        (slope, k): &mut ([[R; D]; 1], Matrix<D, R>),
        i: &Filling<D, R>,
        j: &Filling<D, R>,
        pair: &Pair<D, R>,
    ) {
        let volume_grad_w = pair.r_ij * (pair.gradient * j.volume);
        subtract_outer(slope, 0, Vector([i.beta - j.beta]), volume_grad_w);
        subtract_outer(k, 1, pair.r_ij, volume_grad_w);
    }

    /// Walls and structures take no part.
    #[inline(always)]
    fn ghost<R: Real>(
        &self,
        _: &mut ([[R; D]; 1], Matrix<D, R>),
        _: &Filling<D, R>,
        _: &Filling<D, R>,
        _: &Pair<D, R>,
    ) {
    }
}

/// Computes ⟨∇β⟩ of every fluid particle.
pub fn compression_gradient<const D: usize>(
    diffusion: Res<DensityDiffusion>,
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    mut gradients: ResMut<CompressionGradients>,
    fluid: Query<(&Position, &Mass, &Density, &ReferenceDensity), With<Fluid>>,
    walls: Query<&Position, With<Wall>>,
    structures: Query<&Position, With<Solid>>,
) -> Result {
    if !matches!(*diffusion, DensityDiffusion::Antuono { .. }) {
        return Ok(());
    }
    let [walls, structures] = [columns(&walls), columns(&structures)].map(|x: &[Position]| {
        move |b: usize| Gathered { position: x[b].0.into(), state: Filling { beta: 1.0, volume: 0.0 } }
    });
    for (x, m, rho, rho0) in fluid.contiguous_iter()? {
        let own = |i: usize| Gathered {
            position: x[i].0.into(),
            state: Filling { beta: rho[i].0 / rho0[i].0, volume: m[i].0 / rho[i].0 },
        };
        let records = workspace.gather::<D, Filling<D>>(&neighbours.rows, own, walls, structures);
        let sweep = Sweep::new(&neighbours, &*kernel.0, records, Slope);
        gradients.0.resize(x.len(), DVec3::ZERO);
        gradients.0.par_chunks_mut(PIECE).enumerate().for_each(|(piece, gradients)| {
            sweep.sum(piece * PIECE, gradients.len(), |i, (slope, k)| {
                let trace: f64 = (0..D).map(|a| k[a][a]).sum();
                let [corrected] = times_inverse(slope, symmetric(k), LEAST_RATIO * (trace / D as f64).powi(D as i32));
                gradients[i] = Vector(corrected).into();
            });
        });
    }
    Ok(())
}
