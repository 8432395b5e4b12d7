//! The flow carries fine sediment along with its particles; between them it spreads.
//!
//! `ρ dc/dt = ∇·(ρ κ ∇c)`, after Cleary & Monaghan 1999 (their conduction, J. Comput. Phys. 148, with k = ρκ):
//!
//! `m_i dc_i/dt = Σ_j [4 k_i k_j/(k_i + k_j)] V_i V_j (c_i − c_j) F_ij`, F_ij = r_ij·∇_iW_ij/r² ≤ 0, j over fluid particles.
//!
//! Walls and structures let nothing through; along them less is spread than in the open, since neighbours are missing there. What i gives to j, j gets from i: the mass Σ m_i c_i is conserved to round-off.

use bevy_ecs::prelude::*;
use rayon::prelude::*;
use storegga::clock::{Clock, Limit};
use storegga::kernels::SmoothingKernel;
use storegga::lanes::{Real, fields};
use storegga::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use storegga::particles::{Density, Fluid, Gathered, Mass, PIECE, Position, Solid, Wall, Workspace, columns};
use storegga::scene::Resolution;

use crate::{FineSediment, TurbiditySection};

fields! {
    /// What diffusion needs of a particle.
    pub struct Suspension<D> {
        /// c (kg/kg).
        fraction: f64,
        /// k = ρκ (kg/(m s)).
        conductivity: f64,
        /// V = m/ρ (m³; m² in 2D).
        volume: f64,
    }
}

/// `Σ_j [4 k_i k_j/(k_i + k_j)] V_i V_j (c_i − c_j) F_ij` (kg/s).
struct Spreading;

impl<const D: usize> PairTerm<D> for Spreading {
    type State = Suspension<D>;
    type Sum = f64;

    #[inline(always)]
    fn fluid<R: Real>(&self, sum: &mut R, i: &Suspension<D, R>, j: &Suspension<D, R>, pair: &Pair<D, R>) {
        let k_ij = i.conductivity * j.conductivity * 4.0 / (i.conductivity + j.conductivity);
        *sum += k_ij * i.volume * j.volume * (i.fraction - j.fraction) * pair.gradient;
    }

    /// Walls and structures let nothing through.
    #[inline(always)]
    fn ghost<R: Real>(&self, _: &mut R, _: &Suspension<D, R>, _: &Suspension<D, R>, _: &Pair<D, R>) {}
}

/// c ← c + Δt dc/dt. The plane z = 0 is a part of space: one system serves 2D and 3D.
#[expect(clippy::too_many_arguments, reason = "the signature says what the system reads and writes")]
pub fn spread(
    settings: Res<TurbiditySection>,
    clock: Res<Clock>,
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    mut fluid: Query<(&Position, &Mass, &Density, &mut FineSediment), With<Fluid>>,
    walls: Query<&Position, With<Wall>>,
    structures: Query<&Position, With<Solid>>,
) -> Result {
    let [walls, structures] = [columns(&walls), columns(&structures)].map(|x: &[Position]| {
        let state = Suspension { fraction: 0.0, conductivity: 0.0, volume: 0.0 };
        move |b: usize| Gathered { position: x[b].0.into(), state }
    });
    if settings.diffusivity == 0.0 {
        return Ok(());
    }
    for (x, m, rho, mut c) in fluid.contiguous_iter_mut()? {
        let c = c.bypass_change_detection();
        let own = |i: usize| Gathered {
            position: x[i].0.into(),
            state: Suspension {
                fraction: c[i].0,
                conductivity: rho[i].0 * settings.diffusivity,
                volume: m[i].0 / rho[i].0,
            },
        };
        let records = workspace.gather::<3, Suspension<3>>(&neighbours.rows, own, walls, structures);
        let sweep = Sweep::new(&neighbours, &*kernel.0, records, Spreading);
        c.par_chunks_mut(PIECE).enumerate().for_each(|(piece, c)| {
            let first = piece * PIECE;
            sweep.sum(first, c.len(), |k, sum| c[k].0 += clock.time_step * sum / m[first + k].0);
        });
    }
    Ok(())
}

/// Coefficient of the greatest stable time step (Cleary & Monaghan 1999 take 0.15 in one dimension; 0.1 serves all).
const STABLE: f64 = 0.1;

/// Δt ≤ 0.1 h²/κ, after Eq. 19 has had its say.
pub fn limit_time_step(settings: Res<TurbiditySection>, resolution: Res<Resolution>, mut clock: ResMut<Clock>) {
    let stable = STABLE * resolution.smoothing_length.powi(2) / settings.diffusivity;
    if stable < clock.stable_time_step {
        (clock.stable_time_step, clock.stable_limit) = (stable, Limit::Plugin);
    }
}
