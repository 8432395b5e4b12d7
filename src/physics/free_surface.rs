//! Density of what the free surface has let go: spray, drops, sheets a particle thin.
//!
//! Eq. 5 lets a particle that leaves the others take the thinning of its neighbourhood for its own: integrated over the
//! way out, `ln ρ` loses what `Σ_j V_j W_ij` loses, and alone it would keep `ρ ≈ ρ0/e`, far in tension (−B/e), with nothing
//! left to restore it. It is air that has come between, not expansion. So where less than half of a particle's
//! neighbourhood is filled, its density is not integrated but taken from where its neighbours are:
//!
//! `ρ_i = ρ0_i max(1, Σ_j V_j W_ij)`  if  `φ_i < ½`,  `φ_i = −(1/d) Σ_j V_j r_ij·∇_iW_ij`,
//!
//! j over fluid (i itself included in the first sum), walls and structures. `φ_i` is how much of its neighbourhood is filled,
//! as `∇·r/d` in Lee et al. 2008 (J. Comput. Phys. 227): near 1 inside, between 0.6 and 0.7 in the first layer of a
//! flat surface at rest, ½ for a point on the surface itself; so flat surfaces are left alone, and only what sticks out is
//! treated. The summation that never falls below ρ0 is the one of Zhang, Rezavand & Hu 2020 (J. Comput. Phys. 404) for
//! free-surface flows. It has no memory: what falls back is not stiffer than what never left.
//! (Cutting tension off, `ρ ← max(ρ, ρ0)`, has: each time that a sheet is stretched and pushed together it gains
//! density. In a dam break on a post it reached 1.12 ρ0 and blew the fluid up.)

use bevy_ecs::prelude::*;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{EquationOfState, MidwaySums};
use crate::kernels::SmoothingKernel;
use crate::lanes::Real;
use crate::neighbours::{CLUSTER, Near, Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{
    Density, Fluid, Gathered, Mass, PIECE, Position, Pressure, Records, ReferenceDensity, Solid, Vector, Volume, Wall,
    Workspace, columns,
};
use crate::scene::SceneSettings;

/// How the density of detached particles is found: section `free_surface` of a scene. Without effect where there is a
/// background pressure χ, and so no free surface.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum FreeSurface {
    /// By Eq. 5, as everywhere: spray keeps the tension in which it left.
    Off,
    /// By summation over the neighbours, and at least ρ0.
    #[default]
    Summation,
}

impl SceneSettings for FreeSurface {
    const NAME: &'static str = "free_surface";
}

/// φ of a point on a flat surface: below it a particle is detached.
pub(crate) const LEAST_FILLING: f64 = 0.5;

/// A particle with more than this φ in the middle of the drift is taken not to be detached at its end, as if φ did not change by as much as
/// the margin in half a step; below, φ is summed anew there.
pub(crate) const CLEAR_FILLING: f64 = 0.58;

/// Sets density and pressure of every fluid particle that is detached.
pub fn free_surface<const D: usize>(
    setting: Res<FreeSurface>,
    sums: Res<MidwaySums>,
    kernel: Res<SmoothingKernel>,
    state: Res<EquationOfState>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    mut fluid: Query<(&Position, &Mass, &ReferenceDensity, &mut Density, &mut Pressure), With<Fluid>>,
    walls: Query<(&Position, &Volume), With<Wall>>,
    structures: Query<(&Position, &Volume), With<Solid>>,
) -> Result {
    if *setting == FreeSurface::Off || state.background_pressure > 0.0 {
        return Ok(());
    }
    let [walls, structures] = [columns(&walls), columns(&structures)].map(|(x, volume): (&[Position], &[Volume])| {
        move |b: usize| Gathered { position: x[b].0.into(), state: volume[b].0 }
    });
    for (x, m, rho0, mut rho, mut p) in fluid.contiguous_iter_mut()? {
        if sums.is_clear().is_some_and(|is_clear| is_clear.iter().all(|is| *is)) {
            continue;
        }
        let (rho, p) = (rho.bypass_change_detection(), p.bypass_change_detection());
        let own = |i: usize| Gathered { position: x[i].0.into(), state: m[i].0 / rho[i].0 };
        let records = workspace.gather::<D, f64>(&neighbours.rows, own, walls, structures);
        let sweep = Sweep::new(&neighbours, &*kernel.0, records, Filling);
        (rho.par_chunks_mut(PIECE), p.par_chunks_mut(PIECE)).into_par_iter().enumerate().for_each(
            |(piece, (rho, p))| {
                let mut settle = |i: usize, filled: f64| {
                    if filled < LEAST_FILLING * D as f64 {
                        let sum = kernel_sum(i, neighbours.fluid.of(i), records, &kernel);
                        let k = i - piece * PIECE;
                        rho[k].0 = rho0[i].0 * sum.max(1.0);
                        p[k].0 = state.pressure(rho[k].0, rho0[i].0);
                    }
                };
                let rows = piece * PIECE..x.len().min((piece + 1) * PIECE);
                for first in rows.clone().step_by(CLUSTER) {
                    let particles = CLUSTER.min(rows.end - first);
                    let is_clear = sums.is_clear().map(|is_clear| &is_clear[first..first + particles]);
                    if !is_clear.is_some_and(|is_clear| is_clear.iter().all(|is| *is)) {
                        sweep.sum(first, particles, |k, sum| settle(first + k, -sum.total()));
                    }
                }
            },
        );
    }
    Ok(())
}

/// `−d φ_i = Σ_j V_j r_ij·∇_iW_ij` of volumes, axis by axis: over fluid it is −tr K_i, which another sum may know already.
pub(super) struct Filling;

impl<const D: usize> PairTerm<D> for Filling {
    type State = f64;
    type Sum = Vector<D>;

    #[inline(always)]
    fn fluid<R: Real>(&self, sum: &mut Vector<D, R>, _: &R, volume_j: &R, pair: &Pair<D, R>) {
        let volume_grad_w = pair.r_ij * (pair.gradient * *volume_j);
        sum.add_each_product(pair.r_ij, volume_grad_w);
    }
}

/// Σ_j V_j W_ij, with i itself, which is among what is near it.
fn kernel_sum<const D: usize>(i: usize, near: Near<'_>, records: Records<'_, D, f64>, kernel: &SmoothingKernel) -> f64 {
    let x_i = records.get(i).position;
    let near = near.rows().map(|row| {
        let other = records.get(row as usize);
        let r_ij = x_i - other.position;
        other.state * kernel.value(r_ij.dot(r_ij).sqrt())
    });
    near.sum()
}
