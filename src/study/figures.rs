//! The figures of a study.

use std::path::Path;

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde::{Deserialize, Serialize};

use super::document::FigureSpec;
use super::names::safe;
use super::{Drawn, Plan, PlannedRun, Row, Source, escaped};
use crate::error::UserError;
use crate::figures::{Curve, Figure, LineFigure, Marks, labelled, save};
use crate::number::short;

/// Formats of figures, by the endings of their files.
const FORMATS: [&str; 2] = ["png", "svg"];

/// A figure of a study.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FigureFile {
    /// Its number among the figures of the study, from 1.
    pub number: usize,
    /// Name of the PNG file.
    pub file: String,
    /// What it shows.
    pub caption: String,
}

/// `figures`, files in `folder`, in Markdown, with what they show below them.
#[must_use]
pub fn figure_lines(folder: &str, figures: &[FigureFile]) -> String {
    let line = |FigureFile { number, file, caption }: &FigureFile| {
        let path = format!("{folder}{file}");
        let (link, caption) = (utf8_percent_encode(&path, PLAIN), escaped(caption));
        format!("\n![Figure {number}: {caption}]({link})\n\n*Figure {number}: {caption}.*\n")
    };
    figures.iter().map(line).collect()
}

/// What stands in a link of Markdown as it is: blanks and brackets would end it.
const PLAIN: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'/')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~')
    .remove(b'=')
    .remove(b',')
    .remove(b'+')
    .remove(b'-');

/// Draws the figures of a study into `folder`, as PNG and SVG, as far as its runs are done. Returns numbers of
/// figures and names of their PNG files.
///
/// # Errors
/// A file cannot be written.
pub fn write_figures(plan: &Plan, rows: &[Row], folder: &Path) -> Result<Vec<(usize, String)>, UserError> {
    let mut names = Vec::new();
    for (k, spec) in plan.study.figures.iter().enumerate() {
        let (name, mut figure) = match (spec, &plan.drawn[k]) {
            (FigureSpec::Measure { of, over, by, logarithmic, .. }, _) => {
                let mut figure = measure(plan, rows, of, over, by.as_deref());
                figure.is_log = *logarithmic;
                if figure.is_log {
                    let has_place = |point: &[f64; 2]| point.iter().all(|value| *value > 0.0);
                    figure.curves.iter_mut().for_each(|curve| curve.points.retain(has_place));
                }
                (format!("{of} over {}", label(plan, over)), figure)
            }
            (FigureSpec::Series { of, name, .. }, Drawn::Series(source)) => {
                (of.clone(), curves(plan, rows, k, axes_of(name.as_deref(), of, source)))
            }
            (FigureSpec::Surface { of, at }, _) => {
                let axes = ["x (m)".to_owned(), format!("surface of {of} at {} s (m)", short(*at))];
                (format!("surface of {of}"), curves(plan, rows, k, axes))
            }
            (FigureSpec::Series { .. } | FigureSpec::Field { .. } | FigureSpec::Profile { .. }, _) => continue,
        };
        if figure.curves.iter().all(|curve| curve.points.is_empty()) {
            continue;
        }
        let usually_line = matches!(spec, FigureSpec::Measure { .. });
        if let (FigureSpec::Measure { of, .. }, [_, ..]) = (spec, spec.beside()) {
            // A curve that is alone needs no name until something stands beside it.
            figure.curves.iter_mut().filter(|curve| curve.name.is_empty()).for_each(|curve| curve.name.clone_from(of));
        }
        figure.curves.extend(spec.beside().iter().map(|beside| beside.curve(usually_line)));
        if let FigureSpec::Series { window: Some((from, to)), .. } = spec {
            let is_shown = |point: &[f64; 2]| (*from..=*to).contains(&point[0]);
            figure.curves.iter_mut().for_each(|curve| curve.points.retain(is_shown));
        }
        names.push((k, write_figure(k, &name, &figure, folder)?));
    }
    Ok(names)
}

/// Writes figure `k` of a study, which shows what `name` says, into `folder`. Returns the name of the PNG file.
///
/// # Errors
/// A file cannot be written.
pub fn write_figure(k: usize, name: &str, figure: &impl Figure, folder: &Path) -> Result<String, UserError> {
    let name = format!("figure_{}_{}", k + 1, safe(&name.replace(' ', "_")));
    for format in FORMATS {
        let path = folder.join(&name).with_added_extension(format);
        save(figure, &path).map_err(|what| UserError::plain(format!("cannot write {}: {what}", path.display())))?;
    }
    Ok(format!("{name}.{}", FORMATS[0]))
}

/// What figure `k` of a study shows, in words.
#[must_use]
pub fn caption(plan: &Plan, k: usize) -> String {
    let below = |cutoff: &Option<f64>| cutoff.map_or(String::new(), |cutoff| format!(" below {} Hz", short(cutoff)));
    let at = |times: &[f64]| times.iter().map(|time| short(*time)).collect::<Vec<_>>().join(", ");
    let surface = |of: &str| of.strip_prefix("surface:").map(|phase| format!("upper surface of {phase}"));
    match &plan.study.figures[k] {
        FigureSpec::Measure { of, over, .. } => {
            let varied = plan.varied.iter().find(|varied| varied.path == *over).map(|varied| &varied.shown);
            format!("{of} over {}", varied.filter(|shown| !shown.is_empty()).unwrap_or(over))
        }
        FigureSpec::Series { of, name, cutoff, .. } => {
            format!("{}{} over time", name.as_ref().unwrap_or(of), below(cutoff))
        }
        FigureSpec::Surface { of, at } => format!("upper surface of {of} at {} s", short(*at)),
        FigureSpec::Field { of, at: times, arrows, .. } => {
            format!("{of}{} at {} s", if *arrows { " and mean velocities" } else { "" }, at(times))
        }
        FigureSpec::Profile { of, at: times, .. } => {
            format!("{} at {} s", surface(of).unwrap_or_else(|| of.replace(':', " along ")), at(times))
        }
    }
}

/// A measure over a varied value.
fn measure(plan: &Plan, rows: &[Row], of: &str, over: &str, by: Option<&[String]>) -> LineFigure {
    let place = |path: &str| plan.varied.iter().position(|varied| varied.path == path);
    let measure = |name: &str| plan.study.measures.iter().position(|measure| measure.name == name);
    let Some(m) = measure(of) else { return LineFigure::default() };
    let (along, of_measure) = (place(over), measure(over));
    let others = (0..plan.varied.len()).filter(|k| Some(*k) != along && of_measure.is_none() && plan.study.is_grid);
    let by: Vec<usize> = by.map_or(others.collect(), |by| by.iter().filter_map(|path| place(path)).collect());
    let mut curves: Vec<(Vec<&str>, Curve)> = Vec::new();
    for (run, row) in plan.runs.iter().zip(rows) {
        let x = along.map_or_else(|| row.measure(of_measure?), |along| run.number(along));
        let (Some(x), Some(y)) = (x, row.measure(m)) else { continue };
        // Two curves may have one name, if what tells them apart is not shown.
        let key: Vec<&str> = by.iter().map(|k| run.values[*k].as_str()).collect();
        match curves.iter_mut().find(|(known, _)| *known == key) {
            Some((_, curve)) => curve.points.push([x, y]),
            None => {
                let curve = Curve { name: name(plan, run, &by), points: vec![[x, y]], marks: Marks::Dots };
                curves.push((key, curve));
            }
        }
    }
    let mut curves: Vec<Curve> = curves.into_iter().map(|(_, curve)| curve).collect();
    curves.iter_mut().for_each(|curve| curve.points.sort_by(|a, b| a[0].total_cmp(&b[0])));
    let unit = |m: usize| &plan.measures[m].unit;
    let horizontal = match (along, of_measure) {
        (Some(k), _) => labelled(&plan.varied[k].shown, &plan.varied[k].unit),
        (None, Some(other)) => labelled(over, unit(other)),
        (None, None) => String::new(),
    };
    let axes = [horizontal, labelled(of, unit(m))];
    LineFigure { title: plan.study.title.clone(), axes, curves, ..LineFigure::default() }
}

/// The short name of a varied value; that of a measure as it is.
fn label<'a>(plan: &'a Plan, path: &'a str) -> &'a str {
    plan.varied.iter().find(|varied| varied.path == path).map_or(path, |varied| &varied.label)
}

/// Figure `k` with a curve a run.
fn curves(plan: &Plan, rows: &[Row], k: usize, axes: [String; 2]) -> LineFigure {
    let curve = |(run, row): (usize, &Row)| match row {
        Row::Done(_, _, curves) => {
            let points = curves.get(k)?.as_ref().ok()?.clone();
            Some(Curve { name: run_name(plan, run), points, ..Curve::default() })
        }
        _ => None,
    };
    let curves = rows.iter().enumerate().filter_map(curve).collect();
    LineFigure { title: plan.study.title.clone(), axes, curves, ..LineFigure::default() }
}

/// What tells run number `k` of a study from others, as people are shown it.
#[must_use]
pub fn run_name(plan: &Plan, k: usize) -> String {
    let (run, all): (_, Vec<usize>) = (&plan.runs[k], (0..plan.varied.len()).collect());
    let shown = name(plan, run, &all);
    let names = [&run.label, &shown, &run.name];
    names.into_iter().find(|name| !name.is_empty()).cloned().unwrap_or_default()
}

/// The axes of a number over time.
fn axes_of(name: Option<&str>, of: &str, source: &Source) -> [String; 2] {
    let series_and_field = || of.rsplit_once('.').map_or(of.to_owned(), |(series, field)| format!("{series}: {field}"));
    let name = name.map_or_else(series_and_field, str::to_owned);
    let name = source.cutoff.map_or(name.clone(), |cutoff| format!("{name} below {} Hz", short(cutoff)));
    ["time (s)".to_owned(), labelled(&name, &source.unit)]
}

/// What tells a curve from others: the varied values `by` of its runs.
fn name(plan: &Plan, run: &PlannedRun, by: &[usize]) -> String {
    let part = |k: &usize| {
        let (varied, value) = (&plan.varied[*k], run.shown(*k));
        format!("{} = {value} {}", varied.shown, varied.unit).trim_end().to_owned()
    };
    by.iter().filter(|k| !plan.varied[**k].shown.is_empty()).map(part).collect::<Vec<_>>().join(", ")
}
