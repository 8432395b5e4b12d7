//! A grid of cells in which neighbours are looked for.

use bytemuck::{Pod, Zeroable, cast_slice_mut};
use glam::DVec3;

use super::list::resize_with_room;
use crate::particles::Workspace;

/// One row in the order of the cells.
#[derive(Debug, Clone, Copy, Zeroable, Pod)]
#[repr(C)]
pub(super) struct Entry {
    position: [f64; 3],
    pub row: u32,
    /// Half-skin (m), negative (or −0) of a ghost.
    signed_half_skin: f32,
}

/// Numbers of 32 bits that an entry is made of.
const ENTRY: usize = size_of::<Entry>() / size_of::<u32>();

impl Entry {
    pub fn position(&self) -> DVec3 {
        DVec3::from_array(self.position)
    }

    pub fn is_fluid(&self) -> bool {
        self.signed_half_skin.is_sign_positive()
    }

    /// Half-skin (m).
    pub fn half_skin(&self) -> f64 {
        f64::from(self.signed_half_skin.abs())
    }
}

/// Rows sorted by cell, x fastest, so that the cells beside one another along x are one run of memory.
#[derive(Debug, Default)]
pub(super) struct Grid {
    origin: DVec3,
    inverse_cell: DVec3,
    cells: [usize; 3],
    /// `first[c]..first[c + 1]` are the entries of cell c.
    first: Vec<u32>,
}

/// A grid never has more cells than this many times the number of rows: when one particle flies far away, cells grow
/// instead, and the lists stay right.
const CELLS_PER_ROW: f64 = 8.0;

/// A grid with the rows that lie in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct SortedRows<'a> {
    grid: &'a Grid,
    entries: &'a [Entry],
}

/// Marks a row that lies too far from any fluid to matter.
const OUTSIDE: u32 = u32::MAX;

impl Grid {
    /// Lays cells of edges `cell` (m) over the box `min`–`max`.
    pub fn lay(&mut self, min: DVec3, max: DVec3, mut cell: DVec3, rows: usize) {
        let extent = max - min;
        // Particles at infinity are found by the watch over divergence; here they must only not hang the search.
        let extent = if extent.is_finite() { extent } else { DVec3::ZERO };
        loop {
            let cells = (extent / cell).to_array().map(|length| length.floor() + 1.0);
            if cells.iter().product::<f64>() <= CELLS_PER_ROW * rows as f64 + 1000.0 {
                self.cells = cells.map(|n| n as usize);
                break;
            }
            cell *= 1.5;
        }
        self.origin = min;
        self.inverse_cell = cell.recip();
    }

    fn coordinates(&self, position: DVec3) -> [isize; 3] {
        ((position - self.origin) * self.inverse_cell).to_array().map(|x| x.floor() as isize)
    }

    /// The cell of a position, or `OUTSIDE`.
    pub fn cell(&self, position: DVec3) -> u32 {
        let [x, y, z] = self.coordinates(position);
        let [nx, ny, nz] = self.cells.map(|n| n as isize);
        if (0..nx).contains(&x) && (0..ny).contains(&y) && (0..nz).contains(&z) {
            ((z * ny + y) * nx + x) as u32
        } else {
            OUTSIDE
        }
    }

    /// Sorts rows into cells (a counting sort: rows of one cell keep their order).
    pub fn sort<'a>(
        &'a mut self,
        positions: &[DVec3],
        half_skins: &[f32],
        is_fluid: impl Fn(usize) -> bool,
        workspace: &'a mut Workspace,
    ) -> SortedRows<'a> {
        let rows = positions.len();
        // The entries, then the cell of each row.
        let numbers: &mut [u32] = workspace.values((ENTRY + 1) * rows);
        let (entries, cell_of_row) = numbers.split_at_mut(ENTRY * rows);
        let cells = self.cells.iter().product::<usize>();
        self.first.clear();
        resize_with_room(&mut self.first, cells + 1, 0);
        for (cell, &position) in cell_of_row.iter_mut().zip(positions) {
            *cell = self.cell(position);
            if *cell != OUTSIDE {
                self.first[*cell as usize + 1] += 1;
            }
        }
        for c in 0..cells {
            self.first[c + 1] += self.first[c];
        }
        let entries: &mut [Entry] = &mut cast_slice_mut(entries)[..self.first[cells] as usize];
        for (row, &cell) in cell_of_row.iter().enumerate() {
            if cell != OUTSIDE {
                let place = &mut self.first[cell as usize];
                let signed_half_skin = half_skins[row].copysign(if is_fluid(row) { 1.0 } else { -1.0 });
                let position = positions[row].to_array();
                entries[*place as usize] = Entry { position, row: row as u32, signed_half_skin };
                *place += 1;
            }
        }
        // Filling moved each cell's start to its end, which is the next cell's start: shift them back.
        self.first.copy_within(0..cells, 1);
        self.first[0] = 0;
        SortedRows { grid: self, entries }
    }

    /// The line of cells along x in which a position lies, and how far along it (in 2⁻⁴⁰ of the grid's length): what is sorted
    /// by it lies by twos in a line of cells two spacings wide.
    pub fn place(&self, position: DVec3) -> u64 {
        let [_, y, z] = self.coordinates(position);
        let line = z as u64 * self.cells[1] as u64 + y as u64;
        let along = (position.x - self.origin.x) * self.inverse_cell.x / self.cells[0] as f64;
        line << 40 | (along * (1_u64 << 40) as f64) as u64
    }
}

impl SortedRows<'_> {
    /// Calls `visit` with each run of entries in the cells that touch the box `min`–`max`.
    #[inline(always)]
    pub fn around(&self, (min, max): (DVec3, DVec3), mut visit: impl FnMut(&[Entry])) {
        let grid = self.grid;
        let n = grid.cells.map(|n| n as isize);
        let (first, last) = (grid.coordinates(min), grid.coordinates(max));
        let range = |axis: usize| first[axis].clamp(0, n[axis])..(last[axis] + 1).clamp(0, n[axis]);
        let x = range(0);
        for z in range(2) {
            for y in range(1) {
                let line = (z * n[1] + y) * n[0];
                let [from, to] = [x.start, x.end].map(|x| grid.first[(line + x) as usize] as usize);
                visit(&self.entries[from..to]);
            }
        }
    }
}
