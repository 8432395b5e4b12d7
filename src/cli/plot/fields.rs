//! Particles, coloured by a quantity.

use super::super::view_args::{Look, PlotArgs, View};
use super::{Out, numbers, unknown};
use crate::error::UserError;
use crate::figures::{Arrows, ColourMap, FieldFigure, Paint, Panel, labelled};
use crate::number::short;
use crate::results::{Frame, PARTICLES, Results};

/// Quantities that are drawn if nothing else is asked for.
pub(super) fn usual(results: &Results) -> Vec<String> {
    let phase = (results.facts.phases.len() > 1).then_some("phase");
    ["pressure", "speed"].into_iter().chain(phase).map(str::to_owned).collect()
}

/// Draws each of the `fields`, all wanted times in one figure.
pub(super) fn draw(results: &Results, args: &PlotArgs, fields: &[String], out: &Out) -> Result<(), UserError> {
    if fields.is_empty() {
        return Ok(());
    }
    let scenes = scenes(results, &args.at)?;
    for field in fields {
        let figure = figure(results, &scenes, field, args.look)?;
        out.write(field, &figure)?;
    }
    Ok(())
}

/// The particles of one time: those of the fluid, and those of walls and structures.
pub(in crate::cli) struct Snapshot {
    pub fluid: Frame,
    pub bodies: Vec<Frame>,
}

pub(in crate::cli) fn scenes(results: &Results, times: &[f64]) -> Result<Vec<Snapshot>, UserError> {
    let numbers = numbers(results, PARTICLES, times)?;
    let unreadable = |error: crate::log::LogError| UserError::plain(error.to_string());
    let mut scenes = Vec::new();
    for number in numbers {
        if let Some(fluid) = results.frame(PARTICLES, number).map_err(unreadable)? {
            let bodies = results.bodies_at(fluid.time).map_err(unreadable)?;
            scenes.push(Snapshot { fluid, bodies });
        }
    }
    Ok(scenes)
}

/// Values and unit of a quantity: a field of the log, or `speed`.
pub(super) fn values(frame: &Frame, name: &str) -> Result<(Vec<f64>, String), UserError> {
    if name == "speed" {
        return Ok((frame.speeds(), "m/s".to_owned()));
    }
    let known = frame.fields.iter().map(|field| field.name.as_str()).chain(["speed"]);
    let field = frame.field(name).ok_or_else(|| unknown("field", name, known))?;
    Ok((field.values.clone(), field.unit.clone()))
}

/// The figure of a quantity.
pub(in crate::cli) fn figure(
    results: &Results,
    scenes: &[Snapshot],
    name: &str,
    look: Look,
) -> Result<FieldFigure, UserError> {
    let facts = &results.facts;
    let view = look.view.unwrap_or(if facts.up == 1 { View::Xy } else { View::Xz });
    let is_log = name == "viscosity";
    let mut panels = Vec::new();
    let mut unit = String::new();
    for Snapshot { fluid, bodies } in scenes {
        let (mut values, of_field) = values(fluid, name)?;
        unit = of_field;
        if is_log {
            values.iter_mut().for_each(|value| *value = value.log10());
        }
        let order = view.behind_first(fluid);
        let places: Vec<[f64; 3]> = fluid.positions().collect();
        let flat = |frame: &Frame| frame.positions().map(|x| view.flat(x)).collect::<Vec<_>>();
        panels.push(Panel {
            label: format!("t = {} s", short(fluid.time)),
            places: order.iter().map(|k| view.flat(places[*k])).collect(),
            values: order.iter().map(|k| values[*k]).collect(),
            bodies: bodies.iter().flat_map(flat).collect(),
            arrows: if look.arrows { arrows(fluid, view, bounds(scenes, view, facts.spacing)) } else { Vec::new() },
            spacing: facts.spacing,
        });
    }
    let bounds = bounds(scenes, view, facts.spacing);
    let label = if is_log { labelled("log₁₀ viscosity", "Pa s") } else { labelled(name, &unit) };
    Ok(FieldFigure {
        title: facts.title.clone(),
        paint: if name == "phase" {
            Paint::Names(facts.phases.clone())
        } else {
            scale(&panels, label, name, look.range)
        },
        arrows: look.arrows.then(|| measure(&panels, bounds)),
        panels,
        axes: view.axes().map(|axis| format!("{axis} (m)")),
        bounds,
    })
}

/// Part of the values beyond each end of a scale: single particles shall not darken a figure.
const OUTLIERS: f64 = 0.002;

/// The scale of a quantity: what it is given, else from its least to its greatest value but for outliers.
fn scale(panels: &[Panel], label: String, name: &str, range: Option<(f64, f64)>) -> Paint {
    let mut values: Vec<f64> =
        panels.iter().flat_map(|panel| &panel.values).copied().filter(|v| v.is_finite()).collect();
    values.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| values.get(((values.len().max(1) - 1) as f64 * share) as usize).copied().unwrap_or(0.0);
    let (mut least, mut greatest) = range.unwrap_or((at(OUTLIERS), at(1.0 - OUTLIERS)));
    let has_sign = matches!(name, "vx" | "vy" | "vz");
    if range.is_none() && has_sign {
        greatest = greatest.max(-least);
        least = -greatest;
    } else if range.is_none() && name == "speed" {
        least = 0.0;
    }
    if greatest <= least {
        greatest = least + least.abs().max(1e-12);
    }
    let colours = if has_sign { ColourMap::Diverging } else { ColourMap::Sequential };
    Paint::Scale { label, range: (least, greatest), colours }
}

/// Spacings of bodies that are shown around the fluid.
const RIM: f64 = 4.8;

/// Bodies are shown whole along an axis unless they make the picture so many times as long.
const MOST_STRETCH: f64 = 1.6;

/// What is shown: the fluid of all times and a rim, and bodies where they are not much longer.
fn bounds(scenes: &[Snapshot], view: View, spacing: f64) -> [(f64, f64); 2] {
    let fluid = extent(scenes.iter().map(|scene| &scene.fluid), view, spacing);
    let bodies = extent(scenes.iter().flat_map(|scene| &scene.bodies), view, 0.0);
    std::array::from_fn(|axis| {
        let ((least, greatest), (low, high)) = (fluid[axis], bodies[axis]);
        let both = (least.min(low), greatest.max(high));
        if both.1 - both.0 <= MOST_STRETCH * (greatest - least) { both } else { fluid[axis] }
    })
}

/// Where the particles of `frames` are, and a rim where there are any.
fn extent<'a>(frames: impl Iterator<Item = &'a Frame>, view: View, spacing: f64) -> [(f64, f64); 2] {
    let mut bounds = [(f64::INFINITY, f64::NEG_INFINITY); 2];
    for place in frames.flat_map(Frame::positions) {
        for (bound, x) in bounds.iter_mut().zip(view.flat(place)).filter(|(_, x)| x.is_finite()) {
            *bound = (bound.0.min(x), bound.1.max(x));
        }
    }
    bounds.map(|(least, greatest)| (least - RIM * spacing, greatest + RIM * spacing))
}

/// Arrows along the longer side of the picture.
const ARROWS: f64 = 36.0;

/// Mean velocities of the particles in each square of a grid, at their mean place: an arrow beside the fluid would say that something flows there.
fn arrows(frame: &Frame, view: View, bounds: [(f64, f64); 2]) -> Vec<([f64; 2], [f64; 2])> {
    let edge = bounds.iter().map(|(least, greatest)| greatest - least).fold(0.0, f64::max) / ARROWS;
    let mut squares = std::collections::BTreeMap::new();
    for (x, v) in frame.positions().zip(frame.velocities()) {
        let (x, v) = (view.flat(x), view.flat(v));
        let square = x.map(|x| (x / edge).floor() as i64);
        let (count, places, velocities) = squares.entry(square).or_insert((0.0, [0.0; 2], [0.0; 2]));
        *count += 1.0;
        *places = [places[0] + x[0], places[1] + x[1]];
        *velocities = [velocities[0] + v[0], velocities[1] + v[1]];
    }
    let mean = |count: f64, sum: [f64; 2]| sum.map(|sum| sum / count);
    squares.into_values().map(|(count, places, velocities)| (mean(count, places), mean(count, velocities))).collect()
}

/// Part of the arrows that may be longer than the measure: a few drops that fall shall not make dots of all others.
const LONG: f64 = 0.02;

/// The measure of arrows: a round speed near the greatest but for a few, as long as two squares of the grid.
fn measure(panels: &[Panel], bounds: [(f64, f64); 2]) -> Arrows {
    let edge = bounds.iter().map(|(least, greatest)| greatest - least).fold(0.0, f64::max) / ARROWS;
    let speeds = panels.iter().flat_map(|panel| &panel.arrows).map(|(_, v)| v[0].hypot(v[1]));
    let mut speeds: Vec<f64> = speeds.filter(|speed| speed.is_finite()).collect();
    speeds.sort_unstable_by(f64::total_cmp);
    let place = (1.0 - LONG) * speeds.len().saturating_sub(1) as f64;
    let greatest = speeds.get(place as usize).copied().unwrap_or(0.0).max(1e-9);
    let power = 10_f64.powf(greatest.log10().floor());
    let round = [5.0, 2.0, 1.0].into_iter().map(|times| times * power).find(|speed| *speed <= greatest);
    let speed = round.unwrap_or(power);
    Arrows { speed, length: 2.0 * edge * speed / greatest }
}
