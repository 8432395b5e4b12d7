//! Soils for Storegga, by its public interface alone.
//!
//! - [`MuI`]: granular flow, whose strength is friction (Jop, Forterre & Pouliquen 2006);
//! - [`StrainSoftening`]: sensitive clay, whose yield stress falls from its peak to its remoulded value as it is sheared
//!   (Einav & Randolph 2005), the mechanism of retrogressive submarine slides.

mod mu_i;
mod strain_softening;

pub use mu_i::{MuI, PorePressure};
pub use strain_softening::{AccumulatedStrain, StrainSoftening};

use bevy_app::{App, Plugin};
use storegga::app::StoreggaApp;

/// Lets scenes name [`MuI`] and [`StrainSoftening`].
#[derive(Debug, Clone, Copy, Default)]
pub struct SoilsPlugin;

impl Plugin for SoilsPlugin {
    fn build(&self, app: &mut App) {
        app.register_rheology_system::<MuI, _>("MuI", mu_i::rub)
            .register_particle_column_for::<AccumulatedStrain, StrainSoftening>()
            .log_particle_column::<AccumulatedStrain, StrainSoftening>("strain", "1", |strain| strain.0)
            .register_rheology_system::<StrainSoftening, _>("StrainSoftening", strain_softening::soften);
    }
}
