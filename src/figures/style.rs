//! Fonts, sizes and colours that all figures share.

use std::sync::Once;

use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

/// Width (pixels) of figures: 20 cm at 200 dots an inch.
pub(super) const WIDTH: u32 = 1600;

/// Height (pixels) of letters: 9 points in print, and of titles.
pub(super) const LETTERS: u32 = 25;
pub(super) const TITLE: u32 = 29;

/// Width (pixels) of a digit, and of a letter in words on average, a little more than it is.
pub(super) const LETTER: i32 = 15;
pub(super) const LETTER_IN_WORDS: i32 = 12;

/// Width (pixels) of axes and of curves.
pub(super) const AXIS: u32 = 2;
pub(super) const CURVE: u32 = 4;

/// Name under which the font is known; what shows an SVG file takes its own of that name.
pub(super) const FONT: &str = "sans-serif";

/// Makes the font known. It comes with the program, so that figures look the same on every machine.
pub(super) fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let (regular, bold) = (dejavu::sans::regular(), dejavu::sans::bold());
        // Only a font that is damaged is refused, and then the first figure says so.
        let _ = register_font(FONT, FontStyle::Normal, regular).is_ok()
            && register_font(FONT, FontStyle::Bold, bold).is_ok();
    });
}

/// Colours of curves and phases that can be told apart in print and by the colour-blind (Okabe & Ito 2008).
pub(super) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
];

/// Colour number `k`.
pub(super) fn colour(k: usize) -> RGBColor {
    COLOURS[k % COLOURS.len()]
}

/// Colour of walls and structures.
pub(super) const BODY: RGBColor = RGBColor(120, 120, 120);

/// A quantity with its unit, `pressure (Pa)`, or its name alone.
#[must_use]
pub fn labelled(name: &str, unit: &str) -> String {
    let name = name.replace('_', " ");
    if unit.is_empty() { name } else { format!("{name} ({unit})") }
}
