//! The plugins that make the framework and the paper's physics.

use bevy_app::{App, Plugin, PluginGroup, PluginGroupBuilder};

use crate::app::StoreggaApp;
use crate::checkpoint::{Checkpoints, SavedState};
use crate::clock::Clock;
use crate::kernels::{CubicSpline, KernelRegistry, QuinticSpline, SmoothingKernel, WendlandC2, WendlandC4};
use crate::outputs::OutputTimes;
use crate::particles::{
    Acceleration, Density, DensityRate, Mass, ParticleColumns, ParticleId, PhaseIndex, Position, Pressure,
    ReferenceDensity, ShearRate, Velocity, Viscosity,
};
use crate::physics::EquationOfState;
use crate::scene::{Resolution, SceneDocument, SceneFacts, SceneFiles, SceneInfo, SectionRegistry};
use crate::schedule;

/// The framework and the paper's physics.
pub struct PaperPlugins;

impl PluginGroup for PaperPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(FrameworkPlugin)
            .add(crate::neighbours::NeighboursPlugin)
            .add(crate::physics::PhysicsPlugin)
            .add(crate::rheology::RheologyPlugin)
            .add(crate::phases::PhasesPlugin)
            .add(crate::boundary::BoundaryPlugin)
            .add(FluidsPlugin)
            .add(crate::probes::ProbesPlugin)
            .add(crate::books::BooksPlugin)
            .add(crate::expect::ExpectPlugin)
            .add(crate::log::LogPlugin)
    }
}

/// Schedules, clock, columns, kernels.
struct FrameworkPlugin;

impl Plugin for FrameworkPlugin {
    fn build(&self, app: &mut App) {
        schedule::init(app);
        app.init_resource::<Clock>().init_resource::<OutputTimes>();
        app.register_saved::<Clock>().register_saved::<OutputTimes>();
        app.init_resource::<SceneFiles>();
        app.register_rebuilt::<SavedState>()
            .register_rebuilt::<Checkpoints>()
            .register_rebuilt::<SceneFiles>()
            .register_rebuilt::<ParticleColumns>()
            .register_rebuilt::<KernelRegistry>()
            .register_rebuilt::<SmoothingKernel>()
            .register_rebuilt::<SectionRegistry>()
            .register_rebuilt::<SceneDocument>()
            .register_rebuilt::<SceneFacts>()
            .register_rebuilt::<SceneInfo>()
            .register_rebuilt::<Resolution>();
        app.register_particle_column::<ParticleId>()
            .register_particle_column::<PhaseIndex>()
            .register_particle_column::<Position>()
            .register_particle_column::<Velocity>()
            .register_particle_column::<Acceleration>()
            .register_particle_column::<Mass>()
            .register_particle_column::<ReferenceDensity>()
            .register_particle_column::<Density>()
            .register_particle_column::<DensityRate>()
            .register_particle_column::<Pressure>()
            .register_particle_column::<Viscosity>()
            .register_particle_column::<ShearRate>();
        app.register_kernel("QuinticSpline", QuinticSpline)
            .register_kernel("CubicSpline", CubicSpline)
            .register_kernel("WendlandC2", WendlandC2)
            .register_kernel("WendlandC4", WendlandC4);
    }
}

/// Fluids of a scene; their section comes after those of phases, walls and structures, which it needs.
struct FluidsPlugin;

impl Plugin for FluidsPlugin {
    fn build(&self, app: &mut App) {
        app.register_scene_section::<crate::scene::FluidsSection>()
            .register_scene_section::<crate::scene::Disturbance>()
            .register_rebuilt::<crate::scene::FilledFluids>()
            .register_rebuilt::<EquationOfState>();
    }
}
