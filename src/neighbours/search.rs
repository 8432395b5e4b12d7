//! Who is listed: pairs nearer than `R + s_i + s_j`, R the support radius and s the half-skins.

use std::ops::Range;

use glam::DVec3;

use super::clusters::Kind;
use super::grid::{Entry, SortedRows};

/// The rows among which neighbours are looked for.
pub(super) struct Search<'a> {
    pub grid: SortedRows<'a>,
    /// Of every row, m.
    pub positions: &'a [DVec3],
    /// Of every row, m.
    pub half_skins: &'a [f32],
    /// Of the support, m.
    pub radius: f64,
    /// The greatest half-skin (m): what is sought may have it.
    pub widest: f64,
}

impl Search<'_> {
    /// Appends to `list` all rows of a kind that are to be listed for any of the fluid particles in `rows`, each with the greatest of their half-skins.
    pub fn around_cluster(&self, rows: Range<usize>, kind: Kind, list: &mut Vec<u32>) {
        let (cluster, skins) = (&self.positions[rows.clone()], &self.half_skins[rows]);
        let (min, max) = cluster.iter().fold((cluster[0], cluster[0]), |(min, max), x| (min.min(*x), max.max(*x)));
        let own = self.radius + f64::from(skins.iter().copied().fold(0.0, f32::max));
        let near = |e: &&Entry| {
            let (x, reach) = (e.position(), own + e.half_skin());
            let reach_squared = reach * reach;
            (x.clamp(min, max) - x).length_squared() < reach_squared
                && cluster.iter().any(|x_i| x_i.distance_squared(x) < reach_squared)
        };
        let farthest = own + self.widest;
        self.grid.around((min - farthest, max + farthest), |entries| {
            let of_kind = entries.iter().filter(|e| e.is_fluid() == (kind == Kind::Fluid));
            list.extend(of_kind.filter(near).map(|e| e.row));
        });
    }

    /// Appends to `list` all rows of fluid that are to be listed for the ghost in `row`.
    pub fn fluid_around(&self, row: usize, list: &mut Vec<u32>) {
        let (x, own) = (self.positions[row], self.radius + f64::from(self.half_skins[row]));
        let near = |e: &&Entry| e.position().distance_squared(x) < (own + e.half_skin()).powi(2);
        let farthest = own + self.widest;
        self.grid.around((x - farthest, x + farthest), |entries| {
            list.extend(entries.iter().filter(|e| e.is_fluid()).filter(near).map(|e| e.row));
        });
    }
}
