//! The loop over all pairs of the fluid: sums of pair terms.

use std::array::from_fn;

use pulp::{Simd, WithSimd};

use super::clusters::{CLUSTER, ClusterList, MOST};
use super::{Neighbours, Pair};
use crate::kernels::PairKernel;
use crate::lanes::{Fields, Lanes, Real, one_by_one, vectorised};
use crate::particles::{Records, Vector};

/// A sum over the neighbours of a fluid particle, as a stage writes it down: once, for numbers of any kind.
pub trait PairTerm<const D: usize>: Sync {
    /// What the term reads of a particle.
    type State: Fields<With<f64> = Self::State>;
    /// What it adds up.
    type Sum: Fields<With<f64> = Self::Sum>;

    /// Adds the pair of fluid particle i and fluid particle j.
    fn fluid<R: Real>(
        &self,
        sum: &mut <Self::Sum as Fields>::With<R>,
        i: &<Self::State as Fields>::With<R>,
        j: &<Self::State as Fields>::With<R>,
        pair: &Pair<D, R>,
    );

    /// Adds the pair of fluid particle i and ghost j of a wall or structure; like a fluid particle if not told otherwise.
    #[inline(always)]
    fn ghost<R: Real>(
        &self,
        sum: &mut <Self::Sum as Fields>::With<R>,
        i: &<Self::State as Fields>::With<R>,
        j: &<Self::State as Fields>::With<R>,
        pair: &Pair<D, R>,
    ) {
        self.fluid(sum, i, j, pair);
    }

    /// Called when all fluid was added, before the first ghost if there is any.
    #[inline(always)]
    fn after_fluid<R: Real>(&self, _sum: &mut <Self::Sum as Fields>::With<R>) {}
}

/// One sweep: a term, what it reads of every row, and the kernel.
pub struct Sweep<'a, const D: usize, T: PairTerm<D>> {
    neighbours: &'a Neighbours,
    kernel: &'a dyn PairKernel,
    records: Records<'a, D, T::State>,
    term: T,
}

impl<'a, const D: usize, T: PairTerm<D>> Sweep<'a, D, T> {
    /// The sweep of `term` over `records`.
    pub fn new(
        neighbours: &'a Neighbours,
        kernel: &'a dyn PairKernel,
        records: Records<'a, D, T::State>,
        term: T,
    ) -> Self {
        Self { neighbours, kernel, records, term }
    }

    /// Adds up the term for `particles` fluid particles from row `first` on: `write(k, sum)` is given the sum of particle
    /// `first + k`.
    ///
    /// # Panics
    /// If `first` is no multiple of four.
    pub fn sum(&self, first: usize, particles: usize, write: impl FnMut(usize, T::Sum)) {
        assert!(first.is_multiple_of(CLUSTER), "row {first} is not the first of a cluster");
        let piece = Piece { sweep: self, first, end: first + particles, write };
        if self.neighbours.plain_loops {
            one_by_one(
                #[inline(always)]
                || piece.run(0.0),
            );
        } else {
            vectorised(piece);
        }
    }
}

/// A part of a sweep.
struct Piece<'a, const D: usize, T: PairTerm<D>, W> {
    sweep: &'a Sweep<'a, D, T>,
    first: usize,
    end: usize,
    write: W,
}

impl<const D: usize, T: PairTerm<D>, W: FnMut(usize, T::Sum)> WithSimd for Piece<'_, D, T, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.run(Lanes::zero(simd));
    }
}

/// Numbers r² or F in one call of the kernel.
const BATCH: usize = 256;

/// The kernel is evaluated for so many numbers at once: those that nobody asked for are cheaper than a remainder.
const WHOLE: usize = 16;

/// Most numbers that a term can add up.
const MOST_SUMS: usize = 32;

impl<const D: usize, T: PairTerm<D>, W: FnMut(usize, T::Sum)> Piece<'_, D, T, W> {
    /// As many particles at once as `R` has lanes.
    #[inline(always)]
    fn run<R: Real>(mut self, zero: R) {
        let list: &ClusterList = &self.sweep.neighbours.fluid;
        const { assert!(<T::Sum as Fields>::COUNT <= MOST_SUMS) };
        let (mut sums, mut batch, mut rows) = ([0.0; MOST_SUMS * CLUSTER], [0.0; BATCH], [0; MOST]);
        for first in (self.first..self.end).step_by(R::LANES) {
            let near = list.of(first);
            let sum = self.of(zero, first, [near.fluid.unpacked(&mut rows), near.ghosts], &mut batch);
            T::Sum::each(
                &sum,
                #[inline(always)]
                |k, lanes: R| lanes.write(&mut sums[k * R::LANES..]),
            );
            for lane in 0..R::LANES.min(self.end - first) {
                (self.write)(
                    first - self.first + lane,
                    T::Sum::build(
                        #[inline(always)]
                        |k| sums[k * R::LANES + lane],
                    ),
                );
            }
        }
    }

    /// The sums of as many particles from row `first` on as there are lanes; `batch` is scratch.
    #[inline(always)]
    fn of<R: Real>(
        &self,
        zero: R,
        first: usize,
        [fluid, ghosts]: [&[u32]; 2],
        batch: &mut [f64; BATCH],
    ) -> <T::Sum as Fields>::With<R> {
        let Sweep { kernel, records, term, .. } = self.sweep;
        // Beyond the last particle lanes are filled with it, and beyond the last lane with the first: nobody reads their sums.
        let rows: [&[f64]; CLUSTER] = from_fn(
            #[inline(always)]
            |lane| records.row((first + lane % R::LANES).min(self.end - 1)),
        );
        let x_i: Vector<D, R> = Vector(from_fn(
            #[inline(always)]
            |k| side_by_side(zero, rows, k),
        ));
        let i = T::State::build(
            #[inline(always)]
            |k| side_by_side(zero, rows, D + k),
        );
        let mut sum = T::Sum::build(
            #[inline(always)]
            |_| zero,
        );
        for (rows, is_fluid) in [(fluid, true), (ghosts, false)] {
            if !is_fluid {
                term.after_fluid::<R>(&mut sum);
            }
            for rows in rows.chunks(BATCH / R::LANES) {
                for (&row, out) in rows.iter().zip(batch.chunks_exact_mut(R::LANES)) {
                    let r_ij = separation(zero, x_i, records.row(row as usize));
                    r_ij.dot(r_ij).write(out);
                }
                kernel.gradients(&mut batch[..(rows.len() * R::LANES).next_multiple_of(WHOLE)]);
                for (&row, gradient) in rows.iter().zip(batch.chunks_exact(R::LANES)) {
                    let numbers = records.row(row as usize);
                    let pair = Pair { r_ij: separation(zero, x_i, numbers), gradient: zero.read(gradient) };
                    let j = T::State::build(
                        #[inline(always)]
                        |k| zero.like(numbers[D + k]),
                    );
                    if is_fluid {
                        term.fluid(&mut sum, &i, &j, &pair);
                    } else {
                        term.ghost(&mut sum, &i, &j, &pair);
                    }
                }
            }
        }
        sum
    }
}

/// Number `k` of each of the records.
#[inline(always)]
fn side_by_side<R: Real>(zero: R, records: [&[f64]; CLUSTER], k: usize) -> R {
    zero.read(&records.map(
        #[inline(always)]
        |numbers| numbers[k],
    ))
}

/// r_ij of the particles at `x_i` and the one whose record is `numbers`.
#[inline(always)]
fn separation<const D: usize, R: Real>(zero: R, x_i: Vector<D, R>, numbers: &[f64]) -> Vector<D, R> {
    x_i - Vector(from_fn(
        #[inline(always)]
        |k| zero.like(numbers[k]),
    ))
}
