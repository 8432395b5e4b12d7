//! Velocity of ghost particles, Eq. 16 (Adami et al. 2012).
//!
//! No slip: `v_b = 2 v_w − Σ_f (v_f + ω_w × (x_b − x_f)) W_bf / Σ_f W_bf`. A ghost with no fluid near it moves with its body,
//! `v_b = v_w`. (With free slip nothing reads v_b: the wall is left out of ∇v and of the viscous force.)
//!
//! The term with the angular velocity ω_w of the body is not in the paper: with it what is mirrored is the velocity in the
//! frame of the body, `v_b − v_w(x_b) = −⟨v_f − v_w(x_f)⟩`. Without it a drum drives the fluid that turns with it (by 3 % too
//! fast in a drum 40 spacings wide), since its ghosts are farther from the axis and faster than its surface.

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;

use crate::neighbours::{Neighbours, PairList, Rows};
use crate::particles::{
    Fluid, GRAIN, GhostVelocity, PIECE, Position, Solid, Velocity, Wall, WallAngularVelocity, WallVelocity, columns,
};

type GhostState = (&'static Position, &'static WallVelocity, &'static WallAngularVelocity, &'static mut GhostVelocity);

/// Extrapolates the fluid's velocity to every wall and structure particle.
pub fn ghost_velocity(
    neighbours: Res<Neighbours>,
    fluid: Query<(&Position, &Velocity), With<Fluid>>,
    mut walls: Query<GhostState, (With<Wall>, Without<Fluid>)>,
    mut structures: Query<GhostState, (With<Solid>, Without<Fluid>, Without<Wall>)>,
) -> Result {
    let fluid: (&[Position], &[Velocity]) = columns(&fluid);
    for (x, v_w, omega_w, mut v_b) in walls.contiguous_iter_mut()? {
        let out = v_b.bypass_change_detection();
        extrapolate(&neighbours.rows, &neighbours.walls, fluid, (x, v_w, omega_w), out);
    }
    for (x, v_w, omega_w, mut v_b) in structures.contiguous_iter_mut()? {
        let out = v_b.bypass_change_detection();
        extrapolate(&neighbours.rows, &neighbours.structures, fluid, (x, v_w, omega_w), out);
    }
    Ok(())
}

/// Eq. 16 for every ghost of one table.
fn extrapolate(
    rows: &Rows,
    list: &PairList,
    (x_f, v_f): (&[Position], &[Velocity]),
    (x_b, v_w, omega_w): (&[Position], &[WallVelocity], &[WallAngularVelocity]),
    v_b: &mut [GhostVelocity],
) {
    v_b.par_iter_mut().with_min_len(GRAIN).with_max_len(PIECE).enumerate().for_each(|(b, v_b)| {
        let pairs = list.of(b);
        let turns = omega_w[b].0 != DVec3::ZERO;
        let (mut sum_vw, mut sum_rw, mut sum_w) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for (&row, &w) in pairs.rows.iter().zip(pairs.values) {
            let f = rows.source(row);
            sum_vw += v_f[f].0 * w;
            sum_w += w;
            if turns {
                sum_rw += (x_b[b].0 - (x_f[f].0 + rows.shift(row))) * w;
            }
        }
        let mirrored = (sum_vw + omega_w[b].0.cross(sum_rw)) / sum_w;
        v_b.0 = if sum_w > 0.0 { 2.0 * v_w[b].0 - mirrored } else { v_w[b].0 };
    });
}
