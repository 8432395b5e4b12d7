//! Neighbour lists: for each particle the rows near it, and the kernel of each pair.

use rayon::prelude::*;

use crate::lanes::{Fields, Real, one_by_one};
use crate::particles::{Gathered, PIECE, Records, Vector};

/// Owners that share one piece of memory; lists are built and their kernels evaluated piece by piece in parallel.
const CHUNK: usize = 512;

#[derive(Debug, Default)]
struct Chunk {
    /// `first[k]..first[k + 1]` are the pairs of the k-th owner of this chunk.
    first: Vec<u32>,
    rows: Vec<u32>,
    gradients: Vec<f64>,
    values: Vec<f64>,
}

/// The neighbours of each of a table's particles (the owners), within the support and a skin, with ∇W and W.
#[derive(Debug, Default)]
pub struct PairList {
    chunks: Vec<Chunk>,
}

/// What the list knows about one owner's pairs.
#[derive(Debug, Clone, Copy)]
pub struct Pairs<'a> {
    /// Rows of the neighbours.
    pub rows: &'a [u32],
    /// (dW/dr)/r (1/m^(d+2)); 0 beyond the support. Empty where nobody needs it.
    pub gradients: &'a [f64],
    /// W (1/m^d). Empty where nobody needs it.
    pub values: &'a [f64],
}

/// Which of a list's kernel columns are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Wanted {
    pub gradients: bool,
    pub values: bool,
}

impl PairList {
    /// The pairs of owner `i` (its index in its own table).
    #[inline(always)]
    #[must_use]
    pub fn of(&self, i: usize) -> Pairs<'_> {
        let chunk = &self.chunks[i / CHUNK];
        let range = chunk.first[i % CHUNK] as usize..chunk.first[i % CHUNK + 1] as usize;
        Pairs {
            rows: &chunk.rows[range.clone()],
            gradients: chunk.gradients.get(range.clone()).unwrap_or_default(),
            values: chunk.values.get(range).unwrap_or_default(),
        }
    }

    /// Number of listed pairs, those in the skin included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.rows.len()).sum()
    }

    /// Whether nothing is near anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Lists anew: `find(i, rows)` appends the neighbours of owner i.
    pub(super) fn build(&mut self, owners: usize, find: impl Fn(usize, &mut Vec<u32>) + Sync) {
        self.chunks.resize_with(owners.div_ceil(CHUNK), Chunk::default);
        self.chunks.par_iter_mut().with_max_len(PIECE / CHUNK).enumerate().for_each(|(c, chunk)| {
            clear_with_room(&mut chunk.rows);
            chunk.first.clear();
            chunk.first.push(0);
            for i in c * CHUNK..owners.min((c + 1) * CHUNK) {
                find(i, &mut chunk.rows);
                chunk.first.push(chunk.rows.len() as u32);
            }
        });
    }

    /// Evaluates the wanted kernel columns: `squared_distances(i, rows, out)` writes r² of each pair of owner i, and
    /// `gradients`, `values` turn them into (dW/dr)/r and W.
    pub(crate) fn evaluate(
        &mut self,
        wanted: Wanted,
        squared_distances: impl Fn(usize, &[u32], &mut [f64]) + Sync,
        gradients: impl Fn(&mut [f64]) + Sync,
        values: impl Fn(&mut [f64]) + Sync,
    ) {
        self.chunks.par_iter_mut().with_max_len(PIECE / CHUNK).enumerate().for_each(|(c, chunk)| {
            let pairs = chunk.rows.len();
            resize_with_room(&mut chunk.gradients, if wanted.gradients { pairs } else { 0 }, 0.0);
            resize_with_room(&mut chunk.values, if wanted.values { pairs } else { 0 }, 0.0);
            for (k, ends) in chunk.first.windows(2).enumerate() {
                let range = ends[0] as usize..ends[1] as usize;
                for (on, column, kernel) in [
                    (wanted.gradients, &mut chunk.gradients, &gradients as &(dyn Fn(&mut [f64]) + Sync)),
                    (wanted.values, &mut chunk.values, &values),
                ] {
                    if on {
                        let column = &mut column[range.clone()];
                        squared_distances(c * CHUNK + k, &chunk.rows[range.clone()], column);
                        kernel(column);
                    }
                }
            }
        });
    }
}

/// `column.resize(len, value)`, with so much room that a column which changes little from step to step seldom allocates.
pub(super) fn resize_with_room<T: Clone>(column: &mut Vec<T>, len: usize, value: T) {
    if column.capacity() < len {
        column.reserve(len + len / 2 - column.len());
    }
    column.resize(len, value);
}

/// `column.clear()`, with room for a quarter more than there was: what grows a little now and then seldom allocates.
pub(crate) fn clear_with_room<T>(column: &mut Vec<T>) {
    let used = column.len();
    column.clear();
    if column.capacity() < used + used / 4 {
        column.reserve(used + used / 2);
    }
}

/// `column.clear()`, with room for `rows` and for images, of which there are now more and now fewer than the `images` of the last time.
pub(super) fn clear_with_room_for_images<T>(column: &mut Vec<T>, rows: usize, images: usize) {
    column.clear();
    if column.capacity() < rows + images + images / 8 {
        column.reserve_exact(rows + images + images / 2);
    }
}

/// A pair as a pair term sees it.
#[derive(Debug, Clone, Copy)]
pub struct Pair<const D: usize, R = f64> {
    /// r_ij = x_i − x_j (m).
    pub r_ij: Vector<D, R>,
    /// F_ij = (dW/dr)/r (1/m^(d+2)), also r_ij·∇_iW_ij / r²; ≤ 0.
    pub gradient: R,
}

impl<const D: usize, R: Real> Pair<D, R> {
    /// ∇_iW_ij (1/m^(d+1)), Eq. 3.
    #[inline(always)]
    #[must_use]
    pub fn grad_w(&self) -> Vector<D, R> {
        self.r_ij * self.gradient
    }
}

/// Calls `term(row, neighbour, pair)` for every listed pair of the ghost `own`.
#[inline(always)]
pub fn sum_pairs<const D: usize, T: Fields<With<f64> = T>>(
    own: &Gathered<D, T>,
    pairs: Pairs<'_>,
    records: Records<'_, D, T>,
    mut term: impl FnMut(u32, &T, &Pair<D>),
) {
    one_by_one(
        #[inline(always)]
        || {
            for (&row, &gradient) in pairs.rows.iter().zip(pairs.gradients) {
                let other = records.get(row as usize);
                term(row, &other.state, &Pair { r_ij: own.position - other.position, gradient });
            }
        },
    );
}
