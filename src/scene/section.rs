//! Sections of a scene: what each plugin reads, and how it becomes entities and resources.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::schema::{Describe, check_ranges, describe};
use super::{Document, Invalid, flatten};
use crate::error::UserError;

/// Why a section could not be put into effect.
#[derive(Debug)]
pub enum SectionError {
    /// A value of the section makes no sense; its path is relative to the section.
    Invalid(Invalid),
    /// A complaint that already knows its place.
    User(UserError),
}

impl From<Invalid> for SectionError {
    fn from(invalid: Invalid) -> Self {
        Self::Invalid(invalid)
    }
}

impl From<UserError> for SectionError {
    fn from(error: UserError) -> Self {
        Self::User(error)
    }
}

/// A part of the scene that one plugin owns: a field of `Scene(…)` and the type it is read into.
///
/// Sections are read strictly (put `#[serde(deny_unknown_fields)]` on every struct and enum), checked, and spawned in
/// the order in which they were registered, so that a later one finds what an earlier one made. Doc comments, and units and
/// ranges in `#[schemars(…)]`, make the reference page and the JSON Schema of scenes ([`schema`](super::schema)).
pub trait SceneSection: Serialize + DeserializeOwned + JsonSchema + Send + Sync + 'static {
    /// Name of the field.
    const NAME: &'static str;

    /// The section of a scene that does not mention it; `None` if it has to.
    #[must_use]
    fn when_absent() -> Option<Self> {
        None
    }

    /// Refuses values that make no physical sense. Numbers outside the range that their `#[schemars(…)]` states have been
    /// refused already.
    ///
    /// # Errors
    /// The first such value, with its path inside the section.
    fn check(&self, world: &World) -> Result<(), Invalid> {
        let _ = world;
        Ok(())
    }

    /// Puts the section into effect.
    ///
    /// # Errors
    /// What turned out to be wrong only now.
    fn spawn(self, world: &mut World) -> Result<(), SectionError>;
}

/// A section that takes effect by being a resource, and that a scene may leave out.
///
/// It needs no [`check`](SceneSection::check) beyond the ranges that it states.
pub trait SceneSettings: Resource + Default + Serialize + DeserializeOwned + JsonSchema {
    /// Name of the field.
    const NAME: &'static str;
}

impl<S: SceneSettings> SceneSection for S {
    const NAME: &'static str = <S as SceneSettings>::NAME;

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        world.insert_resource(self);
        Ok(())
    }
}

/// Every number that shapes a run, and which of them the scene left open.
#[derive(Resource, Debug, Clone, Default)]
pub struct SceneFacts {
    /// Path and value of everything that the scene says or leaves at its default.
    pub parameters: Vec<(String, String)>,
    /// Path and value of what the scene left at its default.
    pub defaults: Vec<(String, String)>,
}

impl SceneFacts {
    /// Notes every value under `path`.
    pub(crate) fn note<T: Serialize>(&mut self, document: &Document, path: &str, value: &T) {
        self.parameters.extend(flatten(path, value));
        self.defaults.extend(document.defaults(path, value));
    }

    /// Says what the value at `path` became, which was noted as `None` because it follows from the rest of the scene.
    pub fn resolve(&mut self, path: &str, value: impl Into<String>) {
        let value = value.into();
        let noted = self.parameters.iter_mut().chain(&mut self.defaults);
        noted.filter(|(noted, _)| noted == path).for_each(|(_, text)| text.clone_from(&value));
    }
}

type Load = fn(&Document, &mut World) -> Result<(), UserError>;

/// A section that a scene can have.
#[derive(Clone, Copy)]
pub(super) struct SectionEntry {
    pub(super) name: &'static str,
    load: Load,
    pub(super) describe: Describe,
    /// The section of a scene that does not mention it; none if it has to, null if JSON has no word for it.
    pub(super) when_absent: fn() -> Option<serde_json::Value>,
}

/// The sections that a scene can have.
#[derive(Resource, Default, Clone)]
pub struct SectionRegistry {
    pub(super) entries: Vec<SectionEntry>,
}

impl SectionRegistry {
    pub(crate) fn register<S: SceneSection>(&mut self) {
        self.entries.retain(|entry| entry.name != S::NAME);
        self.entries.push(SectionEntry {
            name: S::NAME,
            load: load::<S>,
            describe: describe::<S>,
            when_absent: || S::when_absent().map(|section| serde_json::to_value(section).unwrap_or_default()),
        });
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.entries.iter().map(|entry| entry.name)
    }

    pub(super) fn load_only(&self, name: &str, document: &Document, world: &mut World) -> Result<(), UserError> {
        self.entries.iter().filter(|entry| entry.name == name).try_for_each(|entry| (entry.load)(document, world))
    }

    pub(super) fn load_all(&self, document: &Document, world: &mut World) -> Result<(), UserError> {
        self.entries.iter().try_for_each(|entry| (entry.load)(document, world))
    }
}

fn load<S: SceneSection>(document: &Document, world: &mut World) -> Result<(), UserError> {
    let section: S = match (document.node(S::NAME), S::when_absent()) {
        (Some(_), _) => document.read(S::NAME)?,
        (None, Some(default)) => default,
        (None, None) => {
            return Err(document.invalid(&Invalid::new("", format!("the section `{}` is missing", S::NAME))));
        }
    };
    check_ranges(describe::<S>, &section).map_err(|invalid| document.invalid(&invalid.under(S::NAME)))?;
    section.check(world).map_err(|invalid| document.invalid(&invalid.under(S::NAME)))?;
    world.get_resource_or_init::<SceneFacts>().note(document, S::NAME, &section);
    section.spawn(world).map_err(|error| match error {
        SectionError::Invalid(invalid) => document.invalid(&invalid.under(S::NAME)),
        SectionError::User(error) => error,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_derived_value_takes_the_place_of_none() {
        let mut facts = SceneFacts::default();
        let document =
            Document::parse("a.ron", "Scene(log: {\"series\": 1.0})").unwrap_or_else(|error| panic!("{error}"));
        let log: std::collections::BTreeMap<&str, Option<f64>> = [("series", Some(1.0)), ("particles", None)].into();
        facts.note(&document, "log", &log);
        facts.resolve("log.particles", "0.02");
        facts.resolve("log.nothing", "1");
        let pair = |path: &str, value: &str| (path.to_owned(), value.to_owned());
        assert_eq!(facts.defaults, [pair("log.particles", "0.02")]);
        assert_eq!(facts.parameters, [pair("log.particles", "0.02"), pair("log.series", "1.0")]);
    }
}
