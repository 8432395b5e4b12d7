//! Columns: whole components as slices, and their reordering in memory.

use bevy_ecs::component::{ComponentId, Mutable};
use bevy_ecs::prelude::*;
use bevy_ecs::query::{ArchetypeFilter, ContiguousQueryData, QueryState, ReadOnlyQueryData};

use super::Fluid;

/// The columns of the one table that `query` matches, as slices (a tuple of them for a tuple of components), or empty
/// ones if there are no such particles.
#[must_use]
pub fn columns<'a, D, F>(query: &'a Query<D, F>) -> <D::ReadOnly as ContiguousQueryData>::Contiguous<'a, 'a>
where
    D: bevy_ecs::query::QueryData,
    D::ReadOnly: ContiguousQueryData + ReadOnlyQueryData,
    F: ArchetypeFilter,
    <D::ReadOnly as ContiguousQueryData>::Contiguous<'a, 'a>: Default,
{
    query.contiguous_iter().ok().and_then(|mut tables| tables.next()).unwrap_or_default()
}

/// A per-particle quantity that moves along when fluid particles are re-sorted.
trait Column: Send + Sync {
    fn permute(&mut self, world: &mut World, cycles: &Cycles<'_>);
}

struct TypedColumn<T: Component<Mutability = Mutable>> {
    values: QueryState<&'static mut T, With<Fluid>>,
}

impl<T: Component<Mutability = Mutable> + Copy> Column for TypedColumn<T> {
    fn permute(&mut self, world: &mut World, cycles: &Cycles<'_>) {
        let Ok(tables) = self.values.contiguous_iter_mut(world) else { return };
        for mut table in tables {
            cycles.apply(table.bypass_change_detection());
        }
    }
}

/// A permutation as its cycles, so that it is applied in place.
struct Cycles<'a> {
    /// Rows, cycle after cycle: what is in one row goes to the row before it, and what is in the first row to the last. Rows that
    /// stay are left out.
    rows: &'a [u32],
    /// Where in `rows` each cycle ends.
    ends: &'a [u32],
}

impl<'a> Cycles<'a> {
    /// That which puts what is in row `order[k]` into row `k`. Afterwards `order` counts 0, 1, 2, …. The cycles are kept in
    /// `memory`, which holds as many numbers as `order`, and half as many for the ends: a cycle has two rows or more.
    fn of(order: &mut [u32], memory: &'a mut [u32]) -> Self {
        let (rows, ends) = memory.split_at_mut(order.len());
        let (mut moved, mut cycles) = (0, 0);
        for first in 0..order.len() {
            let before = moved;
            let mut row = first;
            while order[row] as usize != row {
                rows[moved] = row as u32;
                moved += 1;
                row = std::mem::replace(&mut order[row], row as u32) as usize;
            }
            if before < moved {
                ends[cycles] = moved as u32;
                cycles += 1;
            }
        }
        Self { rows: &rows[..moved], ends: &ends[..cycles] }
    }

    fn apply<T: Copy>(&self, values: &mut [T]) {
        let mut start = 0;
        for &end in self.ends {
            let cycle = &self.rows[start..end as usize];
            let first = values[cycle[0] as usize];
            for step in cycle.windows(2) {
                values[step[0] as usize] = values[step[1] as usize];
            }
            values[cycle[cycle.len() - 1] as usize] = first;
            start = end as usize;
        }
    }
}

/// A column of the fluid of those scenes that have a use for it.
#[derive(Clone, Copy)]
struct OptionalColumn {
    id: ComponentId,
    is_used: fn(&mut World) -> bool,
    add: fn(&mut World),
}

/// Every per-particle column of the fluid table.
#[derive(Resource, Default)]
pub struct ParticleColumns {
    columns: Vec<Box<dyn Column>>,
    known: Vec<ComponentId>,
    optional: Vec<OptionalColumn>,
}

impl ParticleColumns {
    /// Registers column `T`.
    pub(crate) fn register<T: Component<Mutability = Mutable> + Copy>(world: &mut World) {
        let id = world.register_component::<T>();
        let values = world.query_filtered::<&'static mut T, With<Fluid>>();
        let mut columns = world.get_resource_or_init::<Self>();
        if !columns.known.contains(&id) {
            columns.known.push(id);
            columns.columns.push(Box::new(TypedColumn { values }));
        }
    }

    /// Lets the fluid of scenes in which an entity has the component `Used` have column `T`.
    pub(crate) fn register_optional<T, Used>(world: &mut World)
    where
        T: Component<Mutability = Mutable> + Copy + Default,
        Used: Component,
    {
        Self::register::<T>(world);
        world.resource_scope(|world, mut columns: Mut<Self>| {
            columns.optional.push(OptionalColumn {
                id: world.register_component::<T>(),
                is_used: |world| world.query_filtered::<(), With<Used>>().iter(world).next().is_some(),
                // An error means that it is required already.
                add: |world| drop(world.try_register_required_components::<Fluid, T>()),
            });
        });
    }

    /// Lets fluid that is spawned from now on have the optional columns for which the scene has a use.
    pub(crate) fn choose(world: &mut World) {
        for column in world.resource::<Self>().optional.clone() {
            if (column.is_used)(world) {
                (column.add)(world);
            }
        }
    }

    /// Refuses a fluid table with a column that nobody registered, since it would not follow its particle when rows are
    /// re-sorted, and one without a column for which the scene has a use.
    ///
    /// # Errors
    /// The first such component, and what is wrong with it.
    pub(crate) fn check(world: &mut World) -> Result<(), String> {
        let marker = world.register_component::<Fluid>();
        let known = world.resource::<Self>().known.clone();
        // Every kind of fluid particle that exists: a component on some of them would split their table.
        let kinds = world.archetypes().iter().filter(|kind| kind.contains(marker) && !kind.is_empty());
        let held: Vec<ComponentId> = kinds.flat_map(|kind| kind.components().to_vec()).collect();
        let name = |world: &World, id| {
            world.components().get_name(id).map_or_else(|| format!("{id:?}"), |name| name.to_string())
        };
        if let Some(&id) = held.iter().find(|id| **id != marker && !known.contains(id)) {
            let what = "a plugin put it on fluid particles without registering it as a particle column";
            return Err(format!("the component `{}`: {what}", name(world, id)));
        }
        for column in world.resource::<Self>().optional.clone() {
            if !held.is_empty() && !held.contains(&column.id) && (column.is_used)(world) {
                let what = "the scene came to use this particle column after its fluid was filled";
                return Err(format!("the component `{}`: {what}", name(world, column.id)));
            }
        }
        Ok(())
    }
}

/// Puts the particle that is in row `order[k]` into row `k`, in every registered column. `order` is used up; `memory` is room for
/// one and a half times as many numbers.
pub(crate) fn permute_columns(world: &mut World, order: &mut [u32], memory: &mut [u32]) {
    let cycles = Cycles::of(order, memory);
    world.resource_scope(|world, mut registered: Mut<ParticleColumns>| {
        for column in &mut registered.columns {
            column.permute(world, &cycles);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_do_what_the_order_says() {
        // One cycle of three, two rows that stay, one of two, one of two.
        let order = [3, 1, 0, 2, 4, 7, 8, 5, 6];
        let values = ["a", "b", "c", "d", "e", "f", "g", "h", "i"];
        let mut permuted = values;
        Cycles::of(&mut order.clone(), &mut [0; 13]).apply(&mut permuted);
        assert_eq!(permuted, order.map(|row| values[row as usize]));
    }
}
