//! The contract of a probe, the registry through which scenes name them, and the system that lets them measure.

use bevy_app::App;
use bevy_ecs::component::Mutable;
use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Series, SeriesField, State, StateParam};
use crate::checkpoint::SavedState;
use crate::error::UserError;
use crate::outputs::{OutputKind, OutputTimes};
use crate::scene::schema::{Describe, OpenEnum, check_ranges, describe};
use crate::scene::{Document, Invalid, Named, SceneFacts, SceneInfo, flatten};
use crate::schedule::{Output, OutputStage};

/// Something that a scene asks to be measured: its parameters, and how the numbers follow from the state.
///
/// What `prepare` finds out, and memory that `measure` reuses, are fields with `#[serde(skip)]`. A probe remembers nothing
/// from one row to the next: a resumed run makes it anew. A sum over time is a resource or a component of its own, registered
/// with [`register_saved`](crate::app::StoreggaApp::register_saved).
pub trait Probe: Component<Mutability = Mutable> + Serialize + DeserializeOwned + JsonSchema {
    /// What is measured, for the log.
    fn description(&self) -> String;

    /// The numbers of a row.
    fn fields(&self) -> Vec<SeriesField>;

    /// Checks the parameters and resolves names, once, when fluids, walls and structures exist.
    ///
    /// # Errors
    /// The first parameter that makes no sense; its path is relative to the probe.
    fn prepare(&mut self, world: &mut World) -> Result<(), Invalid> {
        let _ = world;
        Ok(())
    }

    /// Fills `row`, which has a number for each of the [`fields`](Self::fields) and holds NaN before.
    fn measure(&mut self, state: &State<'_>, row: &mut [f64]);
}

/// The systems that let probes measure, in [`OutputStage::Measure`]. A plugin's own system that writes to a [`Series`]
/// runs after this set.
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
pub struct ProbeSystems;

/// Orders the systems of probes, which all write series, by registration.
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
struct ProbeOrder(usize);

type Read = fn(&Document, &Named<'_>, &str, &mut World) -> Result<(), UserError>;

/// The probes that a scene can name.
#[derive(Resource, Default, Clone)]
pub struct ProbeRegistry {
    entries: Vec<(String, Read, Describe)>,
    systems: usize,
}

impl OpenEnum for ProbeRegistry {
    const NAME: &'static str = "probe";

    fn variants(&self) -> impl Iterator<Item = (&str, Describe)> {
        self.entries.iter().map(|(name, _, describe)| (name.as_str(), *describe))
    }
}

impl ProbeRegistry {
    /// Lets scenes name the probe `P`.
    pub(crate) fn register<P: Probe>(app: &mut App, name: &str) {
        let mut registry = app.world_mut().get_resource_or_init::<Self>();
        registry.entries.retain(|(known, ..)| known != name);
        registry.entries.push((name.to_owned(), read::<P>, describe::<P>));
        Self::add_system::<P>(app);
    }

    /// Adds the system of the probe `P`, which scenes need not be able to name.
    pub(super) fn add_system<P: Probe>(app: &mut App) {
        SavedState::register_rebuilt::<P>(app.world_mut());
        let mut registry = app.world_mut().get_resource_or_init::<Self>();
        registry.systems += 1;
        let order = registry.systems;
        let system = measure::<P>
            .in_set(OutputStage::Measure)
            .in_set(ProbeSystems)
            .in_set(ProbeOrder(order))
            .after(ProbeOrder(order - 1))
            .run_if(series_due)
            .run_if(any_with_component::<P>);
        app.add_systems(Output, system);
    }

    /// Names that a scene can use.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(|(name, ..)| name.as_str())
    }

    /// Reads the probe called `name` from the scene and spawns it.
    ///
    /// # Errors
    /// An unknown kind of probe, or parameters that are wrong.
    pub(super) fn read(&self, document: &Document, name: &str, world: &mut World) -> Result<(), UserError> {
        let path = format!("probes.{name}");
        let Some(node) = document.node(&path) else {
            return Err(document.invalid(&Invalid::new(path, "a name of a probe may not contain a dot")));
        };
        let named = document.named(node)?;
        let Some((_, read, _)) = self.entries.iter().find(|(known, ..)| known == named.name) else {
            let known: Vec<&str> = self.names().collect();
            return Err(document.unknown_name_error(named.span, "probe", named.name, &known));
        };
        read(document, &named, name, world)
    }
}

fn read<P: Probe>(document: &Document, named: &Named<'_>, name: &str, world: &mut World) -> Result<(), UserError> {
    let path = format!("probes.{name}");
    let probe: P = document.read_body(named)?;
    check_ranges(describe::<P>, &probe).map_err(|invalid| document.invalid(&invalid.under(&path)))?;
    let mut facts = world.resource_mut::<SceneFacts>();
    facts.parameters.push((path.clone(), named.name.to_owned()));
    // A probe without parameters has only its kind.
    facts.parameters.extend(flatten(&path, &probe).into_iter().filter(|(place, _)| *place != path));
    facts.defaults.extend(document.defaults(&path, &probe));
    spawn_probe(world, name, format!("/probes/{name}"), probe)
        .map_err(|invalid| document.invalid(&invalid.under(&path)))
}

/// Prepares a probe and spawns it with an empty series.
///
/// # Errors
/// What the probe refuses.
pub(super) fn spawn_probe<P: Probe>(world: &mut World, name: &str, topic: String, mut probe: P) -> Result<(), Invalid> {
    probe.prepare(world)?;
    let series = Series::new(name, topic, probe.description(), probe.fields());
    world.spawn((probe, series));
    Ok(())
}

/// Whether series are due.
fn series_due(outputs: Res<OutputTimes>) -> bool {
    outputs.due(OutputKind::Series)
}

/// Appends a row to the series of every probe of one kind.
fn measure<P: Probe>(
    mut row: Local<Vec<f64>>,
    outputs: Res<OutputTimes>,
    scene: Res<SceneInfo>,
    state: StateParam,
    mut probes: Query<(&mut P, &mut Series)>,
) {
    let state = state.view();
    for (mut probe, mut series) in &mut probes {
        if series.times().is_empty() {
            series.reserve(outputs.expected(OutputKind::Series, scene.end_time));
        }
        row.clear();
        row.resize(series.fields.len(), f64::NAN);
        probe.measure(&state, &mut row);
        series.push(state.clock.time, &row);
    }
}
