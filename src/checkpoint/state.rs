//! The state that a checkpoint holds: which components and resources, and how each becomes bytes.
//!
//! Numbers are written with all their bits. A component is written for every entity that has one, in the order of the
//! entities; a run that is resumed opens its scene anew, which spawns the same entities in the same order, and gets the
//! values back.

use std::any::{TypeId, type_name};
use std::collections::HashSet;

use bevy_ecs::component::Mutable;
use bevy_ecs::prelude::*;
use serde::de::DeserializeOwned;
use serde::{Serialize, Serializer};

/// One kind of state: its name, and how it comes out of a world and back.
#[derive(Clone, Copy)]
struct Entry {
    name: &'static str,
    save: fn(&mut World, &mut Vec<u8>) -> Result<(), String>,
    restore: fn(&mut World, &[u8]) -> Result<(), String>,
}

/// Which state of a world lives from step to step, and which follows from the scene.
#[derive(Resource, Default)]
pub(crate) struct SavedState {
    entries: Vec<Entry>,
    /// Types that are saved, or that need not be.
    accounted: HashSet<TypeId>,
}

impl SavedState {
    /// Saves `T` of every entity that has it.
    pub fn register<T>(world: &mut World)
    where
        T: Component<Mutability = Mutable> + Serialize + DeserializeOwned,
    {
        Self::register_with::<T>(world, save_values::<T>, restore_values::<T>);
    }

    /// Saves the resource `T` by functions of its own.
    pub fn register_with<T: 'static>(
        world: &mut World,
        save: fn(&mut World, &mut Vec<u8>) -> Result<(), String>,
        restore: fn(&mut World, &[u8]) -> Result<(), String>,
    ) {
        let mut state = world.get_resource_or_init::<Self>();
        state.accounted.insert(TypeId::of::<T>());
        let entry = Entry { name: type_name::<T>(), save, restore };
        if !state.entries.iter().any(|known| known.name == entry.name) {
            state.entries.push(entry);
        }
    }

    /// `T` follows from the scene, or is computed anew before it is read.
    pub fn register_rebuilt<T: 'static>(world: &mut World) {
        world.get_resource_or_init::<Self>().accounted.insert(TypeId::of::<T>());
    }
}

/// Refuses a world with a component or a resource that is neither saved nor known to be rebuilt: a resumed run would go on
/// without it.
///
/// # Errors
/// The types of such state.
pub fn check_state(world: &World) -> Result<(), Vec<String>> {
    let state = world.resource::<SavedState>();
    let on_entities = world.archetypes().iter().filter(|kind| !kind.is_empty()).flat_map(|kind| kind.components());
    let unknown = on_entities.filter_map(|id| world.components().get_info(*id)).filter(|info| {
        let is_accounted = info.type_id().is_some_and(|id| state.accounted.contains(&id));
        // A type without a value, such as a marker, has no state; schedules and the like are bevy's own.
        !is_accounted && info.layout().size() > 0 && !info.name().to_string().starts_with("bevy_")
    });
    let mut names: Vec<String> = unknown.map(|info| info.name().to_string()).collect();
    names.sort_unstable();
    names.dedup();
    if names.is_empty() { Ok(()) } else { Err(names) }
}

/// The whole state of a world between two steps, to the bit: equal worlds give equal bytes.
///
/// # Errors
/// State that cannot be written, with its type.
pub fn save_state(world: &mut World) -> Result<Vec<u8>, String> {
    let entries = world.resource::<SavedState>().entries.clone();
    let mut bytes = Vec::new();
    encode(&entries.len(), &mut bytes)?;
    for entry in entries {
        encode(entry.name, &mut bytes)?;
        // The length of what follows is filled in afterwards.
        let start = bytes.len() + LENGTH;
        bytes.extend_from_slice(&[0; LENGTH]);
        (entry.save)(world, &mut bytes).map_err(|why| format!("`{}` cannot be saved: {why}", entry.name))?;
        let length = (bytes.len() - start) as u64;
        bytes[start - LENGTH..start].copy_from_slice(&length.to_le_bytes());
    }
    Ok(bytes)
}

/// Bytes of the length of one kind of state.
const LENGTH: usize = size_of::<u64>();

/// Puts the state that [`save_state`] made into a world that the same scene, opened with the same plugins, has filled.
///
/// # Errors
/// What does not fit: the world is then of no use any more.
pub fn restore_state(world: &mut World, bytes: &[u8]) -> Result<(), String> {
    let entries = world.resource::<SavedState>().entries.clone();
    let sections = sections(bytes)?;
    if let Some((name, _)) = sections.iter().find(|(name, _)| !entries.iter().any(|entry| entry.name == *name)) {
        return Err(format!("it holds the state `{name}`, which this program does not have"));
    }
    for entry in entries {
        let Some((_, section)) = sections.iter().find(|(name, _)| *name == entry.name) else {
            return Err(format!("it lacks the state `{}`, which this program has", entry.name));
        };
        (entry.restore)(world, section).map_err(|why| format!("its state `{}` does not fit: {why}", entry.name))?;
    }
    Ok(())
}

/// Names and bytes of every kind of state.
fn sections(bytes: &[u8]) -> Result<Vec<(&str, &[u8])>, String> {
    let (count, mut rest): (usize, _) = take(bytes)?;
    let mut sections = Vec::new();
    for _ in 0..count {
        let (name, after): (&str, _) = take(rest)?;
        let (length, after) = after.split_first_chunk::<LENGTH>().ok_or("it ends early")?;
        let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| "it is too long")?;
        let (section, after) = after.split_at_checked(length).ok_or("it ends early")?;
        sections.push((name, section));
        rest = after;
    }
    if rest.is_empty() { Ok(sections) } else { Err("it goes on after its end".to_owned()) }
}

/// Appends `value` to `bytes`.
pub(crate) fn encode<T: Serialize + ?Sized>(value: &T, bytes: &mut Vec<u8>) -> Result<(), String> {
    *bytes = postcard::to_extend(value, std::mem::take(bytes)).map_err(|error| error.to_string())?;
    Ok(())
}

/// The value that `bytes` begin with, and the bytes after it.
pub(crate) fn take<'b, T: serde::Deserialize<'b>>(bytes: &'b [u8]) -> Result<(T, &'b [u8]), String> {
    postcard::take_from_bytes(bytes).map_err(|error| error.to_string())
}

/// The value that `bytes` are.
pub(crate) fn decode<'b, T: serde::Deserialize<'b>>(bytes: &'b [u8]) -> Result<T, String> {
    match take(bytes)? {
        (value, []) => Ok(value),
        (_, rest) => Err(format!("{} bytes too many", rest.len())),
    }
}

/// The values of one component, as a sequence.
struct Values<'w, T>(Vec<(Entity, &'w T)>);

impl<T: Serialize> Serialize for Values<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(|(_, value)| value))
    }
}

fn save_values<T: Component + Serialize>(world: &mut World, bytes: &mut Vec<u8>) -> Result<(), String> {
    let mut query = world.query::<(Entity, &T)>();
    let mut values: Vec<(Entity, &T)> = query.iter(world).collect();
    values.sort_unstable_by_key(|(entity, _)| *entity);
    encode(&Values(values), bytes)
}

fn restore_values<T: Component<Mutability = Mutable> + DeserializeOwned>(
    world: &mut World,
    bytes: &[u8],
) -> Result<(), String> {
    let values: Vec<T> = decode(bytes)?;
    let mut query = world.query::<(Entity, &mut T)>();
    let mut places: Vec<(Entity, Mut<T>)> = query.iter_mut(world).collect();
    if places.len() != values.len() {
        return Err(format!("{} values for {} places", values.len(), places.len()));
    }
    places.sort_unstable_by_key(|(entity, _)| *entity);
    places.iter_mut().zip(values).for_each(|((_, place), value)| **place = value);
    Ok(())
}
