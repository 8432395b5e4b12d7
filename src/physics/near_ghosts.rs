//! The ghosts near one fluid particle, for the stages that add up what walls and structures do to it alone; and what they add up to beside a flat wall.

use glam::DVec3;

use crate::kernels::SmoothingKernel;
use crate::neighbours::Rows;
use crate::particles::Position;

/// The ghosts of walls, then of structures, as the numbering of rows has them: where they are, and `columns` of their own.
pub(crate) struct NearGhosts<'a, C> {
    pub kernel: &'a SmoothingKernel,
    pub rows: &'a Rows,
    pub positions: [&'a [Position]; 2],
    pub columns: [C; 2],
}

/// Ghosts for which the kernel is evaluated in one call.
const BATCH: usize = 32;

impl<C: Copy> NearGhosts<'_, C> {
    /// Calls `term(columns, b, r_ib, F_ib)` for the ghosts b in the rows `near` to a fluid particle at `x_i` that are within the support.
    #[inline(always)]
    pub fn each(&self, x_i: DVec3, near: &[u32], mut term: impl FnMut(C, usize, DVec3, f64)) {
        for rows in near.chunks(BATCH) {
            let (mut gradients, mut pairs) = ([0.0; BATCH], [(0, 0, DVec3::ZERO); BATCH]);
            for ((&row, out), pair) in rows.iter().zip(&mut gradients).zip(&mut pairs) {
                let (table, b) = self.find(row);
                let r_ib = x_i - (self.positions[table][b].0 + self.rows.shift(row));
                (*out, *pair) = (r_ib.length_squared(), (table, b, r_ib));
            }
            let gradients = &mut gradients[..rows.len()];
            self.kernel.0.gradients(gradients);
            for (&gradient, &(table, b, r_ib)) in gradients.iter().zip(&pairs) {
                if gradient != 0.0 {
                    term(self.columns[table], b, r_ib, gradient);
                }
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

/// Rings or shells of equal thickness in the integral over a half-space.
const SHELLS: usize = 512;

/// `∫ w(r) F(r) dr` from `distance` (m) to the edge of the support, `F = (dW/dr)/r`: what a half-space of wall at that distance adds up to, its rings
/// (in 2D arcs) weighted by w.
pub(super) fn half_space(kernel: &SmoothingKernel, distance: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let thickness = (kernel.0.radius() - distance).max(0.0) / SHELLS as f64;
    let radius = |shell: usize| distance + (shell as f64 + 0.5) * thickness;
    let mut gradients: [f64; SHELLS] = std::array::from_fn(|shell| radius(shell).powi(2));
    kernel.0.gradients(&mut gradients);
    let shells = gradients.into_iter().enumerate();
    shells.map(|(shell, gradient)| gradient * weight(radius(shell))).sum::<f64>() * thickness
}
