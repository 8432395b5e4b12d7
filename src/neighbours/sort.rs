//! The order of fluid particles in memory: line by line of cells, so that neighbours in space are neighbours in memory.

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemState;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;

use super::build::Neighbours;
use super::grid::Grid;
use crate::particles::{Fluid, Position, columns, permute_columns};

/// Scratch memory of [`sort_fluid`].
#[derive(Default)]
pub(super) struct SortScratch {
    grid: Grid,
    /// Place and row.
    keys: Vec<(u64, u32)>,
    order: Vec<u32>,
}

/// Re-sorts the fluid table by place, once in so many builds of the neighbour lists.
pub(super) fn sort_fluid(
    world: &mut World,
    positions: &mut SystemState<Query<&'static Position, With<Fluid>>>,
    mut scratch: Local<SortScratch>,
) {
    let neighbours = world.resource::<Neighbours>();
    if !neighbours.sort_is_due() {
        return;
    }
    let cell = neighbours.cell;
    let SortScratch { grid, keys, order } = &mut *scratch;
    {
        let Ok(query) = positions.get(world) else { return };
        let positions: &[Position] = columns(&query);
        let min = positions.iter().fold(DVec3::INFINITY, |min, x| min.min(x.0));
        let max = positions.iter().fold(DVec3::NEG_INFINITY, |max, x| max.max(x.0));
        grid.lay(min, max, cell, positions.len());
        keys.clear();
        keys.extend(positions.iter().enumerate().map(|(row, x)| (grid.place(x.0), row as u32)));
    }
    keys.par_sort_unstable();
    order.clear();
    order.extend(keys.iter().map(|(_, row)| *row));
    permute_columns(world, order);
}
