//! Fine sediment that the flow carries and spreads, and another equation of state: the plugins of the tutorial.

mod channel;
mod diffusion;
mod section;
mod tait;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::common_conditions::resource_exists;
use serde::{Deserialize, Serialize};
use storegga::app::StoreggaApp;
use storegga::probes::ProbeSystems;
use storegga::schedule::{Output, OutputStage, Stage, Step};

pub use section::TurbiditySection;
pub use tait::TaitPlugin;

/// Mass fraction c of fine sediment in suspension (kg per kg of the particle), a column of every fluid particle.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FineSediment(pub f64);

/// Fine sediment: its column, its section of the scene, its diffusion and its channel in the log.
pub struct TurbidityPlugin;

impl Plugin for TurbidityPlugin {
    fn build(&self, app: &mut App) {
        app.register_particle_column::<FineSediment>();
        app.register_scene_section::<TurbiditySection>();
        app.add_to_stage(Stage::Diffusion, diffusion::spread.run_if(resource_exists::<TurbiditySection>));
        app.add_systems(
            Step,
            diffusion::limit_time_step.after(Stage::TimeStep).run_if(resource_exists::<TurbiditySection>),
        );
        app.add_systems(Output, channel::measure.in_set(OutputStage::Measure).after(ProbeSystems));
    }
}
