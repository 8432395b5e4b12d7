//! The order of fluid particles in memory: line by line of cells, so that neighbours in space are neighbours in memory.

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemState;
use bytemuck::cast_slice_mut;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;

use super::build::Neighbours;
use super::grid::Grid;
use crate::particles::{Fluid, Position, Workspace, columns, permute_columns};

/// Re-sorts the fluid table by place, once in so many builds of the neighbour lists.
pub(super) fn sort_fluid(
    world: &mut World,
    positions: &mut SystemState<Query<&'static Position, With<Fluid>>>,
    mut grid: Local<Grid>,
) {
    let neighbours = world.resource::<Neighbours>();
    if !neighbours.sort_is_due() {
        return;
    }
    let cell = neighbours.cell;
    world.resource_scope(|world, mut workspace: Mut<Workspace>| {
        let Ok(query) = positions.get(world) else { return };
        let positions: &[Position] = columns(&query);
        let min = positions.iter().fold(DVec3::INFINITY, |min, x| min.min(x.0));
        let max = positions.iter().fold(DVec3::NEG_INFINITY, |max, x| max.max(x.0));
        grid.lay(min, max, cell, positions.len());
        // Place and row of each, then its row alone, then what putting it there needs.
        let particles = positions.len();
        let numbers: &mut [u32] = workspace.values((4 + 1 + 2) * particles);
        let (keys, numbers) = numbers.split_at_mut(4 * particles);
        let keys: &mut [[u64; 2]] = cast_slice_mut(keys);
        for (row, (key, x)) in keys.iter_mut().zip(positions).enumerate() {
            *key = [grid.place(x.0), row as u64];
        }
        keys.par_sort_unstable();
        let (order, memory) = numbers.split_at_mut(particles);
        for (row, [_, from]) in order.iter_mut().zip(keys) {
            *row = *from as u32;
        }
        permute_columns(world, order, memory);
    });
}
