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
use storegga::neighbours::{Neighbours, sum_pairs};
use storegga::particles::{Density, Fluid, Gather, Gathered, Mass, Position, Solid, Wall, columns};
use storegga::scene::Resolution;

use crate::{FineSediment, TurbiditySection};

/// What diffusion needs of a particle.
#[derive(Debug, Clone, Copy)]
pub struct Suspension {
    /// c (kg/kg).
    fraction: f64,
    /// k = ρκ (kg/(m s)); 0 for walls and structures.
    conductivity: f64,
    /// V = m/ρ (m³; m² in 2D).
    volume: f64,
}

/// c ← c + Δt dc/dt. The plane z = 0 is a part of space: one system serves 2D and 3D.
pub fn spread(
    settings: Res<TurbiditySection>,
    clock: Res<Clock>,
    neighbours: Res<Neighbours>,
    mut gather: Local<Gather<3, Suspension>>,
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
        let records = gather.fill(&neighbours.rows, own, walls, structures);
        c.par_iter_mut().enumerate().for_each(|(i, c)| {
            let own = &records[i];
            let Suspension { fraction: c_i, conductivity: k_i, volume: v_i } = own.state;
            let mut sum = 0.0;
            sum_pairs(own, neighbours.fluid.of(i), records, |other, pair| {
                let k_ij = 4.0 * k_i * other.conductivity / (k_i + other.conductivity);
                sum += k_ij * v_i * other.volume * (c_i - other.fraction) * pair.gradient;
            });
            c.0 += clock.time_step * sum / m[i].0;
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
