//! Profiles: what particles make along a line.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;

use super::Frame;

/// The upper surface of a phase, with the axis `up`: places one `spacing` (m) apart along x, and the height (m) of the top of the highest particle within
/// one spacing of each, half a spacing above its centre. Places without a particle are left out.
///
/// Grains, drops and threads do not count: particles with less than five others of the phase within two spacings. In space it is the highest
/// over all places beside x.
#[must_use]
pub fn upper_surface(frame: &Frame, phase: usize, up: usize, spacing: f64) -> Vec<[f64; 2]> {
    let of_phase = frame.positions().zip(frame.values("phase")).filter(|(_, of)| **of == phase as f64);
    let positions: Vec<[f64; 3]> = of_phase.map(|(x, _)| x).collect();
    let mut heights = BTreeMap::new();
    for x in in_company(&positions, TOGETHER * spacing) {
        let left = (x[0] / spacing).floor() as i64;
        for place in [left, left + 1] {
            let height = heights.entry(place).or_insert(f64::NEG_INFINITY);
            *height = x[up].max(*height);
        }
    }
    heights.into_iter().map(|(place, height)| [place as f64 * spacing, height + 0.5 * spacing]).collect()
}

/// Particles so far apart (in spacings) are together. A particle on a flat surface has seven others so near, one in a thread four.
const TOGETHER: f64 = 2.0;

/// With so many others a particle is part of a body.
const LEAST_COMPANY: usize = 5;

/// The positions that have [`LEAST_COMPANY`] others within `distance` (m).
fn in_company(positions: &[[f64; 3]], distance: f64) -> impl Iterator<Item = [f64; 3]> {
    // A little more, so that the second on a lattice counts whatever the rounding.
    let distance = 1.01 * distance;
    let cell = move |x: [f64; 3]| x.map(|x| (x / distance).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<[f64; 3]>> = HashMap::new();
    for &x in positions {
        cells.entry(cell(x)).or_default().push(x);
    }
    let company = move |x: [f64; 3]| {
        let [i, j, k] = cell(x);
        let around =
            (i - 1..=i + 1).flat_map(|i| (j - 1..=j + 1).flat_map(move |j| (k - 1..=k + 1).map(move |k| [i, j, k])));
        let near = around.filter_map(|cell| cells.get(&cell)).flatten();
        near.filter(|y| DVec3::from(x).distance(DVec3::from(**y)) < distance).count() - 1
    };
    positions.iter().copied().filter(move |x| company(*x) >= LEAST_COMPANY)
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
            let surface = upper_surface(&block(), phase, 1, 0.05);
            assert_eq!(surface.len(), 21);
            assert!(surface.iter().all(|[_, height]| (height - top).abs() < 1e-12), "{surface:?}");
            assert!((surface[3][0] - 0.15).abs() < 1e-12);
        }
    }

    #[test]
    fn grains_drops_and_threads_are_no_surface() {
        let mut frame = block();
        // A grain, a drop of three, and a thread that stands on the block.
        let thread = (0..6).map(|k| (0.775, 1.025 + 0.05 * f64::from(k)));
        let above: Vec<(f64, f64)> =
            [(0.2, 1.4), (0.5, 1.3), (0.55, 1.3), (0.525, 1.34)].into_iter().chain(thread).collect();
        for (field, value) in [("x", 0), ("y", 1), ("phase", 2), ("pressure", 3)] {
            let values = &mut frame.fields.iter_mut().find(|known| known.name == field).expect("it has it").values;
            values.extend(above.iter().map(|(x, y)| [*x, *y, 1.0, 0.0][value]));
        }
        frame.count += above.len();
        let surface = upper_surface(&frame, 1, 1, 0.05);
        // The foot of the thread has the block below it.
        assert!(surface.iter().all(|[_, height]| *height > 0.999 && *height < 1.11), "{surface:?}");
        assert_eq!(upper_surface(&block(), 1, 1, 0.05).len(), surface.len());
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
