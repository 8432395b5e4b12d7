//! Shear rate, Eq. 14.
//!
//! `L_i = ∇v = Σ_j V_j (v_j − v_i) ⊗ ∇_iW_ij`,  `D = ½ (L + Lᵀ)`,  `γ̇ = √(2 D:D)`
//!
//! (simple shear: γ̇ = |du/dy|; the paper omits the ½ and does not say which norm). With the correction of the kernel's
//! gradient (Bonet & Lok 1999) L becomes `L K⁻¹`, `K = Σ_j V_j (x_j − x_i) ⊗ ∇_iW_ij`, which is exact for a
//! linear velocity field wherever the particles are. Velocities are those of the middle of the drift, and so are the positions
//! ([`midway_sums`](super::midway_sums)).

use std::array::from_fn;

use bevy_ecs::prelude::*;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::MidwaySums;
use super::midway::{position_midway, velocity_midway};
use crate::clock::Clock;
use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields};
use crate::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{
    Density, Fluid, Gathered, GhostVelocity, Mass, PIECE, Position, ShearRate, Slip, Solid, Vector, Velocity, Volume,
    Wall, WallAcceleration, WallVelocity, Workspace, columns,
};
use crate::scene::SceneSettings;

/// How ∇v is computed: section `strain_rate` of a scene.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StrainSettings {
    /// Correct the kernel's gradient, so that a linear velocity field has its exact shear rate at walls and surfaces.
    pub gradient_correction: bool,
    /// Where a fluid that is not `Newtonian` jumps at a wall to which it sticks, take the jump over the distance from the wall: the wall then holds a
    /// fluid that yields with the stress of its flow curve, else with twice its yield stress and more.
    pub wall_shear: bool,
}

impl Default for StrainSettings {
    fn default() -> Self {
        Self { gradient_correction: true, wall_shear: true }
    }
}

impl StrainSettings {
    /// γ̇ (1/s) from L_i and the upper triangle of K_i.
    pub(super) fn shear_rate<const D: usize>(&self, (l, k): (Matrix<D>, Matrix<D>)) -> f64 {
        let l = if self.gradient_correction { times_inverse(l, symmetric(k), LEAST_DETERMINANT) } else { l };
        shear_rate_of(&l)
    }
}

impl SceneSettings for StrainSettings {
    const NAME: &'static str = "strain_rate";
}

fields! {
    /// What ∇v needs of a particle.
    pub struct Flow<D> {
        pub(super) velocity: Vector<D>,
        pub(super) volume: f64,
    }
}

pub(super) type Matrix<const D: usize, R = f64> = [[R; D]; D];

/// L_i and the upper triangle of K_i, which is symmetric.
pub(super) struct VelocityGradient;

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
        let volume_grad_w = pair.r_ij * (pair.gradient * j.volume);
        subtract_outer(l, 0, v_ij, volume_grad_w);
        subtract_outer(k, 1, pair.r_ij, volume_grad_w);
    }
}

/// `m ← m − u ⊗ v`; in row a without the first `a · skipped` columns.
#[inline(always)]
#[expect(clippy::needless_range_loop, reason = "with iterators the sums are not kept in registers")]
pub(super) fn subtract_outer<const ROWS: usize, const D: usize, R: Real>(
    m: &mut [[R; D]; ROWS],
    skipped: usize,
    u: Vector<ROWS, R>,
    v: Vector<D, R>,
) {
    for a in 0..ROWS {
        for b in a * skipped..D {
            m[a][b].subtract_product(u.0[a], v.0[b]);
        }
    }
}

/// Volume of a ghost in ∇v: a wall along which fluid slips freely does not enter.
pub(super) fn flow_volume(volume: Volume, slip: Slip) -> f64 {
    if slip == Slip::FreeSlip { 0.0 } else { volume.0 }
}

/// What ∇v needs of ghosts.
pub(super) type Ghosts = (
    &'static Position,
    &'static WallVelocity,
    &'static WallAcceleration,
    &'static GhostVelocity,
    &'static Volume,
    &'static Slip,
);
/// [`Ghosts`] as whole columns.
pub(super) type GhostColumns<'a> =
    (&'a [Position], &'a [WallVelocity], &'a [WallAcceleration], &'a [GhostVelocity], &'a [Volume], &'a [Slip]);

/// Computes γ̇ of every fluid particle.
pub fn strain_rate<const D: usize>(
    clock: Res<Clock>,
    sums: Res<MidwaySums>,
    settings: Res<StrainSettings>,
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    mut fluid: Query<(&Position, &Velocity, &Mass, &Density, &mut ShearRate), With<Fluid>>,
    walls: Query<Ghosts, With<Wall>>,
    structures: Query<Ghosts, With<Solid>>,
) -> Result {
    if sums.are_made() {
        return Ok(());
    }
    let half_step = 0.5 * clock.time_step;
    let [walls, structures] =
        [columns(&walls), columns(&structures)].map(|(x, v_w, a_w, v_b, volume, slip): GhostColumns<'_>| {
            move |b: usize| Gathered {
                position: position_midway(half_step, x[b], velocity_midway(half_step, v_w[b], a_w[b])),
                state: Flow { velocity: v_b[b].0.into(), volume: flow_volume(volume[b], slip[b]) },
            }
        });
    for (x, v, m, rho, mut shear_rate) in fluid.contiguous_iter_mut()? {
        let own = |i: usize| Gathered {
            position: position_midway(half_step, x[i], v[i].0),
            state: Flow { velocity: v[i].0.into(), volume: m[i].0 / rho[i].0 },
        };
        let records = workspace.gather::<D, Flow<D>>(&neighbours.rows, own, walls, structures);
        let sweep = Sweep::new(&neighbours, &*kernel.0, records, VelocityGradient);
        shear_rate.bypass_change_detection().par_chunks_mut(PIECE).enumerate().for_each(|(piece, shear_rate)| {
            sweep.sum(piece * PIECE, shear_rate.len(), |k, sum| shear_rate[k].0 = settings.shear_rate(sum));
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

/// The symmetric matrix with this upper triangle.
pub(super) fn symmetric<const D: usize>(upper: Matrix<D>) -> Matrix<D> {
    from_fn(|a| from_fn(|b| upper[a.min(b)][a.max(b)]))
}

/// `L K⁻¹` of gradients in rows, K⁻¹ being the transposed matrix of cofactors times one over the determinant; L itself where the
/// determinant is less than `least`.
pub(super) fn times_inverse<const ROWS: usize, const D: usize>(
    l: [[f64; D]; ROWS],
    k: Matrix<D>,
    least: f64,
) -> [[f64; D]; ROWS] {
    let cofactors: Matrix<D> = from_fn(|a| from_fn(|b| cofactor(&k, a, b)));
    let dot = |u: [f64; D], v: [f64; D]| (0..D).map(|c| u[c] * v[c]).sum::<f64>();
    let determinant = dot(k[0], cofactors[0]);
    if determinant.abs() < least {
        return l;
    }
    let inverse = 1.0 / determinant;
    l.map(|row| from_fn(|b| dot(row, cofactors[b]) * inverse))
}

/// Cofactor of k_ab.
fn cofactor<const D: usize>(k: &Matrix<D>, a: usize, b: usize) -> f64 {
    if D == 2 {
        return if a == b { k[1 - a][1 - b] } else { -k[1 - a][1 - b] };
    }
    let (a1, a2, b1, b2) = ((a + 1) % D, (a + 2) % D, (b + 1) % D, (b + 2) % D);
    k[a1][b1] * k[a2][b2] - k[a1][b2] * k[a2][b1]
}
