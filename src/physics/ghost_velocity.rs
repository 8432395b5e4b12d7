//! Velocity of ghost particles, Eq. 16 (Adami et al. 2012).
//!
//! No slip: `v_b = 2 v_w − Σ_f v_f W_bf / Σ_f W_bf`. A ghost with no fluid near it moves with its body, `v_b = v_w`.
//! (With free slip nothing reads v_b: the wall is left out of ∇v and of the viscous force.)

use bevy_ecs::prelude::*;
use rayon::prelude::*;

use crate::neighbours::{Neighbours, PairList};
use crate::particles::{Fluid, GRAIN, GhostVelocity, PIECE, Solid, Velocity, Wall, WallVelocity, columns};

/// Extrapolates the fluid's velocity to every wall and structure particle.
pub fn ghost_velocity(
    neighbours: Res<Neighbours>,
    fluid: Query<&Velocity, With<Fluid>>,
    mut walls: Query<(&WallVelocity, &mut GhostVelocity), With<Wall>>,
    mut structures: Query<(&WallVelocity, &mut GhostVelocity), (With<Solid>, Without<Wall>)>,
) -> Result {
    let velocity: &[Velocity] = columns(&fluid);
    let extrapolate = |list: &PairList, v_w: &[WallVelocity], v_b: &mut [GhostVelocity]| {
        (v_w, v_b).into_par_iter().with_min_len(GRAIN).with_max_len(PIECE).enumerate().for_each(|(b, (v_w, v_b))| {
            let pairs = list.of(b);
            let (mut sum_vw, mut sum_w) = (glam::DVec3::ZERO, 0.0);
            for (&row, &w) in pairs.rows.iter().zip(pairs.values) {
                sum_vw += velocity[neighbours.rows.source(row)].0 * w;
                sum_w += w;
            }
            v_b.0 = if sum_w > 0.0 { 2.0 * v_w.0 - sum_vw / sum_w } else { v_w.0 };
        });
    };
    for (v_w, mut v_b) in walls.contiguous_iter_mut()? {
        extrapolate(&neighbours.walls, v_w, v_b.bypass_change_detection());
    }
    for (v_w, mut v_b) in structures.contiguous_iter_mut()? {
        extrapolate(&neighbours.structures, v_w, v_b.bypass_change_detection());
    }
    Ok(())
}
