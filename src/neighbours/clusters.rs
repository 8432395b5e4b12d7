//! Neighbours of fluid particles, four at a time.
//!
//! Four fluid particles that follow one another in memory, and so lie beside one another in space, share one list: whatever is
//! within reach of any of them. It takes a quarter of the memory of four lists and of the time to build them, and a pair
//! loop has the four side by side in one register and meets each neighbour once. The price is that each particle
//! also meets those neighbours of the other three that it does not reach, where the kernel is 0.

use rayon::prelude::*;

use super::list::clear_with_room;
use crate::particles::PIECE;

/// Fluid particles that share one list.
pub const CLUSTER: usize = 4;

/// Clusters that share one piece of memory.
const CHUNK: usize = 128;

#[derive(Debug, Default)]
struct Chunk {
    /// Of the k-th cluster of this chunk `ends[2k]..ends[2k + 1]` are fluid and `ends[2k + 1]..ends[2k + 2]` ghosts.
    ends: Vec<u32>,
    rows: Vec<u32>,
}

/// What is near each cluster of four fluid particles.
#[derive(Debug, Default)]
pub struct ClusterList {
    chunks: Vec<Chunk>,
}

/// Rows that are near a particle: all within reach, the particle itself, and some farther away, where the kernel is 0.
#[derive(Debug, Clone, Copy)]
pub struct Near<'a> {
    /// Fluid particles and their images.
    pub fluid: &'a [u32],
    /// Ghosts of walls and structures, and their images.
    pub ghosts: &'a [u32],
}

impl<'a> Near<'a> {
    /// Fluid, then ghosts.
    pub fn rows(self) -> impl Iterator<Item = u32> + 'a {
        self.fluid.iter().chain(self.ghosts).copied()
    }
}

impl ClusterList {
    /// What is near the fluid particle in row `i`.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, i: usize) -> Near<'_> {
        let (chunk, k) = (&self.chunks[i / (CLUSTER * CHUNK)], i / CLUSTER % CHUNK);
        let [first, ghosts, end] = [0, 1, 2].map(|e| chunk.ends[2 * k + e] as usize);
        Near { fluid: &chunk.rows[first..ghosts], ghosts: &chunk.rows[ghosts..end] }
    }

    /// Number of pairs that a sweep over all particles meets.
    #[must_use]
    pub fn len(&self) -> usize {
        CLUSTER * self.chunks.iter().map(|chunk| chunk.rows.len()).sum::<usize>()
    }

    /// Whether nothing is near anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Lists anew for `particles` fluid particles: `find(rows, kind, list)` appends what is near the particles in `rows`.
    pub(super) fn build(
        &mut self,
        particles: usize,
        find: impl Fn(std::ops::Range<usize>, Kind, &mut Vec<u32>) + Sync,
    ) {
        let clusters = particles.div_ceil(CLUSTER);
        self.chunks.resize_with(clusters.div_ceil(CHUNK), Chunk::default);
        let max_len = PIECE / (CLUSTER * CHUNK);
        self.chunks.par_iter_mut().with_max_len(max_len).enumerate().for_each(|(c, chunk)| {
            clear_with_room(&mut chunk.rows);
            chunk.ends.clear();
            chunk.ends.push(0);
            for cluster in c * CHUNK..clusters.min((c + 1) * CHUNK) {
                let rows = cluster * CLUSTER..particles.min((cluster + 1) * CLUSTER);
                for kind in [Kind::Fluid, Kind::Ghost] {
                    find(rows.clone(), kind, &mut chunk.rows);
                    chunk.ends.push(chunk.rows.len() as u32);
                }
            }
        });
    }
}

/// What a list looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Fluid,
    Ghost,
}
