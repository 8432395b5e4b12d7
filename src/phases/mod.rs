//! Phases: the liquids of a scene, each an entity with its reference density and its rheology.

use std::collections::HashSet;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::app::StoreggaApp;
use crate::particles::ReferenceDensity;
use crate::rheology::{RheologyFacts, RheologyRegistry};
use crate::scene::schema::Open;
use crate::scene::{Deferred, Invalid, SceneDocument, SceneFacts, SceneSection, SectionError};

/// A liquid. The entity also has its [`ReferenceDensity`] and, as a component, the parameters of its rheology.
#[derive(Component, Debug, Clone)]
pub struct Phase {
    /// Name in the scene.
    pub name: String,
    /// Index in the order of the scene, as in [`PhaseIndex`](crate::particles::PhaseIndex).
    pub index: u32,
    /// What its rheology says of itself.
    pub rheology: RheologyFacts,
}

/// Section `phases`: the liquids by name.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct PhasesSection(IndexMap<String, PhaseSpec>);

/// One phase of a scene.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PhaseSpec {
    /// Reference density ρ0 (kg/m³), that of a gas or a liquid.
    #[schemars(range(min = 0.001, max = 1e6), extend("unit" = "kg/m³"))]
    pub reference_density: f64,
    /// Rheology: the name of a registered one with its parameters.
    #[serde(skip_serializing)]
    #[schemars(with = "Open<RheologyRegistry>")]
    pub rheology: Deferred,
}

impl SceneSection for PhasesSection {
    const NAME: &'static str = "phases";

    fn check(&self, _: &World) -> Result<(), Invalid> {
        if self.0.is_empty() {
            return Err(Invalid::new("", "a scene needs at least one phase"));
        }
        Ok(())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let document = world.resource::<SceneDocument>().0.clone();
        for (index, (name, spec)) in self.0.into_iter().enumerate() {
            let path = format!("{}.{name}.rheology", Self::NAME);
            let rheology = world.resource_scope(|world, registry: Mut<RheologyRegistry>| {
                let mut entity = world.spawn(ReferenceDensity(spec.reference_density));
                registry.read(&document, &path, &mut entity).map(|facts| (facts, entity.id()))
            });
            let (rheology, entity) = rheology?;
            let mut facts = world.resource_mut::<SceneFacts>();
            facts.parameters.push((path, rheology.name.clone()));
            facts.parameters.extend(rheology.parameters.iter().cloned());
            facts.defaults.extend(rheology.defaults.iter().cloned());
            world.entity_mut(entity).insert(Phase { name, index: index as u32, rheology });
        }
        Ok(())
    }
}

/// Name, index and reference density (kg/m³) of every phase, in the order of the scene.
pub fn phases(world: &mut World) -> Vec<(Phase, f64)> {
    let mut found: Vec<(Phase, f64)> =
        world.query::<(&Phase, &ReferenceDensity)>().iter(world).map(|(phase, rho0)| (phase.clone(), rho0.0)).collect();
    found.sort_by_key(|(phase, _)| phase.index);
    found
}

/// The phase called `name`, for a section that mentions it at `path`.
///
/// # Errors
/// There is no such phase; the message names the nearest.
pub fn phase_named(world: &mut World, path: &str, name: &str) -> Result<(Phase, f64), Invalid> {
    let all = phases(world);
    if let Some(found) = all.iter().find(|(phase, _)| phase.name == name) {
        return Ok(found.clone());
    }
    let known: HashSet<&str> = all.iter().map(|(phase, _)| phase.name.as_str()).collect();
    Err(crate::scene::unknown(path, "phase", name, known))
}

/// Phases of a scene.
pub struct PhasesPlugin;

impl Plugin for PhasesPlugin {
    fn build(&self, app: &mut App) {
        app.register_scene_section::<PhasesSection>().register_rebuilt::<Phase>();
    }
}
