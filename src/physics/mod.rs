//! The equations: one file a stage, in the order of [`Stage`](crate::schedule::Stage).

mod body_force;
mod compression_gradient;
mod continuity;
mod diffusion;
pub mod divergence;
mod equation_of_state;
mod free_surface;
mod ghost_pressure;
mod ghost_velocity;
mod integration;
mod midway;
mod momentum;
mod near_ghosts;
mod pair_kernel;
mod plugin;
mod pressure_force;
mod shifting;
mod strain_rate;
mod tensile_control;
mod time_step;
mod viscous_force;
mod wall_impact;
mod wall_shear;

pub use body_force::{Gravity, Settling};
pub use compression_gradient::{CompressionGradients, compression_gradient};
pub use continuity::density_rate;
pub use diffusion::{DensityDiffusion, density_diffusion};
pub use divergence::{Advice, BrokenLimit, Cause, Divergence, DivergenceReport, NeighbourGroup, OutOfRange};
pub use equation_of_state::{EquationOfState, StateSettings};
pub use free_surface::{FreeSurface, free_surface};
pub use ghost_pressure::ghost_pressure;
pub use ghost_velocity::ghost_velocity;
pub use integration::drift;
pub use midway::{MidwaySums, midway_sums};
pub use momentum::{ForceSums, Momentum, MomentumSettings, momentum};
pub use pair_kernel::pair_kernel;
pub use plugin::PhysicsPlugin;
pub use pressure_force::{DensityWeighted, PressureAverage, PressureForm, VolumeWeighted};
pub use shifting::{Filled, ShiftedMass, Shifting, Shifts, shift_particles};
pub use strain_rate::{StrainSettings, strain_rate};
pub use tensile_control::{TensileControl, TensileForces, tensile_control};
pub use time_step::{TimeStepSettings, next_time_step};
pub use viscous_force::{CentralForm, LaplacianForm, ViscousForce, ViscousForm};
pub use wall_impact::{ImpactPressures, WallImpact, wall_impact};
pub use wall_shear::wall_shear;

pub(crate) use compression_gradient::LEAST_RATIO;
pub(crate) use divergence::{GREATEST_COMPRESSION, MOST_STEPS, settle_least_time_step};
pub(crate) use free_surface::{CLEAR_FILLING, LEAST_FILLING};
pub(crate) use momentum::{
    FluidColumns, FluidState, ForceSum, Forces, GhostColumns, GhostState, impact_force, pair_forces, with_forms,
};
pub(crate) use near_ghosts::NearGhosts;
pub(crate) use shifting::{AT_SURFACE, LONGEST_SHIFT, NEAR_SURFACE};
pub(crate) use strain_rate::LEAST_DETERMINANT;
pub(crate) use wall_impact::{BEHIND, PUSHED, fullness_in_front};
