//! Who is near whom: cell grid, neighbour lists with a skin, periodic images, order in memory.

mod build;
mod clusters;
mod grid;
mod images;
mod list;
mod search;
mod skin;
mod sort;
mod sweep;

pub use build::{NeighbourSettings, Neighbours, NeighboursPlugin};
pub use clusters::{CLUSTER, ClusterList, Near, NearRows};
pub use images::{Image, PeriodicSides};
pub use list::{Pair, PairList, Pairs, sum_pairs};
pub use sweep::{PairTerm, Sweep};

use glam::DVec3;
use images::add_images;

pub(crate) use list::{Wanted, clear_with_room};
pub(crate) use skin::FIRST_HALF_SKIN;

/// How the rows of all tables follow one another in the numbering that neighbour lists use: first the fluid, then
/// walls, structures, and the periodic images of any of them.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// Number of fluid particles.
    pub fluid: usize,
    /// Number of wall particles.
    pub walls: usize,
    /// Number of structure particles.
    pub structures: usize,
    /// Periodic images.
    pub images: Vec<Image>,
}

impl Rows {
    /// Number of rows without images.
    #[must_use]
    pub fn owned(&self) -> usize {
        self.fluid + self.walls + self.structures
    }

    /// The row that `row` is an image of, or `row` itself.
    #[inline(always)]
    #[must_use]
    pub fn source(&self, row: u32) -> usize {
        let row = row as usize;
        if row < self.owned() { row } else { self.images[row - self.owned()].source as usize }
    }

    /// The displacement (m) of `row` from its source; zero where it is no image.
    #[inline(always)]
    #[must_use]
    pub fn shift(&self, row: u32) -> DVec3 {
        let row = row as usize;
        if row < self.owned() { DVec3::ZERO } else { self.images[row - self.owned()].shift }
    }
}
