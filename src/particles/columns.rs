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
    fn permute(&mut self, world: &mut World, order: &[u32]);
}

struct TypedColumn<T: Component<Mutability = Mutable>> {
    values: QueryState<&'static mut T, With<Fluid>>,
    scratch: Vec<T>,
}

impl<T: Component<Mutability = Mutable> + Copy> Column for TypedColumn<T> {
    fn permute(&mut self, world: &mut World, order: &[u32]) {
        let Ok(tables) = self.values.contiguous_iter_mut(world) else { return };
        for mut table in tables {
            let values = table.bypass_change_detection();
            self.scratch.clear();
            self.scratch.extend(order.iter().map(|&row| values[row as usize]));
            values.copy_from_slice(&self.scratch);
        }
    }
}

/// A fluid particle holds a component that nobody registered.
#[derive(Debug)]
pub struct ColumnError {
    /// Name of the component's type.
    pub component: String,
}

/// Every per-particle column of the fluid table.
#[derive(Resource, Default)]
pub struct ParticleColumns {
    columns: Vec<Box<dyn Column>>,
    known: Vec<ComponentId>,
}

impl ParticleColumns {
    /// Registers column `T`.
    pub(crate) fn register<T: Component<Mutability = Mutable> + Copy>(world: &mut World) {
        let id = world.register_component::<T>();
        let values = world.query_filtered::<&'static mut T, With<Fluid>>();
        let mut columns = world.get_resource_or_init::<Self>();
        if !columns.known.contains(&id) {
            columns.known.push(id);
            columns.columns.push(Box::new(TypedColumn { values, scratch: Vec::new() }));
        }
    }

    /// Refuses a fluid table with a column that nobody registered: it would not follow its particle when rows are
    /// re-sorted.
    ///
    /// # Errors
    /// The first such component.
    pub(crate) fn check(world: &mut World) -> Result<(), ColumnError> {
        let marker = world.register_component::<Fluid>();
        let known = world.resource::<Self>().known.clone();
        // Every kind of fluid particle that exists: a component on some of them would split their table.
        let kinds = world.archetypes().iter().filter(|kind| kind.contains(marker) && !kind.is_empty());
        let held: Vec<ComponentId> = kinds.flat_map(|kind| kind.components().to_vec()).collect();
        match held.into_iter().find(|id| *id != marker && !known.contains(id)) {
            None => Ok(()),
            Some(id) => {
                let component =
                    world.components().get_name(id).map_or_else(|| format!("{id:?}"), |name| name.to_string());
                Err(ColumnError { component })
            }
        }
    }
}

/// Puts the particle that is in row `order[k]` into row `k`, in every registered column.
pub fn permute_columns(world: &mut World, order: &[u32]) {
    world.resource_scope(|world, mut registered: Mut<ParticleColumns>| {
        for column in &mut registered.columns {
            column.permute(world, order);
        }
    });
}
