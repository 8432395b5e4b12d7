//! Particle shifting: particles leave where they crowd for where they are sparse, so that neither clumps nor voids stay.
//!
//! `x_i ← x_i + δr_i`, `δr_i = −A h |v_i| Δt ∇C_i`, `∇C_i = Σ_j V_j ∇_iW_ij`, j over fluid of every phase, walls and structures: Fick's law
//! for the concentration C (Lind, Xu, Stansby & Rogers 2012, J. Comput. Phys. 231, 1499–1523), with the diffusivity A h |v| of
//! Skillen, Lind, Stansby & Rogers 2013 (Comput. Methods Appl. Mech. Eng. 265, 163–173), A = 2. No step is longer than 0.2 h.
//! Velocity and density go along unchanged. The forces keep what they conserve; the height that a shift gains or loses is an entry of the
//! [books](crate::books).
//!
//! **At the free surface** C falls off since nothing is there, and the whole of ∇C would drive the surface apart. Particles with
//! `φ_i < ¾` are at the surface (Lee et al. 2008, J. Comput. Phys. 227: ∇·r < 1.5 in the plane). For them and for those of whose φ they
//! make more than 0.01, the part of δr_i along the normal `n ∝ Σ_j V_j (φ_j − φ_i) ∇_iW_ij` is left out, as Lind et al. do;
//! where a neighbourhood is less than half full (spray) there is no shift. φ is that of [`free_surface`](super::free_surface), φ_j that
//! of the step before.
//!
//! **At the interface** of two phases nothing is missing in C, but a shift across it would mix them: the part along
//! `Σ_j V_j (ρ0_j − ρ0_i) ∇_iW_ij` is left out for particles that meet another ρ0.

use bevy_ecs::prelude::*;
use glam::DVec3;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::LEAST_FILLING;
use crate::clock::Clock;
use crate::kernels::SmoothingKernel;
use crate::lanes::{Real, fields};
use crate::neighbours::{Neighbours, Pair, PairTerm, Sweep};
use crate::particles::{
    Density, Fluid, Gathered, Mass, PIECE, Position, ReferenceDensity, Solid, Vector, Velocity, Volume, Wall,
    Workspace, columns,
};
use crate::scene::{Resolution, SceneSection, SectionError};

/// Whether particles are shifted to where they are sparse: section `shifting` of a scene.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Shifting {
    /// They go where their velocities take them, as in the paper.
    #[default]
    Off,
    /// By Fick's law (Lind et al. 2012), aware of the free surface and of interfaces.
    Fickian {
        /// A (dimensionless); 2 after Skillen et al. 2013, between 1 and 6 in use.
        #[serde(default = "usual_coefficient")]
        #[schemars(range(min = 0.0, max = 10.0), extend("unit" = "1"))]
        coefficient: f64,
    },
}

/// A of Skillen et al. 2013.
const fn usual_coefficient() -> f64 {
    2.0
}

/// Marks scenes in which particles are shifted.
#[derive(Component, Debug, Clone, Copy)]
pub struct Shifts;

impl SceneSection for Shifting {
    const NAME: &'static str = "shifting";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        if self != Self::Off {
            world.spawn(Shifts);
        }
        world.insert_resource(self);
        Ok(())
    }
}

/// φ (dimensionless), how much of a particle's neighbourhood was filled when it was last shifted; a column of scenes that shift.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Filled(pub f64);

/// Σ m δr (kg m) of the last step.
#[derive(Resource, Debug, Default)]
pub struct ShiftedMass(pub DVec3);

/// Below this φ a particle is at the free surface.
pub(crate) const AT_SURFACE: f64 = 0.75;

/// So much of φ from particles at the surface makes a particle near it.
pub(crate) const NEAR_SURFACE: f64 = 0.01;

/// Longest shift, in smoothing lengths (Lind et al. 2012).
pub(crate) const LONGEST_SHIFT: f64 = 0.2;

/// A jump of ρ0 over the kernel, relative to ρ0, from which on a particle meets another phase.
const LEAST_JUMP: f64 = 1e-3;

fields! {
    /// What shifting reads of a particle; a ghost has φ and ρ0 of nobody, and counts in C alone.
    pub(super) struct ShiftState<D> {
        volume: f64,
        filled: f64,
        /// 1 at the free surface, else 0.
        at_surface: f64,
        reference_density: f64,
    }
}

fields! {
    /// ∇C, −d φ, and the normals of the free surface and of the interface.
    pub(super) struct Concentration<D> {
        gradient: Vector<D>,
        filling: f64,
        /// The part of particles at the surface in it.
        near_surface: f64,
        surface: Vector<D>,
        interface: Vector<D>,
    }
}

/// ∇C and what tells where the free surface and interfaces are.
struct ConcentrationGradient;

impl<const D: usize> PairTerm<D> for ConcentrationGradient {
    type State = ShiftState<D>;
    type Sum = Concentration<D>;

    #[inline(always)]
    fn fluid<R: Real>(
        &self,
        sum: &mut Concentration<D, R>,
        i: &ShiftState<D, R>,
        j: &ShiftState<D, R>,
        pair: &Pair<D, R>,
    ) {
        let volume_grad_w = pair.r_ij * (pair.gradient * j.volume);
        sum.gradient += volume_grad_w;
        sum.filling = pair.r_ij.dot_plus(volume_grad_w, sum.filling);
        sum.near_surface = pair.r_ij.dot_plus(volume_grad_w * j.at_surface, sum.near_surface);
        sum.surface.add_product(volume_grad_w, j.filled - i.filled);
        sum.interface.add_product(volume_grad_w, j.reference_density - i.reference_density);
    }

    #[inline(always)]
    fn ghost<R: Real>(
        &self,
        sum: &mut Concentration<D, R>,
        _: &ShiftState<D, R>,
        b: &ShiftState<D, R>,
        pair: &Pair<D, R>,
    ) {
        let volume_grad_w = pair.r_ij * (pair.gradient * b.volume);
        sum.gradient += volume_grad_w;
        sum.filling = pair.r_ij.dot_plus(volume_grad_w, sum.filling);
    }
}

impl<const D: usize> Concentration<D> {
    /// δr_i (m): `scale` (m²) times −∇C without what is not to be, at most `longest` (m).
    fn shift(&self, scale: f64, longest: f64, h: f64, rho0: f64) -> DVec3 {
        let filled = -self.filling / D as f64;
        if filled < LEAST_FILLING {
            return DVec3::ZERO;
        }
        let mut shift = -scale * DVec3::from(self.gradient);
        if filled < AT_SURFACE || -self.near_surface > NEAR_SURFACE * D as f64 {
            shift = shift.reject_from_normalized(DVec3::from(self.surface).normalize_or_zero());
        }
        let interface = DVec3::from(self.interface);
        if interface.length() * h > LEAST_JUMP * rho0 {
            shift = shift.reject_from_normalized(interface.normalize());
        }
        shift.clamp_length_max(longest)
    }
}

type FluidState = (
    &'static mut Position,
    &'static mut Filled,
    &'static Velocity,
    &'static Mass,
    &'static Density,
    &'static ReferenceDensity,
);

/// Shifts every fluid particle.
pub fn shift_particles<const D: usize>(
    setting: Res<Shifting>,
    (clock, resolution): (Res<Clock>, Res<Resolution>),
    kernel: Res<SmoothingKernel>,
    neighbours: Res<Neighbours>,
    mut workspace: ResMut<Workspace>,
    mut shifted: ResMut<ShiftedMass>,
    mut sums: Local<Vec<(DVec3, f64)>>,
    mut fluid: Query<FluidState, With<Fluid>>,
    walls: Query<(&Position, &Volume), (With<Wall>, Without<Fluid>)>,
    structures: Query<(&Position, &Volume), (With<Solid>, Without<Fluid>)>,
) -> Result {
    let Shifting::Fickian { coefficient } = *setting else { return Ok(()) };
    let h = resolution.smoothing_length;
    let [walls, structures] = [columns(&walls), columns(&structures)].map(|(x, volume): (&[Position], &[Volume])| {
        move |b: usize| {
            let state = ShiftState { volume: volume[b].0, filled: 0.0, at_surface: 0.0, reference_density: 0.0 };
            Gathered { position: x[b].0.into(), state }
        }
    });
    for (mut x, mut filled, v, m, rho, rho0) in fluid.contiguous_iter_mut()? {
        let (x, filled) = (x.bypass_change_detection(), filled.bypass_change_detection());
        let own = |i: usize| {
            let volume = m[i].0 / rho[i].0;
            let filled = filled[i].0;
            let at_surface = if filled < AT_SURFACE { 1.0 } else { 0.0 };
            let state = ShiftState { volume, filled, at_surface, reference_density: rho0[i].0 };
            Gathered { position: x[i].0.into(), state }
        };
        let records = workspace.gather::<D, ShiftState<D>>(&neighbours.rows, own, walls, structures);
        let sweep = Sweep::new(&neighbours, &*kernel.0, records, ConcentrationGradient);
        sums.resize(x.len(), (DVec3::ZERO, 0.0));
        sums.par_chunks_mut(PIECE).enumerate().for_each(|(piece, sums)| {
            let first = piece * PIECE;
            sweep.sum(first, sums.len(), |k, sum: Concentration<D>| {
                let i = first + k;
                let scale = coefficient * h * v[i].0.length() * clock.time_step;
                sums[k] = (sum.shift(scale, LONGEST_SHIFT * h, h, rho0[i].0), -sum.filling / D as f64);
            });
        });
        let columns = x.par_iter_mut().zip(filled).zip(&*sums).with_min_len(PIECE);
        columns.for_each(|((x, filled), (shift, phi))| {
            x.0 += *shift;
            filled.0 = *phi;
        });
        shifted.0 = sums.iter().zip(m).map(|((shift, _), m)| m.0 * *shift).sum();
    }
    Ok(())
}
