//! Shear rate of fluid that jumps at a wall.
//!
//! `γ̇_i ← γ̇_i + s (Δv/d_i − γ̇_i)`,  `s = min(max(2 Δv/(d_i γ̇_i) − 3, 0), 1)`,
//!
//! with the velocity Δv of the particle along the wall, relative to it, and its distance `d_i` from the surface. (Not in the paper.)
//!
//! A plastic fluid does not shear next to a rough wall: all of its slip is in a layer thinner than any spacing. Eq. 14
//! spreads the jump over the kernel, `γ̇_i = 2 W₁(d_i) Δv` with the one-dimensional kernel W₁, while the pairs across it, all of them
//! near one another, make a stress of more than 2 τ_y with the viscosity τ_y/γ̇_i, whatever the spacing. With `Δv/d_i` it is τ_y: the
//! ghosts mirror the velocity (Eq. 16), so `v_ib = 2 Δv`, and the force per area `Σ_i Σ_b (V_i² + V_b²) |F_ib| μ_i v_ib = τ_y Σ_i Σ_b (V_i² + V_b²) |F_ib| 2 d_i` is
//! τ_y since `2 d_i` is on average `d_i + d_b`, with which the sums are those of a simple shear of unit rate.
//!
//! In a simple shear both rates are the same, and in a resolved layer nearly: up to `Δv/d_i = 1.5 γ̇_i` (s = 0), nothing changes. Beside a
//! jump it is at least 2 γ̇_i (s = 1), with either kernel: `1/(2 d W₁(d))` is 2.5, 2.1, 3.3 half a spacing, one, and one and
//! a half from the wall (quintic spline, h = 1.2 spacings).
//!
//! `d_i` is how far from a flat wall a neighbourhood is as full of wall as that of the particle: `φ(d_i) = −(1/d) Σ_b V_b r_ib·∇_iW_ib`, with φ as in
//! [`wall_impact`](super::wall_impact). The viscosity of a Newtonian fluid does not depend on γ̇: it is left alone.

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;

use super::StrainSettings;
use super::near_ghosts::NearGhosts;
use super::wall_impact::wall_fullness;
use crate::kernels::SmoothingKernel;
use crate::neighbours::Neighbours;
use crate::particles::{
    Fluid, GRAIN, PIECE, PhaseIndex, Position, ShearRate, Slip, Solid, Velocity, Volume, Wall, WallVelocity, columns,
};
use crate::phases::Phase;
use crate::rheology::Newtonian;
use crate::scene::Resolution;

/// φ at equal steps of the distance from a flat wall.
pub struct Distances {
    /// φ at 0, 1, 2, … steps; falls.
    fullness: Vec<f64>,
    /// One step (m).
    step: f64,
}

/// Steps from the surface of a wall to as far as the kernel reaches.
const STEPS: usize = 128;

impl Distances {
    fn new(kernel: &SmoothingKernel, resolution: &Resolution) -> Self {
        let step = kernel.0.radius() / STEPS as f64;
        let fullness = (0..=STEPS).map(|k| wall_fullness(kernel, resolution.dimension, k as f64 * step)).collect();
        Self { fullness, step }
    }

    /// Distance (m) from a flat wall at which φ is `phi`; none out of its reach. A particle on the surface, or behind it,
    /// counts as one that is a step away from it.
    fn at(&self, phi: f64) -> Option<f64> {
        let k = self.fullness.partition_point(|&of_step| of_step >= phi);
        if k <= 1 {
            return Some(self.step);
        }
        let (nearer, farther) = (self.fullness[k - 1], *self.fullness.get(k)?);
        Some(self.step * (k as f64 - 1.0 + (nearer - phi) / (nearer - farther)))
    }
}

/// Δv/d_i over γ̇_i up to which the layer at the wall counts as resolved.
const RESOLVED: f64 = 1.5;
/// Δv/d_i over γ̇_i from which on there is a jump at the wall.
const JUMP: f64 = 2.0;

/// γ̇_i (1/s) where Eq. 14 gives `shear_rate` and the velocity along the wall over the distance from it is `of_wall`.
fn with_jump(shear_rate: f64, of_wall: f64) -> f64 {
    let s = (of_wall - RESOLVED * shear_rate) / ((JUMP - RESOLVED) * shear_rate);
    if s > 0.0 { shear_rate + s.min(1.0) * (of_wall - shear_rate) } else { shear_rate }
}

/// What a particle's neighbourhood is of walls to which fluid sticks.
#[derive(Default)]
struct Sums {
    /// −Σ_b V_b r_ib·∇_iW_ib.
    fullness: f64,
    /// The same times v_w (m/s).
    wall_velocity: DVec3,
    /// Along the normal.
    normal: DVec3,
}

/// Raises γ̇ of the fluid beside walls and structures to which it sticks.
pub fn wall_shear(
    settings: Res<StrainSettings>,
    resolution: Res<Resolution>,
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    (mut distances, mut newtonian): (Local<Option<Distances>>, Local<Vec<bool>>),
    phases: Query<(&Phase, Has<Newtonian>)>,
    mut fluid: Query<(&PhaseIndex, &Position, &Velocity, &mut ShearRate), With<Fluid>>,
    walls: Query<(&Position, &WallVelocity, &Volume, &Slip), With<Wall>>,
    structures: Query<(&Position, &WallVelocity, &Volume, &Slip), With<Solid>>,
) -> Result {
    if !settings.wall_shear {
        return Ok(());
    }
    newtonian.clear();
    newtonian.resize(phases.iter().len(), false);
    for (phase, is_newtonian) in &phases {
        newtonian[phase.index as usize] = is_newtonian;
    }
    let distances = distances.get_or_insert_with(|| Distances::new(&kernel, &resolution));
    let [walls, structures]: [(&[Position], &[WallVelocity], &[Volume], &[Slip]); 2] =
        [columns(&walls), columns(&structures)];
    let ghosts = NearGhosts {
        kernel: &kernel,
        rows: &neighbours.rows,
        positions: [walls.0, structures.0],
        columns: [walls, structures].map(|(_, v_w, volume, slip)| (v_w, volume, slip)),
    };
    for (phase, x, v, mut shear_rate) in fluid.contiguous_iter_mut()? {
        let out = shear_rate.bypass_change_detection().par_iter_mut().with_min_len(GRAIN).with_max_len(PIECE);
        out.enumerate().for_each(|(i, shear_rate)| {
            let near = neighbours.fluid.of(i).ghosts;
            if near.is_empty() || newtonian[phase[i].0 as usize] {
                return;
            }
            let mut sums = Sums::default();
            ghosts.each(x[i].0, near, |(v_w, volume, slip), b, r_ib, gradient| {
                if slip[b] != Slip::FreeSlip {
                    let volume_grad_w = r_ib * (gradient * volume[b].0);
                    let fullness = -r_ib.dot(volume_grad_w);
                    sums.fullness += fullness;
                    sums.wall_velocity += v_w[b].0 * fullness;
                    sums.normal -= volume_grad_w;
                }
            });
            if let Some(d_i) = distances.at(sums.fullness / resolution.dimension as f64) {
                let relative = v[i].0 - sums.wall_velocity / sums.fullness;
                let along = relative.reject_from_normalized(sums.normal.normalize_or_zero());
                shear_rate.0 = with_jump(shear_rate.0, along.length() / d_i);
            }
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::{KernelRegistry, QuinticSpline};

    #[test]
    fn a_distance_is_that_at_which_a_wall_fills_as_much() {
        let mut registry = KernelRegistry::default();
        registry.register("quintic", QuinticSpline);
        for dimension in [2, 3] {
            let kernel = registry.scaled("quintic", 1.2, dimension).expect("registered above");
            let resolution = Resolution { dimension, spacing: 1.0, smoothing_length: 1.2 };
            let distances = Distances::new(&kernel, &resolution);
            for distance in [0.1, 0.48, 0.77, 1.31, 2.9] {
                let found = distances.at(wall_fullness(&kernel, dimension, distance)).expect("near the wall");
                assert!((found - distance).abs() < 1e-3, "{dimension}D: {found} instead of {distance}");
            }
            assert_eq!(distances.at(0.0), None);
            for inside in [0.5, 0.7] {
                assert_eq!(distances.at(inside), Some(distances.step));
            }
        }
    }

    #[test]
    fn a_rate_goes_over_from_that_of_the_fluid_to_that_of_the_jump() {
        for (of_wall, expected) in [(0.0, 2.0), (3.0, 2.0), (3.5, 2.75), (4.0, 4.0), (9.0, 9.0)] {
            assert_eq!(with_jump(2.0, of_wall), expected);
        }
        assert_eq!((with_jump(0.0, 0.0), with_jump(0.0, 1.0)), (0.0, 1.0));
    }
}
