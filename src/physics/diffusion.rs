//! Diffusion of density, Eqs. 10 and 11.
//!
//! `D_i = 2 δ h c_i ρ0_i Σ_j V_j ψ_ij (r_ij·∇_iW_ij)/r²`, `ψ_ij = β_i − β_j − ½ (s_i + s_j)·(x_i − x_j)`, β = ρ/ρ0, j over
//! fluid particles of every phase. The slope s of β is what does not diffuse:
//!
//! - Molteni & Colagrossi 2009 in the form of Krimi et al. 2018: `s = 0`. A jump of ρ0 does not diffuse, but
//!   hydrostatic pressure does: it drifts at free surfaces and over long times.
//! - Hydrostatically corrected, after Fourtakas et al. 2019: `s_i = ρ0_i g/B`, the slope at rest. (With ρ0_i alone in the
//!   place of the mean the L2 error of the two-phase tank at 8 mm grows, 0.26 % after 0.7 s and 0.50 % after 1.5 s; with the
//!   mean it falls, 0.15 and 0.12 %.)
//! - Antuono et al. 2010: `s_i = ⟨∇β⟩_i`, the slope that there is ([`CompressionGradients`]). What pressure the flow itself has
//!   does not diffuse either, as that of a drum which turns; it costs one sweep more.
//!
//! Positions are those of the middle of the drift, where the sum can be made with others ([`midway_sums`](super::midway_sums)).

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::midway::position_midway;
use super::{CompressionGradients, EquationOfState, Gravity, MidwaySums};
use crate::clock::Clock;
use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields};
use crate::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{
    Density, DensityRate, Fluid, GRAIN, Gathered, Mass, PIECE, Position, ReferenceDensity, Solid, Vector, Velocity,
    Wall, Workspace, columns,
};
use crate::scene::{Resolution, SceneSettings};

/// Which diffusion acts on the density: section `diffusion` of a scene.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum DensityDiffusion {
    /// None.
    Off,
    /// Eqs. 10 and 11 as they stand.
    Molteni {
        /// Strength δ (dimensionless), usually 0.1.
        #[schemars(range(min = 0.0, max = 1.0), extend("unit" = "1"))]
        delta: f64,
    },
    /// Without the part that a column at rest has.
    Hydrostatic {
        /// Strength δ (dimensionless), usually 0.1.
        #[schemars(range(min = 0.0, max = 1.0), extend("unit" = "1"))]
        delta: f64,
    },
    /// Without the part that varies linearly or quadratically from place to place (Antuono et al. 2010).
    Antuono {
        /// Strength δ (dimensionless), usually 0.1.
        #[schemars(range(min = 0.0, max = 1.0), extend("unit" = "1"))]
        delta: f64,
    },
}

impl Default for DensityDiffusion {
    fn default() -> Self {
        Self::Hydrostatic { delta: 0.1 }
    }
}

impl SceneSettings for DensityDiffusion {
    const NAME: &'static str = "diffusion";
}

fields! {
    /// What the diffusion needs of a particle.
    pub struct Compression<D> {
        /// β = ρ/ρ0.
        pub(super) beta: f64,
        /// ½ s (1/m), s the slope of β that does not diffuse.
        pub(super) half_slope: Vector<D>,
        pub(super) volume: f64,
    }
}

/// `Σ_j V_j ψ_ij (r_ij·∇_iW_ij)/r²` (1/m²).
pub(super) struct Diffusion;

impl<const D: usize> PairTerm<D> for Diffusion {
    type State = Compression<D>;
    type Sum = f64;

    #[inline(always)]
    fn fluid<R: Real>(&self, sum: &mut R, i: &Compression<D, R>, j: &Compression<D, R>, pair: &Pair<D, R>) {
        let half_slopes = i.half_slope + j.half_slope;
        let psi_ij = half_slopes.dot_plus(-pair.r_ij, i.beta - j.beta);
        sum.add_product(psi_ij, pair.gradient * j.volume);
    }

    /// Walls and structures take no part.
    #[inline(always)]
    fn ghost<R: Real>(&self, _: &mut R, _: &Compression<D, R>, _: &Compression<D, R>, _: &Pair<D, R>) {}
}

type FluidState = (
    &'static Position,
    &'static Velocity,
    &'static Mass,
    &'static Density,
    &'static ReferenceDensity,
    &'static mut DensityRate,
);

/// δ, and what the slope s follows from.
pub(super) struct Strength<const D: usize> {
    delta: f64,
    g_over_b: Vector<D>,
    /// 1 if s is the slope that there is, else 0.
    own_slope: f64,
}

impl<const D: usize> Strength<D> {
    pub fn of(diffusion: &DensityDiffusion, gravity: &Gravity, state: &EquationOfState) -> Self {
        let none = Self { delta: 0.0, g_over_b: Vector::ZERO, own_slope: 0.0 };
        match *diffusion {
            DensityDiffusion::Off => none,
            DensityDiffusion::Molteni { delta } => Self { delta, ..none },
            DensityDiffusion::Hydrostatic { delta } => {
                Self { delta, g_over_b: Vector::from(gravity.now) * (1.0 / state.bulk_modulus), ..none }
            }
            DensityDiffusion::Antuono { delta } => Self { delta, own_slope: 1.0, ..none },
        }
    }

    /// β, ½ s and V of a fluid particle.
    #[inline(always)]
    pub fn compression(&self, m: Mass, rho: Density, rho0: ReferenceDensity, gradient: DVec3) -> Compression<D> {
        Compression {
            beta: rho.0 / rho0.0,
            half_slope: (self.g_over_b * rho0.0 + Vector::from(gradient) * self.own_slope) * 0.5,
            volume: m.0 / rho.0,
        }
    }
}

/// Adds D_i to dρ/dt of every fluid particle.
pub fn density_diffusion<const D: usize>(
    clock: Res<Clock>,
    sums: Res<MidwaySums>,
    (diffusion, gravity, gradients): (Res<DensityDiffusion>, Res<Gravity>, Res<CompressionGradients>),
    (resolution, state): (Res<Resolution>, Res<EquationOfState>),
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    mut fluid: Query<FluidState, With<Fluid>>,
    walls: Query<&Position, With<Wall>>,
    structures: Query<&Position, With<Solid>>,
) -> Result {
    if *diffusion == DensityDiffusion::Off {
        return Ok(());
    }
    let strength = Strength::of(&diffusion, &gravity, &state);
    let rate_of = |rho0_i: f64, sum: f64| {
        let c_i = state.sound_speed(rho0_i);
        2.0 * strength.delta * resolution.smoothing_length * c_i * rho0_i * sum
    };
    let half_step = 0.5 * clock.time_step;
    let [walls, structures] = [columns(&walls), columns(&structures)].map(|x: &[Position]| {
        let state = Compression { beta: 1.0, half_slope: Vector::ZERO, volume: 0.0 };
        move |b: usize| Gathered { position: x[b].0.into(), state }
    });
    for (x, v, m, rho, rho0, mut rate) in fluid.contiguous_iter_mut()? {
        let rate = rate.bypass_change_detection();
        if let Some(sums) = sums.diffusion() {
            let each = rate.par_iter_mut().zip(rho0).zip(sums).with_min_len(GRAIN).with_max_len(PIECE);
            each.for_each(|((rate, rho0), sum)| rate.0 += rate_of(rho0.0, *sum));
            continue;
        }
        let own = |i: usize| Gathered {
            position: position_midway(half_step, x[i], v[i].0),
            state: strength.compression(m[i], rho[i], rho0[i], gradients.of(i)),
        };
        let records = workspace.gather::<D, Compression<D>>(&neighbours.rows, own, walls, structures);
        let sweep = Sweep::new(&neighbours, &*kernel.0, records, Diffusion);
        rate.par_chunks_mut(PIECE).enumerate().for_each(|(piece, rate)| {
            let first = piece * PIECE;
            sweep.sum(first, rate.len(), |k, sum| rate[k].0 += rate_of(rho0[first + k].0, sum));
        });
    }
    Ok(())
}
