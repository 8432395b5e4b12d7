//! Particles on circles and spherical shells. Lengths in metres.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

/// Evenly spaced points on a circle round the origin: `round(2πr/spacing)` of them, or its centre if fewer than two
/// fit.
pub(super) fn ring(radius: f64, spacing: f64) -> Vec<DVec2> {
    let count = (TAU * radius / spacing).round();
    if count < 2.0 {
        return vec![DVec2::ZERO];
    }
    (0..count as usize).map(|i| radius * DVec2::from_angle(TAU * i as f64 / count)).collect()
}

/// Evenly spread points on a sphere round the origin: `round(4πr²/spacing²)` points of a Fibonacci lattice, or the
/// centre if fewer than two fit.
pub(super) fn shell(radius: f64, spacing: f64) -> Vec<DVec3> {
    let count = (4.0 * PI * (radius / spacing).powi(2)).round();
    if count < 2.0 {
        return vec![DVec3::ZERO];
    }
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    (0..count as usize)
        .map(|i| {
            let height = 1.0 - (2.0 * i as f64 + 1.0) / count;
            let across = (1.0 - height * height).sqrt() * DVec2::from_angle(golden_angle * i as f64);
            radius * across.extend(height)
        })
        .collect()
}

/// Inner radii of the `round(radius/spacing)`, but at least one, equally thick rings or shells that make up a disc
/// or a ball, and their thickness.
pub(super) fn fitted_rings(radius: f64, spacing: f64) -> (Vec<f64>, f64) {
    let count = (radius / spacing).round().max(1.0);
    let thickness = radius / count;
    ((0..count as usize).map(|k| k as f64 * thickness).collect(), thickness)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ring_is_even() {
        let points = ring(1.0, TAU / 12.0);
        assert_eq!(points.len(), 12);
        let chord = 2.0 * (PI / 12.0).sin();
        assert!(points.windows(2).all(|pair| (pair[0].distance(pair[1]) - chord).abs() < 1e-14));
        assert_eq!(ring(0.01, 1.0), vec![DVec2::ZERO]);
    }

    #[test]
    fn shell_is_even() {
        let points = shell(1.0, 0.1);
        assert_eq!(points.len(), 1257);
        let mean = points.iter().sum::<DVec3>() / 1257.0;
        assert!(mean.length() < 1e-3, "{mean}");
        for (i, a) in points.iter().enumerate() {
            assert!((a.length() - 1.0).abs() < 1e-14);
            let nearest =
                points.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, b)| a.distance(*b)).fold(9.0, f64::min);
            assert!((0.07..0.11).contains(&nearest), "{nearest}");
        }
    }
}
