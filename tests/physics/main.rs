//! The equations against exact answers, conservation laws and brute force.

mod accelerated_walls;
mod conservation;
mod determinism;
mod diffusion;
mod ghosts;
mod kernels;
mod linear_fields;
mod motion;
mod neighbours;
mod periodic;
mod pressure_forces;
mod refusals;
mod slip;
mod support;
mod twin;
mod viscous_forces;
