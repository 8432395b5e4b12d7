//! What a run writes to its log, and when.

use std::path::Path;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::IntoScheduleConfigs;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::frames::{write_bodies, write_particles};
use super::particle_fields::collect_particle_fields;
use super::recover::END;
use super::{
    BODY_FIELDS, FLUID_FIELDS, Field, Level, LogError, LogWriter, ParticleFields, PointField, PointsId, SeriesId,
    Value, derived_numbers, program_facts,
};
use crate::app::{End, StoreggaApp};
use crate::boundary::{Body, Structure};
use crate::clock::Clock;
use crate::number::plain;
use crate::outputs::{OutputKind, OutputTimes};
use crate::particles::{Solid, Wall};
use crate::phases::phases;
use crate::probes::Series;
use crate::scene::{Document, Invalid, SceneDocument, SceneFacts, SceneInfo, SceneSection, SectionError};
use crate::schedule::{Output, OutputStage};

/// Section `log`: how often outputs are written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LogSection {
    /// Interval (s) of the frames of particles; `None` for a fiftieth of the run.
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0, "derived" = "a fiftieth of the run"))]
    pub particles: Option<f64>,
    /// Interval (s) of probes, loads, energy and step records; `None` for a five-hundredth of the run.
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0, "derived" = "a five-hundredth of the run"))]
    pub series: Option<f64>,
}

/// Frames of a run whose scene does not say how often.
const FRAMES: f64 = 50.0;

/// Rows of each series of a run whose scene does not say how often.
const ROWS: f64 = 500.0;

impl SceneSection for LogSection {
    const NAME: &'static str = "log";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn check(&self, world: &World) -> Result<(), Invalid> {
        let least = LEAST_INTERVAL * world.resource::<SceneInfo>().end_time;
        for (name, interval) in [("particles", self.particles), ("series", self.series)] {
            if let Some(interval) = interval.filter(|interval| *interval <= least) {
                let message = format!(
                    "must be greater than {least:.1e} s (ten million outputs a run), got {} s",
                    plain(interval)
                );
                return Err(Invalid::new(name, message));
            }
        }
        Ok(())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let end_time = world.resource::<SceneInfo>().end_time;
        let frames = self.particles.unwrap_or(end_time / FRAMES);
        let series = self.series.unwrap_or(end_time / ROWS);
        let mut facts = world.resource_mut::<SceneFacts>();
        for (field, given, taken) in [("particles", self.particles, frames), ("series", self.series, series)] {
            if given.is_none() {
                facts.resolve(&format!("{}.{field}", Self::NAME), format!("{taken} s"));
            }
        }
        world.insert_resource(OutputTimes::new(frames, series));
        Ok(())
    }
}

/// Shortest interval of outputs, in units of the end time.
const LEAST_INTERVAL: f64 = 1e-7;

/// The log of the run. Without this resource nothing is written.
#[derive(Resource, Debug)]
pub struct Log {
    pub(super) writer: LogWriter,
    pub(super) particles: PointsId,
    pub(super) walls: Option<PointsId>,
    pub(super) structures: Option<PointsId>,
    steps: SeriesId,
    series: Vec<SeriesChannel>,
    /// Time (s) of the last frame.
    pub(super) last_frame: Option<f64>,
}

/// How far one series has been written.
#[derive(Debug)]
pub(super) struct SeriesChannel {
    entity: Entity,
    channel: SeriesId,
    rows: usize,
}

/// Why the log could not be written; the run ends when this is set.
#[derive(Resource, Debug, Default)]
pub struct LogFailure(pub Option<String>);

impl LogFailure {
    /// Keeps the first error.
    pub(super) fn note(&mut self, result: Result<(), LogError>) {
        if let Err(error) = result {
            self.0.get_or_insert_with(|| error.to_string());
        }
    }
}

/// Properties of `/steps`, besides its time.
const STEP_FIELDS: [Field; 7] = [
    Field::number("step", "1", "steps done"),
    Field::number("time_step", "s", "length of the last step"),
    Field::text("limit", "what limited the last step: a term of Eq. 19, a plugin, or an output that was nearer"),
    Field::number("stable_time_step", "s", "greatest stable length of the next step, Eq. 19"),
    Field::text("stable_limit", "the term of Eq. 19, or the plugin, that limits the next step"),
    Field::number("greatest_speed", "m/s", "upper bound on the speed of any particle"),
    Field::number("greatest_acceleration", "m/s²", "upper bound on the acceleration of any fluid particle"),
];

/// The log and its section of the scene.
pub struct LogPlugin;

impl Plugin for LogPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<LogFailure>().init_resource::<ParticleFields>();
        app.register_rebuilt::<Log>().register_rebuilt::<LogFailure>().register_rebuilt::<ParticleFields>();
        app.register_scene_section::<LogSection>();
        let frame = (collect_particle_fields, write_particles, write_bodies).chain().run_if(due(OutputKind::Frames));
        let series = (write_series, write_step).chain().run_if(due(OutputKind::Series));
        let systems = (series, frame, flush).chain().in_set(OutputStage::Write).run_if(resource_exists::<Log>);
        app.add_systems(Output, systems);
    }
}

fn due(kind: OutputKind) -> impl Fn(Res<OutputTimes>) -> bool + Clone {
    move |times: Res<OutputTimes>| times.due(kind)
}

/// Appends the rows that every series got since it was last written.
fn write_series(mut log: ResMut<Log>, mut failure: ResMut<LogFailure>, series: Query<(Entity, &Series)>) {
    let log = &mut *log;
    for (entity, series) in &series {
        let result = log.append(entity, series);
        failure.note(result);
    }
}

/// Writes a record of the step that led here.
fn write_step(mut log: ResMut<Log>, mut failure: ResMut<LogFailure>, clock: Res<Clock>) {
    let (limit, stable_limit) = (clock.limit.to_string(), clock.stable_limit.to_string());
    let values = [
        Value::Number(clock.step as f64),
        Value::Number(clock.time_step),
        Value::Text(&limit),
        Value::Number(clock.stable_time_step),
        Value::Text(&stable_limit),
        Value::Number(clock.greatest_speed),
        Value::Number(clock.greatest_acceleration),
    ];
    let steps = log.steps;
    failure.note(log.writer.write_record(steps, clock.time, &values));
}

/// Hands everything so far to the operating system with every frame, so that a killed run leaves it readable.
fn flush(mut log: ResMut<Log>, mut failure: ResMut<LogFailure>, times: Res<OutputTimes>) {
    if times.due(OutputKind::Frames) {
        failure.note(log.writer.flush());
    }
}

impl Log {
    /// The log of a world that goes to `writer`, with the topics that every run has.
    pub(super) fn new(world: &mut World, mut writer: LogWriter) -> Result<Self, LogError> {
        let particles = writer.add_points("/particles", &fluid_fields(world))?;
        let walls = any::<Wall>(world).then(|| writer.add_points("/walls", &BODY_FIELDS)).transpose()?;
        let structures = any::<Solid>(world).then(|| writer.add_points("/structures", &BODY_FIELDS)).transpose()?;
        let steps = writer.add_series("/steps", "time step and what limits it", &STEP_FIELDS)?;
        Ok(Self { writer, particles, walls, structures, steps, series: Vec::new(), last_frame: None })
    }

    /// Adds the topic of a series of which `rows` rows have been written.
    pub(super) fn add_channel(&mut self, entity: Entity, series: &Series, rows: usize) -> Result<(), LogError> {
        let unit = |unit: &'_ str| if unit.is_empty() { "1".to_owned() } else { unit.to_owned() };
        let units: Vec<String> = series.fields.iter().map(|field| unit(&field.unit)).collect();
        let fields: Vec<Field> = series
            .fields
            .iter()
            .zip(&units)
            .map(|(field, unit)| Field::number(&field.name, unit, &field.description))
            .collect();
        let channel = self.writer.add_series(&series.topic, &series.description, &fields)?;
        self.series.push(SeriesChannel { entity, channel, rows });
        Ok(())
    }

    fn append(&mut self, entity: Entity, series: &Series) -> Result<(), LogError> {
        let known = self.series.iter().position(|channel| channel.entity == entity);
        let index = match known {
            Some(index) => index,
            None => {
                self.add_channel(entity, series, 0)?;
                self.series.len() - 1
            }
        };
        let SeriesChannel { channel, rows, .. } = &mut self.series[index];
        for row in *rows..series.times().len() {
            self.writer.write_series(*channel, series.times()[row], series.row(row))?;
        }
        *rows = series.times().len();
        Ok(())
    }
}

/// Opens the log of a loaded scene at `path`, for a run to `end_time` (s), and writes what the run starts from: the text of
/// the scene, every parameter, every default, every number derived from them. From then on outputs are written to it.
///
/// # Errors
/// The file cannot be created or written.
pub fn open_log(world: &mut World, path: &Path, end_time: f64) -> Result<(), LogError> {
    let mut writer = LogWriter::create(path)?;
    let document = &world.resource::<SceneDocument>().0;
    attach(&mut writer, document, "")?;
    if let Some(variant) = document.variant() {
        attach(&mut writer, variant, "variant ")?;
    }
    writer.metadata("overrides", document.overrides())?;
    let facts = world.resource::<SceneFacts>();
    writer.metadata("parameters", &facts.parameters)?;
    writer.metadata("defaults", &facts.defaults)?;
    let named: Vec<_> = derived_numbers(world).iter().map(|fact| (fact.key(), fact.value.clone())).collect();
    writer.metadata("derived", &named)?;
    writer.metadata("program", &program_facts(end_time))?;
    for (name, entries) in names(world) {
        writer.metadata(name, &entries)?;
    }

    let mut log = Log::new(world, writer)?;
    let clock = world.resource::<Clock>();
    let title = &world.resource::<SceneInfo>().title;
    log.writer.message(clock.time, Level::Info, &format!("the run starts: {title}"))?;
    world.insert_resource(log);
    Ok(())
}

fn attach(writer: &mut LogWriter, document: &Document, kind: &str) -> Result<(), LogError> {
    let name = Path::new(document.file()).file_name().map_or(document.file().into(), |name| name.to_string_lossy());
    writer.attach(&format!("{kind}{name}"), "text/plain", document.text().as_bytes())
}

/// What the numbers in point clouds stand for: names by index of phases, walls and structures, and units of the fields.
fn names(world: &mut World) -> [(&'static str, Vec<(String, String)>); 4] {
    let phases = phases(world).into_iter().map(|(phase, _)| (phase.index.to_string(), phase.name)).collect();
    let mut bodies = world.query::<(&Body, Has<Structure>)>();
    let mut named = |structures: bool| {
        let own = bodies.iter(world).filter(|(_, is_structure)| *is_structure == structures);
        own.map(|(body, _)| (body.index.to_string(), body.name.clone())).collect()
    };
    let (walls, structures) = (named(false), named(true));
    let fluid_fields = fluid_fields(world);
    let units = fluid_fields.iter().chain(&BODY_FIELDS).map(|field| (field.name.to_owned(), field.unit.to_owned()));
    [("phases", phases), ("walls", walls), ("structures", structures), ("units", units.collect())]
}

/// The fields of a fluid particle, those of plugins last.
fn fluid_fields(world: &mut World) -> Vec<PointField<'static>> {
    [FLUID_FIELDS.as_slice(), &ParticleFields::choose(world)].concat()
}

fn any<M: Component>(world: &mut World) -> bool {
    world.query_filtered::<(), With<M>>().iter(world).next().is_some()
}

/// Writes a line for people to read to the log, if there is one.
pub fn log_message(world: &mut World, level: Level, text: &str) {
    let time = world.resource::<Clock>().time;
    let Some(mut log) = world.get_resource_mut::<Log>() else { return };
    let result = log.writer.message(time, level, text);
    world.get_resource_or_init::<LogFailure>().note(result);
}

/// How a run ended, for programs: the word of `storegga run --json`, the simulated time and the number of steps.
fn end_facts(end: &End, clock: &Clock) -> [(String, String); 3] {
    [
        ("how".to_owned(), end.word().to_owned()),
        ("time [s]".to_owned(), clock.time.to_string()),
        ("step".to_owned(), clock.step.to_string()),
    ]
}

/// Writes the last state, if the last frame was earlier, and how the run ended; then finishes the log, if there is one.
///
/// # Errors
/// The file cannot be written.
pub fn close_log(world: &mut World, end: &End) -> Result<(), String> {
    let time = world.resource::<Clock>().time;
    let Some(log) = world.get_resource::<Log>() else { return Ok(()) };
    if log.last_frame != Some(time) {
        for result in [world.run_system_cached(write_series), world.run_system_cached(write_step)] {
            result.map_err(|error| error.to_string())?;
        }
        world.run_system_cached(collect_particle_fields).map_err(|error| error.to_string())?;
        world.run_system_cached(write_particles).map_err(|error| error.to_string())?;
        world.run_system_cached(write_bodies).map_err(|error| error.to_string())?;
    }
    let (level, text) = match end {
        End::Done => (Level::Info, format!("the run ends at t = {time} s")),
        End::Interrupted => (Level::Warning, format!("the run was interrupted at t = {time} s")),
        End::Diverged(report) => (Level::Error, report.to_string()),
        End::Failed(what) => (Level::Error, format!("the run failed at t = {time} s: {what}")),
        End::LogFailed(why) => (Level::Error, format!("the log failed at t = {time} s: {why}")),
    };
    log_message(world, level, &text);
    let facts = end_facts(end, world.resource::<Clock>());
    if let Some(mut log) = world.remove_resource::<Log>() {
        let result = log.writer.metadata(END, &facts).and_then(|()| log.writer.finish());
        world.get_resource_or_init::<LogFailure>().note(result);
    }
    match world.resource_mut::<LogFailure>().0.take() {
        Some(failure) => Err(failure),
        None => Ok(()),
    }
}
