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
//! `d_i` is how far from a flat wall the wall's part of the kernel's gradient would be as great: `W₁(d_i) = |Σ_b V_b ∇_iW_ib|`; at least half a
//! spacing, nearer than which W₁ is flat and no particle rests. In corners and beside curved walls it is an estimate: 0.5 spacings for the first
//! particle in a right corner, 0.55 beside a cylinder of five spacings' radius. `v_w = ⟨v_b^w + ω_w × r_ib⟩`, over the ghosts b, is the velocity of
//! the body where the particle is: fluid that turns with its drum does not jump.
//!
//! Every rheology but `Newtonian`, whose viscosity does not depend on γ̇, is treated so. Here `∇_iW_ib = F_ib r_ib`, and W₁ is the
//! integral of the kernel over the plane (in 2D the line) at a distance.

use std::f64::consts::PI;

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;

use super::StrainSettings;
use super::near_ghosts::{NearGhosts, half_space};
use crate::kernels::SmoothingKernel;
use crate::neighbours::Neighbours;
use crate::particles::{
    Fluid, GRAIN, PIECE, PhaseIndex, Position, ShearRate, Slip, Solid, Velocity, Volume, Wall, WallAngularVelocity,
    WallVelocity, columns,
};
use crate::phases::Phase;
use crate::rheology::Newtonian;
use crate::scene::Resolution;

/// W₁ at equal steps of the distance from a flat wall.
pub struct Distances {
    /// W₁ (1/m) at 0, 1, 2, … steps; falls.
    wall_kernel: Vec<f64>,
    /// One step (m).
    step: f64,
    /// The least distance (m) that is told: half a spacing.
    least: f64,
}

/// Steps from the surface of a wall to as far as the kernel reaches.
const STEPS: usize = 128;

impl Distances {
    fn new(kernel: &SmoothingKernel, resolution: &Resolution) -> Self {
        let step = kernel.0.radius() / STEPS as f64;
        let wall_kernel = (0..=STEPS).map(|k| wall_kernel(kernel, resolution.dimension, k as f64 * step)).collect();
        Self { wall_kernel, step, least: 0.5 * resolution.spacing }
    }

    /// Distance (m) from a flat wall at which W₁ is `normal` (1/m); none out of its reach.
    fn at(&self, normal: f64) -> Option<f64> {
        let k = self.wall_kernel.partition_point(|&of_step| of_step >= normal);
        if k == 0 {
            return Some(self.least);
        }
        let (nearer, farther) = (self.wall_kernel[k - 1], *self.wall_kernel.get(k)?);
        let distance = self.step * (k as f64 - 1.0 + (nearer - normal) / (nearer - farther));
        Some(distance.max(self.least))
    }
}

/// W₁ (1/m) at `distance` (m): `−∫ n·∇W` over the half-space behind a flat wall.
fn wall_kernel(kernel: &SmoothingKernel, dimension: usize, distance: f64) -> f64 {
    // r ∫ cos θ over the arc or cap of the circle or sphere of radius r that lies behind the wall.
    let along_normal = |r: f64| {
        let squared = r * r - distance * distance;
        r * if dimension == 2 { 2.0 * squared.sqrt() } else { PI * squared }
    };
    -half_space(kernel, distance, along_normal)
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
    weight: f64,
    /// The same times the velocity (m/s) of the body where the particle is.
    wall_velocity: DVec3,
    /// −Σ_b V_b ∇_iW_ib (1/m), into the wall.
    normal: DVec3,
}

type GhostState =
    (&'static Position, &'static WallVelocity, &'static WallAngularVelocity, &'static Volume, &'static Slip);
type GhostColumns<'a> = (&'a [Position], &'a [WallVelocity], &'a [WallAngularVelocity], &'a [Volume], &'a [Slip]);

/// Raises γ̇ of the fluid beside walls and structures to which it sticks.
pub fn wall_shear(
    settings: Res<StrainSettings>,
    resolution: Res<Resolution>,
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    (mut distances, mut newtonian): (Local<Option<Distances>>, Local<Vec<bool>>),
    phases: Query<(&Phase, Has<Newtonian>)>,
    mut fluid: Query<(&PhaseIndex, &Position, &Velocity, &mut ShearRate), With<Fluid>>,
    walls: Query<GhostState, With<Wall>>,
    structures: Query<GhostState, With<Solid>>,
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
    let [walls, structures]: [GhostColumns<'_>; 2] = [columns(&walls), columns(&structures)];
    let ghosts = NearGhosts {
        kernel: &kernel,
        rows: &neighbours.rows,
        positions: [walls.0, structures.0],
        columns: [walls, structures],
    };
    for (phase, x, v, mut shear_rate) in fluid.contiguous_iter_mut()? {
        let out = shear_rate.bypass_change_detection().par_iter_mut().with_min_len(GRAIN).with_max_len(PIECE);
        out.enumerate().for_each(|(i, shear_rate)| {
            let near = neighbours.fluid.of(i).ghosts;
            if near.is_empty() || newtonian[phase[i].0 as usize] {
                return;
            }
            let mut sums = Sums::default();
            ghosts.each(x[i].0, near, |(_, v_w, omega_w, volume, slip), b, r_ib, gradient| {
                if slip[b] != Slip::FreeSlip {
                    let volume_grad_w = r_ib * (gradient * volume[b].0);
                    let weight = -r_ib.dot(volume_grad_w);
                    sums.weight += weight;
                    sums.wall_velocity += (v_w[b].0 + omega_w[b].0.cross(r_ib)) * weight;
                    sums.normal -= volume_grad_w;
                }
            });
            if let Some(d_i) = distances.at(sums.normal.length()) {
                let relative = v[i].0 - sums.wall_velocity / sums.weight;
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
    fn a_distance_is_that_at_which_a_wall_weighs_as_much() {
        let mut registry = KernelRegistry::default();
        registry.register("quintic", QuinticSpline);
        for dimension in [2, 3] {
            let kernel = registry.scaled("quintic", 1.2, dimension).expect("registered above");
            let resolution = Resolution { dimension, spacing: 1.0, smoothing_length: 1.2 };
            let distances = Distances::new(&kernel, &resolution);
            for distance in [0.51, 0.77, 1.31, 2.9] {
                // The kernel over the plane at that distance, by its values.
                let step = 1e-3;
                let ring = |r: f64| if dimension == 2 { 2.0 } else { 2.0 * PI * r };
                let plane = (0..4000).map(|k| (f64::from(k) + 0.5) * step);
                let mut values: Vec<f64> = plane.clone().map(|r| r * r + distance * distance).collect();
                kernel.0.values(&mut values);
                let normal: f64 = plane.zip(&values).map(|(r, w)| w * ring(r) * step).sum();
                let found = distances.at(normal).expect("near the wall");
                assert!((found - distance).abs() < 1e-3, "{dimension}D: {found} instead of {distance}");
            }
            assert_eq!(distances.at(0.0), None);
            for inside in [wall_kernel(&kernel, dimension, 0.1), 9.0] {
                assert_eq!(distances.at(inside), Some(0.5));
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
