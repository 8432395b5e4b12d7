//! Profiles: what particles make along a line.

use super::Frame;

/// Which way is up: y in the plane, z in space.
#[must_use]
pub fn vertical_axis(dimension: usize) -> usize {
    if dimension == 2 { 1 } else { 2 }
}

/// The upper surface of a phase: places one `spacing` (m) apart along x, and the height (m) of the top of the highest particle within
/// one spacing of each, half a spacing above its centre. Places without a particle are left out.
///
/// A drop above the surface counts too; in space it is the highest over all y.
#[must_use]
pub fn upper_surface(frame: &Frame, phase: usize, dimension: usize, spacing: f64) -> Vec<[f64; 2]> {
    let up = vertical_axis(dimension);
    let mut heights = std::collections::BTreeMap::new();
    for (x, of) in frame.positions().zip(frame.values("phase")) {
        if *of == phase as f64 {
            let left = (x[0] / spacing).floor() as i64;
            for place in [left, left + 1] {
                let height = heights.entry(place).or_insert(f64::NEG_INFINITY);
                *height = x[up].max(*height);
            }
        }
    }
    heights.into_iter().map(|(place, height)| [place as f64 * spacing, height + 0.5 * spacing]).collect()
}

/// Support of the interpolation along a line, in spacings.
const SUPPORT: f64 = 2.0;

/// Values along a line on which axis `fixed` (0 for x, …) has the coordinate `at` (m), one a spacing along axis `along`: the mean of the
/// particles within two spacings, weighted by `(1 − r/2dp)⁴ (1 + 2r/dp)` (Wendland's C2 kernel; Shepard's interpolation). Where no
/// particle is within one spacing there is no value.
#[must_use]
pub fn line_profile(
    frame: &Frame,
    values: &[f64],
    (fixed, at): (usize, f64),
    along: usize,
    spacing: f64,
) -> Vec<[f64; 2]> {
    let radius = SUPPORT * spacing;
    let near: Vec<([f64; 3], f64)> =
        frame.positions().zip(values.iter().copied()).filter(|(x, _)| (x[fixed] - at).abs() < radius).collect();
    let ends = near.iter().map(|(x, _)| x[along]);
    let (least, greatest) =
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), x| (x.min(least), x.max(greatest)));
    if near.is_empty() {
        return Vec::new();
    }
    let places = ((least / spacing).floor() as i64..=(greatest / spacing).ceil() as i64).map(|k| k as f64 * spacing);
    places.filter_map(|place| Some([place, interpolated(&near, (fixed, at), (along, place), spacing)?])).collect()
}

fn interpolated(near: &[([f64; 3], f64)], fixed: (usize, f64), along: (usize, f64), spacing: f64) -> Option<f64> {
    let (mut sum, mut weights, mut nearest) = (0.0, 0.0, f64::INFINITY);
    for (x, value) in near {
        let r = (x[fixed.0] - fixed.1).hypot(x[along.0] - along.1);
        let q = r / (SUPPORT * spacing);
        if q < 1.0 {
            let weight = (1.0 - q).powi(4) * (1.0 + 4.0 * q);
            (sum, weights, nearest) = (sum + weight * value, weights + weight, r.min(nearest));
        }
    }
    (nearest < spacing && weights > 0.0).then(|| sum / weights)
}

#[cfg(test)]
mod tests {
    use super::super::FrameField;
    use super::*;

    /// A block of two phases, 1 m × 1 m, whose pressure grows linearly downwards.
    fn block() -> Frame {
        let places: Vec<(f64, f64)> =
            (0..400).map(|k| (0.05 * (f64::from(k % 20) + 0.5), 0.05 * (f64::from(k / 20) + 0.5))).collect();
        let field = |name: &str, values: Vec<f64>| FrameField {
            name: name.into(),
            unit: String::new(),
            is_whole: false,
            values,
        };
        let fields = vec![
            field("x", places.iter().map(|place| place.0).collect()),
            field("y", places.iter().map(|place| place.1).collect()),
            field("phase", places.iter().map(|place| f64::from(place.1 > 0.5)).collect()),
            field("pressure", places.iter().map(|place| 1000.0 * (1.0 - place.1)).collect()),
        ];
        Frame { time: 0.0, fields, count: places.len() }
    }

    #[test]
    fn the_surface_of_a_block_is_its_top() {
        for (phase, top) in [(0, 0.5), (1, 1.0)] {
            let surface = upper_surface(&block(), phase, 2, 0.05);
            assert_eq!(surface.len(), 21);
            assert!(surface.iter().all(|[_, height]| (height - top).abs() < 1e-12), "{surface:?}");
            assert!((surface[3][0] - 0.15).abs() < 1e-12);
        }
    }

    #[test]
    fn a_linear_field_is_interpolated_exactly_inside() {
        let frame = block();
        let profile = line_profile(&frame, frame.values("pressure"), (0, 0.5), 1, 0.05);
        let inside: Vec<_> = profile.iter().filter(|[y, _]| (0.1..0.9).contains(y)).collect();
        assert!(inside.len() > 14);
        assert!(inside.iter().all(|[y, p]| (p - 1000.0 * (1.0 - y)).abs() < 1e-9), "{inside:?}");
        assert!(line_profile(&frame, frame.values("pressure"), (0, 7.0), 1, 0.05).is_empty());
    }
}
