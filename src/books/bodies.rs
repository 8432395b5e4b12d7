//! What walls and structures do to the fluid beside them: forces and their power, kind by kind, and `G_ib`.

use glam::DVec3;

use super::sums::{BodySums, Kind};
use super::sweep::Account;
use crate::kernels::SmoothingKernel;
use crate::neighbours::{Neighbours, Pair};
use crate::particles::WallVelocity;
use crate::physics::{self, Momentum, NearGhosts, PressureAverage, ViscousForce, impact_force, pair_forces};

/// What the books read of walls or of structures.
pub(super) type BodyColumns<'a> = (physics::GhostColumns<'a>, &'a [WallVelocity]);

/// The ghosts near fluid; the second column says whether they are those of structures.
pub(super) struct NearBodies<'a>(NearGhosts<'a, (BodyColumns<'a>, bool)>);

/// The ghosts of walls, then of structures.
pub(super) fn near_bodies<'a>(
    kernel: &'a SmoothingKernel,
    neighbours: &'a Neighbours,
    [walls, structures]: [BodyColumns<'a>; 2],
) -> NearBodies<'a> {
    let positions = [walls.0.0, structures.0.0];
    NearBodies(NearGhosts { kernel, rows: &neighbours.rows, positions, columns: [(walls, false), (structures, true)] })
}

impl NearBodies<'_> {
    /// Enters in `sums` what the ghosts in the rows `near` do to the fluid particle `own` at `x_i` with the impact pressure `p_w` (Pa);
    /// gives back Σ_b G_ib.
    #[inline(always)]
    pub fn act<const D: usize, P: PressureAverage, V: ViscousForce>(
        &self,
        x_i: DVec3,
        own: &Account<D>,
        p_w: f64,
        near: &[u32],
        sums: &mut BodySums,
    ) -> DVec3 {
        let i = own.momentum();
        let mut ghosts = DVec3::ZERO;
        self.0.each(
            x_i,
            near,
            #[inline(always)]
            |(((_, v, volume, rho, p, slip), v_w), is_structure), b, r_ib, gradient| {
                let body = Momentum::ghost(v[b], volume[b], rho[b], p[b], slip[b]);
                let pair = Pair { r_ij: r_ib.into(), gradient };
                let (pressure, viscous) = pair_forces::<D, P, V>(i.viscosity * body.viscosity, &i, &body, &pair);
                let impact = impact_force(p_w, &i, &body, &pair);
                let ghost = pressure + pair.grad_w() * (own.pressure * own.volume * volume[b].0);
                let [force, viscous, impact, ghost] =
                    [pressure + viscous + impact, viscous, impact, ghost].map(DVec3::from);
                ghosts += ghost;
                *(if is_structure { &mut sums.structures } else { &mut sums.walls }) += force;
                sums.power += force.dot(v_w[b].0);
                for (kind, force) in [(Kind::Viscous, viscous), (Kind::Impact, impact), (Kind::Ghosts, ghost)] {
                    sums.of_kind[kind as usize] += force.dot(v_w[b].0);
                }
            },
        );
        ghosts
    }
}
