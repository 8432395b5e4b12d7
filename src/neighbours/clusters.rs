//! Neighbours of fluid particles, four at a time.
//!
//! Four fluid particles that follow one another in memory, and so lie beside one another in space, share one list: whatever is
//! within reach of any of them. It takes a quarter of the memory of four lists and of the time to build them, and a pair
//! loop has the four side by side in one register and meets each neighbour once. The price is that each particle
//! also meets those neighbours of the other three that it does not reach, where the kernel is 0.
//!
//! Fluid near one another is near in memory too: most rows are kept in 16 bits, as what they are beyond the first of their chunk.

use rayon::prelude::*;

use super::list::clear_with_room;
use crate::particles::PIECE;

/// Fluid particles that share one list.
pub const CLUSTER: usize = 4;

/// Clusters that share one piece of memory.
const CHUNK: usize = 128;

#[derive(Debug, Default)]
struct Chunk {
    /// Of the k-th cluster of this chunk the fluid ends at `ends[k + 1][0]` and the ghosts at `ends[k + 1][1]`.
    ends: Vec<[u32; 2]>,
    /// 2¹⁵ before the first row of the chunk, since what is near lies on both sides.
    base: u32,
    /// Rows of fluid beyond the base, if 16 bits hold all of them; and a few numbers more, so that the last can be unpacked with others.
    offsets: Vec<u16>,
    /// Rows of fluid otherwise, as beside a periodic side.
    fluid: Vec<u32>,
    /// Whether rows of fluid are kept as they are.
    is_whole: bool,
    ghosts: Vec<u32>,
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
    pub fluid: NearRows<'a>,
    /// Ghosts of walls and structures, and their images.
    pub ghosts: &'a [u32],
}

impl<'a> Near<'a> {
    /// Fluid, then ghosts.
    pub fn rows(self) -> impl Iterator<Item = u32> + 'a {
        self.fluid.iter().chain(self.ghosts.iter().copied())
    }
}

/// Rows as a list keeps them.
#[derive(Debug, Clone, Copy)]
pub enum NearRows<'a> {
    /// As they are.
    Whole(&'a [u32]),
    /// What they are beyond a base: of so many, and of others up to a whole number of eight.
    Beyond(u32, usize, &'a [[u16; TOGETHER]]),
}

/// Rows that are unpacked together.
const TOGETHER: usize = 8;

/// Most rows in a list that is kept in 16 bits: as many as the loop over pairs has room to unpack.
pub(super) const MOST: usize = 512;

impl<'a> NearRows<'a> {
    /// How many there are.
    #[inline(always)]
    #[must_use]
    pub fn len(self) -> usize {
        match self {
            Self::Whole(rows) => rows.len(),
            Self::Beyond(_, len, _) => len,
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// One after the other.
    pub fn iter(self) -> impl Iterator<Item = u32> + 'a {
        let (whole, base, len, offsets): (&[u32], _, _, &[_]) = match self {
            Self::Whole(rows) => (rows, 0, 0, &[]),
            Self::Beyond(base, len, offsets) => (&[], base, len, offsets),
        };
        let beyond = offsets.as_flattened()[..len].iter();
        whole.iter().copied().chain(beyond.map(move |offset| base + u32::from(*offset)))
    }

    /// All of them, in the `buffer` if they are not kept as they are.
    #[inline(always)]
    pub(super) fn unpacked<'b>(self, buffer: &'b mut [u32; MOST]) -> &'b [u32]
    where
        'a: 'b,
    {
        match self {
            Self::Whole(rows) => rows,
            Self::Beyond(base, len, offsets) => {
                unpack(base, offsets, buffer);
                &buffer[..len]
            }
        }
    }
}

/// Not inlined: the loop over pairs has no register to spare.
#[inline(never)]
fn unpack(base: u32, offsets: &[[u16; TOGETHER]], rows: &mut [u32; MOST]) {
    for (rows, offsets) in rows.as_chunks_mut::<TOGETHER>().0.iter_mut().zip(offsets) {
        *rows = offsets.map(|offset| base + u32::from(offset));
    }
}

impl ClusterList {
    /// What is near the fluid particle in row `i`.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, i: usize) -> Near<'_> {
        let (chunk, k) = (&self.chunks[i / (CLUSTER * CHUNK)], i / CLUSTER % CHUNK);
        let [[fluid, ghosts], [fluid_end, ghosts_end]] = [k, k + 1].map(|k| chunk.ends[k].map(|end| end as usize));
        let near_fluid = if chunk.is_whole {
            NearRows::Whole(&chunk.fluid[fluid..fluid_end])
        } else {
            let len = fluid_end - fluid;
            let offsets = &chunk.offsets[fluid..fluid + len.next_multiple_of(TOGETHER)];
            NearRows::Beyond(chunk.base, len, offsets.as_chunks().0)
        };
        Near { fluid: near_fluid, ghosts: &chunk.ghosts[ghosts..ghosts_end] }
    }

    /// Number of pairs that a sweep over all particles meets.
    #[must_use]
    pub fn len(&self) -> usize {
        let ends = self.chunks.iter().filter_map(|chunk| chunk.ends.last());
        CLUSTER * ends.map(|[fluid, ghosts]| (fluid + ghosts) as usize).sum::<usize>()
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
            chunk.clear(c * CHUNK * CLUSTER);
            for cluster in c * CHUNK..clusters.min((c + 1) * CHUNK) {
                let rows = cluster * CLUSTER..particles.min((cluster + 1) * CLUSTER);
                find(rows.clone(), Kind::Fluid, &mut chunk.fluid);
                find(rows, Kind::Ghost, &mut chunk.ghosts);
                chunk.end_cluster();
            }
            chunk.offsets.extend([0; TOGETHER - 1]);
        });
    }
}

impl Chunk {
    /// Forgets the lists; those to come are of particles from row `first` on.
    fn clear(&mut self, first: usize) {
        clear_with_room(&mut self.offsets);
        clear_with_room(&mut self.fluid);
        clear_with_room(&mut self.ghosts);
        self.ends.clear();
        self.ends.push([0; 2]);
        self.is_whole = false;
        self.base = (first as u32).saturating_sub(1 << 15);
    }

    /// Closes the list of a cluster, whose rows were appended to those that are kept as they are.
    fn end_cluster(&mut self) {
        let base = self.base;
        if !self.is_whole {
            let fits = |row: &u32| row.wrapping_sub(base) <= u32::from(u16::MAX);
            if self.fluid.len() <= MOST && self.fluid.iter().all(fits) {
                self.offsets.extend(self.fluid.drain(..).map(|row| (row - base) as u16));
            } else {
                self.is_whole = true;
                self.fluid.splice(0..0, self.offsets.drain(..).map(|offset| base + u32::from(offset)));
            }
        }
        let fluid = if self.is_whole { self.fluid.len() } else { self.offsets.len() };
        self.ends.push([fluid, self.ghosts.len()].map(|end| end as u32));
    }
}

/// What a list looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Fluid,
    Ghost,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lists of 3000 particles in whose cluster 200 something is not as usual; they say what was found, built anew twice.
    fn lists_say_what_was_found(unusual: impl Fn(u32) -> Vec<u32> + Sync) {
        let near = |first: usize, kind: Kind| match (kind, first / CLUSTER) {
            (Kind::Fluid, 200) => unusual(first as u32),
            (Kind::Fluid, cluster) => (first as u32..first as u32 + cluster as u32 % 23).collect(),
            (Kind::Ghost, cluster) => vec![1_000_000 + first as u32; cluster % 3],
        };
        let mut list = ClusterList::default();
        for _ in 0..2 {
            list.build(2999, |rows, kind, found| found.extend(near(rows.start, kind)));
        }
        for i in 0..2999 {
            let first = i / CLUSTER * CLUSTER;
            let (fluid, ghosts) = (near(first, Kind::Fluid), near(first, Kind::Ghost));
            let listed = list.of(i);
            assert_eq!(listed.fluid.iter().collect::<Vec<_>>(), fluid, "particle {i}");
            assert_eq!(listed.fluid.unpacked(&mut [0; MOST]), fluid, "particle {i}");
            assert_eq!(listed.ghosts, ghosts, "particle {i}");
            assert_eq!(listed.rows().count(), fluid.len() + ghosts.len());
        }
    }

    #[test]
    fn rows_nearby_are_found_again() {
        lists_say_what_was_found(|first| vec![first, 0, first + 1, 33_000]);
    }

    #[test]
    fn rows_far_away_are_found_again() {
        lists_say_what_was_found(|first| vec![first, 70_000, first + 1, u32::MAX]);
    }

    #[test]
    fn long_lists_are_found_again() {
        lists_say_what_was_found(|first| (first..first + MOST as u32 + 1).collect());
    }
}
