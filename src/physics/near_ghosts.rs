//! The ghosts near one fluid particle, for the stages that add up what walls and structures do to it alone.

use glam::DVec3;

use crate::kernels::SmoothingKernel;
use crate::neighbours::Rows;
use crate::particles::Position;

/// The ghosts of walls, then of structures, as the numbering of rows has them: where they are, and `columns` of their own.
pub(super) struct NearGhosts<'a, C> {
    pub kernel: &'a SmoothingKernel,
    pub rows: &'a Rows,
    pub positions: [&'a [Position]; 2],
    pub columns: [C; 2],
}

/// Ghosts for which the kernel is evaluated in one call.
const BATCH: usize = 64;

impl<C: Copy> NearGhosts<'_, C> {
    /// Calls `term(columns, b, r_ib, F_ib)` for the ghosts b in the rows `near` to a fluid particle at `x_i`.
    #[inline(always)]
    pub fn each(&self, x_i: DVec3, near: &[u32], mut term: impl FnMut(C, usize, DVec3, f64)) {
        for rows in near.chunks(BATCH) {
            let mut gradients = [0.0; BATCH];
            let gradients = &mut gradients[..rows.len()];
            for (&row, out) in rows.iter().zip(&mut *gradients) {
                let (table, b) = self.find(row);
                *out = x_i.distance_squared(self.positions[table][b].0 + self.rows.shift(row));
            }
            self.kernel.0.gradients(gradients);
            for (&row, &gradient) in rows.iter().zip(&*gradients) {
                let (table, b) = self.find(row);
                let r_ib = x_i - (self.positions[table][b].0 + self.rows.shift(row));
                term(self.columns[table], b, r_ib, gradient);
            }
        }
    }

    /// The table of the ghost in `row`, and its place there.
    #[inline(always)]
    fn find(&self, row: u32) -> (usize, usize) {
        let ghost = self.rows.source(row) - self.rows.fluid;
        match ghost.checked_sub(self.rows.walls) {
            None => (0, ghost),
            Some(structure) => (1, structure),
        }
    }
}
