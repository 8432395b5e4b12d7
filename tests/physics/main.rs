//! The equations against exact answers, conservation laws and brute force.

mod conservation;
mod determinism;
mod diffusion;
mod ghosts;
mod kernels;
mod linear_fields;
mod neighbours;
mod periodic;
mod pressure_forces;
mod refusals;
mod support;
mod twin;
mod viscous_forces;
