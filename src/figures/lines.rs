//! Curves: series over time, profiles over a coordinate, results beside references.

use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::{Axes, BOTTOM, LEFT, TOP, write, write_title};
use super::style::{COLOURS, CURVE, LETTER, WIDTH, colour};
use super::{DrawResult, Figure, words};

/// How the points of a curve are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Marks {
    /// Joined by a line.
    #[default]
    Line,
    /// Joined by a dashed line.
    Dashes,
    /// Joined by a line, each with a dot: a number of each of some runs.
    Dots,
    /// Each as a ring: measurements.
    Rings,
}

/// One curve.
#[derive(Debug, Clone, Default)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Its points; where one is NaN, the line is broken.
    pub points: Vec<[f64; 2]>,
    /// How they are drawn.
    pub marks: Marks,
}

/// Curves over one pair of axes.
#[derive(Debug, Clone, Default)]
pub struct LineFigure {
    /// What stands above; may be empty.
    pub title: String,
    /// Names of the axes, such as `time (s)`.
    pub axes: [String; 2],
    /// Curves, in the order of their colours.
    pub curves: Vec<Curve>,
    /// What stands below the names of the curves: numbers that judge them.
    pub notes: Vec<String>,
    /// Least and greatest value that the vertical axis shows; `None` for those of the curves.
    pub range: Option<(f64, f64)>,
}

/// Height (pixels) of the axes.
const HEIGHT: i32 = 800;
/// Pixels to the right of the axes.
const RIGHT: i32 = 40;
/// Pixels between lines of text.
const LINE: i32 = 38;
/// Part of the height that stays free above and below the curves.
const MARGIN: f64 = 0.06;
/// Radius (pixels) of dots.
const DOT: i32 = 8;
/// Length (pixels) of dashes, and between them.
const DASH: (i32, i32) = (18, 12);

impl LineFigure {
    fn bounds(&self) -> [(f64, f64); 2] {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let ends = |axis: usize| {
            let values = points().map(|point| point[axis]).filter(|value| value.is_finite());
            let (least, greatest) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), v| (v.min(least), v.max(greatest)));
            match greatest - least {
                span if span > 0.0 => (least, greatest),
                // One value only, or none.
                0.0 => (least - 0.5 * least.abs().max(1e-9), least + 0.5 * least.abs().max(1e-9)),
                _ => (0.0, 1.0),
            }
        };
        let (least, greatest) = ends(1);
        let margin = MARGIN * (greatest - least);
        [ends(0), self.range.unwrap_or((least - margin, greatest + margin))]
    }

    fn draw_curve<DB: DrawingBackend>(&self, k: usize, axes: &Axes, area: &DrawingArea<DB, Shift>) -> DrawResult {
        let (curve, style) = (&self.curves[k], colour(k).stroke_width(CURVE));
        if curve.marks == Marks::Rings {
            for point in curve.points.iter().filter(|point| axes.holds(**point)) {
                area.draw(&Circle::new(axes.pixel(*point), 7, BLACK.stroke_width(2))).map_err(words)?;
            }
            return Ok(());
        }
        for part in curve.points.split(|point| !axes.holds(*point)).filter(|part| !part.is_empty()) {
            let pixels = part.iter().map(|point| axes.pixel(*point));
            draw_line(area, pixels, is_dashed(k, curve), style)?;
        }
        if curve.marks == Marks::Dots {
            for point in curve.points.iter().filter(|point| axes.holds(**point)) {
                area.draw(&Circle::new(axes.pixel(*point), DOT, colour(k).filled())).map_err(words)?;
            }
        }
        Ok(())
    }

    fn draw_names<DB: DrawingBackend>(&self, axes: &Axes, area: &DrawingArea<DB, Shift>) -> DrawResult {
        let [left, top, width, _] = axes.rectangle;
        let x = left + width + RIGHT;
        for (k, curve) in self.curves.iter().enumerate() {
            let y = top + 22 + LINE * k as i32;
            if curve.marks == Marks::Rings {
                area.draw(&Circle::new((x + 24, y), 7, BLACK.stroke_width(2))).map_err(words)?;
            } else {
                draw_line(area, [(x, y), (x + 48, y)].into_iter(), is_dashed(k, curve), colour(k).stroke_width(CURVE))?;
            }
            write(area, &curve.name, (x + 62, y), (HPos::Left, VPos::Center))?;
        }
        for (k, note) in self.notes.iter().enumerate() {
            let y = top + 22 + LINE * (self.curves.len() + k) as i32 + LINE / 2;
            write(area, note, (x, y), (HPos::Left, VPos::Center))?;
        }
        Ok(())
    }

    /// Pixels that the longest name takes; nothing is named if there is one curve without a name.
    fn names(&self) -> i32 {
        let curves = self.curves.iter().map(|curve| curve.name.chars().count() as i32 * LETTER + 62);
        let notes = self.notes.iter().map(|note| note.chars().count() as i32 * LETTER);
        let is_named = self.curves.iter().any(|curve| !curve.name.is_empty()) || !self.notes.is_empty();
        if is_named { curves.chain(notes).max().unwrap_or(0) + RIGHT } else { 0 }
    }
}

impl Figure for LineFigure {
    fn size(&self) -> (u32, u32) {
        // Names of many curves need more height than the axes.
        let lines = (self.curves.len() + self.notes.len() + 2) as i32 * LINE;
        let height = if self.names() > 0 { (TOP + lines).max(TOP + HEIGHT + BOTTOM) } else { TOP + HEIGHT + BOTTOM };
        (WIDTH + self.names().max(0) as u32, height as u32)
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> DrawResult {
        let [x, y] = self.bounds();
        let axes = Axes { rectangle: [LEFT, TOP, WIDTH as i32 - LEFT - RIGHT, HEIGHT], x, y };
        write_title(area, &self.title, LEFT + axes.rectangle[2] / 2)?;
        axes.draw(area, Some(&self.axes[0]), &self.axes[1], true)?;
        for k in 0..self.curves.len() {
            self.draw_curve(k, &axes, area)?;
        }
        if self.names() > 0 { self.draw_names(&axes, area) } else { Ok(()) }
    }
}

/// Whether the line of curve number `k` is dashed: it is where colours come again, too.
fn is_dashed(k: usize, curve: &Curve) -> bool {
    curve.marks == Marks::Dashes || k >= COLOURS.len()
}

/// Joins pixels by a line, dashed if it shall be.
fn draw_line<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    pixels: impl Iterator<Item = (i32, i32)> + Clone,
    is_dashed: bool,
    style: ShapeStyle,
) -> DrawResult {
    if is_dashed {
        area.draw(&DashedPathElement::new(pixels, DASH.0, DASH.1, style)).map_err(words)
    } else {
        // Piece by piece: where a thick line turns back, its joint would be a spike far beyond the axes.
        let pixels: Vec<_> = pixels.collect();
        pixels.windows(2).try_for_each(|piece| area.draw(&PathElement::new(piece.to_vec(), style)).map_err(words))
    }
}

#[cfg(test)]
mod tests {
    use super::super::style::register_fonts;
    use super::*;

    /// The eighth curve has the colour of the first, and is told from it by its dashes, with dots or without.
    #[test]
    fn curves_with_one_colour_differ() {
        for marks in [Marks::Line, Marks::Dots] {
            let curve = |k: i32| Curve { name: k.to_string(), points: vec![[0.0, f64::from(k)], [1.0, 9.0]], marks };
            let figure = LineFigure { curves: (0..8).map(curve).collect(), ..LineFigure::default() };
            let mut drawn = String::new();
            register_fonts();
            crate::figures::drawn(&figure, SVGBackend::with_string(&mut drawn, figure.size())).expect("it is drawn");
            let of = |colour: &str| {
                drawn.lines().filter(|line| line.starts_with("<polyline") && line.contains(colour)).count()
            };
            // The line and that beside its name; dashes are lines of their own.
            assert_eq!(of("#D55E00"), 2, "{marks:?}");
            assert!(of("#0072B2") > 6, "{marks:?}: {}", of("#0072B2"));
        }
    }
}
