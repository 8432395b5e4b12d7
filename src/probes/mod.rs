//! What a run measures: probes that the scene names, and the series that every run has.
//!
//! A probe is a set of parameters that a scene names, `probes: {"front": Front(phase: "slide", direction: (1, -1))}`. It
//! becomes a component of an entity that also has a [`Series`], to which it adds a row of numbers whenever series are
//! due. `energy` and the load on each structure are series of every run.

mod center_of_mass;
mod channel_error;
mod channel_flow;
mod couette_error;
mod couette_flow;
mod density_error;
mod energy;
mod front;
mod interface;
mod layer_mode;
mod parameters;
mod particle_disorder;
mod phase_mixing;
mod pressure_error;
mod pressure_point;
mod probe;
mod rigid_rotation;
mod section;
mod series;
mod shear_stress;
mod state;
mod structure_load;
mod surface_height;
#[cfg(test)]
pub(crate) mod test_support;

pub(crate) use density_error::DEPTH;
pub(crate) use particle_disorder::{CLUMPED, FULL};
pub(crate) use phase_mixing::LEAST_SHARE;
pub(crate) use pressure_point::DRY;
pub(crate) use rigid_rotation::RIM;

pub use center_of_mass::CenterOfMass;
pub use channel_error::ChannelError;
pub use channel_flow::ChannelFlow;
pub use couette_error::CouetteError;
pub use couette_flow::{CouetteFlow, CouetteLayer};
pub use density_error::DensityError;
pub use energy::Energy;
pub use front::Front;
pub use interface::Interface;
pub use layer_mode::LayerMode;
pub use parameters::box_inside;
pub use particle_disorder::ParticleDisorder;
pub use phase_mixing::PhaseMixing;
pub use pressure_error::HydrostaticError;
pub use pressure_point::PressurePoint;
pub use probe::{Probe, ProbeRegistry, ProbeSystems};
pub use rigid_rotation::RigidRotationError;
pub use section::ProbesSection;
pub use series::{Series, SeriesField};
pub use shear_stress::ShearStress;
pub use state::{FluidColumns, State, StateParam, Structures};
pub use structure_load::StructureLoad;
pub use surface_height::SurfaceHeight;

use bevy_app::{App, Plugin};

use crate::app::StoreggaApp;

/// The probes, and their section of the scene; it comes after fluids, walls and structures.
pub struct ProbesPlugin;

impl Plugin for ProbesPlugin {
    fn build(&self, app: &mut App) {
        app.register_saved::<Series>().register_rebuilt::<ProbeRegistry>();
        ProbeRegistry::add_system::<Energy>(app);
        ProbeRegistry::add_system::<StructureLoad>(app);
        app.register_probe::<PressurePoint>("PressurePoint")
            .register_probe::<SurfaceHeight>("SurfaceHeight")
            .register_probe::<Front>("Front")
            .register_probe::<CenterOfMass>("CenterOfMass")
            .register_probe::<HydrostaticError>("HydrostaticError")
            .register_probe::<ChannelError>("ChannelError")
            .register_probe::<CouetteError>("CouetteError")
            .register_probe::<ShearStress>("ShearStress")
            .register_probe::<DensityError>("DensityError")
            .register_probe::<Interface>("Interface")
            .register_probe::<RigidRotationError>("RigidRotationError")
            .register_probe::<LayerMode>("LayerMode")
            .register_probe::<PhaseMixing>("PhaseMixing")
            .register_probe::<ParticleDisorder>("ParticleDisorder")
            .register_scene_section::<ProbesSection>();
    }
}
