//! Where fluid can be: places of particles, and what is there already.

use std::collections::HashMap;

use glam::DVec3;

use super::geometry::LatticeIndex;
use crate::boundary::BodyShape;
use crate::neighbours::PeriodicSides;

/// A particle lies farther (in spacings) than this from the surface of a wall or structure: not on it, as some places of the
/// lattice do on a slanted wall, but otherwise as near as it comes, so that on average a body displaces its own volume.
pub(crate) const WALL_CLEARANCE: f64 = 1e-6;

/// Fluid that reaches deeper (in spacings) into a wall than this is a mistake in the scene.
const OVERLAP: f64 = 0.75;

/// A particle to be.
pub(super) struct Seed {
    /// The cell of the lattice that it lies in.
    pub(super) index: LatticeIndex,
    pub(super) position: DVec3,
    /// What it fills (m³; m² in 2D).
    pub(super) volume: f64,
    pub(super) fluid: usize,
}

/// Which fluid has which cell of the lattice; asked where fluids meet only, so filled when asked.
#[derive(Default)]
pub(super) struct Taken {
    cells: HashMap<LatticeIndex, usize>,
    seen: usize,
}

impl Taken {
    /// The fluid that the last of the `seeds` in this cell belongs to.
    pub(super) fn by(&mut self, cell: LatticeIndex, seeds: &[Seed]) -> Option<usize> {
        self.cells.extend(seeds[self.seen..].iter().map(|seed| (seed.index, seed.fluid)));
        self.seen = seeds.len();
        self.cells.get(&cell).copied()
    }
}

/// What is at a place of the lattice.
pub(super) enum Place<'a> {
    /// Nothing that keeps fluid out.
    Free,
    /// The surface of a wall.
    Beside,
    /// The structure of this name.
    InStructure(&'a str),
    /// The wall of this name: fluid that reaches so deep into it is a mistake.
    InWall(&'a str),
}

pub(super) fn place_of<'a>(
    x: DVec3,
    bodies: &'a [(String, BodyShape, bool)],
    periodic: &PeriodicSides,
    spacing: f64,
) -> Place<'a> {
    let mut found = Place::Free;
    for (name, shape, is_structure) in bodies {
        let clearance = shape.clearance_through(periodic, x) / spacing;
        match *is_structure {
            false if clearance < -OVERLAP => return Place::InWall(name),
            false if clearance < WALL_CLEARANCE => found = Place::Beside,
            true if clearance < WALL_CLEARANCE && matches!(found, Place::Free) => found = Place::InStructure(name),
            _ => {}
        }
    }
    found
}
