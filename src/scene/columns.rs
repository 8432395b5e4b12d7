//! Columns of fluid along gravity: what stands above each place of a scene.

use std::collections::BTreeMap;

use bevy_ecs::prelude::*;
use glam::DVec3;

use super::Resolution;
use super::fluids::FilledFluids;
use super::geometry::LatticeIndex;
use super::hydrostatics::Column;
use super::places::{Seed, WALL_CLEARANCE};
use crate::boundary::BodyShape;
use crate::neighbours::PeriodicSides;
use crate::physics::{EquationOfState, Gravity, StateSettings};

/// The columns of fluid above each place, along gravity.
pub(super) struct Depths {
    axis: usize,
    /// +1 if the axis points up, −1 if it points down.
    up: f64,
    columns: BTreeMap<LatticeIndex, Column>,
}

impl Depths {
    /// Stacks the cells of every column; `None` if gravity vanishes, is oblique, or acts along a periodic axis.
    pub(super) fn of(
        world: &World,
        seeds: &[Seed],
        filled: &FilledFluids,
        reference_density: impl Fn(usize) -> f64,
    ) -> Option<Self> {
        let gravity = world.resource::<Gravity>().full;
        let (axis, up) = vertical(gravity)?;
        if world.resource::<PeriodicSides>().0[axis].is_some() {
            return None;
        }
        let spacing = world.resource::<Resolution>().spacing;
        let chi = world.resource::<StateSettings>().background_pressure;
        let mut from_the_top: Vec<&Seed> = seeds.iter().collect();
        from_the_top.sort_by(|a, b| (up * b.position[axis]).total_cmp(&(up * a.position[axis])));
        let mut columns: BTreeMap<LatticeIndex, Column> = BTreeMap::new();
        for seed in from_the_top {
            let column = columns.entry(foot(seed.index, axis)).or_insert_with(|| Column {
                gravity: gravity.length(),
                surface_pressure: chi,
                ..Column::default()
            });
            let top = up * seed.position[axis] + 0.5 * spacing;
            let in_body = |above: f64| filled.is_body(seed.position, (axis, up), (top, above), spacing);
            column.push(top, spacing, reference_density(seed.fluid), in_body);
        }
        Some(Self { axis, up, columns })
    }

    pub(super) fn pressure(&self, seed: &Seed, state: &EquationOfState) -> f64 {
        let height = self.up * seed.position[self.axis];
        self.columns.get(&foot(seed.index, self.axis)).map_or(state.background_pressure, |column| {
            column.compressible(height, state.bulk_modulus, state.background_pressure)
        })
    }

    /// Greatest incompressible pressure (Pa) above χ, and the height (m) from the lowest to the highest fluid.
    pub(super) fn extremes(&self) -> (f64, f64) {
        let (mut pressure, mut top, mut bottom) = (0.0_f64, f64::NEG_INFINITY, f64::INFINITY);
        for column in self.columns.values() {
            for layer in &column.layers {
                pressure = pressure.max(column.incompressible(layer.bottom) - column.surface_pressure);
                (top, bottom) = (top.max(layer.top), bottom.min(layer.bottom));
            }
        }
        (pressure, top - bottom)
    }
}

/// Index of a column: that of its cells, without the one along the axis.
fn foot(mut index: LatticeIndex, axis: usize) -> LatticeIndex {
    index[axis] = 0;
    index
}

/// The axis along which gravity acts and whether it points up (+1) or down (−1); `None` if gravity is oblique or zero.
pub(crate) fn vertical(gravity: DVec3) -> Option<(usize, f64)> {
    let axis = (0..3).max_by(|a, b| gravity[*a].abs().total_cmp(&gravity[*b].abs()))?;
    let along = gravity[axis].abs();
    (along > 0.0 && (gravity.length() - along) < 1e-12 * along).then(|| (axis, -gravity[axis].signum()))
}

impl FilledFluids {
    /// Whether bodies fill the vertical through `x` between two heights (m), from `from` up to `to`.
    fn is_body(&self, x: DVec3, (axis, up): (usize, f64), (from, to): (f64, f64), spacing: f64) -> bool {
        let cells = ((to - from) / spacing).round() as usize;
        (0..cells).all(|cell| {
            let mut center = x;
            center[axis] = up * (from + (cell as f64 + 0.5) * spacing);
            let taken = |body: &BodyShape| body.clearance_through(&self.periodic, center) < WALL_CLEARANCE * spacing;
            self.bodies.iter().any(taken)
        })
    }

    /// The column of layers at rest through the place `x` (m), cell by cell of height `spacing` (m); empty if gravity
    /// is oblique or zero.
    #[must_use]
    pub fn column(&self, x: DVec3, gravity: DVec3, spacing: f64, surface_pressure: f64) -> Column {
        let mut column = Column { gravity: gravity.length(), surface_pressure, ..Column::default() };
        let Some((axis, up)) = vertical(gravity) else { return column };
        let heights =
            self.fluids.iter().map(|(shape, _)| shape.bounds()).flat_map(|(a, b)| [up * a[axis], up * b[axis]]);
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
        let (first, last) = ((high / spacing).ceil() as i64 - 1, (low / spacing).floor() as i64);
        for cell in (last..=first).rev() {
            let height = (cell as f64 + 0.5) * spacing;
            let mut center = x;
            center[axis] = up * height;
            if let Some((_, rho0)) = self.fluids.iter().find(|(shape, _)| shape.contains(center)) {
                let top = height + 0.5 * spacing;
                let in_body = |above: f64| self.is_body(x, (axis, up), (top, above), spacing);
                column.push(top, spacing, *rho0, in_body);
            }
        }
        column
    }
}
