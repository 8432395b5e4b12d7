//! Section `probes` of a scene, and the series that every run has.

use bevy_ecs::prelude::*;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

use super::probe::{ProbeRegistry, spawn_probe};
use super::{Energy, Series, StructureLoad};
use crate::boundary::{Body, Structure};
use crate::scene::schema::Open;
use crate::scene::{Deferred, Invalid, SceneDocument, SceneSection, SectionError};

/// Section `probes`: what is measured, by name. The name is that of its series, too.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct ProbesSection(#[schemars(with = "IndexMap<String, Open<ProbeRegistry>>")] IndexMap<String, Deferred>);

/// As the list of names: each probe notes its own parameters.
impl Serialize for ProbesSection {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.keys())
    }
}

/// Name of the series of energies.
const ENERGY: &str = "energy";

impl SceneSection for ProbesSection {
    const NAME: &'static str = "probes";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let document = world.resource::<SceneDocument>().0.clone();
        spawn_probe(world, ENERGY, format!("/{ENERGY}"), Energy)?;
        for name in structure_names(world) {
            let place = format!("structures.{name}");
            require_free(world, &name).map_err(|taken| document.invalid(&taken.under(&place)))?;
            spawn_probe(world, &name, format!("/structures/{name}/load"), StructureLoad::new(&name))?;
        }
        let registry = world.resource::<ProbeRegistry>().clone();
        for name in self.0.keys() {
            require_free(world, name).map_err(|taken| taken.under(name))?;
            registry.read(&document, name, world)?;
        }
        Ok(())
    }
}

fn structure_names(world: &mut World) -> Vec<String> {
    let mut query = world.query_filtered::<&Body, With<Structure>>();
    let mut structures: Vec<&Body> = query.iter(world).collect();
    structures.sort_by_key(|body| body.index);
    structures.into_iter().map(|body| body.name.clone()).collect()
}

/// Refuses a name that another series has, or that would be two parts of a topic.
fn require_free(world: &mut World, name: &str) -> Result<(), Invalid> {
    if name.contains('/') {
        return Err(Invalid::new("", "a name that becomes a topic of the log may not contain a `/`"));
    }
    match world.query::<&Series>().iter(world).find(|series| series.name == name) {
        Some(other) => {
            Err(Invalid::new("", format!("the series `{}` has this name, too: {}", name, other.description)))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use crate::probes::test_support::{TANK, complaint, measured, scene};

    #[test]
    fn every_run_has_energy_and_loads() {
        let mut app = measured(&scene(TANK, ""));
        assert!(app.value("energy.kinetic").is_some() && app.value("floor.force_y").is_some());
    }

    #[test]
    fn misspelt_and_doubled_names_are_refused() {
        assert!(complaint(&scene(TANK, "probes: {\"p\": PresurePoint(at: (0, 0))},")).contains("PressurePoint"));
        assert!(complaint(&scene(TANK, "probes: {\"floor\": PressurePoint(at: (0, 0))},")).contains("has this name"));
        assert!(complaint(&scene(TANK, "probes: {\"a.b\": PressurePoint(at: (0, 0))},")).contains("dot"));
        assert!(
            complaint(&scene(TANK, "probes: {\"f\": Front(phase: \"watr\", direction: (1, 0))},")).contains("water")
        );
    }
}
