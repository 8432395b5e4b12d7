//! Numbers of pair terms: one particle at a time, or as many side by side as the processor has lanes.
//!
//! A pair term is written once, over [`Real`]. With `f64` it is the plain loop; with [`Lanes`] the same operations run in the
//! same order for four particles at once. So both give the same bits, on every processor: lanes never mix, and nothing
//! contracts `a·b + c` unless the term says so ([`Real::mul_add`]: one rounding, everywhere).

mod fields;
mod real;

pub use fields::{Fields, fields};
pub use real::{Lanes, Real};
pub(crate) use real::{one_by_one, vectorised};
