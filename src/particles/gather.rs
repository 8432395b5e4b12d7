//! What a sweep reads of a neighbour, packed so that one neighbour is one place in memory.

use bevy_ecs::prelude::Resource;
use rayon::prelude::*;

use super::Vector;
use crate::neighbours::{Rows, clear_with_room};

/// Particles below which a loop is not split further between threads.
pub const GRAIN: usize = 256;

/// Particles above which a loop is always split, so that a thread that was held up leaves its share to the others.
pub const PIECE: usize = 2048;

/// One particle as a sweep sees it: where it is and the values that the pair term needs.
#[derive(Debug, Clone, Copy)]
pub struct Gathered<const D: usize, T> {
    /// Position (m).
    pub position: Vector<D>,
    /// What the pair term needs of this particle.
    pub state: T,
}

/// Step-local records of every row (fluid, walls, structures, periodic images), reused from step to step.
#[derive(Resource)]
pub struct Gather<const D: usize, T> {
    rows: Vec<Gathered<D, T>>,
}

impl<const D: usize, T> Default for Gather<D, T> {
    fn default() -> Self {
        Self { rows: Vec::new() }
    }
}

impl<const D: usize, T: Copy + Send + Sync> Gather<D, T> {
    /// Packs every row: `fluid`, `walls`, `structures` make the record of the k-th particle of their table; periodic
    /// images are copies of their source, shifted.
    pub fn fill(
        &mut self,
        rows: &Rows,
        fluid: impl Fn(usize) -> Gathered<D, T> + Sync + Send,
        walls: impl Fn(usize) -> Gathered<D, T> + Sync + Send,
        structures: impl Fn(usize) -> Gathered<D, T> + Sync + Send,
    ) -> &[Gathered<D, T>] {
        clear_with_room(&mut self.rows);
        self.rows.par_extend((0..rows.fluid).into_par_iter().with_min_len(GRAIN).with_max_len(PIECE).map(fluid));
        self.rows.par_extend((0..rows.walls).into_par_iter().with_min_len(GRAIN).with_max_len(PIECE).map(walls));
        self.rows
            .par_extend((0..rows.structures).into_par_iter().with_min_len(GRAIN).with_max_len(PIECE).map(structures));
        for image in &rows.images {
            let mut record = self.rows[image.source as usize];
            record.position += image.shift.into();
            self.rows.push(record);
        }
        &self.rows
    }
}
