//! What a run measures.

mod series;

pub use series::{Series, SeriesField};
