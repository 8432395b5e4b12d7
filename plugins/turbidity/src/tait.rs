//! Another equation of state in the place of Eq. 7: that of Cole 1948, which is mostly called Tait's.
//!
//! `p = (B/γ) ((ρ/ρ0)^γ − 1) + χ`, γ = 7. At ρ0 it has the bulk modulus B and so the sound speed of Eq. 7; it is stiffer where the
//! fluid is compressed.

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use rayon::prelude::*;
use storegga::app::StoreggaApp;
use storegga::clock::Clock;
use storegga::particles::{Density, DensityRate, Fluid, Pressure, ReferenceDensity};
use storegga::physics::EquationOfState;
use storegga::schedule::Stage;

/// γ of water.
const GAMMA: i32 = 7;

/// Puts Cole's equation in charge of [`Stage::State`].
pub struct TaitPlugin;

impl Plugin for TaitPlugin {
    fn build(&self, app: &mut App) {
        app.set_stage(Stage::State, advance_state, advance_state);
    }
}

/// `ρ ← ρ + Δt dρ/dt`, then p(ρ): all that the stage is in charge of.
fn advance_state(
    clock: Res<Clock>,
    state: Res<EquationOfState>,
    mut fluid: Query<(&DensityRate, &ReferenceDensity, &mut Density, &mut Pressure), With<Fluid>>,
) -> Result {
    for (rate, rho0, mut rho, mut p) in fluid.contiguous_iter_mut()? {
        (rate, rho0, rho.bypass_change_detection(), p.bypass_change_detection()).into_par_iter().for_each(
            |(rate, rho0, rho, p)| {
                rho.0 += clock.time_step * rate.0;
                let stiffness = state.bulk_modulus / f64::from(GAMMA);
                p.0 = stiffness * ((rho.0 / rho0.0).powi(GAMMA) - 1.0) + state.background_pressure;
            },
        );
    }
    Ok(())
}
