//! Puts the paper's equations in charge of their stages.

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::IntoScheduleConfigs;

use super::body_force::{apply_body_force, ramp_gravity};
use super::divergence::{OutOfRange, explain_divergence};
use super::equation_of_state::advance_state;
use super::integration::kick;
use super::{
    CompressionGradients, DensityDiffusion, Divergence, Filled, ForceSums, FreeSurface, Gravity, ImpactPressures,
    MidwaySums, MomentumSettings, Settling, ShiftedMass, Shifting, Shifts, StateSettings, StrainSettings,
    TensileControl, TensileForces, TimeStepSettings, WallImpact, compression_gradient, density_diffusion, density_rate,
    drift, free_surface, ghost_pressure, ghost_velocity, midway_sums, momentum, next_time_step, pair_kernel,
    shift_particles, strain_rate, tensile_control, wall_impact, wall_shear,
};
use crate::app::StoreggaApp;
use crate::schedule::Stage;

/// The stages of the paper's model, and the scene sections that set them.
pub struct PhysicsPlugin;

impl Plugin for PhysicsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Divergence>().init_resource::<OutOfRange>().init_resource::<Gravity>();
        app.init_resource::<ForceSums>().register_rebuilt::<ForceSums>();
        app.init_resource::<MidwaySums>().init_resource::<CompressionGradients>();
        app.register_rebuilt::<MidwaySums>().register_rebuilt::<CompressionGradients>();
        // A run that has diverged ends: between two steps there is nothing to save.
        app.register_rebuilt::<Divergence>().register_rebuilt::<OutOfRange>().register_saved::<Gravity>();
        app.register_scene_section::<StateSettings>()
            .register_scene_section::<DensityDiffusion>()
            .register_scene_section::<StrainSettings>()
            .register_scene_section::<FreeSurface>()
            .register_scene_section::<MomentumSettings>()
            .register_scene_section::<TensileControl>()
            .register_scene_section::<WallImpact>()
            .register_scene_section::<Shifting>()
            .register_scene_section::<Settling>()
            .register_scene_section::<TimeStepSettings>();

        app.init_resource::<ImpactPressures>().register_rebuilt::<ImpactPressures>();
        app.register_particle_column_for::<Filled, Shifts>();
        app.init_resource::<ShiftedMass>().register_rebuilt::<ShiftedMass>();
        app.init_resource::<TensileForces>().register_rebuilt::<TensileForces>();

        let time_step = || (next_time_step, explain_divergence.run_if(|out: Res<OutOfRange>| out.0)).chain();

        app.add_to_stage(Stage::FirstKick, ramp_gravity)
            .set_stage(Stage::FirstKick, kick, kick)
            .set_stage(Stage::Drift, drift, drift)
            .set_stage(Stage::PairKernel, pair_kernel::<2>, pair_kernel::<3>)
            .set_stage(Stage::GhostVelocity, ghost_velocity, ghost_velocity)
            .set_stage(Stage::CompressionGradient, compression_gradient::<2>, compression_gradient::<3>)
            .set_stage(
                Stage::StrainRate,
                (midway_sums::<2>, strain_rate::<2>).chain(),
                (midway_sums::<3>, strain_rate::<3>).chain(),
            )
            .set_stage(Stage::WallShear, wall_shear, wall_shear)
            .set_stage(Stage::Continuity, density_rate::<2>, density_rate::<3>)
            .set_stage(Stage::Diffusion, density_diffusion::<2>, density_diffusion::<3>)
            .set_stage(Stage::State, advance_state, advance_state)
            .set_stage(Stage::FreeSurface, free_surface::<2>, free_surface::<3>)
            .set_stage(Stage::GhostPressure, ghost_pressure, ghost_pressure)
            .set_stage(Stage::WallImpact, wall_impact, wall_impact)
            .set_stage(Stage::Momentum, momentum::<2>, momentum::<3>)
            .set_stage(Stage::TensileControl, tensile_control::<2>, tensile_control::<3>)
            .set_stage(Stage::BodyForce, apply_body_force, apply_body_force)
            .set_stage(Stage::Shifting, shift_particles::<2>, shift_particles::<3>)
            .set_stage(Stage::SecondKick, kick, kick)
            .set_stage(Stage::TimeStep, time_step(), time_step());
    }
}
