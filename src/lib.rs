//! Storegga: submarine landslides, the waves they raise, and the forces with which they hit structures.
//!
//! An entity-component-system framework for smoothed particle hydrodynamics and the simulator built with it.
//! **Components are the state**: fluid, wall and structure particles are three kinds of entity, a quantity is a component
//! named by its physics term. **A stage is a system**: one step of the algorithm is one system in one file beside its
//! equation, and [`Stage`](schedule::Stage) is the algorithm on one page. **A plugin is how anything is added**, the
//! paper's own physics too: see [`StoreggaApp`](app::StoreggaApp).
//!
//! | equation | file |
//! |---|---|
//! | 3, 4 kernel and its gradient | `kernels/quintic.rs`, `neighbours/sweep.rs`, `physics/pair_kernel.rs` |
//! | 5 continuity | `physics/continuity.rs` |
//! | 6 momentum | `physics/momentum.rs`, `physics/pressure_force.rs`, `physics/body_force.rs` |
//! | 7–9 equation of state, sound speed | `physics/equation_of_state.rs` |
//! | 10, 11 diffusion of density | `physics/diffusion.rs` |
//! | 12 viscous force | `physics/viscous_force.rs` |
//! | 13 Herschel–Bulkley | `rheology/herschel_bulkley.rs` |
//! | 14 shear rate | `physics/strain_rate.rs` |
//! | – shear rate of fluid that jumps at a wall | `physics/wall_shear.rs` |
//! | 5, 10, 11, 14 in one sweep | `physics/midway.rs` |
//! | – density of spray | `physics/free_surface.rs` |
//! | 15 pressure of ghosts | `physics/ghost_pressure.rs` |
//! | 16 velocity of ghosts | `physics/ghost_velocity.rs` |
//! | – walls stop what comes too near | `physics/wall_impact.rs` |
//! | – what is under tension does not clump | `physics/tensile_control.rs` |
//! | – particles go where they are sparse | `physics/shifting.rs` |
//! | 17, 18 force on structures | `boundary/loads.rs` |
//! | 19 time step | `physics/time_step.rs` |
//! | 20, 21 error norm | `probes/pressure_error.rs` |
//! | 22 goodness of fit | `results/fit.rs` |
//! | – books of energy, momentum, mass | `books/` |
//! | – when a run has diverged | `physics/divergence/` |
//!
//! Equation numbers are those of the paper that the model follows (Dai, Lan, et al.: SPH simulation of the motion of
//! submarine landslides and their impact on cables), in the corrected form that each file states.

pub mod app;
pub mod books;
pub mod boundary;
pub mod checkpoint;
pub mod cli;
pub mod clock;
pub mod error;
mod estimate;
pub mod expect;
mod failure;
pub mod figures;
mod framework;
pub mod kernels;
pub mod lanes;
pub mod log;
pub mod neighbours;
mod number;
pub mod outputs;
pub mod particles;
pub mod phases;
pub mod physics;
pub mod probes;
mod replace;
pub mod results;
pub mod rheology;
pub mod scene;
pub mod schedule;
pub mod study;
