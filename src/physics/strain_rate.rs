//! Shear rate, Eq. 14.
//!
//! `L_i = ∇v = Σ_j V_j (v_j − v_i) ⊗ ∇_iW_ij`,  `D = ½ (L + Lᵀ)`,  `γ̇ = √(2 D:D)`
//!
//! (simple shear: γ̇ = |du/dy|; the paper omits the ½ and does not say which norm). With the correction of the kernel's
//! gradient (Bonet & Lok 1999) L becomes `L K⁻¹`, `K = Σ_j V_j (x_j − x_i) ⊗ ∇_iW_ij`, which is exact for a
//! linear velocity field wherever the particles are.

use std::array::from_fn;

use bevy_ecs::prelude::*;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields};
use crate::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{
    Density, Fluid, Gather, Gathered, GhostVelocity, Mass, PIECE, Position, ShearRate, Slip, Solid, Vector, Velocity,
    Volume, Wall, columns,
};
use crate::scene::SceneSettings;

/// How ∇v is computed: section `strain_rate` of a scene.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StrainSettings {
    /// Correct the kernel's gradient, so that a linear velocity field has its exact shear rate at walls and surfaces.
    pub gradient_correction: bool,
}

impl Default for StrainSettings {
    fn default() -> Self {
        Self { gradient_correction: true }
    }
}

impl SceneSettings for StrainSettings {
    const NAME: &'static str = "strain_rate";
}

fields! {
    /// What ∇v needs of a particle.
    pub struct Flow<D> {
        velocity: Vector<D>,
        /// 0 for a wall with free slip, which does not enter ∇v.
        volume: f64,
    }
}

pub(super) type Matrix<const D: usize, R = f64> = [[R; D]; D];

/// L_i and K_i.
struct VelocityGradient;

impl<const D: usize> PairTerm<D> for VelocityGradient {
    type State = Flow<D>;
    type Sum = (Matrix<D>, Matrix<D>);

    #[inline(always)]
    fn fluid<R: Real>(
        &self,
        (l, k): &mut (Matrix<D, R>, Matrix<D, R>),
        i: &Flow<D, R>,
        j: &Flow<D, R>,
        pair: &Pair<D, R>,
    ) {
        let v_ij = i.velocity - j.velocity;
        let volume_grad_w = pair.grad_w() * j.volume;
        for a in 0..D {
            for b in 0..D {
                l[a][b] -= v_ij.0[a] * volume_grad_w.0[b];
                k[a][b] -= pair.r_ij.0[a] * volume_grad_w.0[b];
            }
        }
    }
}

type Ghosts = (&'static Position, &'static GhostVelocity, &'static Volume, &'static Slip);

/// Computes γ̇ of every fluid particle.
pub fn strain_rate<const D: usize>(
    settings: Res<StrainSettings>,
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    mut gather: Local<Gather<D, Flow<D>>>,
    mut fluid: Query<(&Position, &Velocity, &Mass, &Density, &mut ShearRate), With<Fluid>>,
    walls: Query<Ghosts, With<Wall>>,
    structures: Query<Ghosts, With<Solid>>,
) -> Result {
    let ghosts = [columns(&walls), columns(&structures)].map(
        |(x, v, volume, slip): (&[Position], &[GhostVelocity], &[Volume], &[Slip])| {
            move |b: usize| {
                let volume = if slip[b] == Slip::FreeSlip { 0.0 } else { volume[b].0 };
                Gathered { position: x[b].0.into(), state: Flow { velocity: v[b].0.into(), volume } }
            }
        },
    );
    let [walls, structures] = ghosts;
    for (x, v, m, rho, mut shear_rate) in fluid.contiguous_iter_mut()? {
        let own = |i: usize| Gathered {
            position: x[i].0.into(),
            state: Flow { velocity: v[i].0.into(), volume: m[i].0 / rho[i].0 },
        };
        let records = gather.fill(&neighbours.rows, own, walls, structures);
        let sweep = Sweep::new(&neighbours, &*kernel.0, records, VelocityGradient);
        shear_rate.bypass_change_detection().par_chunks_mut(PIECE).enumerate().for_each(|(piece, shear_rate)| {
            sweep.sum(piece * PIECE, shear_rate.len(), |i, (l, k)| {
                let l = if settings.gradient_correction { times_inverse(l, k, LEAST_DETERMINANT) } else { l };
                shear_rate[i].0 = shear_rate_of(&l);
            });
        });
    }
    Ok(())
}

/// γ̇ = √(2 D:D).
fn shear_rate_of<const D: usize>(l: &Matrix<D>) -> f64 {
    let d = (0..D).flat_map(|a| (0..D).map(move |b| 0.5 * (l[a][b] + l[b][a])));
    (2.0 * d.map(|d_ab| d_ab * d_ab).sum::<f64>()).sqrt()
}

/// A particle with so few neighbours that K is this close to singular keeps its uncorrected gradient (K → 1 in a full
/// neighbourhood).
pub(crate) const LEAST_DETERMINANT: f64 = 0.1;

/// `L K⁻¹` of gradients in rows, K⁻¹ being the transposed matrix of cofactors over the determinant; L itself where the
/// determinant is less than `least`.
pub(super) fn times_inverse<const ROWS: usize, const D: usize>(
    l: [[f64; D]; ROWS],
    k: Matrix<D>,
    least: f64,
) -> [[f64; D]; ROWS] {
    let cofactors: Matrix<D> = from_fn(|a| from_fn(|b| cofactor(&k, a, b)));
    let determinant: f64 = (0..D).map(|b| k[0][b] * cofactors[0][b]).sum();
    if determinant.abs() < least {
        return l;
    }
    from_fn(|a| from_fn(|b| (0..D).map(|c| l[a][c] * cofactors[b][c]).sum::<f64>() / determinant))
}

/// Cofactor of k_ab.
fn cofactor<const D: usize>(k: &Matrix<D>, a: usize, b: usize) -> f64 {
    if D == 2 {
        return if a == b { k[1 - a][1 - b] } else { -k[1 - a][1 - b] };
    }
    let (a1, a2, b1, b2) = ((a + 1) % D, (a + 2) % D, (b + 1) % D, (b + 2) % D);
    k[a1][b1] * k[a2][b2] - k[a1][b2] * k[a2][b1]
}
