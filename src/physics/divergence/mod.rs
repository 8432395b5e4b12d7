//! The watch over a run: what range the model holds in, and what is said when a run leaves it.
//!
//! Every step, in [`Stage::TimeStep`](crate::schedule::Stage::TimeStep), of every fluid particle:
//!
//! - x, v, dv/dt and ρ are numbers;
//! - `|v| < c` of its phase: what is faster than its own sound is not weakly compressible (Eq. 8 asks for a tenth);
//! - `½ < ρ/ρ0 < 2` (Eq. 8 keeps it within some hundredths);
//!
//! and `Δt ≥ Δt_min` of Eq. 19. The default of Δt_min ([`TimeStepSettings::least`](super::TimeStepSettings)) is a hundredth of the
//! least Δt that sound and viscosity ask for within these limits, or what it takes to end the run in 10¹¹ steps if that
//! is longer: only accelerations of more than some ten thousand c²/h, or a viscosity beyond what its rheology promised,
//! lead there.

mod advice;
mod explain;
mod report;

pub use advice::{Advice, Cause};
pub use explain::OutOfRange;
pub use report::{BrokenLimit, Divergence, DivergenceReport, NeighbourGroup};

pub(super) use explain::explain_divergence;
pub(crate) use explain::{GREATEST_COMPRESSION, MOST_STEPS, settle_least_time_step};
