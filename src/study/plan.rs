//! What follows from a study: its runs, each of which has been put into effect once.

use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Arc;

use bevy_app::PluginGroup;
use bevy_ecs::prelude::*;

use super::Study;
use super::document::{FigureSpec, Scale, number, shown};
use super::names::{file_name, labels};
use crate::app::{StopFlag, end_time, open};
use crate::checkpoint::check_state;
use crate::error::UserError;
use crate::estimate::Estimate;
use crate::expect::{Take, find_number};
use crate::log::{FLUID_FIELDS, ParticleCounts, ParticleFields};
use crate::number::short;
use crate::outputs::{OutputKind, OutputTimes};
use crate::phases::phases;
use crate::probes::Series;
use crate::scene::schema::{scene_schema, unit_at};
use crate::scene::{Document, Invalid, SceneFiles, unknown};

/// A study, and every run of it.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The study.
    pub study: Study,
    /// What is varied, in the order of the study.
    pub varied: Vec<Varied>,
    /// Runs, in the order of the table.
    pub runs: Vec<PlannedRun>,
    /// Where each measure of the study stands in a log.
    pub measures: Vec<Source>,
    /// What each figure is drawn from.
    pub drawn: Vec<Drawn>,
}

/// A varied value of the scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Varied {
    /// Path in the scene.
    pub path: String,
    /// The shortest end of the path that no other has: what files are called by.
    pub label: String,
    /// What people are shown: its name in the study, or else the label; empty if they are not.
    pub shown: String,
    /// SI unit; empty for pure numbers and words.
    pub unit: String,
}

/// A run of a study.
#[derive(Debug, Clone)]
pub struct PlannedRun {
    /// Name of its files, without their ending.
    pub name: String,
    /// What the study calls it; may be empty.
    pub label: String,
    /// The value of everything that is varied, as text; empty where the scene leaves it open.
    pub values: Vec<String>,
    /// Overrides, as `--set` is given them.
    pub overrides: Vec<String>,
    /// The text of its scene, with all overrides in it.
    pub text: Arc<str>,
    /// Files that the scene reads, with the length and the CRC-32 of each.
    pub files: Vec<(PathBuf, u64, u32)>,
    /// End (s).
    pub end_time: f64,
    /// Particles.
    pub particles: ParticleCounts,
    /// Estimated memory (bytes).
    pub memory: f64,
    /// Estimated duration (s) on one thread.
    pub duration: f64,
    /// Whether its whole state can be saved, so that it can go on from a checkpoint.
    pub can_be_saved: bool,
}

/// Bytes of a particle in a checkpoint, which is in memory twice while it is written.
const BYTES_IN_CHECKPOINT: f64 = 2.0 * 170.0;

/// Letters of a value that people are shown: a shape has hundreds.
const MOST_LETTERS: usize = 24;

impl PlannedRun {
    /// The value of varied value `k` as people are shown it.
    #[must_use]
    pub fn shown(&self, k: usize) -> String {
        let value = self.number(k).map_or_else(|| self.values[k].clone(), short);
        if value.chars().count() <= MOST_LETTERS {
            return value;
        }
        value.chars().take(MOST_LETTERS).chain("…".chars()).collect()
    }

    /// The number that varied value `k` is, if it is one.
    #[must_use]
    pub fn number(&self, k: usize) -> Option<f64> {
        self.values.get(k).and_then(|value| number(value))
    }
}

/// Where a number stands in a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Topic of its series.
    pub topic: String,
    /// Its field.
    pub field: String,
    /// SI unit; empty for pure numbers.
    pub unit: String,
    /// Cutoff (Hz) of the filter through which it goes.
    pub cutoff: Option<f64>,
    /// What it is multiplied by.
    pub factor: f64,
}

/// What a figure is drawn from.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawn {
    /// The table.
    Measures,
    /// A number over time.
    Series(Source),
    /// The phase with this number, at a time (s).
    Surface(usize, f64),
    /// The frames of the last run.
    Frames,
}

impl Plan {
    /// Reads the scene of every run and puts it into effect, one after the other. None if it was told to stop.
    ///
    /// # Errors
    /// The first thing that is wrong with the study or with the scene of a run, with its place.
    pub fn new<P: PluginGroup>(study: Study, plugins: fn() -> P, stop: &StopFlag) -> Result<Option<Self>, UserError> {
        let base = study.base()?;
        let paths = labels(&study.varied);
        let unlabelled = study.varied.iter().zip(paths);
        let varied = unlabelled.map(|(path, label)| {
            let shown = study.shown.get(path).cloned().unwrap_or_else(|| label.replace('_', " "));
            Varied { path: path.clone(), label, shown, unit: String::new() }
        });
        let (measures, drawn) = (Vec::new(), Vec::new());
        let mut plan = Self { varied: varied.collect(), runs: Vec::new(), measures, drawn, study };
        for k in 0..plan.study.runs.len() {
            let document = plan.study.scene_of(&base, k)?;
            let mut app = open(plugins(), document.clone())?;
            plan.add(k, &document, app.world_mut())?;
            if stop.is_set() {
                return Ok(None);
            }
        }
        plan.name_apart();
        Ok(Some(plan))
    }

    /// Adds run number `k`, the scene of which is `document` and has been put into effect in `world`.
    fn add(&mut self, k: usize, document: &Document, world: &mut World) -> Result<(), UserError> {
        if self.runs.is_empty() {
            let schema = scene_schema(world);
            self.varied.iter_mut().for_each(|varied| varied.unit = unit_at(&schema, &varied.path).unwrap_or_default());
        }
        let run = self.planned(k, document, world);
        let found =
            self.sources(world, run.end_time).and_then(|measures| Ok((measures, self.drawn(world, run.end_time)?)));
        let found = found.and_then(|found| self.refuse_other_units(&found.0, k).map(|()| found));
        (self.measures, self.drawn) = found.map_err(|invalid| self.study.invalid(&invalid))?;
        self.runs.push(run);
        Ok(())
    }

    fn planned(&self, k: usize, document: &Document, world: &mut World) -> PlannedRun {
        let (own, estimate) = (&self.study.runs[k], Estimate::of(world, 1));
        let (particles, can_be_saved) = (ParticleCounts::of(world), check_state(world).is_ok());
        let all = (particles.fluid + particles.wall + particles.structure) as f64;
        let scene_end = end_time(world);
        let end_time = self.study.until.unwrap_or(scene_end);
        let value = |varied: &Varied| {
            let given = own.iter().find(|setting| setting.path == varied.path).map(|setting| setting.shown());
            let of_scene = || {
                let span = document.node(&varied.path)?.span.clone();
                document.text().get(span).map(shown)
            };
            given.or_else(of_scene).unwrap_or_default()
        };
        let labelled: Vec<(&str, String)> = self
            .varied
            .iter()
            .filter(|varied| own.iter().any(|setting| setting.path == varied.path))
            .map(|varied| (varied.label.as_str(), value(varied)))
            .collect();
        PlannedRun {
            name: file_name(labelled.iter().map(|(label, value)| (*label, value.as_str()))),
            label: self.study.names.get(k).cloned().unwrap_or_default(),
            values: self.varied.iter().map(value).collect(),
            overrides: self.study.overrides(k).map(|setting| format!("{}={}", setting.path, setting.text)).collect(),
            text: Arc::clone(document.text()),
            files: world.resource::<SceneFiles>().fingerprints().to_vec(),
            end_time,
            particles,
            memory: estimate.memory + if can_be_saved { BYTES_IN_CHECKPOINT * all } else { 0.0 },
            duration: estimate.duration * end_time / scene_end,
            can_be_saved,
        }
    }

    /// Finds the numbers that measures name in a run to `end_time` (s).
    fn sources(&self, world: &mut World, end_time: f64) -> Result<Vec<Source>, Invalid> {
        let mut measures = Vec::new();
        for (k, measure) in self.study.measures.iter().enumerate() {
            let place = format!("measures.{k}");
            let source = source(world, &measure.of, measure.cutoff, measure.scale.as_ref());
            let source = source.map_err(|invalid| invalid.under(&place))?;
            measure.take.check_times(end_time).map_err(|invalid| invalid.under("take").under(&place))?;
            let unit = measure.take.unit(&source.unit).into_owned();
            let unit = if measure.against.is_some() { String::new() } else { unit };
            measures.push(Source { unit, ..source });
        }
        Ok(measures)
    }

    /// Finds what figures show in a run to `end_time` (s).
    fn drawn(&self, world: &mut World, end_time: f64) -> Result<Vec<Drawn>, Invalid> {
        let mut drawn = |figure: &FigureSpec| match figure {
            FigureSpec::Measure { .. } => Ok(Drawn::Measures),
            FigureSpec::Series { of, cutoff, scale, .. } => {
                source(world, of, *cutoff, scale.as_ref()).map(Drawn::Series)
            }
            FigureSpec::Field { of, at, .. } => {
                quantity(world, of).and_then(|()| times(at, end_time)).map(|()| Drawn::Frames)
            }
            FigureSpec::Profile { of, at, .. } => {
                let what = match of.split_once(':') {
                    Some(("surface", name)) => phase(world, name).map(drop),
                    Some((field, _)) => quantity(world, field),
                    None => Err(Invalid::new("of", "expected surface:<phase>, or <field>:<axis>=<coordinate in m>")),
                };
                what.and_then(|()| times(at, end_time)).map(|()| Drawn::Frames)
            }
            FigureSpec::Surface { of, at } => {
                Take::At(*at).check_times(end_time).map_err(|invalid| invalid.under("at"))?;
                phase(world, of).map(|number| Drawn::Surface(number, *at))
            }
        };
        let figures = self.study.figures.iter().enumerate();
        figures.map(|(k, figure)| drawn(figure).map_err(|invalid| invalid.under(&format!("figures.{k}")))).collect()
    }

    /// One column of a table has one unit.
    fn refuse_other_units(&self, measures: &[Source], k: usize) -> Result<(), Invalid> {
        let mut pairs = self.measures.iter().zip(measures).enumerate();
        match pairs.find(|(_, (first, this))| first.unit != this.unit) {
            Some((m, (first, this))) => {
                let message =
                    format!("has the unit `{}` in the first run and `{}` in run {}", first.unit, this.unit, k + 1);
                Err(Invalid::new(format!("measures.{m}.of"), message))
            }
            None => Ok(()),
        }
    }

    /// Numbers the runs whose files would have one name where upper and lower case are the same.
    fn name_apart(&mut self) {
        let mut taken = HashSet::new();
        for run in &mut self.runs {
            let name = run.name.clone();
            let mut number = 1;
            while !taken.insert(run.name.to_lowercase()) {
                number += 1;
                run.name = format!("{name}-{number}");
            }
        }
    }
}

/// The number of the phase called `name`.
fn phase(world: &mut World, name: &str) -> Result<usize, Invalid> {
    let phases: Vec<String> = phases(world).into_iter().map(|(phase, _)| phase.name).collect();
    let number = phases.iter().position(|phase| phase == name);
    number.ok_or_else(|| unknown("of", "phase", name, phases.iter().map(String::as_str)))
}

/// Checks that the particles of a log will have the quantity `name`.
fn quantity(world: &World, name: &str) -> Result<(), Invalid> {
    let of_plugins = world.get_resource::<ParticleFields>().into_iter().flat_map(ParticleFields::names);
    let known: Vec<&str> = FLUID_FIELDS.iter().map(|field| field.name).chain(["speed"]).chain(of_plugins).collect();
    if known.contains(&name) { Ok(()) } else { Err(unknown("of", "quantity", name, known)) }
}

/// Checks that a run to `end_time` (s) has frames `at` these times (s).
fn times(at: &[f64], end_time: f64) -> Result<(), Invalid> {
    at.iter().enumerate().try_for_each(|(k, at)| {
        Take::At(*at).check_times(end_time).map_err(|invalid| invalid.under(&format!("at.{k}")))
    })
}

/// Where the number `of`, `<series>.<field>`, filtered with `cutoff` (Hz) and scaled, will stand in the log of a run.
fn source(world: &mut World, of: &str, cutoff: Option<f64>, scale: Option<&Scale>) -> Result<Source, Invalid> {
    let (entity, index) = find_number(world, of)?;
    let series = world.get::<Series>(entity);
    let found = series.and_then(|series| Some((series, series.fields.get(index)?)));
    let (series, field) = found.ok_or_else(|| Invalid::new("of", "is not measured"))?;
    let unit = scale.map_or(&field.unit, |scale| &scale.unit).clone();
    let factor = scale.map_or(1.0, |scale| scale.by);
    if factor == 0.0 || !factor.is_finite() {
        return Err(Invalid::new("scale.by", format!("must be a number other than 0, got {factor}")));
    }
    let source = Source { topic: series.topic.clone(), field: field.name.clone(), unit, cutoff, factor };
    let half_rate = 0.5 / world.resource::<OutputTimes>().interval(OutputKind::Series);
    match cutoff.filter(|cutoff| !(0.0 < *cutoff && *cutoff < half_rate)) {
        Some(cutoff) => {
            let message =
                format!("must lie between 0 and {} Hz, half the rate of the log, got {cutoff} Hz", short(half_rate));
            Err(Invalid::new("cutoff", message))
        }
        None => Ok(source),
    }
}
