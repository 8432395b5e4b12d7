//! Particle places along one coordinate axis between two walls.

use super::Side;

/// A place along an axis.
pub(super) struct AxisPlace {
    /// Coordinate in metres.
    pub(super) at: f64,
    /// Whether it belongs to the ghost layers of one of the two ends.
    pub(super) ghost: bool,
}

/// Centres of the `round((to - from)/spacing)`, but at least one, equal cells between two coordinates in metres.
pub(super) fn fitted(from: f64, to: f64, spacing: f64) -> Vec<f64> {
    let count = ((to - from) / spacing).round().max(1.0);
    let step = (to - from) / count;
    (0..count as usize).map(|i| from + (i as f64 + 0.5) * step).collect()
}

/// Places from end to end, ghost layers included, in ascending order; `from`, `to` and `spacing` in metres.
///
/// Layer k lies (k + ½) spacings off its end; the rest of the interval is filled with equal cells. If the layers of
/// both ends meet inside, equal cells fill the whole interval.
pub(super) fn walled(from: f64, to: f64, side: Side, layers: usize, spacing: f64) -> Vec<AxisPlace> {
    let offset = |layer: usize| (layer as f64 + 0.5) * spacing;
    let depth = layers as f64 * spacing;
    let (low, middle, high): (Vec<f64>, Vec<f64>, Vec<f64>) = match side {
        Side::Outside => (
            (0..layers).rev().map(|layer| from - offset(layer)).collect(),
            fitted(from, to, spacing),
            (0..layers).map(|layer| to + offset(layer)).collect(),
        ),
        Side::Inside if ((to - from) / spacing).round() <= 2.0 * layers as f64 => {
            (fitted(from, to, spacing), Vec::new(), Vec::new())
        }
        Side::Inside => (
            (0..layers).map(|layer| from + offset(layer)).collect(),
            fitted(from + depth, to - depth, spacing),
            (0..layers).rev().map(|layer| to - offset(layer)).collect(),
        ),
    };
    let place = |ghost: bool| move |at: f64| AxisPlace { at, ghost };
    let ends = (low.into_iter().map(place(true)), high.into_iter().map(place(true)));
    ends.0.chain(middle.into_iter().map(place(false))).chain(ends.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(places: &[f64], expected: &[f64]) -> bool {
        places.len() == expected.len() && places.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14)
    }

    fn all(places: &[AxisPlace]) -> Vec<f64> {
        places.iter().map(|place| place.at).collect()
    }

    #[test]
    fn cells_stretch_to_fit() {
        assert!(close(&fitted(1.0, 2.0, 0.3), &[1.0 + 1.0 / 6.0, 1.5, 2.0 - 1.0 / 6.0]));
        assert!(close(&fitted(1.0, 1.1, 0.3), &[1.05]));
    }

    #[test]
    fn layers_continue_the_cells() {
        let outside = walled(0.0, 2.0, Side::Outside, 2, 1.0);
        assert!(close(&all(&outside), &[-1.5, -0.5, 0.5, 1.5, 2.5, 3.5]));
        assert_eq!(outside.iter().filter(|place| place.ghost).count(), 4);
        let inside = walled(0.0, 5.0, Side::Inside, 2, 1.0);
        assert!(close(&all(&inside), &[0.5, 1.5, 2.5, 3.5, 4.5]));
        assert_eq!(inside.iter().filter(|place| place.ghost).count(), 4);
        assert!(walled(0.0, 3.0, Side::Inside, 2, 1.0).iter().all(|place| place.ghost));
    }
}
