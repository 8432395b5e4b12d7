//! Flows driven and shaken from outside, by the public interface of Storegga alone.
//!
//! | what | section or probe | file |
//! |---|---|---|
//! | velocity driven to a profile: open channels, wave absorption | `relaxation_zones` | `relaxation.rs`, `profile.rs` |
//! | seismic shaking from a tabulated accelerogram | `shaking` | `shaking.rs` |
//! | drag and lift coefficients of a structure | `ForceCoefficients` | `force_coefficients.rs` |
//! | mean velocity in a shape | `MeanVelocity` | `mean_velocity.rs` |

mod force_coefficients;
mod mean_velocity;
mod profile;
mod relaxation;
mod shaking;

pub use force_coefficients::ForceCoefficients;
pub use mean_velocity::MeanVelocity;
pub use profile::{Profile, ProfileRow};
pub use relaxation::{RelaxationZone, RelaxationZones, relax};
pub use shaking::{Accelerogram, AccelerogramColumn, Shaking, shake};

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use storegga::app::StoreggaApp;
use storegga::physics::drift;
use storegga::schedule::Stage;

/// Relaxation zones, seismic shaking, and the probes that go with them.
#[derive(Debug, Clone, Copy, Default)]
pub struct FlowPlugin;

impl Plugin for FlowPlugin {
    fn build(&self, app: &mut App) {
        app.register_scene_section::<Shaking>()
            .register_rebuilt::<Accelerogram>()
            .register_scene_section::<RelaxationZones>()
            .register_probe::<ForceCoefficients>("ForceCoefficients")
            .register_probe::<MeanVelocity>("MeanVelocity");
        // Gravity was set for this step with the first kick, and is read from the diffusion of density on.
        app.add_to_stage(Stage::MoveBodies, shake.run_if(resource_exists::<Accelerogram>));
        app.add_to_stage(Stage::Drift, relax.before(drift).run_if(relaxation::any));
    }
}
