//! Figures that one would print: particles coloured by a quantity, and curves; PNG and SVG, by the name of the file.

mod axes;
mod colours;
mod field;
mod lines;
mod style;
mod ticks;

pub use colours::ColourMap;
pub use field::{Arrows, FieldFigure, Paint, Panel};
pub use lines::{Curve, LineFigure, Marks};
pub use style::labelled;

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

/// What goes wrong while something is drawn, in words.
pub type DrawResult = Result<(), String>;

/// Something that can be drawn on any backend.
pub trait Figure {
    /// Width and height (pixels).
    fn size(&self) -> (u32, u32);

    /// Draws it.
    ///
    /// # Errors
    /// What the backend says.
    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> DrawResult;
}

/// Writes a figure to `path`: SVG if the name ends so, else PNG.
///
/// # Errors
/// The file cannot be written.
pub fn save(figure: &impl Figure, path: &Path) -> DrawResult {
    style::register_fonts();
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg")) {
        drawn(figure, SVGBackend::new(path, figure.size()))
    } else {
        drawn(figure, BitMapBackend::new(path, figure.size()))
    }
}

/// The pixels of a figure, three bytes each: red, green, blue.
///
/// # Errors
/// It cannot be drawn.
pub fn pixels(figure: &impl Figure) -> Result<Vec<u8>, String> {
    style::register_fonts();
    let (width, height) = figure.size();
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    drawn(figure, BitMapBackend::with_buffer(&mut pixels, (width, height)))?;
    Ok(pixels)
}

fn drawn<DB: DrawingBackend>(figure: &impl Figure, backend: DB) -> DrawResult {
    let area = backend.into_drawing_area();
    area.fill(&WHITE).map_err(words)?;
    figure.draw(&area)?;
    area.present().map_err(words)
}

fn words(error: impl std::fmt::Display) -> String {
    error.to_string()
}
