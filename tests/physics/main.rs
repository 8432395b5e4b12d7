//! The equations against exact answers, conservation laws and brute force.

mod conservation;
mod determinism;
mod ghosts;
mod kernels;
mod linear_fields;
mod neighbours;
mod periodic;
mod refusals;
mod support;
mod twin;
