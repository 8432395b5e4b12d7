//! `storegga forces`.

use std::collections::BTreeMap;
use std::process::ExitCode;

use bevy_app::{App, PluginGroup};
use bevy_ecs::prelude::*;

use super::exit::say;
use super::export::open;
use super::plot::{Out, default_folder, unknown};
use super::view_args::ForcesArgs;
use crate::error::UserError;
use crate::figures::{Curve, LineFigure, labelled};
use crate::number::{count, short};
use crate::phases::Phase;
use crate::results::{Record, Results, SeriesField, TimeSeries};
use crate::scene::{Document, load_section};

/// Judges the force on a structure as engineers do: peaks, mean, impulse, coefficients, raw and filtered.
pub(super) fn forces<P: PluginGroup>(args: &ForcesArgs, plugins: fn() -> P) -> Result<ExitCode, UserError> {
    let results = open(&args.log)?;
    let (structure, load) = structure(&results, args.structure.as_deref())?;
    let flow = Flow::of(args, &results, structure, plugins)?;
    let mut components = Vec::new();
    for component in wanted(args, &results) {
        let raw = Record::of(&component.points(load))
            .map_err(|what| UserError::plain(format!("the force on `{structure}` cannot be judged: {what}")))?;
        let cutoff = args.cutoff.unwrap_or(CUTOFF / raw.interval);
        let filtered = raw.filtered(cutoff).map_err(|what| UserError::plain(format!("--cutoff {cutoff}: {what}")))?;
        components.push((component.name, raw, filtered, cutoff));
    }
    let Some((_, raw, _, cutoff)) = components.first() else { return Ok(ExitCode::SUCCESS) };
    let whole = (raw.start, raw.end());
    let window = part("--window", args.window.unwrap_or(whole), whole)?;
    let steady = part("--steady", args.steady.unwrap_or((0.5 * (window.0 + window.1), window.1)), whole)?;
    let of_length = || format!(", of {} m of its length", short(length(&results, structure)));
    let of_length = if results.facts.dimension == 2 { of_length() } else { String::new() };
    let mut told = format!("{}: force of the fluid on `{structure}`{of_length}\n", args.log.display());
    told.push_str(&head(raw, *cutoff, window, steady));
    if let Some(flow) = &flow {
        told.push_str(&flow.line());
    }
    told.push_str(&table(&components, window, steady, flow.as_ref()));
    say(&told);
    let out = Out { folder: args.out.clone().unwrap_or_else(|| default_folder(&args.log)), format: args.format };
    out.make()?;
    for (name, raw, filtered, cutoff) in &components {
        out.write(&format!("{structure}_{name}_record"), &figure(&results, structure, name, (raw, filtered, *cutoff)))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The part of the record, `whole` from one time (s) to another, in what the option `name` gives.
fn part(name: &str, (from, to): (f64, f64), whole: (f64, f64)) -> Result<(f64, f64), UserError> {
    let part = (from.max(whole.0), to.min(whole.1));
    if part.0 < part.1 {
        return Ok(part);
    }
    let what = format!("{name} {from},{to}: the record reaches from {} to {} s", short(whole.0), short(whole.1));
    Err(UserError::plain(what))
}

/// What is judged, and how.
fn head(raw: &Record, cutoff: f64, window: (f64, f64), steady: (f64, f64)) -> String {
    format!(
        "  record      {} to {} s, {} samples, one every {} s\n  filter      Butterworth, second order forward and backward (no lag), cutoff {} Hz\n  peaks       and impulse from {} to {} s\n  mean        from {} to {} s\n",
        short(raw.start),
        short(raw.end()),
        count(raw.values.len() as u64),
        short(raw.interval),
        short(cutoff),
        short(window.0),
        short(window.1),
        short(steady.0),
        short(steady.1),
    )
}

/// Cutoff of the filter in units of the rate of sampling, if none is given.
const CUTOFF: f64 = 0.05;

/// The structure whose load has this topic.
fn structure_of(topic: &str) -> Option<&str> {
    topic.strip_prefix("/structures/")?.strip_suffix("/load")
}

/// The structure called `name`, or the only one, and its load.
fn structure<'r>(results: &'r Results, name: Option<&str>) -> Result<(&'r str, &'r TimeSeries), UserError> {
    let all: Vec<(&str, &TimeSeries)> =
        results.series.iter().filter_map(|series| Some((structure_of(&series.topic)?, series))).collect();
    let names = || all.iter().map(|(name, _)| *name);
    match (name, all.as_slice()) {
        (Some(name), _) => {
            let found = all.iter().find(|(known, _)| *known == name);
            found.copied().ok_or_else(|| unknown("structure", name, names()))
        }
        (None, [only]) => Ok(*only),
        (None, []) => Err(UserError::plain(format!("{} has no structure", results.path().display()))),
        (None, _) => {
            let names = names().collect::<Vec<_>>().join(", ");
            Err(UserError::plain("there are several structures: say which with --structure")
                .help(format!("they are {names}")))
        }
    }
}

/// A component of the force: the sum of fields of the series, each times a factor.
struct Component {
    name: &'static str,
    factors: Vec<(&'static str, f64)>,
}

impl Component {
    fn points(&self, series: &TimeSeries) -> Vec<(f64, f64)> {
        let fields: Vec<(&SeriesField, f64)> =
            self.factors.iter().filter_map(|(name, factor)| Some((series.field(name)?, *factor))).collect();
        let value = |k: usize| fields.iter().map(|(field, factor)| factor * field.values[k]).sum();
        series.times.iter().enumerate().map(|(k, time)| (*time, value(k))).collect()
    }
}

/// Drag along the direction asked for and lift across it; of what turns, the moment over the arm.
fn wanted(args: &ForcesArgs, results: &Results) -> Vec<Component> {
    if let Some(arm) = args.arm {
        return vec![Component { name: "tangential", factors: vec![("moment_z", 1.0 / arm)] }];
    }
    let direction = args.direction.unwrap_or([1.0, 0.0, 0.0]);
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = direction.map(|component| component / length);
    let drag = Component { name: "drag", factors: vec![("force_x", x), ("force_y", y), ("force_z", z)] };
    if results.facts.dimension == 2 {
        vec![drag, Component { name: "lift", factors: vec![("force_x", -y), ("force_y", x)] }]
    } else {
        vec![drag]
    }
}

/// Length (m) across the plane of a structure of two dimensions, to which its force belongs.
fn length(results: &Results, structure: &str) -> f64 {
    let given = results.facts.parameters.get(&format!("structures.{structure}.length"));
    given.and_then(|text| text.parse().ok()).unwrap_or(1.0)
}

/// What makes forces dimensionless.
struct Flow {
    /// ρ (kg/m³).
    density: f64,
    /// U (m/s).
    velocity: f64,
    /// D (m), and A (m²) = D L.
    width: f64,
    area: f64,
    /// τ (Pa) at γ̇ = U/D.
    stress: Option<f64>,
}

impl Flow {
    /// `None` if no velocity is given.
    fn of<P: PluginGroup>(
        args: &ForcesArgs,
        results: &Results,
        structure: &str,
        plugins: fn() -> P,
    ) -> Result<Option<Self>, UserError> {
        let (Some(velocity), Some(width)) = (args.velocity, args.width) else { return Ok(None) };
        let parameters = &results.facts.parameters;
        let number = |path: String| parameters.get(&path).and_then(|text| text.parse::<f64>().ok());
        let area = args.area.unwrap_or(width * length(results, structure));
        let (density, stress) = match &args.phase {
            Some(phase) => {
                let phases = results.facts.phases.iter().map(String::as_str);
                let density = number(format!("phases.{phase}.reference_density"));
                let density = density.ok_or_else(|| unknown("phase", phase, phases))?;
                (args.density.unwrap_or(density), stress(parameters, phase, velocity / width, plugins))
            }
            None => (args.density.unwrap_or(1000.0), None),
        };
        Ok(Some(Self { density, velocity, width, area, stress }))
    }

    /// ½ρU²A (N).
    fn scale(&self) -> f64 {
        0.5 * self.density * self.velocity.powi(2) * self.area
    }

    fn line(&self) -> String {
        let Self { density, velocity, width, area, stress } = self;
        let mut line = format!(
            "  flow        U = {} m/s, ρ = {} kg/m³, D = {} m, A = {} m²: ½ρU²A = {} N\n",
            short(*velocity),
            short(*density),
            short(*width),
            short(*area),
            short(self.scale())
        );
        if let Some(stress) = stress {
            line.push_str(&format!(
                "  Reynolds    {} = ρU²/τ, with τ = {} Pa at γ̇ = U/D = {} 1/s: τA = {} N\n",
                short(density * velocity * velocity / stress),
                short(*stress),
                short(velocity / width),
                short(stress * area)
            ));
        }
        line
    }
}

/// τ = μ(γ̇) γ̇ (Pa) of a phase of the log at the shear rate `rate` (1/s) and no pressure; `None` for rheologies with a memory.
fn stress<P: PluginGroup>(
    parameters: &BTreeMap<String, String>,
    phase: &str,
    rate: f64,
    plugins: fn() -> P,
) -> Option<f64> {
    let path = format!("phases.{phase}");
    let fields = format!(
        "reference_density: {}, rheology: {}",
        parameters.get(&format!("{path}.reference_density"))?,
        value(parameters, &format!("{path}.rheology"))?
    );
    let document = Document::parse("the log", &format!("Scene(phases: {{{phase:?}: ({fields})}})")).ok()?;
    let mut app = App::new();
    app.add_plugins(plugins());
    app.finish();
    let world = app.world_mut();
    load_section(world, document, "phases").ok()?;
    let (entity, curve) =
        world.query::<(Entity, &Phase)>().iter(world).map(|(e, phase)| (e, phase.rheology.curve)).next()?;
    let viscosity = curve?(world.entity(entity), rate, 0.0)?;
    Some(viscosity * rate)
}

/// The text of the value at `path` as a scene would have it, from the flat parameters of a log.
fn value(parameters: &BTreeMap<String, String>, path: &str) -> Option<String> {
    let head = parameters.get(path)?;
    let below = format!("{path}.");
    let names = parameters.range(below.clone()..).map(|(key, _)| key).take_while(|key| key.starts_with(&below));
    let fields = names.filter_map(|key| Some(key.strip_prefix(&below)?.to_owned())).filter(|name| !name.contains('.'));
    let fields: Vec<String> =
        fields.filter_map(|name| Some(format!("{name}: {}", value(parameters, &format!("{below}{name}"))?))).collect();
    Some(if fields.is_empty() { head.clone() } else { format!("{head}({})", fields.join(", ")) })
}

type Judged = (&'static str, Record, Record, f64);

/// Peaks, means and impulses, with their coefficients.
fn table(components: &[Judged], window: (f64, f64), steady: (f64, f64), flow: Option<&Flow>) -> String {
    let coefficient =
        |force: f64| flow.map(|flow| format!("   C = {}", short(force / flow.scale()))).unwrap_or_default();
    let mut text = String::new();
    for (name, raw, filtered, _) in components {
        text.push_str(&format!("\n  {name}\n"));
        for (kind, record) in [("raw", raw), ("filtered", filtered)] {
            let Some((time, peak)) = record.peak(window.0, window.1) else { continue };
            let mean = record.mean(steady.0, steady.1);
            text.push_str(&format!(
                "    peak, {kind:<10}{:>12} N at {} s{}\n",
                short(peak),
                short(time),
                coefficient(peak)
            ));
            if kind == "raw" {
                text.push_str(&format!("    mean            {:>12} N{}\n", short(mean), coefficient(mean)));
                let impulse = record.integral(window.0, window.1);
                text.push_str(&format!("    impulse         {:>12} N s\n", short(impulse)));
            }
        }
    }
    text
}

/// The record, raw and filtered.
fn figure(
    results: &Results,
    structure: &str,
    name: &str,
    (raw, filtered, cutoff): (&Record, &Record, f64),
) -> LineFigure {
    let curve = |name: String, record: &Record| Curve {
        name,
        points: (0..record.values.len()).map(|k| [record.time(k), record.values[k]]).collect(),
        ..Curve::default()
    };
    let curves = vec![curve("raw".to_owned(), raw), curve(format!("below {} Hz", short(cutoff)), filtered)];
    let axis = labelled(&format!("{}: {name} force", structure.replace('_', " ")), "N");
    LineFigure {
        title: results.facts.title.clone(),
        axes: ["time (s)".to_owned(), axis],
        curves,
        ..LineFigure::default()
    }
}
