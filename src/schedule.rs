//! The algorithm on one page: one step of the simulation is this list of stages, in this order.
//!
//! Each stage is one system in one file beside its equation. Two systems that write the same column without an order
//! between them are refused when the schedule is built.

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::{
    IntoScheduleConfigs, LogLevel, ScheduleBuildSettings, ScheduleConfigs, ScheduleLabel, SingleThreadedExecutor,
};
use bevy_ecs::system::ScheduleSystem;

/// The schedule that advances the state by one time step.
#[derive(ScheduleLabel, Debug, Clone, PartialEq, Eq, Hash)]
pub struct Step;

/// The schedule that runs whenever an output is due: probes measure, then channels write.
#[derive(ScheduleLabel, Debug, Clone, PartialEq, Eq, Hash)]
pub struct Output;

/// The stages of one step (kick–drift–kick with one force evaluation), in the order in which they run.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// v ← v + ½Δt a ([`physics::integration`](crate::physics)).
    FirstKick,
    /// x ← x + Δt v.
    Drift,
    /// Walls and structures move as prescribed.
    MoveBodies,
    /// Neighbour lists, when particles have moved far enough to need new ones.
    Neighbours,
    /// W_ij and ∇_iW_ij (Eqs. 3, 4) of every pair of a ghost and fluid; sweeps over the fluid evaluate ∇W as they go.
    PairKernel,
    /// Velocity of the ghosts, Eq. 16.
    GhostVelocity,
    /// ⟨∇β⟩, for the diffusion of Antuono et al. 2010.
    CompressionGradient,
    /// Shear rate γ̇, Eq. 14; in the same sweep the [sums](crate::physics::midway_sums) of later stages.
    StrainRate,
    /// Shear rate of fluid that jumps at a wall.
    WallShear,
    /// Viscosity μ(γ̇) of each phase, Eq. 13: one system a registered rheology.
    Rheology,
    /// dρ/dt, Eq. 5.
    Continuity,
    /// Diffusion of density D_i, added to dρ/dt, Eqs. 10 and 11.
    Diffusion,
    /// ρ ← ρ + Δt dρ/dt and p(ρ), Eq. 7.
    State,
    /// Density and pressure of what the free surface has let go.
    FreeSurface,
    /// Pressure of the ghosts, Eq. 15, and the density that belongs to it.
    GhostPressure,
    /// Pressure with which walls stop fluid that comes too near.
    WallImpact,
    /// Pressure and viscous force between particles, Eqs. 6 and 12.
    Momentum,
    /// What keeps particles under tension from clumping, added to these forces.
    TensileControl,
    /// Gravity and whatever else acts on every particle by itself; damping of the settling phase.
    BodyForce,
    /// Force of the fluid on structures, Eqs. 17 and 18.
    Loads,
    /// Shifting of particles to where they are sparse.
    Shifting,
    /// v ← v + ½Δt a.
    SecondKick,
    /// The next Δt, Eq. 19, and the watch over divergence.
    TimeStep,
}

/// The order of work when an output is due.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum OutputStage {
    /// Probes read the state.
    Measure,
    /// Channels write to the log.
    Write,
}

/// Systems of one stage, for scenes of one dimension or of any.
struct StageEntry {
    stage: Stage,
    dimension: Option<usize>,
    systems: ScheduleConfigs<ScheduleSystem>,
}

/// The systems in charge of each stage.
///
/// Not a resource: systems waiting for their schedule cannot be sent between threads. It exists until the scene is loaded.
#[derive(Default)]
pub struct Stages {
    entries: Vec<StageEntry>,
}

impl Stages {
    /// Puts `two` (in 2D scenes) and `three` (in 3D scenes) in charge of `stage`, in the place of all that was in charge.
    pub fn set<A, B>(
        &mut self,
        stage: Stage,
        two: impl IntoScheduleConfigs<ScheduleSystem, A>,
        three: impl IntoScheduleConfigs<ScheduleSystem, B>,
    ) {
        self.entries.retain(|entry| entry.stage != stage);
        self.entries.push(StageEntry { stage, dimension: Some(2), systems: two.into_configs() });
        self.entries.push(StageEntry { stage, dimension: Some(3), systems: three.into_configs() });
    }

    /// Puts `systems` in charge of `stage` beside those that are.
    pub fn extend<M>(&mut self, stage: Stage, systems: impl IntoScheduleConfigs<ScheduleSystem, M>) {
        self.entries.push(StageEntry { stage, dimension: None, systems: systems.into_configs() });
    }
}

/// Empty step and output schedules with their order and their rules.
pub(crate) fn init(app: &mut App) {
    let rules = ScheduleBuildSettings { ambiguity_detection: LogLevel::Error, ..ScheduleBuildSettings::default() };
    use Stage as S;
    let order = (
        (
            S::FirstKick,
            S::Drift,
            S::MoveBodies,
            S::Neighbours,
            S::PairKernel,
            S::GhostVelocity,
            S::CompressionGradient,
            S::StrainRate,
            S::WallShear,
            S::Rheology,
        )
            .chain(),
        (S::Continuity, S::Diffusion, S::State, S::FreeSurface, S::GhostPressure, S::WallImpact).chain(),
        (S::Momentum, S::TensileControl, S::BodyForce, S::Loads, S::Shifting, S::SecondKick, S::TimeStep).chain(),
    );
    let mut step = Schedule::new(Step);
    step.configure_sets(order.chain());
    let mut output = Schedule::new(Output);
    output.configure_sets((OutputStage::Measure, OutputStage::Write).chain());
    for mut schedule in [step, output] {
        schedule.set_build_settings(rules.clone());
        schedule.set_executor(SingleThreadedExecutor::default());
        app.add_schedule(schedule);
    }
    app.world_mut().init_non_send::<Stages>();
}

/// Adds the system in charge of each stage to the step schedule, for a scene of `dimension` 2 or 3.
pub(crate) fn install_stages(world: &mut World, dimension: usize) {
    let stages = world.remove_non_send::<Stages>().unwrap_or_default();
    world.schedule_scope(Step, |_, schedule| {
        let fits = |entry: &StageEntry| entry.dimension.is_none_or(|of| of == dimension);
        for entry in stages.entries.into_iter().filter(fits) {
            schedule.add_systems(entry.systems.in_set(entry.stage));
        }
    });
}
