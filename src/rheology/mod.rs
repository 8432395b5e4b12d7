//! Rheologies: the contract, the registry, one file a model.
//!
//! A rheology is a set of parameters that a scene names: `rheology: HerschelBulkley(consistency: 0.15, …)`. It becomes a
//! component of its phase's entity. Two kinds can be registered:
//!
//! - a [`FlowCurve`] is a pure function μ(γ̇, p); one generic system applies it to the particles of its phases
//!   ([`register_rheology`](crate::app::StoreggaApp::register_rheology));
//! - a rheology with a memory brings a system of its own, which may own per-particle columns and reads Δt from the
//!   [`Clock`](crate::clock::Clock)
//!   ([`register_rheology_system`](crate::app::StoreggaApp::register_rheology_system)).

mod bi_viscosity;
mod bingham;
mod carreau_yasuda;
mod casson;
mod cross;
mod herschel_bulkley;
mod newtonian;
mod parameters;
mod power_law;
mod registry;
mod regularisation;
#[cfg(test)]
mod test_support;

pub use bi_viscosity::BiViscosity;
pub use bingham::Bingham;
pub use carreau_yasuda::CarreauYasuda;
pub use casson::Casson;
pub use cross::Cross;
pub use herschel_bulkley::HerschelBulkley;
pub use newtonian::Newtonian;
pub use parameters::{Bound, check_bounds, check_order};
pub use power_law::PowerLaw;
pub use registry::{FlowCurve, Rheology, RheologyFacts, RheologyRegistry, apply_flow_curve, models_by_phase};
pub use regularisation::Regularisation;

use bevy_app::{App, Plugin};

use crate::app::StoreggaApp;

/// The paper's rheologies, and other fluids by name.
pub struct RheologyPlugin;

impl Plugin for RheologyPlugin {
    fn build(&self, app: &mut App) {
        app.register_rebuilt::<RheologyRegistry>();
        app.register_rheology::<Newtonian>("Newtonian")
            .register_rheology::<HerschelBulkley>("HerschelBulkley")
            .register_rheology::<Bingham>("Bingham")
            .register_rheology::<PowerLaw>("PowerLaw")
            .register_rheology::<Casson>("Casson")
            .register_rheology::<CarreauYasuda>("CarreauYasuda")
            .register_rheology::<Cross>("Cross")
            .register_rheology::<BiViscosity>("BiViscosity");
    }
}
