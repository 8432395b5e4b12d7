//! Control of the tensile instability: what is under tension is driven by differences of pressure, not by their sum.
//!
//! In Eq. 6 a pair with `p_i + p_j < 0` attracts, the more the closer it is, and particles clump. So after Sun, Colagrossi, Marrone, Antuono
//! & Zhang 2018 (Comput. Phys. Commun. 224, 63–80) the sign of a particle's own pressure is changed where that is negative:
//!
//! `m_i dv_i/dt = −Σ_j (p_j V_j² + |p_i| V_i²) ∇_iW_ij`  if  `p_i < 0`, i not near the free surface,
//!
//! `p_j − p_i` in the place of their sum. Both are consistent with −∇p, since `Σ_j V_j ∇_iW_ij ≈ 0` inside the fluid, and what was
//! attraction becomes a push to where particles are sparse. [`momentum`](super::momentum()) has added up the sum of Eq. 6; this stage
//! adds to the acceleration what is wanting, of either average of the pressures: that of `−2 p_i` and 0.
//!
//! **At the free surface** `Σ_j V_j ∇_iW_ij` is not small, and the sum of Eq. 6 stays. A particle is at it if `φ_i < ¾`, and near it if particles with
//! `φ_j < ¾` make more than 0.01 of its φ (which is 1 in the bulk), as for [shifting](super::shift_particles).
//!
//! The price: these forces are not antisymmetric, so momentum is not kept to round-off where they act. The [books](crate::books) enter
//! their work as `tensile`, and their impulse with that of the body forces.

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::free_surface::Filling;
use super::momentum::add_pressure;
use super::shifting::{AT_SURFACE, NEAR_SURFACE};
use super::{DensityWeighted, Momentum, MomentumSettings, PressureAverage, PressureForm, VolumeWeighted};
use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields};
use crate::neighbours::{CLUSTER, Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{
    Acceleration, Density, Fluid, Gathered, Mass, PIECE, Position, Pressure, Solid, Vector, Volume, Wall, Workspace,
    columns,
};
use crate::scene::SceneSettings;

/// What keeps particles under tension from clumping: section `tensile_control` of a scene.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum TensileControl {
    /// Nothing, as in the paper.
    #[default]
    Off,
    /// Differences of pressure under tension (Sun et al. 2018). Momentum is not kept to round-off.
    PressureDifference,
}

impl SceneSettings for TensileControl {
    const NAME: &'static str = "tensile_control";
}

/// What the stage adds to Eq. 6: a force (N; N/m in 2D) on each fluid particle; empty where there is no control.
#[derive(Resource, Debug, Default)]
pub struct TensileForces(pub Vec<DVec3>);

fields! {
    /// A particle whose pressure is `−2 p` of the fluid; ghosts have none.
    struct Tension<D> {
        momentum: Momentum<D>,
        volume: f64,
        /// 1 at the free surface, else 0.
        at_surface: f64,
    }
}

fields! {
    /// The missing force, and the part of particles at the surface in −d φ, axis by axis.
    struct Control<D> {
        force: Vector<D>,
        near_surface: Vector<D>,
    }
}

/// The missing force of a form of the pressures' average.
struct MissingForce<P>(std::marker::PhantomData<fn() -> P>);

impl<const D: usize, P: PressureAverage> PairTerm<D> for MissingForce<P> {
    type State = Tension<D>;
    type Sum = Control<D>;

    #[inline(always)]
    fn fluid<R: Real>(&self, sum: &mut Control<D, R>, i: &Tension<D, R>, j: &Tension<D, R>, pair: &Pair<D, R>) {
        let other = Momentum { pressure: j.volume.like(0.0), ..j.momentum };
        add_pressure::<D, R, P>(&mut sum.force, &i.momentum, &other, pair);
        Filling.fluid(&mut sum.near_surface, &i.volume, &(j.volume * j.at_surface), pair);
    }
}

type FluidState = (&'static Position, &'static Mass, &'static Density, &'static Pressure, &'static mut Acceleration);
type GhostState = (&'static Position, &'static Volume, &'static Density);
type GhostColumns<'a> = (&'a [Position], &'a [Volume], &'a [Density]);

/// Adds to the acceleration of fluid particles under tension.
pub fn tensile_control<const D: usize>(
    (setting, momentum): (Res<TensileControl>, Res<MomentumSettings>),
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    mut missing: ResMut<TensileForces>,
    mut at_surface: Local<Vec<f64>>,
    mut fluid: Query<FluidState, With<Fluid>>,
    walls: Query<GhostState, With<Wall>>,
    structures: Query<GhostState, With<Solid>>,
) -> Result {
    if *setting == TensileControl::Off {
        return Ok(());
    }
    let ghosts: [GhostColumns<'_>; 2] = [columns(&walls), columns(&structures)];
    for (x, m, rho, p, mut acceleration) in fluid.contiguous_iter_mut()? {
        let force = &mut missing.0;
        force.clear();
        force.resize(x.len(), DVec3::ZERO);
        if p.iter().all(|p| p.0 >= 0.0) {
            continue;
        }
        let [walls, structures] =
            ghosts.map(|(x, volume, _)| move |b: usize| Gathered { position: x[b].0.into(), state: volume[b].0 });
        let own = |i: usize| Gathered { position: x[i].0.into(), state: m[i].0 / rho[i].0 };
        let records = workspace.gather::<D, f64>(&neighbours.rows, own, walls, structures);
        let sweep = Sweep::new(&neighbours, &*kernel.0, records, Filling);
        at_surface.resize(x.len(), 0.0);
        at_surface.par_chunks_mut(PIECE).enumerate().for_each(|(piece, at_surface)| {
            sweep.sum(piece * PIECE, at_surface.len(), |k, filling| {
                at_surface[k] = if -filling.total() < AT_SURFACE * D as f64 { 1.0 } else { 0.0 };
            });
        });

        let state = |volume: f64, density: f64, pressure: f64, at_surface: f64| {
            let (velocity, squared_volume) = (Vector([0.0; D]), volume * volume);
            Tension {
                momentum: Momentum { velocity, squared_volume, density, pressure, viscosity: 0.0 },
                volume,
                at_surface,
            }
        };
        let [walls, structures] = ghosts.map(|(x, volume, rho)| {
            move |b: usize| Gathered { position: x[b].0.into(), state: state(volume[b].0, rho[b].0, 0.0, 0.0) }
        });
        let own = |i: usize| Gathered {
            position: x[i].0.into(),
            state: state(m[i].0 / rho[i].0, rho[i].0, -2.0 * p[i].0, at_surface[i]),
        };
        let records = workspace.gather::<D, Tension<D>>(&neighbours.rows, own, walls, structures);
        match momentum.pressure {
            PressureForm::VolumeWeighted => {
                let term = MissingForce::<VolumeWeighted>(std::marker::PhantomData);
                sum_where_tense(&Sweep::new(&neighbours, &*kernel.0, records, term), (p, &at_surface), force);
            }
            PressureForm::DensityWeighted => {
                let term = MissingForce::<DensityWeighted>(std::marker::PhantomData);
                sum_where_tense(&Sweep::new(&neighbours, &*kernel.0, records, term), (p, &at_surface), force);
            }
        }
        let each = acceleration.bypass_change_detection().par_iter_mut().zip(force).zip(m).with_min_len(PIECE);
        each.for_each(|((a, force), m)| a.0 += *force * (1.0 / m.0));
    }
    Ok(())
}

/// The force on every particle under tension that is not near the free surface.
fn sum_where_tense<const D: usize, P: PressureAverage>(
    sweep: &Sweep<'_, D, MissingForce<P>>,
    (p, at_surface): (&[Pressure], &[f64]),
    out: &mut [DVec3],
) {
    out.par_chunks_mut(PIECE).enumerate().for_each(|(piece, out)| {
        for start in (0..out.len()).step_by(CLUSTER) {
            let first = piece * PIECE + start;
            let particles = CLUSTER.min(out.len() - start);
            if p[first..first + particles].iter().all(|p| p.0 >= 0.0) {
                continue;
            }
            sweep.sum(first, particles, |k, sum| {
                let is_away = at_surface[first + k] == 0.0 && -sum.near_surface.total() <= NEAR_SURFACE * D as f64;
                if p[first + k].0 < 0.0 && is_away {
                    out[start + k] = sum.force.into();
                }
            });
        }
    });
}
