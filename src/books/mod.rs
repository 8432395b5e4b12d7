//! Books of energy, momentum and mass, kept from step to step where a scene asks for them: `probes: {"books": Books}`.
//!
//! # Energy
//!
//! `E = K + U + C` with `K = ½ Σ m v²`, `U = −Σ m g·x` with the g of the scene (without its part along periodic axes, where
//! there is no height) and `C = Σ m e(ρ)`, `e = ∫ p dρ/ρ²` from ρ0 on with the pressure p of Eq. 7. The books hold
//!
//! `E(t) − E(0) = W_walls + W_body + W_damping + W_viscous + W_impact + W_tensile + W_diffusion + W_resets + W_shifting + W_ghosts + W_volumes + R`
//!
//! where each W (J; J/m in 2D) is work done *on* the fluid, found from its own forces, and R, the residual, is what is
//! left: with all pair forces accounted for, the error of the integration in time, of second order in Δt where the flow is smooth.
//!
//! **Kicks.** A half-kick of length τ takes v to v + τ a and changes K by exactly `τ Σ m a·(v + ½τ a)`. So the force
//! `F_i` of any one kind does the work `τ (P + ½τ Q)` in it, `P = Σ F_i·v_i`, `Q = Σ F_i·a_i`. The forces of one
//! evaluation act in two half-kicks, the second of its step (from v on) and the first of the next one (from v + ½Δt a
//! on): two sums a kind are all that is kept.
//!
//! | entry | force or change |
//! |---|---|
//! | walls | `Σ F_ib·v_w`: all forces of Eqs. 6 and 12 with ghosts of walls and structures, along the velocity of the body |
//! | body | `m a_i − (sum of pair forces) − m g`: whatever accelerates besides pair forces and the g of U: forces of plugins, gravity along periodic axes, what a ramp or shaking makes of gravity |
//! | damping | K changed otherwise than by kicks: the damping of a settling phase, a relaxation zone |
//! | viscous | viscous pair forces (Eq. 12), less what walls do by them: dissipation |
//! | impact | impact pressure of walls, less what walls do by it: dissipation |
//! | tensile | forces that the [control of tension](crate::physics::TensileControl) adds to Eq. 6 |
//! | diffusion | `Σ m (p/ρ²) Δt D_i`, exact by the secant of e over the step |
//! | resets | densities set anew: C changed otherwise than by `Δt dρ/dt`; within a step, less what the pressure force had put into it |
//! | shifting | `−Σ m g·δr`: height that [shifting](crate::physics::Shifting) gains |
//!
//! **Densities set anew.** Where the free surface gives a particle another density than `ρ + Δt dρ/dt`, the pressure that acts
//! before and after is that of the densities it had and was given, not of the one in between that nothing ever
//! felt: `½ Δt m (p/ρ + p'/ρ') (dρ/dt)/ρ` is what the pressure force put into the compression of the particle, and
//! the entry is `m e(ρ') − m e(ρ)` less that.
//!
//! **Two entries belong to the discretisation.** The continuity equation takes `p_i V_i V_j v_ij·∇_iW_ij` into
//! compression, the pressure force does `−(p_i V_i² + p_j V_j²) v_i·∇_iW_ij`. Between two fluid particles the sum is that of
//! the pair force
//!
//! `N_ij = [(p_i + p_j) V_i V_j − (p_i V_i² + p_j V_j²)] ∇_iW_ij = −(V_i − V_j)(p_i V_i − p_j V_j) ∇_iW_ij` (entry
//! volumes; with the other average of the pressures, its own);
//!
//! between a fluid particle and a ghost, relative to v_w, it is `G_ib = [p_i V_i V_b − (p_i V_i² + p_b V_b²)] ∇_iW_ib` (entry
//! ghosts). `G·(v_i − v_w)` is what the ghost's own compression would take up: it comes back when the fluid leaves the
//! wall at the pressure with which it came.
//!
//! **Turnover**, to which the residual is compared: `K(0) + ∫ (|dU/dt| + |Ẇ_walls| + |Ẇ_body|) dt`, the energy that gravity,
//! bodies and forces put to work. Sound, which turns K into C and back, does not count.
//!
//! # Momentum and mass
//!
//! `Σ m v(t) − Σ m v(0) = ∫ (F_body + F_walls + F_structures) dt + J_damping + R`: F_body everything that is no pair force,
//! gravity too. R is the sum of the forces between fluid particles, round-off. Masses are constant;
//! the volume Σ m/ρ is logged beside them.

mod bodies;
mod ledger;
mod probe;
mod sums;
mod sweep;

pub use probe::Books;

use ledger::Ledger;
use sums::Worksheet;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::IntoScheduleConfigs;

use crate::app::StoreggaApp;
use crate::scene::Resolution;
use crate::schedule::{Stage, Step};

/// The books: a probe, and the systems that keep them in scenes that ask for it.
pub struct BooksPlugin;

impl Plugin for BooksPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Worksheet>().init_resource::<Ledger>();
        app.register_rebuilt::<Worksheet>().register_saved::<Ledger>();
        app.register_probe::<Books>("Books");
        let of = |dimension: usize| move |resolution: Res<Resolution>| resolution.dimension == dimension;
        let pair_forces = (sweep::pair_forces::<2>.run_if(of(2)), sweep::pair_forces::<3>.run_if(of(3))).chain();
        app.add_systems(
            Step,
            (
                sums::note_before.after(Stage::Continuity).before(Stage::Diffusion),
                pair_forces.after(Stage::WallImpact).before(Stage::Momentum),
                ledger::close_step.after(Stage::Loads).before(Stage::Shifting),
                ledger::enter_shift.after(Stage::Shifting).before(Stage::SecondKick),
            )
                .run_if(any_with_component::<Books>),
        );
    }
}
