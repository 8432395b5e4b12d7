//! Shapes of a scene and the particles that fill or surround them.
//!
//! A [`Shape`] says where fluid, walls and structures are. [`lattice`] fills it with fluid particles,
//! [`ghost_layers`] lines it with the ghost particles of a wall and [`solid_particles`] fills it as a structure.
//! Everything is in metres; a two-dimensional scene is the plane z = 0.

mod axis;
mod body;
mod check;
mod distance;
mod fill;
mod layers;
mod lining;
mod point;
mod polygon;
mod rings;
mod rotation;
mod rows;
mod shape;
#[cfg(test)]
mod test_support;

pub use body::{SolidParticle, solid_particles};
pub use check::{axis_exists, coordinates};
pub use fill::{LatticeIndex, LatticePoint, lattice};
pub use layers::{Side, ghost_layers};
pub(crate) use lining::lining_measure;
pub use point::Point;
pub use rotation::RigidRotation;
pub(crate) use rotation::{check_axis, corners, unit_axis};
pub use shape::{Axis, Shape};
