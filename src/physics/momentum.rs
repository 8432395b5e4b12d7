//! Conservation of momentum, Eqs. 6 and 12: pressure and viscous force between particles.
//!
//! `dv_i/dt = (1/m_i) Σ_j [−(pressure average) ∇_iW_ij + viscous force]`. The two pair terms stand in
//! [`pressure_force`](super::PressureAverage) and [`viscous_force`](super::ViscousForce); each is antisymmetric, so total
//! momentum is conserved to round-off.

use bevy_ecs::prelude::*;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ImpactPressure, PressureAverage, PressureForm, ViscousForce, ViscousForm};
use crate::neighbours::{Neighbours, sum_pairs};
use crate::particles::{
    Acceleration, Density, Fluid, GRAIN, Gather, Gathered, GhostVelocity, Mass, PIECE, Position, Pressure, Slip, Solid,
    Vector, Velocity, Viscosity, Volume, Wall, columns,
};
use crate::scene::SceneSettings;

/// Forms of the two forces between particles: section `momentum` of a scene.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MomentumSettings {
    /// Average of the pressures of a pair.
    pub pressure: PressureForm,
    /// Form of the viscous force.
    pub viscosity: ViscousForm,
}

impl SceneSettings for MomentumSettings {
    const NAME: &'static str = "momentum";
}

/// The viscosity with which a particle enters a pair: its own, or what its wall prescribes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairViscosity(f64);

impl PairViscosity {
    /// A ghost on which the fluid sticks takes the viscosity of the fluid particle that it acts on.
    const NO_SLIP: Self = Self(-1.0);
    /// A ghost along which the fluid slips: no viscous force.
    const FREE_SLIP: Self = Self(-2.0);

    /// A fluid particle's own μ (Pa s).
    #[inline(always)]
    #[must_use]
    pub fn fluid(mu: f64) -> Self {
        Self(mu)
    }

    /// What a ghost of a wall or structure brings.
    #[inline(always)]
    #[must_use]
    pub fn ghost(slip: Slip) -> Self {
        if slip == Slip::FreeSlip { Self::FREE_SLIP } else { Self::NO_SLIP }
    }

    /// μ (Pa s) of a fluid particle.
    #[inline(always)]
    #[must_use]
    pub fn own(self) -> f64 {
        self.0
    }

    /// μ̄_ij = 2 μ_i μ_j/(μ_i + μ_j) (Pa s) of a fluid particle with `mu_i` and this one.
    #[inline(always)]
    #[must_use]
    pub fn mean_with(self, mu_i: f64) -> f64 {
        let mu_j = self.0.max(0.0);
        let harmonic = 2.0 * mu_i * mu_j / (mu_i + mu_j + f64::MIN_POSITIVE);
        if self == Self::NO_SLIP { mu_i } else { harmonic }
    }

    /// Whether the particle is a ghost of a wall or structure.
    #[inline(always)]
    #[must_use]
    pub fn is_ghost(self) -> bool {
        self.0 < 0.0
    }
}

/// What the forces need of a particle.
#[derive(Debug, Clone, Copy)]
pub struct Momentum<const D: usize> {
    /// v, or v_b of a ghost (m/s).
    pub velocity: Vector<D>,
    /// V (m³; m² in 2D).
    pub volume: f64,
    /// ρ (kg/m³).
    pub density: f64,
    /// p (Pa).
    pub pressure: f64,
    /// μ (Pa s), or what a ghost brings.
    pub viscosity: PairViscosity,
}

impl<const D: usize> Momentum<D> {
    /// What a fluid particle brings: v, m, ρ, p, μ.
    #[inline(always)]
    #[must_use]
    pub fn fluid(v: Velocity, m: Mass, rho: Density, p: Pressure, mu: Viscosity) -> Self {
        Self {
            velocity: v.0.into(),
            volume: m.0 / rho.0,
            density: rho.0,
            pressure: p.0,
            viscosity: PairViscosity::fluid(mu.0),
        }
    }

    /// What a ghost of a wall or structure brings: v_b, V, ρ, p, and how the fluid slips along it.
    #[inline(always)]
    #[must_use]
    pub fn ghost(v: GhostVelocity, volume: Volume, rho: Density, p: Pressure, slip: Slip) -> Self {
        Self {
            velocity: v.0.into(),
            volume: volume.0,
            density: rho.0,
            pressure: p.0,
            viscosity: PairViscosity::ghost(slip),
        }
    }
}

/// Pressure and viscous force of one pair on particle i.
pub(crate) struct PairTerms;

impl PairTerms {
    /// (−average ∇_iW_ij, viscous force) with mean viscosity `mu_ij`; `impact` is p^w (Pa) between a fluid particle and a
    /// wall, which counts as a pressure of both (either average of `p + p^w` is that of p, and p^w (V_i² + V_j²)).
    #[inline(always)]
    pub(crate) fn of<const D: usize, P: PressureAverage, V: ViscousForce>(
        mu_ij: f64,
        impact: f64,
        i: &Momentum<D>,
        j: &Momentum<D>,
        pair: &crate::neighbours::Pair<D>,
    ) -> (Vector<D>, Vector<D>) {
        let average = P::average(i, j) + impact * (i.volume * i.volume + j.volume * j.volume);
        (pair.grad_w() * -average, V::force(mu_ij, i, j, pair))
    }
}

/// Calls `$function::<D, P, V>(…)` for the forms that the scene chose.
macro_rules! with_forms {
    ($settings:expr, $function:ident::<$D:ident>($($argument:expr),* $(,)?)) => {{
        use $crate::physics::{CentralForm, DensityWeighted, LaplacianForm, PressureForm, ViscousForm, VolumeWeighted};
        match ($settings.pressure, $settings.viscosity) {
            (PressureForm::VolumeWeighted, ViscousForm::Laplacian) => {
                $function::<$D, VolumeWeighted, LaplacianForm>($($argument),*)
            }
            (PressureForm::VolumeWeighted, ViscousForm::Central) => {
                $function::<$D, VolumeWeighted, CentralForm>($($argument),*)
            }
            (PressureForm::DensityWeighted, ViscousForm::Laplacian) => {
                $function::<$D, DensityWeighted, LaplacianForm>($($argument),*)
            }
            (PressureForm::DensityWeighted, ViscousForm::Central) => {
                $function::<$D, DensityWeighted, CentralForm>($($argument),*)
            }
        }
    }};
}
pub(crate) use with_forms;

/// What the forces read of fluid particles.
pub(crate) type FluidState = (
    &'static Position,
    &'static Velocity,
    &'static Mass,
    &'static Density,
    &'static Pressure,
    &'static Viscosity,
    &'static ImpactPressure,
);
/// [`FluidState`] as whole columns.
pub(crate) type FluidColumns<'a> =
    (&'a [Position], &'a [Velocity], &'a [Mass], &'a [Density], &'a [Pressure], &'a [Viscosity], &'a [ImpactPressure]);
/// What the forces read of ghosts of walls and structures.
pub(crate) type GhostState =
    (&'static Position, &'static GhostVelocity, &'static Volume, &'static Density, &'static Pressure, &'static Slip);
/// [`GhostState`] as whole columns.
pub(crate) type GhostColumns<'a> =
    (&'a [Position], &'a [GhostVelocity], &'a [Volume], &'a [Density], &'a [Pressure], &'a [Slip]);

/// Computes the acceleration of every fluid particle from the forces between particles.
pub fn momentum<const D: usize>(
    settings: Res<MomentumSettings>,
    neighbours: Res<Neighbours>,
    mut gather: Local<Gather<D, Momentum<D>>>,
    mut fluid: Query<(FluidState, &mut Acceleration), With<Fluid>>,
    walls: Query<GhostState, With<Wall>>,
    structures: Query<GhostState, With<Solid>>,
) -> Result {
    let [walls, structures] =
        [columns(&walls), columns(&structures)].map(|(x, v, volume, rho, p, slip): GhostColumns<'_>| {
            move |b: usize| Gathered {
                position: x[b].0.into(),
                state: Momentum::ghost(v[b], volume[b], rho[b], p[b], slip[b]),
            }
        });
    for ((x, v, m, rho, p, mu, impact), mut acceleration) in fluid.contiguous_iter_mut()? {
        let own =
            |i: usize| Gathered { position: x[i].0.into(), state: Momentum::fluid(v[i], m[i], rho[i], p[i], mu[i]) };
        let records = gather.fill(&neighbours.rows, own, walls, structures);
        let out = acceleration.bypass_change_detection();
        with_forms!(settings, accelerate::<D>(&neighbours, records, m, (mu, impact), out));
    }
    Ok(())
}

fn accelerate<const D: usize, P: PressureAverage, V: ViscousForce>(
    neighbours: &Neighbours,
    records: &[Gathered<D, Momentum<D>>],
    m: &[Mass],
    (mu, impact): (&[Viscosity], &[ImpactPressure]),
    out: &mut [Acceleration],
) {
    out.par_iter_mut().with_min_len(GRAIN).with_max_len(PIECE).enumerate().for_each(|(i, acceleration)| {
        let own = &records[i];
        let (mu_i, impact_i) = (mu[i].0, impact[i].0);
        let mut force = Vector::ZERO;
        sum_pairs(own, neighbours.fluid.of(i), records, |other, pair| {
            let mu_ij = other.viscosity.mean_with(mu_i);
            let impact = if other.viscosity.is_ghost() { impact_i } else { 0.0 };
            let (pressure, viscous) = PairTerms::of::<D, P, V>(mu_ij, impact, &own.state, other, pair);
            force += pressure + viscous;
        });
        acceleration.0 = (force * (1.0 / m[i].0)).into();
    });
}
