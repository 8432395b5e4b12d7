//! From a number to a colour.

use plotters::style::RGBColor;

/// Colours for a quantity between two values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColourMap {
    /// From dark blue over green to yellow: brightness grows evenly, in print and for the colour-blind too (matplotlib's viridis).
    Sequential,
    /// From blue over white to red: for what has a sign, with white at zero.
    Diverging,
}

/// Eleven colours of viridis, at equal distances.
const VIRIDIS: [[u8; 3]; 11] = [
    [68, 1, 84],
    [72, 36, 117],
    [65, 68, 135],
    [53, 95, 141],
    [42, 120, 142],
    [33, 145, 140],
    [34, 168, 132],
    [68, 191, 112],
    [122, 209, 81],
    [189, 223, 38],
    [253, 231, 37],
];

/// Seven colours of ColorBrewer's RdBu, turned round.
const BLUE_RED: [[u8; 3]; 7] =
    [[33, 102, 172], [103, 169, 207], [209, 229, 240], [247, 247, 247], [253, 219, 199], [239, 138, 98], [178, 24, 43]];

impl ColourMap {
    /// The colour at `place` between 0 and 1; beyond, that of the end.
    #[must_use]
    pub fn at(self, place: f64) -> RGBColor {
        let table: &[[u8; 3]] = match self {
            Self::Sequential => &VIRIDIS,
            Self::Diverging => &BLUE_RED,
        };
        let place = if place.is_finite() { place.clamp(0.0, 1.0) } else { 0.0 } * (table.len() - 1) as f64;
        let k = (place as usize).min(table.len() - 2);
        let share = place - k as f64;
        let [red, green, blue] = std::array::from_fn(|channel| {
            let [from, to] = [table[k], table[k + 1]].map(|colour| f64::from(colour[channel]));
            (from + share * (to - from)).round() as u8
        });
        RGBColor(red, green, blue)
    }
}
