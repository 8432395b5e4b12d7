//! Curves: series over time, profiles over a coordinate, results beside references.

use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::{Axes, BOTTOM, LEFT, TOP, write, write_title};
use super::style::{COLOURS, CURVE, LETTER_IN_WORDS, WIDTH, colour};
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
    /// Whether both axes are logarithmic; what is not greater than 0 is left out then.
    pub is_log: bool,
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
/// Length (pixels) of dashes, and between them, and those of dotted lines.
const DASH: (i32, i32) = (18, 12);
const DOTTED: (i32, i32) = (4, 10);
/// Pixels of a line or ring beside the name of a curve, and between two columns of names.
const SAMPLE: i32 = 62;
const COLUMN: i32 = 40;

impl LineFigure {
    fn bounds(&self) -> [(f64, f64); 2] {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let ends = |axis: usize| {
            let values = points().map(|point| if self.is_log { point[axis].log10() } else { point[axis] });
            let (least, greatest) = values
                .filter(|value| value.is_finite())
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), v| (v.min(least), v.max(greatest)));
            match greatest - least {
                span if span > 0.0 => (least, greatest),
                // One value only, or none.
                0.0 if self.is_log => (least - 0.5, least + 0.5),
                0.0 => (least - 0.5 * least.abs().max(1e-9), least + 0.5 * least.abs().max(1e-9)),
                _ => (0.0, 1.0),
            }
        };
        let with_margin = |(least, greatest): (f64, f64), share: f64| {
            let margin = share * (greatest - least);
            (least - margin, greatest + margin)
        };
        // Dots at the ends would stand over the frame.
        let has_dots = self.curves.iter().any(|curve| curve.marks == Marks::Dots);
        let x = with_margin(ends(0), if has_dots { MARGIN / 2.0 } else { 0.0 });
        let bounds = [x, with_margin(ends(1), MARGIN)];
        let power = |(least, greatest): (f64, f64)| (10_f64.powf(least), 10_f64.powf(greatest));
        let [x, y] = if self.is_log { bounds.map(power) } else { bounds };
        [x, self.range.unwrap_or(y)]
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
            draw_line(area, pixels, dashes(k, curve), style)?;
        }
        if curve.marks == Marks::Dots {
            for point in curve.points.iter().filter(|point| axes.holds(**point)) {
                draw_dot(area, axes.pixel(*point), k)?;
            }
        }
        Ok(())
    }

    fn draw_names<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> DrawResult {
        let (column, rows) = self.names();
        let top = TOP + HEIGHT + BOTTOM + LINE / 2;
        for (k, curve) in self.curves.iter().enumerate().take_while(|_| rows > 0) {
            let (x, y) = (LEFT + column * (k as i32 / rows), top + LINE * (k as i32 % rows));
            if curve.marks == Marks::Rings {
                area.draw(&Circle::new((x + 24, y), 7, BLACK.stroke_width(2))).map_err(words)?;
            } else {
                let style = colour(k).stroke_width(CURVE);
                draw_line(area, [(x, y), (x + 48, y)].into_iter(), dashes(k, curve), style)?;
            }
            if curve.marks == Marks::Dots {
                draw_dot(area, (x + 24, y), k)?;
            }
            write(area, &curve.name, (x + SAMPLE, y), (HPos::Left, VPos::Center))?;
        }
        for (k, note) in self.notes.iter().enumerate() {
            let y = top + LINE * (rows + k as i32);
            write(area, note, (LEFT, y), (HPos::Left, VPos::Center))?;
        }
        Ok(())
    }

    /// Width (pixels) of a column of names below the axes, and how many lines there are; none if there is one curve without a name.
    fn names(&self) -> (i32, i32) {
        if self.curves.iter().all(|curve| curve.name.is_empty()) {
            return (0, 0);
        }
        let letters = self.curves.iter().map(|curve| curve.name.chars().count()).max().unwrap_or(0);
        let column = letters as i32 * LETTER_IN_WORDS + SAMPLE + COLUMN;
        let (columns, count) = (((WIDTH as i32 - LEFT) / column).max(1), self.curves.len() as i32);
        (column, (count + columns - 1) / columns)
    }
}

impl Figure for LineFigure {
    fn size(&self) -> (u32, u32) {
        let ((column, rows), notes) = (self.names(), self.notes.len() as i32);
        let longest = self.notes.iter().map(|note| note.chars().count() as i32 * LETTER_IN_WORDS).max().unwrap_or(0);
        let width = (WIDTH as i32).max(LEFT + column.max(longest));
        (width as u32, (TOP + HEIGHT + BOTTOM + LINE * (rows + notes)) as u32)
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> DrawResult {
        let [x, y] = self.bounds();
        let is_log = self.is_log;
        let axes = Axes { rectangle: [LEFT, TOP, WIDTH as i32 - LEFT - RIGHT, HEIGHT], x, y, is_log };
        write_title(area, &self.title, LEFT + axes.rectangle[2] / 2)?;
        axes.draw(area, Some(&self.axes[0]), &self.axes[1], true)?;
        for k in 0..self.curves.len() {
            self.draw_curve(k, &axes, area)?;
        }
        if self.names().1 > 0 || !self.notes.is_empty() { self.draw_names(area) } else { Ok(()) }
    }
}

/// The dashes of the line of curve number `k`, and what is between them: colours that come again are told apart by them.
fn dashes(k: usize, curve: &Curve) -> Option<(i32, i32)> {
    match k / COLOURS.len() {
        0 if curve.marks != Marks::Dashes => None,
        0 | 1 => Some(DASH),
        _ => Some(DOTTED),
    }
}

/// Joins pixels by a line, dashed if it shall be.
fn draw_line<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    pixels: impl Iterator<Item = (i32, i32)> + Clone,
    dashes: Option<(i32, i32)>,
    style: ShapeStyle,
) -> DrawResult {
    if let Some((dash, gap)) = dashes {
        area.draw(&DashedPathElement::new(pixels, dash, gap, style)).map_err(words)
    } else {
        // Piece by piece: where a thick line turns back, its joint would be a spike far beyond the axes.
        let pixels: Vec<_> = pixels.collect();
        pixels.windows(2).try_for_each(|piece| area.draw(&PathElement::new(piece.to_vec(), style)).map_err(words))
    }
}

/// The dot of curve number `k`: round, square or with three corners as colours come again.
fn draw_dot<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, (x, y): (i32, i32), k: usize) -> DrawResult {
    let style = colour(k).filled();
    let drawn = match k / COLOURS.len() {
        0 => area.draw(&Circle::new((x, y), DOT, style)),
        1 => area.draw(&Rectangle::new([(x - DOT, y - DOT), (x + DOT, y + DOT)], style)),
        _ => area.draw(&TriangleMarker::new((x, y), DOT + 3, style)),
    };
    drawn.map_err(words)
}

#[cfg(test)]
mod tests {
    use super::super::style::register_fonts;
    use super::*;

    /// Pieces of lines in the colours of the first and the second of `count` curves, each line once in the figure and once beside its name.
    fn pieces(count: i32, marks: Marks) -> [usize; 2] {
        let curve = |k: i32| Curve { name: k.to_string(), points: vec![[0.0, f64::from(k)], [1.0, 9.0]], marks };
        let figure = LineFigure { curves: (0..count).map(curve).collect(), ..LineFigure::default() };
        let mut drawn = String::new();
        register_fonts();
        crate::figures::drawn(&figure, SVGBackend::with_string(&mut drawn, figure.size())).expect("it is drawn");
        let of =
            |colour: &str| drawn.lines().filter(|line| line.starts_with("<polyline") && line.contains(colour)).count();
        ["#0072B2", "#D55E00"].map(of)
    }

    /// The eighth curve has the colour of the first, and is told from it by its dashes, with dots or without; the 15th by shorter ones.
    #[test]
    fn curves_with_one_colour_differ() {
        for marks in [Marks::Line, Marks::Dots] {
            let [eight, fifteen] = [8, 15].map(|count| pieces(count, marks));
            assert!(eight[1] == 2 && eight[0] > 6, "{marks:?}: {eight:?}");
            let (dashes, dots) = (eight[0] - 2, fifteen[0] - eight[0]);
            assert!(dots > dashes * 3 / 2, "{marks:?}: {dashes} {dots}");
        }
    }

    /// Names below the axes are in as many columns as there is room for, and make no figure wider.
    #[test]
    fn names_are_in_columns() {
        let figure = |letters: usize| {
            let curve = Curve { name: "m".repeat(letters), points: vec![[0.0, 0.0], [1.0, 1.0]], ..Curve::default() };
            LineFigure { curves: vec![curve; 4], ..LineFigure::default() }
        };
        assert_eq!([5, 40, 80].map(|letters| figure(letters).names().1), [1, 2, 4]);
        assert!([5, 40, 80].iter().all(|letters| figure(*letters).size().0 == WIDTH));
        let unnamed = LineFigure { notes: vec!["a note".to_owned()], ..figure(0) };
        assert!(crate::figures::pixels(&unnamed).is_ok());
    }

    /// On logarithmic axes a power law is a straight line, and what is not greater than 0 has no place.
    #[test]
    fn a_power_law_is_straight_on_logarithmic_axes() {
        let points = vec![[-1.0, 1.0], [0.001, 1e-6], [0.01, 1e-4], [0.1, 0.01]];
        let figure =
            LineFigure { curves: vec![Curve { points, ..Curve::default() }], is_log: true, ..LineFigure::default() };
        let [x, y] = figure.bounds();
        let axes = Axes { rectangle: [0, 0, 900, 900], x, y, is_log: true };
        let [a, b, c] = [0.001, 0.01, 0.1].map(|x| axes.pixel([x, x * x]));
        assert!((a.0 + c.0 - 2 * b.0).abs() <= 1 && (a.1 + c.1 - 2 * b.1).abs() <= 1, "{a:?} {b:?} {c:?}");
        assert!(!axes.holds([-1.0, 1.0]) && a.0 >= 0 && c.0 <= 900);
    }
}
