//! How many particles a scene may have.

use std::f64::consts::PI;

use bevy_ecs::prelude::*;
use glam::DVec3;
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

use super::geometry::Shape;
use super::{Invalid, Resolution};
use crate::kernels::SmoothingKernel;
use crate::neighbours::NeighbourSettings;

/// More particles than this are a mistake in the scene rather than a case that a machine of today runs.
const MOST_PARTICLES: f64 = 5e7;

/// Refuses a box that would need too many particles, before any is made.
pub(crate) fn limit_particles((min, max): (DVec3, DVec3), resolution: &Resolution) -> Result<(), Invalid> {
    let cells = |spacing: f64| {
        let lengths = (max - min).to_array();
        lengths[..resolution.dimension].iter().map(|length| (length / spacing).ceil().max(1.0)).product::<f64>()
    };
    // NaN and infinity are too many as well.
    if cells(resolution.spacing) <= MOST_PARTICLES {
        return Ok(());
    }
    let mut fits = resolution.spacing.max(f64::MIN_POSITIVE);
    while cells(fits) > MOST_PARTICLES && fits.is_finite() {
        fits *= 2.0;
    }
    Err(Invalid::new(
        "",
        format!(
            "needs up to {:.1e} particles at a spacing of {} m, more than the {MOST_PARTICLES:.0e} that are allowed: a \
             spacing of {fits:.3e} m would do",
            cells(resolution.spacing),
            resolution.spacing,
        ),
    ))
}

/// Bytes that a particle takes besides its pairs: its columns, the change ticks of each, the packed records of the
/// sweeps, its place in the grid.
const BYTES_PER_PARTICLE: f64 = 700.0;

/// Bytes of a listed pair: the neighbour's row and one kernel column.
const BYTES_PER_PAIR: f64 = 12.0;

/// Lists grow by doubling: on average a third of their memory is not in use.
const SLACK: f64 = 1.5;

/// Estimated bytes of so many particles with so many listed pairs.
pub(crate) fn bytes_of(particles: f64, pairs: f64) -> f64 {
    particles * BYTES_PER_PARTICLE + pairs * BYTES_PER_PAIR * SLACK
}

/// Refuses fluids that would need more memory than is free, before any particle of them is made.
pub(super) fn limit_memory<'a>(world: &World, fluids: impl Iterator<Item = &'a Shape>) -> Result<(), Invalid> {
    let resolution = *world.resource::<Resolution>();
    let reach = (1.0 + world.resource::<NeighbourSettings>().skin) * world.resource::<SmoothingKernel>().0.radius();
    let size: f64 = fluids.map(|shape| greatest_measure(shape, resolution.dimension)).sum();
    // A small scene fits any machine, and asking takes a moment.
    let particles = size / resolution.particle_volume();
    if particles < 1e5 { Ok(()) } else { fits(particles, reach, available_memory(), &resolution) }
}

/// Refuses `particles` that need more than `available` bytes; pairs up to `reach` (m) are listed.
fn fits(particles: f64, reach: f64, available: f64, resolution: &Resolution) -> Result<(), Invalid> {
    let ball = if resolution.dimension == 2 { PI * reach.powi(2) } else { 4.0 / 3.0 * PI * reach.powi(3) };
    let needed = bytes_of(particles, particles * ball / resolution.particle_volume());
    if needed <= available {
        return Ok(());
    }
    let coarser = resolution.spacing * (needed / available).powf(1.0 / resolution.dimension as f64);
    let message = format!(
        "they need about {particles:.1e} particles and {:.1} GB of memory, but {:.1} GB are free: a spacing of {coarser:.2e} m \
         would do",
        needed / 1e9,
        available / 1e9
    );
    Err(Invalid::new("", message))
}

/// Memory (bytes) that the program can have, within the limits of its container.
fn available_memory() -> f64 {
    let system =
        System::new_with_specifics(RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram()));
    let in_container = system.cgroup_limits().map_or(u64::MAX, |limits| limits.free_memory);
    system.available_memory().min(in_container) as f64
}

/// Area (m²) or volume (m³) of a shape, or a bound of it where it has no closed form.
fn greatest_measure(shape: &Shape, dimension: usize) -> f64 {
    match shape {
        Shape::Union(parts) => parts.iter().map(|part| greatest_measure(part, dimension)).sum(),
        Shape::Difference { of, .. } => greatest_measure(of, dimension),
        other => other.measure(dimension).unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_that_of_the_particles_and_a_coarser_spacing_fits() {
        let resolution = |spacing| Resolution { dimension: 3, spacing, smoothing_length: 1.2 * spacing };
        // Of a cube of 1 m: 10⁶ particles, each with 4/3 π 4³ = 268 pairs of 18 bytes.
        let bytes = 1e6 * (700.0 + 4.0 / 3.0 * PI * 64.0 * 18.0);
        assert_eq!(fits(1e6, 0.04, bytes * 1.001, &resolution(0.01)), Ok(()));
        let refused = fits(1e6, 0.04, bytes / 8.0, &resolution(0.01)).map_err(|invalid| invalid.message);
        assert!(refused.as_ref().is_err_and(|text| text.contains("a spacing of 2.00e-2 m")), "{refused:?}");
        assert_eq!(fits(1e6 / 8.0, 0.08, bytes / 8.0 * 1.001, &resolution(0.02)), Ok(()));
        assert!(available_memory() > 1e6);
    }

    #[test]
    fn shapes_without_a_closed_form_are_bounded() {
        let disc = |radius| Shape::Circle { center: super::super::geometry::Point::plane(0.0, 0.0), radius };
        let ring = Shape::Difference { of: Box::new(disc(2.0)), minus: vec![disc(1.0)] };
        assert!((greatest_measure(&Shape::Union(vec![ring, disc(1.0)]), 2) - 5.0 * PI).abs() < 1e-12);
    }
}
