//! Filling a structure with solid particles.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::axis::fitted;
use super::rings::{fitted_rings, ring, shell};
use super::{Axis, Shape, lattice};

/// A particle of a structure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolidParticle {
    /// Centre in metres; z = 0 in 2D.
    pub position: DVec3,
    /// The part of the structure it stands for: an area in m² in 2D, a volume in m³ in 3D.
    pub volume: f64,
}

/// Fills a structure of the given shape with particles about `spacing` (metres) apart; `dimension` is 2 or 3.
///
/// Boxes get a lattice stretched to fit, circles and cylinders rings, spheres shells; in other shapes lie the lattice
/// centres counted from the lower end of the bounds. The volumes add up to the exact size of the shape, but for
/// `Union` and `Difference`, where each particle stands for one lattice cell. A shape that is too small for the
/// spacing gets a single particle or none.
#[must_use]
pub fn solid_particles(shape: &Shape, spacing: f64, dimension: usize) -> Vec<SolidParticle> {
    match shape {
        Shape::Box { min, max } => fill_box(min.position(), max.position(), spacing, dimension),
        Shape::Circle { center, radius } => disc(*radius, spacing)
            .into_iter()
            .map(|(offset, area)| SolidParticle { position: center.position() + offset.extend(0.0), volume: area })
            .collect(),
        Shape::Cylinder { center, axis, radius, length } => {
            fill_cylinder(center.position(), *axis, *radius, *length, spacing)
        }
        Shape::Sphere { center, radius } => fill_sphere(center.position(), *radius, spacing),
        Shape::Polygon(_) | Shape::Prism { .. } | Shape::Union(_) | Shape::Difference { .. } => {
            fill_lattice(shape, spacing, dimension)
        }
    }
}

fn fill_box(min: DVec3, max: DVec3, spacing: f64, dimension: usize) -> Vec<SolidParticle> {
    let xs = fitted(min.x, max.x, spacing);
    let ys = fitted(min.y, max.y, spacing);
    let (zs, depth) = if dimension == 2 { (vec![0.0], 1.0) } else { (fitted(min.z, max.z, spacing), max.z - min.z) };
    let size = (max.x - min.x) * (max.y - min.y) * depth;
    let volume = size / (xs.len() * ys.len() * zs.len()) as f64;
    let mut particles = Vec::with_capacity(xs.len() * ys.len() * zs.len());
    for &x in &xs {
        for &y in &ys {
            particles.extend(zs.iter().map(|&z| SolidParticle { position: DVec3::new(x, y, z), volume }));
        }
    }
    particles
}

/// Particles of a disc round the origin with the area in m² that each stands for.
fn disc(radius: f64, spacing: f64) -> Vec<(DVec2, f64)> {
    let (inner_radii, thickness) = fitted_rings(radius, spacing);
    let mut particles = Vec::new();
    for inner in inner_radii {
        let places = ring(inner + 0.5 * thickness, thickness);
        let outer = inner + thickness;
        let area = PI * (outer * outer - inner * inner) / places.len() as f64;
        particles.extend(places.into_iter().map(|place| (place, area)));
    }
    particles
}

fn fill_cylinder(center: DVec3, axis: Axis, radius: f64, length: f64, spacing: f64) -> Vec<SolidParticle> {
    let slice = disc(radius, spacing);
    let along = fitted(-0.5 * length, 0.5 * length, spacing);
    let thickness = length / along.len() as f64;
    let mut particles = Vec::with_capacity(slice.len() * along.len());
    for height in along {
        particles.extend(slice.iter().map(|(offset, area)| SolidParticle {
            position: center + axis.compose(offset.to_array(), height),
            volume: area * thickness,
        }));
    }
    particles
}

fn fill_sphere(center: DVec3, radius: f64, spacing: f64) -> Vec<SolidParticle> {
    let (inner_radii, thickness) = fitted_rings(radius, spacing);
    let mut particles = Vec::new();
    for inner in inner_radii {
        let places = shell(inner + 0.5 * thickness, thickness);
        let size = 4.0 / 3.0 * PI * ((inner + thickness).powi(3) - inner.powi(3));
        let volume = size / places.len() as f64;
        particles.extend(places.into_iter().map(|place| SolidParticle { position: center + place, volume }));
    }
    particles
}

fn fill_lattice(shape: &Shape, spacing: f64, dimension: usize) -> Vec<SolidParticle> {
    let (low, _) = shape.bounds();
    // Centres on the surface itself are left out, whatever the rounding.
    let points = lattice(shape, dimension, spacing, low, 1e-9 * spacing);
    let cell = if dimension == 2 { spacing * spacing } else { spacing.powi(3) };
    let volume = shape.measure(dimension).map_or(cell, |size| size / points.len() as f64);
    points.into_iter().map(|point| SolidParticle { position: point.position, volume }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Point;
    use super::super::test_support::{SLOPE_TANK, corners};
    use super::*;

    fn total(particles: &[SolidParticle]) -> f64 {
        particles.iter().map(|particle| particle.volume).sum()
    }

    /// Second moment of the particles about z through the origin, point masses only.
    fn polar_moment(particles: &[SolidParticle]) -> f64 {
        particles.iter().map(|particle| particle.volume * particle.position.truncate().length_squared()).sum()
    }

    #[test]
    fn box_is_stretched_to_fit() {
        let shape = Shape::Box { min: Point::plane(0.0, 0.0), max: Point::plane(0.32, 0.1) };
        let particles = solid_particles(&shape, 0.05, 2);
        assert_eq!(particles.len(), 6 * 2);
        assert!((total(&particles) - 0.032).abs() < 1e-16);
        assert!(particles[0].position.distance(DVec3::new(0.32 / 12.0, 0.025, 0.0)) < 1e-15);
        let cube = Shape::Box { min: Point::space(0.0, 0.0, 0.0), max: Point::space(0.2, 0.2, 0.2) };
        let particles = solid_particles(&cube, 0.05, 3);
        assert_eq!(particles.len(), 64);
        assert!((total(&particles) - 0.008).abs() < 1e-16);
    }

    #[test]
    fn disc_has_exact_area_and_nearly_exact_moment() {
        let shape = Shape::Circle { center: Point::plane(0.0, 0.0), radius: 0.5 };
        let particles = solid_particles(&shape, 0.03, 2);
        assert!((total(&particles) - PI * 0.25).abs() < 1e-14);
        let exact = PI * 0.5_f64.powi(4) / 2.0;
        assert!((polar_moment(&particles) / exact - 1.0).abs() < 0.005);
        assert!(particles.iter().all(|particle| shape.contains(particle.position) && particle.position.z == 0.0));
        assert!(particles.iter().all(|particle| (particle.volume / 9e-4 - 1.0).abs() < 0.3), "cells of similar size");
    }

    #[test]
    fn round_solids_have_exact_volumes() {
        let center = Point::space(0.0, 0.0, 0.0);
        let sphere = Shape::Sphere { center, radius: 0.3 };
        let particles = solid_particles(&sphere, 0.04, 3);
        assert!((total(&particles) - 4.0 / 3.0 * PI * 0.027).abs() < 1e-14);
        assert!((polar_moment(&particles) / (8.0 / 15.0 * PI * 0.3_f64.powi(5)) - 1.0).abs() < 0.02);
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            let cylinder = Shape::Cylinder { center, axis, radius: 0.2, length: 0.7 };
            let particles = solid_particles(&cylinder, 0.04, 3);
            assert!((total(&particles) - PI * 0.028).abs() < 1e-14);
            assert!(particles.iter().all(|particle| cylinder.contains(particle.position)));
        }
    }

    #[test]
    fn lattice_bodies_share_their_size_or_take_cells() {
        let tank = Shape::Polygon(corners(&SLOPE_TANK));
        assert!((total(&solid_particles(&tank, 0.05, 2)) - 5.375).abs() < 1e-12);
        let prism = Shape::Prism { polygon: corners(&SLOPE_TANK), z: (0.0, 0.4) };
        assert!((total(&solid_particles(&prism, 0.1, 3)) - 2.15).abs() < 1e-12);
        let block = Shape::Box { min: Point::plane(0.0, 0.0), max: Point::plane(0.4, 0.2) };
        let hole = Shape::Box { min: Point::plane(0.1, 0.1), max: Point::plane(0.2, 0.2) };
        let particles = solid_particles(&Shape::Difference { of: Box::new(block), minus: vec![hole] }, 0.05, 2);
        assert_eq!(particles.len(), 28);
        assert!(particles.iter().all(|particle| (particle.volume - 0.0025).abs() < 1e-18));
    }

    #[test]
    fn tiny_shapes_get_what_there_is() {
        let dot = Shape::Circle { center: Point::plane(0.0, 0.0), radius: 0.001 };
        assert!((total(&solid_particles(&dot, 0.1, 2)) - PI * 1e-6).abs() < 1e-18);
        let sliver = Shape::Polygon(corners(&[(0.0, 0.0), (0.01, 0.0), (0.0, 0.01)]));
        assert!(solid_particles(&sliver, 0.1, 2).is_empty());
    }
}
