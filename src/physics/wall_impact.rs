//! Pressure with which walls and structures stop fluid that comes too near to them.
//!
//! `p^w_i = ρ_i c_i (s_i u_i + c_i d_i/dp)`, with the speed of approach `u_i = 2h max(Σ_b V_b v_ib·∇_iW_ib, 0)`, b over the ghosts of walls
//! and structures, v_ib against the velocity v_w of the wall. It is the dissipative part ½ρc(u_L − u_R) of the linearised
//! Riemann problem between a particle and its mirror image in the wall (Zhang, Hu & Adams 2017, J. Comput. Phys. 335),
//! and drives particle and ghost apart like a pressure of both: `−p^w_i (V_i² + V_b²) ∇_iW_ib`. (`2h |Σ_b V_b ∇_iW_ib|` is near 1
//! beside a flat wall.)
//!
//! s_i makes it act on what is nearer to a flat wall than the first layer of a fluid at rest, half a spacing, and leave all else
//! alone (in a corner, which fills more of a neighbourhood, it damps the first layer's approach as well):
//! `s_i = min(max((φ_i − φ_0)/(φ_1 − φ_0), 0), 1)`. `φ_i = −(1/d) Σ_b V_b r_ib·∇_iW_ib` is how much of the particle's neighbourhood the
//! wall takes up: ½ on the surface of a flat wall, φ_0 and φ_1 0.45 and 0.25 spacings in front of it. (The
//! two distances come from trials on the shipped dam break, not from the literature.)
//!
//! What has come a quarter of a spacing behind the surface is pushed back: `d_i = max(depth_i − ¼ dp, 0)` with its depth (m) in the wall as
//! the shape of the wall has it, and the wall is as stiff there as the fluid is. A particle deeper than a spacing has not come through the
//! surface, and has `d_i = 0`. The spring is no literature's either: without it grains of the shipped flume ended in its wall, and went
//! round with it. It begins so deep since the ghosts beside an edge push aside: from the surface on, it flung what slid along a face over
//! the edge, and gave the shipped dam break on a post at 50 mm a third of the energy that this turns over; from 0.1 spacings on it still gave some.
//!
//! Without p^w jets leak: in a thin sheet density follows the diffusion and the neighbours that the sheet has lost, and
//! no longer tells how near the wall is.

use std::f64::consts::PI;

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use glam::DVec3;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::EquationOfState;
use super::near_ghosts::{NearGhosts, half_space};
use crate::boundary::{BodyShape, Motion};
use crate::clock::Clock;
use crate::kernels::SmoothingKernel;
use crate::neighbours::{Neighbours, PeriodicSides};
use crate::particles::{
    Density, Fluid, GRAIN, PIECE, Position, ReferenceDensity, Solid, Velocity, Volume, Wall, WallVelocity, columns,
};
use crate::scene::{Resolution, SceneSettings};

/// Whether walls and structures stop fluid that comes too near: section `wall_impact` of a scene.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum WallImpact {
    /// Ghost pressure (Eq. 15) alone, as in the paper: thin jets can enter walls.
    Off,
    /// With the impact pressure of the one-sided Riemann problem, and a spring that pushes out what has come a quarter of a spacing in.
    #[default]
    Riemann,
}

impl SceneSettings for WallImpact {
    const NAME: &'static str = "wall_impact";
}

/// p^w (Pa) of every fluid particle, row by row, with which walls act on one that is about to enter them, beside the pressure; empty where
/// nobody computes it. It holds from [`Stage::WallImpact`](crate::schedule::Stage) to the end of the step: who replaces that stage
/// writes all rows in every step, since they are re-sorted between steps.
#[derive(Resource, Debug, Clone, Default)]
pub struct ImpactPressures(pub Vec<f64>);

impl ImpactPressures {
    /// That of fluid particle `i`, or zero.
    #[inline(always)]
    pub(crate) fn of(&self, i: usize) -> f64 {
        if self.0.is_empty() { 0.0 } else { self.0[i] }
    }
}

/// Σ_b of one fluid particle.
#[derive(Clone, Copy)]
struct Sums {
    /// Σ_b V_b v_ib·∇_iW_ib (1/s).
    approach: f64,
    /// −Σ_b V_b r_ib·∇_iW_ib.
    fullness: f64,
    /// |r_ib|² (m²) of the nearest ghost.
    nearest: f64,
}

/// What is behind the surface of a body has a ghost so near (in spacings): half the diagonal of a cell. What rests on the surface has none.
pub(crate) const BEHIND: f64 = 0.87;

/// What is deeper behind the surface (in spacings) is pushed out.
pub(crate) const PUSHED: f64 = 0.25;

/// Computes p^w of every fluid particle.
pub fn wall_impact(
    setting: Res<WallImpact>,
    resolution: Res<Resolution>,
    kernel: Res<SmoothingKernel>,
    state: Res<EquationOfState>,
    neighbours: Res<Neighbours>,
    mut layers: Local<Option<[f64; 2]>>,
    mut impact: ResMut<ImpactPressures>,
    fluid: Query<(&Position, &Velocity, &Density, &ReferenceDensity), With<Fluid>>,
    walls: Query<(&Position, &WallVelocity, &Volume), With<Wall>>,
    structures: Query<(&Position, &WallVelocity, &Volume), With<Solid>>,
    depth: Depth,
) {
    if *setting == WallImpact::Off {
        impact.0.clear();
        return;
    }
    let (dimension, dp, h) = (resolution.dimension, resolution.spacing, resolution.smoothing_length);
    let [phi_0, phi_1] = *layers.get_or_insert_with(|| fullness_in_front(&kernel, &resolution));
    let [walls, structures]: [(&[Position], &[WallVelocity], &[Volume]); 2] = [columns(&walls), columns(&structures)];
    let ghosts = NearGhosts {
        kernel: &kernel,
        rows: &neighbours.rows,
        positions: [walls.0, structures.0],
        columns: [(walls.1, walls.2), (structures.1, structures.2)],
    };
    let (x, v, rho, rho0): (&[Position], &[Velocity], &[Density], &[ReferenceDensity]) = columns(&fluid);
    impact.0.resize(x.len(), 0.0);
    let each = impact.0.par_iter_mut().with_min_len(GRAIN).with_max_len(PIECE).enumerate();
    each.for_each(|(i, impact)| {
        let mut sums = Sums { approach: 0.0, fullness: 0.0, nearest: f64::INFINITY };
        ghosts.each(x[i].0, neighbours.fluid.of(i).ghosts, |(v_w, volume), b, r_ib, gradient| {
            let volume_grad_w = r_ib * (gradient * volume[b].0);
            sums.approach += (v[i].0 - v_w[b].0).dot(volume_grad_w);
            sums.fullness -= r_ib.dot(volume_grad_w);
            sums.nearest = sums.nearest.min(r_ib.length_squared());
        });
        let phi = sums.fullness / dimension as f64;
        let s = ((phi - phi_0) / (phi_1 - phi_0)).clamp(0.0, 1.0);
        let u = 2.0 * h * sums.approach.max(0.0);
        let c = state.sound_speed(rho0[i].0);
        let d = if sums.nearest < (BEHIND * dp).powi(2) { depth.of(x[i].0) } else { 0.0 };
        *impact = rho[i].0 * c * (s * u + c * d / dp);
    });
}

/// How deep particles are in walls and structures.
#[derive(SystemParam)]
pub struct Depth<'w, 's> {
    clock: Res<'w, Clock>,
    resolution: Res<'w, Resolution>,
    periodic: Res<'w, PeriodicSides>,
    bodies: Query<'w, 's, (&'static BodyShape, &'static Motion)>,
}

impl Depth<'_, '_> {
    /// d (m) of a particle at `x`: how much deeper than a quarter of a spacing it is behind the surface of a wall or structure; nothing if it is
    /// deeper than a spacing.
    fn of(&self, x: DVec3) -> f64 {
        let depths = self.bodies.iter().map(|(body, motion)| {
            let moved = motion.at(self.clock.time).map(|now| now.inverse());
            -body.clearance_moved(&self.periodic, moved.as_ref(), x)
        });
        let spacing = self.resolution.spacing;
        depths.filter(|depth| *depth <= spacing).map(|depth| depth - PUSHED * spacing).fold(0.0, f64::max)
    }
}

/// φ_0 and φ_1 of the run.
pub(crate) fn fullness_in_front(kernel: &SmoothingKernel, resolution: &Resolution) -> [f64; 2] {
    [0.45, 0.25].map(|spacings| wall_fullness(kernel, resolution.dimension, spacings * resolution.spacing))
}

/// φ at `distance` (m) in front of a flat wall: `−(1/d) ∫ r·∇W` over the half-space behind it.
fn wall_fullness(kernel: &SmoothingKernel, dimension: usize, distance: f64) -> f64 {
    // r² times the arc or cap of the circle or sphere of radius r that lies behind the wall.
    let behind =
        |r: f64| r * r * if dimension == 2 { 2.0 * r * (distance / r).acos() } else { 2.0 * PI * r * (r - distance) };
    -half_space(kernel, distance, behind) / dimension as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::{KernelRegistry, QuinticSpline, WendlandC2};

    /// On the wall's surface half the neighbourhood is wall, whatever the kernel; out of reach, none; and far behind it
    /// the integral over the whole space, which is 1, would be approached from below.
    #[test]
    fn fullness_is_a_half_on_the_surface_and_falls_to_nothing() {
        let mut registry = KernelRegistry::default();
        registry.register("quintic", QuinticSpline);
        registry.register("wendland", WendlandC2);
        for (name, dimension) in [("quintic", 2), ("quintic", 3), ("wendland", 2), ("wendland", 3)] {
            let kernel = registry.scaled(name, 1.2, dimension).expect("registered above");
            let at = |distance| wall_fullness(&kernel, dimension, distance);
            assert!((at(0.0) - 0.5).abs() < 1e-4, "{name} {dimension}D: {}", at(0.0));
            assert!(at(0.5) < at(0.25) && at(0.25) < at(0.0) && at(0.5) > 0.0);
            assert_eq!(at(kernel.0.radius()), 0.0);
        }
    }
}
