//! Shear rate, Eq. 14.
//!
//! `L_i = ∇v = Σ_j V_j (v_j − v_i) ⊗ ∇_iW_ij`,  `D = ½ (L + Lᵀ)`,  `γ̇ = √(2 D:D)`
//!
//! (simple shear: γ̇ = |du/dy|; the paper omits the ½ and does not say which norm). With the correction of the kernel's
//! gradient (Bonet & Lok 1999) L becomes `L K⁻¹`, `K = Σ_j V_j (x_j − x_i) ⊗ ∇_iW_ij`, which is exact for a
//! linear velocity field wherever the particles are.

use bevy_ecs::prelude::*;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::neighbours::{Neighbours, sum_pairs};
use crate::particles::{
    Density, Fluid, GRAIN, Gather, Gathered, GhostVelocity, Mass, Position, ShearRate, Slip, Solid, Vector, Velocity,
    Volume, Wall, columns,
};
use crate::scene::{SceneSection, SectionError};

/// How ∇v is computed: section `strain_rate` of a scene.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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

impl SceneSection for StrainSettings {
    const NAME: &'static str = "strain_rate";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        world.insert_resource(self);
        Ok(())
    }
}

/// What ∇v needs of a particle.
#[derive(Debug, Clone, Copy)]
pub struct Flow<const D: usize> {
    velocity: Vector<D>,
    /// 0 for a wall with free slip, which does not enter ∇v.
    volume: f64,
}

type Matrix<const D: usize> = [[f64; D]; D];
type Ghosts = (&'static Position, &'static GhostVelocity, &'static Volume, &'static Slip);

/// Computes γ̇ of every fluid particle.
pub fn strain_rate<const D: usize>(
    settings: Res<StrainSettings>,
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
        let out = shear_rate.bypass_change_detection().par_iter_mut().with_min_len(GRAIN);
        out.enumerate().for_each(|(i, shear_rate)| {
            let own = &records[i];
            let (mut l, mut k): (Matrix<D>, Matrix<D>) = ([[0.0; D]; D], [[0.0; D]; D]);
            sum_pairs(own, neighbours.fluid.of(i), records, |other, pair| {
                let v_ij = own.state.velocity - other.velocity;
                let volume_grad_w = pair.grad_w() * other.volume;
                for a in 0..D {
                    for b in 0..D {
                        l[a][b] -= v_ij.0[a] * volume_grad_w.0[b];
                        k[a][b] -= pair.r_ij.0[a] * volume_grad_w.0[b];
                    }
                }
            });
            let l = if settings.gradient_correction { times_inverse(l, k) } else { l };
            shear_rate.0 = shear_rate_of(&l);
        });
    }
    Ok(())
}

/// γ̇ = √(2 D:D).
fn shear_rate_of<const D: usize>(l: &Matrix<D>) -> f64 {
    let mut double_contraction = 0.0;
    for a in 0..D {
        for b in 0..D {
            let d_ab = 0.5 * (l[a][b] + l[b][a]);
            double_contraction += d_ab * d_ab;
        }
    }
    (2.0 * double_contraction).sqrt()
}

/// A particle with so few neighbours that K is this close to singular keeps its uncorrected gradient (K → 1 in a full
/// neighbourhood).
const SINGULAR: f64 = 0.1;

/// `L K⁻¹`, by Cramer's rule.
fn times_inverse<const D: usize>(l: Matrix<D>, k: Matrix<D>) -> Matrix<D> {
    let (mut inverse, determinant): (Matrix<D>, f64) = adjugate(&k);
    if determinant.abs() < SINGULAR {
        return l;
    }
    inverse.as_flattened_mut().iter_mut().for_each(|x| *x /= determinant);
    std::array::from_fn(|a| std::array::from_fn(|b| (0..D).map(|c| l[a][c] * inverse[c][b]).sum()))
}

/// Adjugate and determinant.
fn adjugate<const D: usize>(k: &Matrix<D>) -> (Matrix<D>, f64) {
    let mut adjugate = [[0.0; D]; D];
    if D == 2 {
        adjugate[0][0] = k[1][1];
        adjugate[1][1] = k[0][0];
        adjugate[0][1] = -k[0][1];
        adjugate[1][0] = -k[1][0];
    } else {
        for a in 0..D {
            for b in 0..D {
                let (a1, a2, b1, b2) = ((a + 1) % D, (a + 2) % D, (b + 1) % D, (b + 2) % D);
                adjugate[b][a] = k[a1][b1] * k[a2][b2] - k[a1][b2] * k[a2][b1];
            }
        }
    }
    let determinant = (0..D).map(|b| k[0][b] * adjugate[b][0]).sum();
    (adjugate, determinant)
}
