//! The order of fluid particles in memory: line by line of cells, so that neighbours in space are neighbours in memory.

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemState;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;

use super::build::Neighbours;
use super::grid::Grid;
use crate::particles::{Fluid, Position, Workspace, columns, permute_columns};

/// Scratch memory of [`sort_fluid`].
#[derive(Default)]
pub(super) struct SortScratch {
    grid: Grid,
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
    let SortScratch { grid, order } = &mut *scratch;
    world.resource_scope(|world, mut workspace: Mut<Workspace>| {
        let Ok(query) = positions.get(world) else { return };
        let positions: &[Position] = columns(&query);
        let min = positions.iter().fold(DVec3::INFINITY, |min, x| min.min(x.0));
        let max = positions.iter().fold(DVec3::NEG_INFINITY, |max, x| max.max(x.0));
        grid.lay(min, max, cell, positions.len());
        // Place and row.
        let keys: &mut [[u64; 2]] = workspace.values(positions.len());
        for (row, (key, x)) in keys.iter_mut().zip(positions).enumerate() {
            *key = [grid.place(x.0), row as u64];
        }
        keys.par_sort_unstable();
        order.clear();
        order.extend(keys.iter().map(|[_, row]| *row as u32));
    });
    permute_columns(world, order);
}
