//! From a scene's text to entities.

use bevy_ecs::prelude::*;
use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};

use super::header::load_header;
use super::{Document, Header, SectionRegistry};
use crate::error::UserError;
use crate::particles::ParticleColumns;
use crate::schedule::install_stages;

/// The scene as written, with its overrides.
#[derive(Resource, Debug, Clone)]
pub struct SceneDocument(pub Document);

/// A value that its owner reads later, by its path: one whose name decides its type.
#[derive(Debug, Clone, Copy, Default)]
pub struct Deferred;

impl<'de> Deserialize<'de> for Deferred {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        IgnoredAny::deserialize(deserializer).map(|_| Self)
    }
}

/// Low numbers of entities that are kept free for what comes after the particles. A resource is an entity, and for each there is a
/// table as long as its number is great: resources made after the particles would each take 4 bytes of every particle. So many that
/// they are free at once; a few wait until there are more.
const LOW_ENTITIES: u32 = 256;

/// Reads the head of a scene, as strictly as [`load_scene`] does; the sections that `world` knows are not looked into.
///
/// # Errors
/// What the user got wrong there, with its place.
pub fn read_header(world: &World, document: &Document) -> Result<Header, UserError> {
    let sections = world.resource::<SectionRegistry>().names();
    let known: Vec<&str> = Header::FIELDS.iter().copied().chain(sections).collect();
    document.require_known_fields("", &known)?;
    Header::read(document)
}

/// Reads one section of a scene into `world`, for those who need no more of it.
///
/// # Errors
/// What the user got wrong there, with its place.
pub(crate) fn load_section(world: &mut World, document: Document, name: &str) -> Result<(), UserError> {
    world.insert_resource(SceneDocument(document.clone()));
    let registry = world.resource::<SectionRegistry>().clone();
    registry.load_only(name, &document, world)
}

/// Reads every section of a scene into `world` and puts the stages of its dimension into the step schedule.
///
/// # Errors
/// What the user got wrong, with its place.
pub fn load_scene(world: &mut World, document: Document) -> Result<(), UserError> {
    let header = read_header(world, &document)?;
    world.insert_resource(SceneDocument(document.clone()));
    load_header(&document, header, world)?;
    let registry = world.resource::<SectionRegistry>().clone();
    let low: Vec<Entity> = world.entity_allocator().alloc_many(LOW_ENTITIES).collect();
    registry.load_all(&document, world)?;
    world.entity_allocator_mut().free_many(&low);
    ParticleColumns::check(world).map_err(UserError::plain)?;
    let dimension = world.resource::<super::Resolution>().dimension;
    install_stages(world, dimension);
    Ok(())
}
