//! Building an app from plugins and a scene, and running it to its end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use bevy_app::{App, Plugins};
use bevy_ecs::component::Mutable;
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::system::ScheduleSystem;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::checkpoint::{SavedState, write_before_end, write_if_due, write_last};
use crate::clock::Clock;
use crate::error::UserError;
use crate::failure;
use crate::kernels::{Kernel, KernelRegistry};
use crate::log::ParticleFields;
use crate::outputs::OutputTimes;
use crate::particles::{Fluid, ParticleColumns};
use crate::physics::{Divergence, DivergenceReport, MOST_STEPS, settle_least_time_step};
use crate::probes::{Probe, ProbeRegistry};
use crate::rheology::{FlowCurve, Rheology, RheologyRegistry, apply_flow_curve};
use crate::scene::{Document, SceneInfo, SceneSection, SectionRegistry, load_scene};
use crate::schedule::{Output, Stage, Stages, Step};

pub use crate::framework::PaperPlugins;

/// Registration points of the framework. The paper's own physics uses nothing else.
pub trait StoreggaApp {
    /// Lets scenes name the rheology `R`, a pure function of shear rate and pressure.
    fn register_rheology<R: FlowCurve>(&mut self, name: &str) -> &mut Self;

    /// Lets scenes name the rheology `R`, which `system` applies: it writes
    /// [`Viscosity`](crate::particles::Viscosity) of the particles whose phase has the component `R`, may own
    /// per-particle columns, and reads Δt from the [`Clock`].
    fn register_rheology_system<R: Rheology, M>(
        &mut self,
        name: &str,
        system: impl IntoScheduleConfigs<ScheduleSystem, M>,
    ) -> &mut Self;

    /// Lets scenes name a smoothing kernel.
    fn register_kernel<K: Kernel + Clone + JsonSchema>(&mut self, name: &str, kernel: K) -> &mut Self;

    /// Puts systems in charge of a stage, for 2D and for 3D scenes, in the place of those that were: for
    /// [`Stage::Rheology`] those of all rheologies registered so far. Without effect once a scene is loaded.
    fn set_stage<A, B>(
        &mut self,
        stage: Stage,
        two: impl IntoScheduleConfigs<ScheduleSystem, A>,
        three: impl IntoScheduleConfigs<ScheduleSystem, B>,
    ) -> &mut Self;

    /// Adds a system to a stage, beside the one in charge; order them with `before` and `after` if they share columns.
    fn add_to_stage<M>(&mut self, stage: Stage, systems: impl IntoScheduleConfigs<ScheduleSystem, M>) -> &mut Self;

    /// Lets scenes name the probe `P`, which measures whenever series are due.
    fn register_probe<P: Probe>(&mut self, name: &str) -> &mut Self;

    /// Gives scenes the section `S`.
    fn register_scene_section<S: SceneSection>(&mut self) -> &mut Self;

    /// Gives every fluid particle the column `T`, which follows its particle through re-sorting, and is saved in checkpoints
    /// (of whatever entity has a `T`).
    fn register_particle_column<T>(&mut self) -> &mut Self
    where
        T: Component<Mutability = Mutable> + Copy + Default + Serialize + DeserializeOwned;

    /// [`register_particle_column`](Self::register_particle_column) for scenes in which an entity has the component `Used`, such as a
    /// phase its rheology, before its fluids are filled; in others particles have no `T`.
    fn register_particle_column_for<T, Used>(&mut self) -> &mut Self
    where
        T: Component<Mutability = Mutable> + Copy + Default + Serialize + DeserializeOwned,
        Used: Component;

    /// Saves the component or resource `T`, of every entity that has it, in [checkpoints](crate::checkpoint): for state that
    /// lives from one step to the next. It has to be there from the start of the run on.
    fn register_saved<T>(&mut self) -> &mut Self
    where
        T: Component<Mutability = Mutable> + Serialize + DeserializeOwned;

    /// Says that the component or resource `T` needs no place in [checkpoints](crate::checkpoint): it follows from the scene,
    /// or is computed anew before it is read. Scene sections, rheologies and probes are known as such.
    fn register_rebuilt<T: Component>(&mut self) -> &mut Self;

    /// Adds the field `name` (in `unit`) to the point cloud `/particles` of the log: the `value` of column `T`, for scenes
    /// in which an entity has the component `Used`, such as a phase its rheology.
    fn log_particle_column<T: Component, Used: Component>(
        &mut self,
        name: &'static str,
        unit: &'static str,
        value: fn(&T) -> f64,
    ) -> &mut Self;
}

/// Orders the systems of registered rheologies, which may all write the viscosity, by registration.
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
struct RheologyOrder(usize);

impl StoreggaApp for App {
    fn register_rheology<R: FlowCurve>(&mut self, name: &str) -> &mut Self {
        self.register_rheology_system::<R, _>(name, apply_flow_curve::<R>);
        self.world_mut().resource_mut::<RheologyRegistry>().set_curve::<R>(name);
        self
    }

    fn register_rheology_system<R: Rheology, M>(
        &mut self,
        name: &str,
        system: impl IntoScheduleConfigs<ScheduleSystem, M>,
    ) -> &mut Self {
        let mut registry = self.world_mut().get_resource_or_init::<RheologyRegistry>();
        let order = registry.register::<R>(name);
        SavedState::register_rebuilt::<R>(self.world_mut());
        let in_use = any_with_component::<R>;
        let system = system.in_set(RheologyOrder(order)).after(RheologyOrder(order - 1)).run_if(in_use);
        if let Some(mut stages) = self.world_mut().get_non_send_mut::<Stages>() {
            stages.extend(Stage::Rheology, system);
        }
        self
    }

    fn register_kernel<K: Kernel + Clone + JsonSchema>(&mut self, name: &str, kernel: K) -> &mut Self {
        self.world_mut().get_resource_or_init::<KernelRegistry>().register(name, kernel);
        self
    }

    fn set_stage<A, B>(
        &mut self,
        stage: Stage,
        two: impl IntoScheduleConfigs<ScheduleSystem, A>,
        three: impl IntoScheduleConfigs<ScheduleSystem, B>,
    ) -> &mut Self {
        if let Some(mut stages) = self.world_mut().get_non_send_mut::<Stages>() {
            stages.set(stage, two, three);
        }
        self
    }

    fn add_to_stage<M>(&mut self, stage: Stage, systems: impl IntoScheduleConfigs<ScheduleSystem, M>) -> &mut Self {
        self.add_systems(Step, systems.in_set(stage))
    }

    fn register_probe<P: Probe>(&mut self, name: &str) -> &mut Self {
        ProbeRegistry::register::<P>(self, name);
        self
    }

    fn register_scene_section<S: SceneSection>(&mut self) -> &mut Self {
        self.world_mut().get_resource_or_init::<SectionRegistry>().register::<S>();
        SavedState::register_rebuilt::<S>(self.world_mut());
        self
    }

    fn register_particle_column<T>(&mut self) -> &mut Self
    where
        T: Component<Mutability = Mutable> + Copy + Default + Serialize + DeserializeOwned,
    {
        let world = self.world_mut();
        // The framework's own columns are required by the marker itself, and so is a column registered twice.
        let _ = world.try_register_required_components::<Fluid, T>();
        ParticleColumns::register::<T>(world);
        self.register_saved::<T>()
    }

    fn register_particle_column_for<T, Used>(&mut self) -> &mut Self
    where
        T: Component<Mutability = Mutable> + Copy + Default + Serialize + DeserializeOwned,
        Used: Component,
    {
        ParticleColumns::register_optional::<T, Used>(self.world_mut());
        self.register_saved::<T>()
    }

    fn register_saved<T>(&mut self) -> &mut Self
    where
        T: Component<Mutability = Mutable> + Serialize + DeserializeOwned,
    {
        SavedState::register::<T>(self.world_mut());
        self
    }

    fn register_rebuilt<T: Component>(&mut self) -> &mut Self {
        SavedState::register_rebuilt::<T>(self.world_mut());
        self
    }

    fn log_particle_column<T: Component, Used: Component>(
        &mut self,
        name: &'static str,
        unit: &'static str,
        value: fn(&T) -> f64,
    ) -> &mut Self {
        ParticleFields::register::<T, Used>(self.world_mut(), name, unit, value);
        self
    }
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum End {
    /// It reached its end time.
    Done,
    /// It left the range of the model.
    Diverged(Box<DivergenceReport>),
    /// It was told to stop.
    Interrupted,
    /// The log could not be written.
    LogFailed(String),
    /// A system failed: a mistake in the program or in a plugin.
    Failed(String),
}

impl End {
    /// One word for programs: `done`, `diverged`, `interrupted`, `log_failed`, `failed`.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Diverged(_) => "diverged",
            Self::Interrupted => "interrupted",
            Self::LogFailed(_) => "log_failed",
            Self::Failed(_) => "failed",
        }
    }
}

/// An app with `plugins`, at the start of the scene `document`: forces, walls and time step are those of t = 0.
///
/// # Errors
/// What the user got wrong in the scene, or a plugin whose systems do not fit.
pub fn open<M>(plugins: impl Plugins<M>, document: Document) -> Result<App, UserError> {
    let mut app = App::new();
    app.add_plugins(plugins);
    app.finish();
    let world = app.world_mut();
    failure::install(world);
    load_scene(world, document)?;
    settle_least_time_step(world);
    let plugin_error = |what: &str| UserError::plain(format!("a plugin does not fit: {what}"));
    failure::build_schedules(world).map_err(|what| plugin_error(&what))?;
    // A step of no duration finds neighbours, ghosts, forces and the first time step.
    world.run_schedule(Step);
    if let Some(what) = failure::take() {
        return Err(plugin_error(&what));
    }
    refuse_endless_run(world)?;
    Ok(app)
}

/// Refuses a scene whose time step would never come to its end.
fn refuse_endless_run(world: &World) -> Result<(), UserError> {
    let (clock, end_time) = (world.resource::<Clock>(), end_time(world));
    if clock.stable_time_step * MOST_STEPS > end_time {
        return Ok(());
    }
    let (step, limit) = (clock.stable_time_step, clock.stable_limit);
    let message = format!("the time step would be {step:.2e} s, bound by {limit} (Eq. 19): the run would never end");
    Err(UserError::plain(message).help("look at the greatest viscosity, the sound speed and the spacing"))
}

/// What the run loop tells while it runs, and where it hears that it should stop.
#[derive(Clone, Default)]
pub struct StopFlag(Arc<AtomicBool>);

impl StopFlag {
    /// Asks the run to stop after the step in progress.
    pub fn stop(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether somebody asked.
    #[must_use]
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Runs a world that [`open`] made until `end_time` (s), writing outputs when they are due; `watch` is called after every step.
///
/// Call it inside a rayon thread pool to choose the number of threads; results do not depend on it.
pub fn run(world: &mut World, end_time: f64, stop: &StopFlag, mut watch: impl FnMut(&Clock)) -> End {
    if let Err(end) = write_outputs(world) {
        return end;
    }
    while world.resource::<Clock>().time < end_time {
        if stop.is_set() {
            write_last(world, false);
            return End::Interrupted;
        }
        let output = world.resource::<OutputTimes>().next();
        if end_time < output && world.resource::<Clock>().is_cut_by(end_time) {
            write_before_end(world);
        }
        world.resource_mut::<Clock>().begin_step(output.min(end_time));
        world.run_schedule(Step);
        // Nobody asks what was removed: kept, it would pile up step by step.
        world.clear_trackers();
        if let Some(what) = failure::take() {
            return End::Failed(what);
        }
        watch(world.resource::<Clock>());
        if let Some(report) = world.resource_mut::<Divergence>().0.take() {
            return End::Diverged(Box::new(report));
        }
        if let Err(end) = write_outputs(world) {
            return end;
        }
        write_if_due(world);
    }
    write_last(world, true);
    End::Done
}

/// Runs the output schedule if anything is due.
fn write_outputs(world: &mut World) -> Result<(), End> {
    let time = world.resource::<Clock>().time;
    if world.resource_mut::<OutputTimes>().begin(time) {
        world.run_schedule(Output);
        world.resource_mut::<OutputTimes>().finish(time);
        if let Some(what) = failure::take() {
            return Err(End::Failed(what));
        }
    }
    match world.get_resource_mut::<crate::log::LogFailure>().and_then(|mut failure| failure.0.take()) {
        Some(failure) => Err(End::LogFailed(failure)),
        None => Ok(()),
    }
}

/// The end time (s) that the scene asks for.
#[must_use]
pub fn end_time(world: &World) -> f64 {
    world.resource::<SceneInfo>().end_time
}
