//! Particles: their components, their columns, and how pair loops read them.

mod columns;
mod components;
mod gather;
mod vector;

pub(crate) use columns::permute_columns;
pub use columns::{ParticleColumns, columns};
pub use components::*;
pub use gather::{GRAIN, Gathered, PIECE, Records, Workspace};
pub use vector::Vector;
