//! Profiles along a line, and surfaces of phases.

use super::super::view_args::PlotArgs;
use super::fields::values;
use super::reference::Reference;
use super::{Out, numbers, unknown};
use crate::error::UserError;
use crate::figures::{Curve, LineFigure, labelled};
use crate::number::short;
use crate::results::{Frame, PARTICLES, Results, line_profile, upper_surface};

const AXES: [&str; 3] = ["x", "y", "z"];

/// What a profile shows.
enum Profile<'a> {
    /// The upper surface of the phase with this number.
    Surface(usize),
    /// A quantity along a line, and the axis and coordinate (m) that are fixed.
    Line(&'a str, usize, f64),
}

/// Draws a profile at every wanted time.
pub(super) fn draw(
    results: &Results,
    args: &PlotArgs,
    wanted: &str,
    reference: Option<&Reference>,
    out: &Out,
) -> Result<(), UserError> {
    let mut figure = figure(results, wanted, &args.at)?;
    if let Some(reference) = reference {
        reference.add_to(&mut figure, args.points)?;
    }
    out.write(wanted, &figure)
}

/// The figure of `surface:<phase>`, or `<field>:<axis>=<coordinate>`, at `times` (s).
pub(in crate::cli) fn figure(results: &Results, wanted: &str, times: &[f64]) -> Result<LineFigure, UserError> {
    let profile = parse(results, wanted)?;
    let facts = &results.facts;
    let mut figure = LineFigure { title: facts.title.clone(), ..LineFigure::default() };
    for number in numbers(results, PARTICLES, times)? {
        let frame = results.frame(PARTICLES, number).map_err(|error| UserError::plain(error.to_string()))?;
        let Some(frame) = frame else { continue };
        let (axes, points) = match &profile {
            Profile::Surface(phase) => (
                ["x (m)".to_owned(), format!("surface of {} (m)", facts.phases[*phase])],
                upper_surface(&frame, *phase, facts.up, facts.spacing),
            ),
            Profile::Line(field, fixed, at) => line(&frame, field, (*fixed, *at), facts.up, facts.spacing)?,
        };
        figure.axes = axes;
        figure.curves.push(Curve { name: format!("t = {} s", short(frame.time)), points, ..Curve::default() });
    }
    Ok(figure)
}

fn parse<'a>(results: &Results, wanted: &'a str) -> Result<Profile<'a>, UserError> {
    let wrong = || {
        UserError::plain(format!("--profile {wanted} is not understood"))
            .help("expected surface:<phase>, or <field>:<axis>=<coordinate in m>, such as pressure:x=0.2")
    };
    let (what, place) = wanted.split_once(':').ok_or_else(wrong)?;
    if what == "surface" {
        let phases = &results.facts.phases;
        let phase = phases.iter().position(|phase| phase == place);
        return phase.map(Profile::Surface).ok_or_else(|| unknown("phase", place, phases.iter().map(String::as_str)));
    }
    let (axis, at) = place.split_once('=').ok_or_else(wrong)?;
    let axis = AXES.iter().position(|name| *name == axis).ok_or_else(wrong)?;
    let at = at.parse().ok().filter(|at: &f64| at.is_finite()).ok_or_else(wrong)?;
    Ok(Profile::Line(what, axis, at))
}

/// Names of the axes and points of a quantity along a line: upwards, or along x where the height is fixed.
fn line(
    frame: &Frame,
    field: &str,
    (fixed, at): (usize, f64),
    up: usize,
    spacing: f64,
) -> Result<([String; 2], Vec<[f64; 2]>), UserError> {
    let along = if fixed == up { 0 } else { up };
    let (values, unit) = values(frame, field)?;
    let axes = [format!("{} (m) at {} = {} m", AXES[along], AXES[fixed], short(at)), labelled(field, &unit)];
    Ok((axes, line_profile(frame, &values, (fixed, at), along, spacing)))
}
