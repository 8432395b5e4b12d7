//! The equations against exact answers, conservation laws and brute force.

mod accelerated_walls;
mod books;
mod channel;
mod conservation;
mod determinism;
mod diffusion;
mod divergence;
mod filling;
mod free_surface;
mod ghosts;
mod kernels;
mod linear_fields;
mod loads;
mod motion;
mod neighbours;
mod periodic;
mod pressure_forces;
mod refusals;
mod rheologies;
mod settling;
mod shifting;
mod slip;
mod state;
#[path = "../support/steps.rs"]
mod steps;
mod support;
mod tensile_control;
mod time_step;
mod twin;
mod viscous_forces;
mod wall_impact;
mod wall_shear;
mod walls;
