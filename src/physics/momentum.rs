//! Conservation of momentum, Eqs. 6 and 12: pressure and viscous force between particles.
//!
//! `dv_i/dt = (1/m_i) {Σ_j [−(pressure average) ∇_iW_ij + viscous force] − p^w_i Σ_b (V_i² + V_b²) ∇_iW_ib}`. The two pair terms stand in
//! [`pressure_force`](super::PressureAverage) and [`viscous_force`](super::ViscousForce), the impact pressure p^w of walls and structures in
//! [`wall_impact`](super::WallImpact); each is antisymmetric, so total momentum is conserved to round-off.

use std::marker::PhantomData;

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ImpactPressures, PressureAverage, PressureForm, ViscousForce, ViscousForm};
use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields};
use crate::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{
    Acceleration, Density, Fluid, GRAIN, Gathered, GhostVelocity, Mass, PIECE, Position, Pressure, Records, Slip,
    Solid, Vector, Velocity, Viscosity, Volume, Wall, Workspace, columns,
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

fields! {
    /// What the forces need of a particle.
    pub struct Momentum<D> {
        /// v, or v_b of a ghost (m/s).
        pub velocity: Vector<D>,
        /// V² (m⁶; m⁴ in 2D).
        pub squared_volume: f64,
        /// ρ (kg/m³).
        pub density: f64,
        /// p (Pa).
        pub pressure: f64,
        /// μ of a fluid particle (Pa s). Of a ghost how many times the μ of the fluid particle that it meets: 1 where the
        /// fluid sticks, 0 where it slips.
        pub viscosity: f64,
    }
}

impl<const D: usize> Momentum<D> {
    /// What a fluid particle brings: v, m, ρ, p, μ.
    #[inline(always)]
    #[must_use]
    pub fn fluid(v: Velocity, m: Mass, rho: Density, p: Pressure, mu: Viscosity) -> Self {
        let volume = m.0 / rho.0;
        Self { velocity: v.0.into(), squared_volume: volume * volume, density: rho.0, pressure: p.0, viscosity: mu.0 }
    }

    /// What a ghost of a wall or structure brings: v_b, V, ρ, p, and how the fluid slips along it.
    #[inline(always)]
    #[must_use]
    pub fn ghost(v: GhostVelocity, volume: Volume, rho: Density, p: Pressure, slip: Slip) -> Self {
        let viscosity = if slip == Slip::FreeSlip { 0.0 } else { 1.0 };
        let squared_volume = volume.0 * volume.0;
        Self { velocity: v.0.into(), squared_volume, density: rho.0, pressure: p.0, viscosity }
    }
}

/// μ̄_ij = 2 μ_i μ_j/(μ_i + μ_j) (Pa s) of two fluid particles.
#[inline(always)]
pub(super) fn mean_viscosity<R: Real>(mu_i: R, mu_j: R) -> R {
    (mu_i * 2.0) * mu_j / ((mu_i + f64::MIN_POSITIVE) + mu_j)
}

/// Adds the pressure force on particle i from particle j.
#[inline(always)]
pub(super) fn add_pressure<const D: usize, R: Real, P: PressureAverage>(
    force: &mut Vector<D, R>,
    i: &Momentum<D, R>,
    j: &Momentum<D, R>,
    pair: &Pair<D, R>,
) {
    force.subtract_product(pair.r_ij, P::average(i, j) * pair.gradient);
}

/// Adds the force with which an impact pressure p^w of 1 Pa between a fluid particle and a ghost drives i from j. It
/// counts as a pressure of both: either average of `p + p^w` is that of p, and p^w (V_i² + V_j²).
#[inline(always)]
fn add_unit_impact<const D: usize, R: Real>(
    force: &mut Vector<D, R>,
    i: &Momentum<D, R>,
    j: &Momentum<D, R>,
    pair: &Pair<D, R>,
) {
    force.subtract_product(pair.r_ij, (i.squared_volume + j.squared_volume) * pair.gradient);
}

/// (Pressure force, viscous force) on particle i from particle j, with mean viscosity `mu_ij`.
#[inline(always)]
pub(crate) fn pair_forces<const D: usize, P: PressureAverage, V: ViscousForce>(
    mu_ij: f64,
    i: &Momentum<D>,
    j: &Momentum<D>,
    pair: &Pair<D>,
) -> (Vector<D>, Vector<D>) {
    let (mut pressure, mut viscous) = (Vector::ZERO, Vector::ZERO);
    add_pressure::<D, f64, P>(&mut pressure, i, j, pair);
    V::add_to(&mut viscous, mu_ij, i, j, pair);
    (pressure, viscous)
}

/// The force of the impact pressure `impact` (Pa) on particle i from particle j.
#[inline(always)]
pub(crate) fn impact_force<const D: usize>(impact: f64, i: &Momentum<D>, j: &Momentum<D>, pair: &Pair<D>) -> Vector<D> {
    let mut force = Vector::ZERO;
    add_unit_impact(&mut force, i, j, pair);
    force * impact
}

fields! {
    /// The sum of pair forces on a fluid particle.
    pub(crate) struct ForceSum<D> {
        /// Pressure force without that of the impact pressure (N; N/m in 2D).
        pub pressure: Vector<D>,
        /// Viscous force (N; N/m in 2D).
        pub viscous: Vector<D>,
        /// `−Σ_b (V_i² + V_b²) ∇_iW_ib` (m²; m in 2D), the force for each Pa of impact pressure: the p^w of a particle acts alike on all ghosts.
        pub of_unit_impact: Vector<D>,
    }
}

impl<const D: usize> ForceSum<D> {
    /// The whole force with the impact pressure `impact` = p^w (Pa).
    #[inline(always)]
    pub(crate) fn total(self, impact: f64) -> Vector<D> {
        self.pressure + self.viscous + self.of_unit_impact * impact
    }
}

/// Forces of the chosen forms, added up.
pub(crate) struct Forces<P, V>(PhantomData<fn() -> (P, V)>);

impl<P, V> Default for Forces<P, V> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

/// Pair forces that somebody who tells them apart has added up ahead of this stage: it takes them then, and makes its own if there
/// are none. The bits are the same.
#[derive(Resource, Default)]
pub struct ForceSums {
    /// Sum of the pair forces (N; N/m in 2D) on each fluid particle.
    pub(crate) forces: Vec<DVec3>,
    /// Whether they wait to be taken.
    pub(crate) are_new: bool,
}

impl ForceSums {
    /// Forgets the sums: the stage makes its own, of what particles carry then.
    pub fn clear(&mut self) {
        self.are_new = false;
    }
}

impl<const D: usize, P: PressureAverage, V: ViscousForce> PairTerm<D> for Forces<P, V> {
    type State = Momentum<D>;
    type Sum = ForceSum<D>;

    #[inline(always)]
    fn fluid<R: Real>(&self, sum: &mut ForceSum<D, R>, i: &Momentum<D, R>, j: &Momentum<D, R>, pair: &Pair<D, R>) {
        let mu_ij = mean_viscosity(i.viscosity, j.viscosity);
        add_pressure::<D, R, P>(&mut sum.pressure, i, j, pair);
        V::add_to(&mut sum.viscous, mu_ij, i, j, pair);
    }

    #[inline(always)]
    fn ghost<R: Real>(&self, sum: &mut ForceSum<D, R>, i: &Momentum<D, R>, b: &Momentum<D, R>, pair: &Pair<D, R>) {
        let mu_ib = i.viscosity * b.viscosity;
        add_pressure::<D, R, P>(&mut sum.pressure, i, b, pair);
        add_unit_impact(&mut sum.of_unit_impact, i, b, pair);
        V::add_to(&mut sum.viscous, mu_ib, i, b, pair);
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
pub(crate) type FluidState =
    (&'static Position, &'static Velocity, &'static Mass, &'static Density, &'static Pressure, &'static Viscosity);
/// [`FluidState`] as whole columns.
pub(crate) type FluidColumns<'a> =
    (&'a [Position], &'a [Velocity], &'a [Mass], &'a [Density], &'a [Pressure], &'a [Viscosity]);
/// What the forces read of ghosts of walls and structures.
pub(crate) type GhostState =
    (&'static Position, &'static GhostVelocity, &'static Volume, &'static Density, &'static Pressure, &'static Slip);
/// [`GhostState`] as whole columns.
pub(crate) type GhostColumns<'a> =
    (&'a [Position], &'a [GhostVelocity], &'a [Volume], &'a [Density], &'a [Pressure], &'a [Slip]);

/// Computes the acceleration of every fluid particle from the forces between particles.
pub fn momentum<const D: usize>(
    settings: Res<MomentumSettings>,
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    mut sums: ResMut<ForceSums>,
    impact: Res<ImpactPressures>,
    mut fluid: Query<(FluidState, &mut Acceleration), With<Fluid>>,
    walls: Query<GhostState, With<Wall>>,
    structures: Query<GhostState, With<Solid>>,
) -> Result {
    let [walls, structures] =
        [columns(&walls), columns(&structures)].map(|(x, v, volume, rho, p, slip): GhostColumns<'_>| {
            move |b: usize| {
                let state = Momentum::ghost(v[b], volume[b], rho[b], p[b], slip[b]);
                Gathered { position: x[b].0.into(), state }
            }
        });
    for ((x, v, m, rho, p, mu), mut acceleration) in fluid.contiguous_iter_mut()? {
        let out = acceleration.bypass_change_detection();
        if std::mem::take(&mut sums.are_new) {
            let each = out.par_iter_mut().with_min_len(GRAIN).with_max_len(PIECE).zip(&sums.forces).zip(m);
            each.for_each(|((a, force), m)| a.0 = *force * (1.0 / m.0));
            continue;
        }
        let own = |i: usize| {
            let state = Momentum::fluid(v[i], m[i], rho[i], p[i], mu[i]);
            Gathered { position: x[i].0.into(), state }
        };
        let records = workspace.gather::<D, Momentum<D>>(&neighbours.rows, own, walls, structures);
        with_forms!(settings, accelerate::<D>(&neighbours, &kernel, records, (m, &impact), out));
    }
    Ok(())
}

fn accelerate<const D: usize, P: PressureAverage, V: ViscousForce>(
    neighbours: &Neighbours,
    kernel: &SmoothingKernel,
    records: Records<'_, D, Momentum<D>>,
    (m, impact): (&[Mass], &ImpactPressures),
    out: &mut [Acceleration],
) {
    let sweep = Sweep::new(neighbours, &*kernel.0, records, Forces::<P, V>::default());
    out.par_chunks_mut(PIECE).enumerate().for_each(|(piece, acceleration)| {
        let first = piece * PIECE;
        sweep.sum(first, acceleration.len(), |k, sum| {
            let i = first + k;
            acceleration[k].0 = (sum.total(impact.of(i)) * (1.0 / m[i].0)).into();
        });
    });
}
