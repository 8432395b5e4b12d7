//! Force and moment of the fluid on structures, Eqs. 17 and 18.
//!
//! `F = Σ_s m_s dv_s/dt`,
//! `m_s dv_s/dt = −Σ_f (p_s V_s² + p_f V_f²) ∇_sW_sf + Σ_f μ_f (V_s² + V_f²) (r_sf·∇_sW_sf)/r² v_sf`
//!
//! with the impact pressure p^w of [`WallImpact`](crate::physics::WallImpact) counted to the pressures (Eq. 6 without g;
//! the ghost takes the viscosity of the fluid particle that acts on it). It is minus what the
//! structure does to the fluid. Pressures count from χ, so that a background pressure leaves no force.

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::Body;
use crate::neighbours::{Neighbours, sum_pairs};
use crate::particles::{
    BodyIndex, Fluid, ForceOnParticle, GRAIN, Gathered, PIECE, PeriodShift, Position, Pressure, Records, Solid, Vector,
    Workspace, columns,
};
use crate::physics::{
    EquationOfState, FluidColumns, FluidState, GhostState, ImpactPressures, Momentum, MomentumSettings,
    PressureAverage, ViscousForce, impact_force, pair_forces, with_forms,
};

/// Marks a body as a structure, and says how its load is reported.
#[derive(Component, Debug, Clone, Copy, PartialEq)]
#[require(Load)]
pub struct Structure {
    /// Out-of-plane length (m) by which forces per metre are multiplied in 2D; 1 where the scene gives none, and in 3D.
    pub length: f64,
    /// Point (m) about which the moment is taken; it does not move with the body.
    pub moment_about: DVec3,
    /// Area (m²) in 2D or volume (m³) in 3D filled by its particles.
    pub volume: f64,
    /// Area or volume that the fluids left free for it at the start: whole cells of the lattice.
    pub displaced: f64,
}

/// Force (N; N/m in 2D where the scene gives no length) and moment (N m; N) of the fluid on a structure.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Load {
    /// Force from the pressure.
    pub pressure_force: DVec3,
    /// Force from the viscous stress.
    pub viscous_force: DVec3,
    /// Moment from the pressure.
    pub pressure_moment: DVec3,
    /// Moment from the viscous stress.
    pub viscous_moment: DVec3,
}

impl Load {
    /// Whole force.
    #[must_use]
    pub fn force(&self) -> DVec3 {
        self.pressure_force + self.viscous_force
    }

    /// Whole moment.
    #[must_use]
    pub fn moment(&self) -> DVec3 {
        self.pressure_moment + self.viscous_moment
    }
}

/// Computes the force on every solid particle.
pub fn force_on_particles<const D: usize>(
    settings: Res<MomentumSettings>,
    state: Res<EquationOfState>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    impact: Res<ImpactPressures>,
    fluid: Query<FluidState, With<Fluid>>,
    mut structures: Query<(GhostState, &mut ForceOnParticle), With<Solid>>,
) -> Result {
    let chi = state.background_pressure;
    let from_chi = |p: Pressure| Pressure(p.0 - chi);
    let (x, v, m, rho, p, mu): FluidColumns<'_> = columns(&fluid);
    for ((x_s, v_s, volume, rho_s, p_s, slip), mut force) in structures.contiguous_iter_mut()? {
        let fluid = |i: usize| {
            let state = Momentum::fluid(v[i], m[i], rho[i], from_chi(p[i]), mu[i]);
            Gathered { position: x[i].0.into(), state }
        };
        let solid = |s: usize| {
            let state = Momentum::ghost(v_s[s], volume[s], rho_s[s], from_chi(p_s[s]), slip[s]);
            Gathered { position: x_s[s].0.into(), state }
        };
        // Structures list fluid only: the walls' records are never read.
        let records = workspace.gather::<D, Momentum<D>>(&neighbours.rows, fluid, |_| solid(0), solid);
        let out = force.bypass_change_detection();
        with_forms!(settings, sum_forces::<D>(&neighbours, records, &impact, out));
    }
    Ok(())
}

fn sum_forces<const D: usize, P: PressureAverage, V: ViscousForce>(
    neighbours: &Neighbours,
    records: Records<'_, D, Momentum<D>>,
    impact: &ImpactPressures,
    out: &mut [ForceOnParticle],
) {
    let first = neighbours.rows.fluid + neighbours.rows.walls;
    out.par_iter_mut().with_min_len(GRAIN).with_max_len(PIECE).enumerate().for_each(|(s, force)| {
        let own = &records.get(first + s);
        let solid = &own.state;
        let (mut pressure_force, mut viscous_force) = (Vector::ZERO, Vector::ZERO);
        sum_pairs(
            own,
            neighbours.structures.of(s),
            records,
            #[inline(always)]
            |row, fluid, pair| {
                let mu_sf = solid.viscosity * fluid.viscosity;
                let (pressure, viscous) = pair_forces::<D, P, V>(mu_sf, solid, fluid, pair);
                pressure_force += pressure + impact_force(impact.of(neighbours.rows.source(row)), solid, fluid, pair);
                viscous_force += viscous;
            },
        );
        *force = ForceOnParticle { pressure: pressure_force.into(), viscous: viscous_force.into() };
    });
}

/// Adds up force and moment of every structure, particle by particle in their order. Arms are those of the whole body, also
/// where a periodic side cuts it.
pub fn sum_loads(
    particles: Query<(&BodyIndex, &Position, &PeriodShift, &ForceOnParticle), With<Solid>>,
    mut structures: Query<(&Body, &Structure, &mut Load)>,
) {
    for (body, structure, mut load) in &mut structures {
        let mut sum = Load::default();
        for (_, x, shift, force) in particles.iter().filter(|(index, ..)| index.0 == body.index) {
            let arm = x.0 - shift.0 - structure.moment_about;
            sum.pressure_force += force.pressure * structure.length;
            sum.viscous_force += force.viscous * structure.length;
            sum.pressure_moment += arm.cross(force.pressure) * structure.length;
            sum.viscous_moment += arm.cross(force.viscous) * structure.length;
        }
        *load = sum;
    }
}
