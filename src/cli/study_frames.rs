//! Figures of a study that show particles: those of its last runs that are done.

use super::plot::{fields, profiles};
use super::view_args::Look;
use crate::error::UserError;
use crate::figures::{FieldFigure, LineFigure};
use crate::results::Results;
use crate::study::{Beside, FigureSpec, Place, Plan, Row, run_name, write_figure};

/// Writes fields and profiles as PNG and SVG into the folder of the study. Returns numbers of figures and names of
/// their PNG files.
pub(super) fn write(plan: &Plan, rows: &[Row], place: &Place) -> Result<Vec<(usize, String)>, UserError> {
    let mut names = Vec::new();
    let done: Vec<usize> = (0..rows.len()).filter(|k| matches!(rows[*k], Row::Done(..))).collect();
    let Some(last) = done.last() else { return Ok(names) };
    for (k, spec) in plan.study.figures.iter().enumerate() {
        match spec {
            FigureSpec::Field { of, at, arrows, runs } => {
                let look = Look { arrows: *arrows, range: None, view: None };
                let drawn = &done[done.len().saturating_sub(runs.get())..];
                let figure = field(plan, place, drawn, of, at, look)?;
                names.push((k, write_figure(k, of, &figure, &place.folder)?));
            }
            FigureSpec::Profile { of, at, beside } => {
                let figure = profile(plan, place, *last, of, at, beside)?;
                names.push((k, write_figure(k, of, &figure, &place.folder)?));
            }
            _ => {}
        }
    }
    Ok(names)
}

/// The log of run number `k`.
fn results(plan: &Plan, place: &Place, k: usize) -> Result<Results, UserError> {
    Results::open(&place.log(plan, k)).map_err(|error| UserError::plain(error.to_string()))
}

/// The field `of` some runs `at` some times, one below the other.
fn field(
    plan: &Plan,
    place: &Place,
    runs: &[usize],
    of: &str,
    at: &[f64],
    look: Look,
) -> Result<FieldFigure, UserError> {
    let of_run = |run: &usize| {
        let results = results(plan, place, *run)?;
        let mut figure = fields::figure(&results, &fields::scenes(&results, at)?, of, look)?;
        if plan.runs.len() > 1 {
            let name = run_name(plan, *run);
            figure.panels.iter_mut().for_each(|panel| panel.label = format!("{name}, {}", panel.label));
        }
        Ok(figure)
    };
    let figures = runs.iter().map(of_run).collect::<Result<Vec<_>, UserError>>()?;
    let together = figures.into_iter().reduce(|mut all, mut figure| {
        all.widen(&figure);
        all.panels.append(&mut figure.panels);
        all
    });
    together.ok_or_else(|| UserError::plain("no run is done"))
}

/// The profile `of` a run `at` some times, and what stands `beside` it.
fn profile(
    plan: &Plan,
    place: &Place,
    run: usize,
    of: &str,
    at: &[f64],
    beside: &[Beside],
) -> Result<LineFigure, UserError> {
    let mut figure = profiles::figure(&results(plan, place, run)?, of, at)?;
    figure.curves.extend(beside.iter().map(|beside| beside.curve(false)));
    if plan.runs.len() > 1 {
        figure.notes.push(run_name(plan, run));
    }
    Ok(figure)
}
