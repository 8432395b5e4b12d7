//! Fields that plugins add to the point cloud of the fluid: columns of their own.

use bevy_ecs::prelude::*;

use super::{PointField, PointKind};
use crate::particles::Fluid;

/// Reads one number a particle, in the order in which particles lie in memory.
type Read = Box<dyn FnMut(&World, &mut Vec<f64>) + Send + Sync>;

/// A column that can be a field of the point cloud.
struct ParticleField {
    field: PointField<'static>,
    /// Whether the scene at hand has a use for it.
    is_used: fn(&mut World) -> bool,
    read: Read,
}

/// The columns that plugins want logged, and the values of those that this run logs.
#[derive(Resource, Default)]
pub(crate) struct ParticleFields {
    entries: Vec<ParticleField>,
    values: Vec<Vec<f64>>,
}

impl ParticleFields {
    /// Registers the field `name` (in `unit`), the `value` of column `T`, for scenes in which an entity has the component
    /// `Used`.
    pub fn register<T: Component, Used: Component>(
        world: &mut World,
        name: &'static str,
        unit: &'static str,
        value: fn(&T) -> f64,
    ) {
        let mut column = world.query_filtered::<&'static T, With<Fluid>>();
        let read: Read = Box::new(move |world, values| values.extend(column.iter(world).map(value)));
        let is_used = |world: &mut World| world.query_filtered::<(), With<Used>>().iter(world).next().is_some();
        let field = PointField::new(name, unit, PointKind::F32);
        world.get_resource_or_init::<Self>().entries.push(ParticleField { field, is_used, read });
    }

    /// Names of the fields that plugins registered.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.entries.iter().map(|entry| entry.field.name)
    }

    /// Drops the fields that this scene does not use; those that are left.
    pub fn choose(world: &mut World) -> Vec<PointField<'static>> {
        world.resource_scope(|world, mut own: Mut<Self>| {
            own.entries.retain(|entry| (entry.is_used)(world));
            own.values = vec![Vec::new(); own.entries.len()];
            own.entries.iter().map(|entry| entry.field).collect()
        })
    }

    /// What [`collect_particle_fields`] found, a column a field.
    pub fn values(&self) -> &[Vec<f64>] {
        &self.values
    }
}

/// Reads the logged columns, for the frame that is written next.
pub(super) fn collect_particle_fields(world: &mut World) {
    world.resource_scope(|world, mut own: Mut<ParticleFields>| {
        let ParticleFields { entries, values } = &mut *own;
        for (entry, values) in entries.iter_mut().zip(values) {
            values.clear();
            (entry.read)(world, values);
        }
    });
}
