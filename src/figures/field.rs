//! Particles at one or several times, coloured by a quantity or by their phase.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axes::{Axes, BOTTOM, LEFT, TOP, write, write_title, write_upwards};
use super::style::{AXIS, BODY, LETTER, WIDTH, colour};
use super::ticks::{tick_label, ticks};
use super::{ColourMap, DrawResult, Figure, words};
use crate::number::short;

/// One time of one run.
#[derive(Debug, Clone, Default)]
pub struct Panel {
    /// What stands in its corner, such as `t = 0.4 s`.
    pub label: String,
    /// Places (m) in the plane of the picture; those that are drawn last come last.
    pub places: Vec<[f64; 2]>,
    /// Value of each particle, or the number of its phase.
    pub values: Vec<f64>,
    /// Places (m) of walls and structures.
    pub bodies: Vec<[f64; 2]>,
    /// Velocities (m/s), with the places (m) at which they are drawn.
    pub arrows: Vec<([f64; 2], [f64; 2])>,
    /// Diameter (m) of particles.
    pub spacing: f64,
}

/// How values become colours.
#[derive(Debug, Clone, PartialEq)]
pub enum Paint {
    /// By a scale with a bar beside the picture.
    Scale {
        /// What stands along the bar, such as `pressure (Pa)`.
        label: String,
        /// Values at the ends of the bar.
        range: (f64, f64),
        /// Its colours.
        colours: ColourMap,
    },
    /// By number, with these names.
    Names(Vec<String>),
}

/// How long arrows are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrows {
    /// Speed (m/s) of the arrow that stands beside the picture as a measure.
    pub speed: f64,
    /// Its length (m) in the picture.
    pub length: f64,
}

/// The figure: panels below one another, with the same axes and colours.
#[derive(Debug, Clone)]
pub struct FieldFigure {
    /// What stands above; may be empty.
    pub title: String,
    /// Panels, from the top.
    pub panels: Vec<Panel>,
    /// Colours.
    pub paint: Paint,
    /// Names of the axes, such as `x (m)`.
    pub axes: [String; 2],
    /// Least and greatest coordinates (m) that are shown.
    pub bounds: [(f64, f64); 2],
    /// Arrows, if there are any.
    pub arrows: Option<Arrows>,
}

/// Pixels to the right of the panels, for the bar of colours.
const RIGHT: i32 = 240;
/// Pixels above each panel, for its label.
const ABOVE: i32 = 52;
/// Most pixels of all panels together: two thirds of a page.
const MOST_HEIGHT: f64 = 2100.0;
/// Particles are drawn so many spacings wide: where they lie apart, what is between them shall not shine through.
const SIZE: f64 = 1.2;
/// Particles narrower than so many pixels are drawn as squares, which leave no gaps.
const DISC: i32 = 16;
/// Discs on a lattice cover it if they are as wide as its squares are from corner to corner.
const SQUARE: f64 = std::f64::consts::SQRT_2;

impl FieldFigure {
    /// Width and height (pixels) of a panel. Both axes have the same scale.
    fn panel(&self) -> (i32, i32) {
        let [width, height] = self.bounds.map(|(least, greatest)| greatest - least);
        let most_width = f64::from(WIDTH as i32 - LEFT - RIGHT);
        let most_height = MOST_HEIGHT / self.panels.len().max(1) as f64;
        let scale = (most_width / width).min(most_height / height);
        ((scale * width).max(60.0) as i32, (scale * height).max(60.0) as i32)
    }

    /// Makes it show what another of the same scene shows too: with the same axes, colours and arrows.
    pub fn widen(&mut self, other: &Self) {
        let both = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
        for (bounds, more) in self.bounds.iter_mut().zip(other.bounds) {
            *bounds = both(*bounds, more);
        }
        if let (Paint::Scale { range, .. }, Paint::Scale { range: more, .. }) = (&mut self.paint, &other.paint) {
            *range = both(*range, *more);
        }
        if let (Some(arrows), Some(more)) = (self.arrows, other.arrows)
            && more.speed > arrows.speed
        {
            self.arrows = Some(more);
        }
    }

    fn colour(&self, value: f64) -> RGBColor {
        match &self.paint {
            Paint::Scale { range: (least, greatest), colours, .. } => colours.at((value - least) / (greatest - least)),
            Paint::Names(names) => phase_colour(names, value as usize),
        }
    }

    fn draw_panel<DB: DrawingBackend>(&self, panel: &Panel, axes: &Axes, area: &DrawingArea<DB, Shift>) -> DrawResult {
        let spacing = axes.pixels(panel.spacing);
        let size = ((SIZE * spacing).ceil() as i32).max(2);
        let bodies = panel.bodies.iter().map(|place| (place, BODY));
        let fluid = panel.places.iter().zip(&panel.values).map(|(place, value)| (place, self.colour(*value)));
        let [left, top, width, height] = axes.rectangle;
        let radius = if size < DISC { size / 2 } else { (0.5 * SQUARE * spacing).ceil() as i32 };
        for (&place, colour) in bodies.chain(fluid).filter(|(place, _)| axes.holds(**place)) {
            let (x, y) = axes.pixel(place);
            // What reaches over the frame would hide the title and the numbers.
            let is_inside = |at: i32, least: i32, span: i32| at >= least + radius && at <= least + span - radius;
            if !is_inside(x, left, width) || !is_inside(y, top, height) {
                continue;
            }
            let drawn = if size < DISC {
                let (left, top) = (x - size / 2, y - size / 2);
                area.draw(&Rectangle::new([(left, top), (left + size, top + size)], colour.filled()))
            } else {
                area.draw(&Circle::new((x, y), radius, colour.filled()))
            };
            drawn.map_err(words)?;
        }
        if let Some(Arrows { speed, length }) = self.arrows {
            for (place, v) in panel.arrows.iter().filter(|(place, _)| axes.holds(*place)) {
                let tip = [0, 1].map(|axis| place[axis] + v[axis] * length / speed);
                draw_arrow(area, axes.pixel(*place), axes.pixel(tip))?;
            }
        }
        write(area, &panel.label, (left, top - 8), (HPos::Left, VPos::Bottom))
    }

    /// The bar of colours or the names of phases, and the measure of the arrows.
    fn draw_legend<DB: DrawingBackend>(&self, axes: &Axes, height: i32, area: &DrawingArea<DB, Shift>) -> DrawResult {
        let [left, top, width, _] = axes.rectangle;
        let left = left + width + 34;
        let mut bottom = top + height;
        match &self.paint {
            Paint::Scale { label, range, colours } => draw_bar(area, [left, top, height], label, *range, *colours)?,
            Paint::Names(names) => {
                for (k, name) in names.iter().enumerate() {
                    let y = top + 20 + 44 * k as i32;
                    let patch = Rectangle::new([(left, y - 12), (left + 26, y + 12)], phase_colour(names, k).filled());
                    area.draw(&patch).map_err(words)?;
                    write(area, name, (left + 40, y), (HPos::Left, VPos::Center))?;
                }
                bottom = top + 44 * names.len() as i32;
            }
        }
        let Some(arrows) = self.arrows else { return Ok(()) };
        let y = bottom + 40;
        draw_arrow(area, (left, y), (left + axes.pixels(arrows.length) as i32, y))?;
        write(area, &format!("{} m/s", short(arrows.speed)), (left, y + 16), (HPos::Left, VPos::Top))
    }
}

impl Figure for FieldFigure {
    fn size(&self) -> (u32, u32) {
        let (width, height) = self.panel();
        let panels = self.panels.len().max(1) as i32;
        ((LEFT + width + RIGHT) as u32, (TOP + panels * (height + ABOVE) + BOTTOM) as u32)
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> DrawResult {
        let (width, height) = self.panel();
        write_title(area, &self.title, LEFT + width / 2)?;
        let axes = |k: usize| Axes {
            rectangle: [LEFT, TOP + ABOVE + k as i32 * (height + ABOVE), width, height],
            x: self.bounds[0],
            y: self.bounds[1],
            is_log: false,
        };
        let last = self.panels.len().saturating_sub(1);
        for (k, panel) in self.panels.iter().enumerate() {
            self.draw_panel(panel, &axes(k), area)?;
            axes(k).draw(area, (k == last).then_some(self.axes[0].as_str()), &self.axes[1], false)?;
        }
        let all = (last as i32 + 1) * (height + ABOVE) - ABOVE;
        let arrows = if self.arrows.is_some() { 40 } else { 0 };
        self.draw_legend(&axes(0), (all - arrows).clamp(60, 800), area)
    }
}

/// Colour of phase `k`: water is blue, and what comes first besides it has the colour of sand.
fn phase_colour(names: &[String], k: usize) -> RGBColor {
    let is_water = |name: &String| name.to_lowercase().contains("water");
    let dry = names.iter().take(k).filter(|name| !is_water(name)).count();
    match names.get(k) {
        Some(name) if is_water(name) => RGBColor(140, 195, 235),
        _ if dry == 0 => RGBColor(181, 128, 56),
        _ => colour(dry),
    }
}

/// An arrow; what is shorter than its head is a dot.
fn draw_arrow<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, from: (i32, i32), to: (i32, i32)) -> DrawResult {
    let along = [f64::from(to.0 - from.0), f64::from(to.1 - from.1)];
    let length = along[0].hypot(along[1]);
    let style = BLACK.stroke_width(AXIS);
    area.draw(&PathElement::new(vec![from, to], style)).map_err(words)?;
    let head = (0.4 * length).min(11.0);
    if head < 2.0 {
        return Ok(());
    }
    let corner = |side: f64| {
        let [x, y] = along.map(|component| component / length * head);
        (to.0 - (x - side * y).round() as i32, to.1 - (y + side * x).round() as i32)
    };
    area.draw(&Polygon::new(vec![corner(0.45), to, corner(-0.45)], BLACK.filled())).map_err(words)
}

/// The bar of colours, its numbers, and what it shows.
fn draw_bar<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    [left, top, height]: [i32; 3],
    label: &str,
    (least, greatest): (f64, f64),
    colours: ColourMap,
) -> DrawResult {
    const THICK: i32 = 34;
    for row in 0..height {
        let colour = colours.at(1.0 - f64::from(row) / f64::from(height - 1));
        area.draw(&Rectangle::new([(left, top + row), (left + THICK, top + row + 1)], colour.filled()))
            .map_err(words)?;
    }
    let black = BLACK.stroke_width(AXIS);
    area.draw(&Rectangle::new([(left, top), (left + THICK, top + height)], black)).map_err(words)?;
    let numbers = ticks(least, greatest, (height / 80).max(2) as usize);
    for value in &numbers {
        let y = top + height - ((value - least) / (greatest - least) * f64::from(height)).round() as i32;
        area.draw(&PathElement::new(vec![(left + THICK - 8, y), (left + THICK, y)], black)).map_err(words)?;
        write(area, &tick_label(*value, &numbers), (left + THICK + 10, y), (HPos::Left, VPos::Center))?;
    }
    let widest = numbers.iter().map(|value| tick_label(*value, &numbers).chars().count()).max().unwrap_or(0) as i32;
    write_upwards(area, label, (left + THICK + 38 + LETTER * widest, top + height / 2))
}
