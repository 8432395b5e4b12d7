//! Series over time.

use super::reference::Reference;
use super::{Out, unknown};
use crate::error::UserError;
use crate::figures::{Curve, LineFigure, labelled};
use crate::results::{Results, SeriesField, TimeSeries};

/// Draws the series called `wanted`: `<name>`, all its quantities, or `<name>.<field>`, one of them.
pub(super) fn draw(
    results: &Results,
    wanted: &str,
    reference: Option<&Reference>,
    points: Option<usize>,
    out: &Out,
) -> Result<(), UserError> {
    let (name, field) = wanted.split_once('.').map_or((wanted, None), |(name, field)| (name, Some(field)));
    let series = results.series.iter().find(|series| series.topic == name || series.name() == name);
    let names = results.series.iter().map(TimeSeries::name);
    let series = series.ok_or_else(|| unknown("series", name, names))?;
    let Some(field) = field else {
        if reference.is_some() && series.fields.len() > 1 {
            return Err(UserError::plain(format!(
                "`{name}` has several quantities: say which, as {name}.{}",
                series.fields[0].name
            )));
        }
        return draw_series(results, series, reference, points, out);
    };
    let fields = series.fields.iter().map(|field| field.name.as_str());
    let field = series.field(field).ok_or_else(|| unknown("quantity", field, fields))?;
    draw_fields(results, series, &[field], reference, points, out)
}

/// Draws every series.
pub(super) fn draw_all(results: &Results, out: &Out) -> Result<(), UserError> {
    results.series.iter().try_for_each(|series| draw_series(results, series, None, None, out))
}

/// One figure for all quantities of a unit.
fn draw_series(
    results: &Results,
    series: &TimeSeries,
    reference: Option<&Reference>,
    points: Option<usize>,
    out: &Out,
) -> Result<(), UserError> {
    let mut units: Vec<&str> = series.fields.iter().map(|field| field.unit.as_str()).collect();
    units.sort_unstable();
    units.dedup();
    for unit in units {
        let fields: Vec<&SeriesField> = series.fields.iter().filter(|field| field.unit == unit).collect();
        draw_fields(results, series, &fields, reference, points, out)?;
    }
    Ok(())
}

fn draw_fields(
    results: &Results,
    series: &TimeSeries,
    fields: &[&SeriesField],
    reference: Option<&Reference>,
    points: Option<usize>,
    out: &Out,
) -> Result<(), UserError> {
    let [first, ..] = fields else { return Ok(()) };
    let curve = |field: &&SeriesField| Curve {
        name: field.name.replace('_', " "),
        points: series.times.iter().zip(&field.values).map(|(time, value)| [*time, *value]).collect(),
        ..Curve::default()
    };
    let is_one = fields.len() == 1;
    let name = series.name().replace('_', " ");
    let axis =
        if is_one { labelled(&format!("{name}: {}", first.name), &first.unit) } else { labelled(&name, &first.unit) };
    let mut figure = LineFigure {
        title: results.facts.title.clone(),
        axes: ["time (s)".to_owned(), axis],
        curves: fields.iter().map(curve).collect(),
        ..LineFigure::default()
    };
    if is_one && reference.is_none() {
        figure.curves[0].name.clear();
    }
    if let Some(reference) = reference {
        reference.add_to(&mut figure, points)?;
    }
    out.write(&format!("{}_{}", series.name(), first.name), &figure)
}
