//! Conservation of mass, Eq. 5.
//!
//! `dρ_i/dt = ρ_i Σ_j V_j v_ij·∇_iW_ij`, j over fluid, walls and structures; the velocity of a wall is that with which
//! it moves, v_w.

use bevy_ecs::prelude::*;
use rayon::prelude::*;

use crate::neighbours::{Neighbours, sum_pairs};
use crate::particles::{
    Density, DensityRate, Fluid, GRAIN, Gather, Gathered, Mass, PIECE, Position, Solid, Vector, Velocity, Volume, Wall,
    WallVelocity, columns,
};

/// What the continuity equation needs of a particle.
#[derive(Debug, Clone, Copy)]
pub struct Flux<const D: usize> {
    velocity: Vector<D>,
    volume: f64,
}

type Ghosts = (&'static Position, &'static WallVelocity, &'static Volume);

/// Computes dρ/dt of every fluid particle.
pub fn density_rate<const D: usize>(
    neighbours: Res<Neighbours>,
    mut gather: Local<Gather<D, Flux<D>>>,
    mut fluid: Query<(&Position, &Velocity, &Mass, &Density, &mut DensityRate), With<Fluid>>,
    walls: Query<Ghosts, With<Wall>>,
    structures: Query<Ghosts, With<Solid>>,
) -> Result {
    let ghosts =
        [columns(&walls), columns(&structures)].map(|(x, v, volume): (&[Position], &[WallVelocity], &[Volume])| {
            move |b: usize| Gathered {
                position: x[b].0.into(),
                state: Flux { velocity: v[b].0.into(), volume: volume[b].0 },
            }
        });
    let [walls, structures] = ghosts;
    for (x, v, m, rho, mut rate) in fluid.contiguous_iter_mut()? {
        let own = |i: usize| Gathered {
            position: x[i].0.into(),
            state: Flux { velocity: v[i].0.into(), volume: m[i].0 / rho[i].0 },
        };
        let records = gather.fill(&neighbours.rows, own, walls, structures);
        let out = rate.bypass_change_detection().par_iter_mut().with_min_len(GRAIN).with_max_len(PIECE);
        out.enumerate().for_each(|(i, rate)| {
            let own = &records[i];
            let mut sum = 0.0;
            sum_pairs(own, neighbours.fluid.of(i), records, |other, pair| {
                let v_ij = own.state.velocity - other.velocity;
                sum += other.volume * v_ij.dot(pair.grad_w());
            });
            rate.0 = rho[i].0 * sum;
        });
    }
    Ok(())
}
