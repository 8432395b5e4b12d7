//! Two axes around a rectangle, and the way from a place to a pixel.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::style::{AXIS, FONT, LETTERS, TITLE};
use super::ticks::{log_ticks, tick_label, ticks};
use super::{DrawResult, words};
use crate::number::short;

/// Pixels that labels take: of the vertical axis to the left, of the horizontal one below, of the title above.
pub(super) const LEFT: i32 = 150;
pub(super) const BOTTOM: i32 = 95;
pub(super) const TOP: i32 = 75;

/// Length (pixels) of a tick.
const TICK: i32 = 9;

/// A rectangle of pixels with the values at its edges.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    /// Left, top, width, height (pixels).
    pub rectangle: [i32; 4],
    /// Values at the left and right edge.
    pub x: (f64, f64),
    /// Values at the lower and upper edge.
    pub y: (f64, f64),
    /// Whether both are logarithmic; what is not greater than 0 has no place then.
    pub is_log: bool,
}

impl Axes {
    /// The pixel of a place.
    pub fn pixel(&self, [x, y]: [f64; 2]) -> (i32, i32) {
        let [left, top, width, height] = self.rectangle;
        let share = |value: f64, (least, greatest): (f64, f64)| {
            if self.is_log {
                (value / least).ln() / (greatest / least).ln()
            } else {
                (value - least) / (greatest - least)
            }
        };
        let (along, up) = (share(x, self.x) * f64::from(width), share(y, self.y) * f64::from(height));
        (left + along.round() as i32, top + height - up.round() as i32)
    }

    /// Whether a place lies between the edges.
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        (self.x.0..=self.x.1).contains(&x) && (self.y.0..=self.y.1).contains(&y)
    }

    /// Pixels of a length along the horizontal axis.
    pub fn pixels(&self, length: f64) -> f64 {
        length / (self.x.1 - self.x.0) * f64::from(self.rectangle[2])
    }

    /// Draws the frame with ticks and their numbers; the names of the axes, where they are given. Without that of the horizontal axis
    /// it has no numbers either: it is that of the panel below.
    pub fn draw<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        x_name: Option<&str>,
        y_name: &str,
        is_grid: bool,
    ) -> DrawResult {
        let [left, top, width, height] = self.rectangle;
        let (right, bottom) = (left + width, top + height);
        let line = |from: (i32, i32), to: (i32, i32), style: ShapeStyle| {
            area.draw(&PathElement::new(vec![from, to], style)).map_err(words)
        };
        let (black, grey) = (BLACK.stroke_width(AXIS), RGBColor(222, 222, 222).stroke_width(1));
        let ticks = if self.is_log { log_ticks } else { ticks };
        // Powers of ten and what is between them have few digits each; others as many as tell them apart.
        let label = |value: f64, all: &[f64]| {
            let has_powers =
                self.is_log && all.last().zip(all.first()).is_some_and(|(last, first)| *last >= 5.0 * first);
            if has_powers { short(value) } else { tick_label(value, all) }
        };
        let x_ticks = ticks(self.x.0, self.x.1, (width / 170).max(2) as usize);
        for value in &x_ticks {
            let (x, _) = self.pixel([*value, self.y.0]);
            if is_grid {
                line((x, top), (x, bottom), grey)?;
            }
            line((x, bottom), (x, bottom - TICK), black)?;
            if x_name.is_some() {
                write(area, &label(*value, &x_ticks), (x, bottom + 12), (HPos::Center, VPos::Top))?;
            }
        }
        let y_ticks = ticks(self.y.0, self.y.1, (height / 75).max(2) as usize);
        for value in &y_ticks {
            let (_, y) = self.pixel([self.x.0, *value]);
            if is_grid {
                line((left, y), (right, y), grey)?;
            }
            line((left, y), (left + TICK, y), black)?;
            write(area, &label(*value, &y_ticks), (left - 12, y), (HPos::Right, VPos::Center))?;
        }
        area.draw(&Rectangle::new([(left, top), (right, bottom)], black)).map_err(words)?;
        if let Some(name) = x_name {
            write(area, name, (left + width / 2, bottom + 52), (HPos::Center, VPos::Top))?;
        }
        write_upwards(area, y_name, (left - LEFT + 22, top + height / 2))
    }
}

/// Writes `text` so that its anchor lies at a pixel.
pub(super) fn write<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    text: &str,
    at: (i32, i32),
    (h, v): (HPos, VPos),
) -> DrawResult {
    let style = (FONT, LETTERS).into_font().into_text_style(area).pos(Pos::new(h, v));
    let down = if matches!(v, VPos::Center) { SINK } else { 0 };
    area.draw(&Text::new(text.to_owned(), (at.0, at.1 + down), style)).map_err(words)
}

/// Pixels by which the middle of a line with room for accents and tails lies above that of its capitals and digits.
const SINK: i32 = 3;

/// Writes `text` upwards, its middle at a pixel.
pub(super) fn write_upwards<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    text: &str,
    at: (i32, i32),
) -> DrawResult {
    let font = (FONT, LETTERS).into_font().transform(FontTransform::Rotate270);
    let style = font.into_text_style(area).pos(Pos::new(HPos::Center, VPos::Center));
    area.draw(&Text::new(text.to_owned(), at, style)).map_err(words)
}

/// Writes the title above a figure whose axes have their middle at `middle`: over it if there is room, in two lines if one is too
/// long, and smaller if two are.
pub(super) fn write_title<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, title: &str, middle: i32) -> DrawResult {
    let width = area.dim_in_pixel().0 as i32;
    let room = width - 2 * TITLE_MARGIN;
    let measure = |line: &str, size: u32| {
        let style = (FONT, size).into_font().style(FontStyle::Bold).into_text_style(area);
        area.estimate_text_size(line, &style).map(|(width, _)| width as i32).map_err(words)
    };
    let one = measure(title, TITLE)?;
    let (lines, size) = if one <= room {
        (vec![title], TITLE)
    } else {
        let lines = halves(title);
        let longest = lines.iter().map(|line| measure(line, LETTERS)).collect::<Result<Vec<_>, _>>()?.into_iter().max();
        let fit = room as f64 / f64::from(longest.unwrap_or(1).max(1));
        (lines, (f64::from(LETTERS) * fit.min(1.0)) as u32)
    };
    for (k, line) in lines.iter().enumerate() {
        let half = measure(line, size)? / 2;
        let x = middle.clamp((TITLE_MARGIN + half).min(width / 2), (width - TITLE_MARGIN - half).max(width / 2));
        let y = TOP / 2 + (2 * k as i32 + 1 - lines.len() as i32) * (size as i32 * 6 / 10);
        let font = (FONT, size).into_font().style(FontStyle::Bold);
        let style = font.into_text_style(area).pos(Pos::new(HPos::Center, VPos::Center));
        area.draw(&Text::new((*line).to_owned(), (x, y), style)).map_err(words)?;
    }
    Ok(())
}

/// Pixels beside a title.
const TITLE_MARGIN: i32 = 20;

/// A text in two lines, broken at the blank that is nearest to its middle.
fn halves(text: &str) -> Vec<&str> {
    let middle = text.len() / 2;
    match text.match_indices(' ').map(|(at, _)| at).min_by_key(|at| at.abs_diff(middle)) {
        Some(at) => vec![&text[..at], &text[at + 1..]],
        None => vec![text],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_is_broken_at_the_blank_nearest_to_its_middle() {
        assert_eq!(halves("a slide meets ä cable"), ["a slide meets", "ä cable"]);
        assert_eq!(halves("rotating_flume"), ["rotating_flume"]);
    }
}
