//! Figures of a study that show particles: those of its last run that is done.

use super::plot::{fields, profiles};
use super::view_args::Look;
use crate::error::UserError;
use crate::results::Results;
use crate::study::{FigureSpec, Place, Plan, Row, write_figure};

/// Writes fields and profiles as PNG and SVG into the folder of the study. Returns numbers of figures and names of
/// their PNG files.
pub(super) fn write(plan: &Plan, rows: &[Row], place: &Place) -> Result<Vec<(usize, String)>, UserError> {
    let mut names = Vec::new();
    let Some(last) = rows.iter().rposition(|row| matches!(row, Row::Done(..))) else { return Ok(names) };
    let wanted = plan.study.figures.iter().enumerate();
    let wanted: Vec<_> =
        wanted.filter(|(_, figure)| matches!(figure, FigureSpec::Field { .. } | FigureSpec::Profile { .. })).collect();
    if wanted.is_empty() {
        return Ok(names);
    }
    let results = Results::open(&place.log(plan, last)).map_err(|error| UserError::plain(error.to_string()))?;
    for (k, figure) in wanted {
        match figure {
            FigureSpec::Field { of, at, arrows } => {
                let look = Look { arrows: *arrows, range: None, view: None };
                let drawn = fields::figure(&results, &fields::scenes(&results, at)?, of, look)?;
                names.push((k, write_figure(k, of, &drawn, &place.folder)?));
            }
            FigureSpec::Profile { of, at, beside } => {
                let mut drawn = profiles::figure(&results, of, at)?;
                drawn.curves.extend(beside.iter().map(|beside| beside.curve(false)));
                names.push((k, write_figure(k, of, &drawn, &place.folder)?));
            }
            _ => {}
        }
    }
    Ok(names)
}
