//! What a sweep reads of a neighbour, packed so that one neighbour is one place in memory.

use std::marker::PhantomData;

use bevy_ecs::prelude::Resource;
use bytemuck::{Pod, cast_slice_mut};
use rayon::prelude::*;

use super::Vector;
use crate::lanes::Fields;
use crate::neighbours::Rows;

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

/// Memory that belongs to whatever system runs, and holds nothing from one system to the next: for the records of a sweep,
/// for the sorting of rows. One for all, since each alone would be the largest column that there is.
#[derive(Resource, Default)]
pub struct Workspace {
    numbers: Vec<f64>,
}

/// The records of every row, row after row: position, then state.
pub struct Records<'a, const D: usize, T> {
    numbers: &'a [f64],
    of: PhantomData<T>,
}

impl<const D: usize, T> Clone for Records<'_, D, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<const D: usize, T> Copy for Records<'_, D, T> {}

impl Workspace {
    /// Packs every row: `fluid`, `walls`, `structures` make the record of the k-th particle of their table; periodic
    /// images are copies of their source, shifted.
    pub fn gather<const D: usize, T: Fields<With<f64> = T>>(
        &mut self,
        rows: &Rows,
        fluid: impl Fn(usize) -> Gathered<D, T> + Sync + Send,
        walls: impl Fn(usize) -> Gathered<D, T> + Sync + Send,
        structures: impl Fn(usize) -> Gathered<D, T> + Sync + Send,
    ) -> Records<'_, D, T> {
        let stride = D + T::COUNT;
        let numbers = self.numbers((rows.owned() + rows.images.len()) * stride, rows.images.len() * stride);
        let (of_fluid, rest) = numbers.split_at_mut(rows.fluid * stride);
        let (of_walls, rest) = rest.split_at_mut(rows.walls * stride);
        let of_structures = &mut rest[..rows.structures * stride];
        pack(of_fluid, fluid);
        pack(of_walls, walls);
        pack(of_structures, structures);
        let first_image = rows.owned() * stride;
        for (k, image) in rows.images.iter().enumerate() {
            let (from, to) = (image.source as usize * stride, first_image + k * stride);
            numbers.copy_within(from..from + stride, to);
            for (x, shift) in numbers[to..to + D].iter_mut().zip(image.shift.to_array()) {
                *x += shift;
            }
        }
        Records { numbers, of: PhantomData }
    }

    /// `len` values of a kind that needs no other alignment than numbers have; what they are is not said.
    pub(crate) fn values<T: Pod>(&mut self, len: usize) -> &mut [T] {
        &mut cast_slice_mut(self.numbers((len * size_of::<T>()).div_ceil(size_of::<f64>()), 0))[..len]
    }

    /// The first `len` numbers. Of them `wavering` come and go: a little room for them spares most new allocations.
    fn numbers(&mut self, len: usize, wavering: usize) -> &mut [f64] {
        if self.numbers.capacity() < len {
            self.numbers.reserve_exact(len + wavering / 4 - self.numbers.len());
        }
        if self.numbers.len() < len {
            self.numbers.resize(len, 0.0);
        }
        &mut self.numbers[..len]
    }
}

impl<const D: usize, T: Fields<With<f64> = T>> Records<'_, D, T> {
    /// The numbers of one row.
    #[inline(always)]
    pub(crate) fn row(&self, row: usize) -> &[f64] {
        let stride = D + T::COUNT;
        &self.numbers[row * stride..][..stride]
    }

    /// One row.
    #[inline(always)]
    #[must_use]
    pub fn get(&self, row: usize) -> Gathered<D, T> {
        let numbers = self.row(row);
        Gathered { position: Vector(std::array::from_fn(|k| numbers[k])), state: T::build(|k| numbers[D + k]) }
    }
}

/// Writes the records of one table, in parallel.
fn pack<const D: usize, T: Fields<With<f64> = T>>(
    numbers: &mut [f64],
    record: impl Fn(usize) -> Gathered<D, T> + Sync + Send,
) {
    let stride = D + T::COUNT;
    numbers.par_chunks_mut(PIECE * stride).enumerate().for_each(|(piece, numbers)| {
        for (k, numbers) in numbers.chunks_exact_mut(stride).enumerate() {
            let Gathered { position, state } = record(piece * PIECE + k);
            let (x, values) = numbers.split_at_mut(D);
            x.copy_from_slice(&position.0);
            T::each(&state, |field, value: f64| values[field] = value);
        }
    });
}
