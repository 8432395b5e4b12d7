//! Walls and structures: bodies made of ghost particles, their motion, and the loads on structures.

mod body;
mod loads;
mod motion;
mod overlap;
mod structures;
mod walls;

pub use body::{Body, BodyShape};
pub use loads::{Load, Structure, force_on_particles, sum_loads};
pub use motion::{InverseMotion, Kinematics, Motion, TableRow, move_bodies};
pub use overlap::LeftOut;
pub use structures::{StructureSpec, StructuresSection};
pub use walls::{FluidSide, WallSpec, WallsSection};
pub(crate) use walls::{body_shapes, ghost_layer_count};

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;

use crate::app::StoreggaApp;
use crate::particles::{
    BodyIndex, ForceOnParticle, GhostVelocity, PeriodShift, RestPosition, Slip, Volume, WallAcceleration,
    WallAngularVelocity, WallVelocity,
};
use crate::schedule::Stage;

/// Walls and structures of a scene.
pub struct BoundaryPlugin;

impl Plugin for BoundaryPlugin {
    fn build(&self, app: &mut App) {
        app.register_scene_section::<WallsSection>().register_scene_section::<StructuresSection>();
        app.register_rebuilt::<Body>()
            .register_rebuilt::<BodyShape>()
            .register_rebuilt::<LeftOut>()
            .register_rebuilt::<Motion>()
            .register_rebuilt::<Structure>()
            .register_rebuilt::<BodyIndex>()
            .register_rebuilt::<Slip>()
            .register_rebuilt::<Volume>();
        app.register_saved::<RestPosition>()
            .register_saved::<PeriodShift>()
            .register_saved::<WallVelocity>()
            .register_saved::<WallAcceleration>()
            .register_saved::<WallAngularVelocity>()
            .register_saved::<GhostVelocity>()
            .register_saved::<ForceOnParticle>()
            .register_saved::<Load>();
        app.set_stage(Stage::MoveBodies, move_bodies, move_bodies).set_stage(
            Stage::Loads,
            (force_on_particles::<2>, sum_loads).chain(),
            (force_on_particles::<3>, sum_loads).chain(),
        );
    }
}
