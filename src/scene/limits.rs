//! How many particles a scene may have.

use std::f64::consts::PI;

use bevy_ecs::prelude::*;
use glam::DVec3;
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

use super::geometry::{Shape, Side, lining_measure};
use super::{FluidsSection, Invalid, Resolution, SceneDocument, SceneSection};
use crate::boundary::{StructuresSection, WallsSection};
use crate::error::UserError;
use crate::kernels::SmoothingKernel;
use crate::neighbours::{FIRST_HALF_SKIN, NeighbourSettings};
use crate::number::{bytes, plain, short};

/// More particles than this are a mistake in the scene rather than a case that a machine of today runs.
const MOST_PARTICLES: f64 = 5e7;

/// Refuses a box that would need too many particles, before any is made.
pub(crate) fn limit_particles((min, max): (DVec3, DVec3), resolution: &Resolution) -> Result<(), Invalid> {
    let cells = |spacing: f64| {
        let lengths = (max - min).to_array();
        lengths[..resolution.dimension].iter().map(|length| (length / spacing).ceil().max(1.0)).product::<f64>()
    };
    let needed = cells(resolution.spacing);
    // NaN and infinity are too many as well.
    if needed <= MOST_PARTICLES {
        return Ok(());
    }
    let mut fits = resolution.spacing.max(f64::MIN_POSITIVE);
    while cells(fits) > MOST_PARTICLES && fits.is_finite() {
        fits *= 2.0;
    }
    Err(Invalid::new(
        "",
        format!(
            "needs {} particles at a spacing of {} m, more than the {MOST_PARTICLES:.0e} that are allowed: a spacing of \
             {fits:.3e} m would do",
            if needed < 1e15 { format!("up to {needed:.1e}") } else { about(needed) },
            plain(resolution.spacing),
        ),
    ))
}

/// Bytes that a particle takes besides its pairs: its columns and the change ticks of each, the packed records of the sweeps, where it
/// was when lists were built, its part of a frame of the log and of that frame's chunk.
const BYTES_PER_PARTICLE: f64 = 620.0;

/// Bytes of a pair that a sweep over the fluid meets: a quarter of the neighbour's row, since four particles share a list. Mostly half of
/// that in the plane, where 16 bits hold the row.
const BYTES_PER_FLUID_PAIR: f64 = 1.0;

/// Bytes of a pair of a ghost: the neighbour's row and one kernel column.
const BYTES_PER_GHOST_PAIR: f64 = 12.0;

/// Lists grow by doubling: on average a third of their memory is not in use.
const SLACK: f64 = 1.5;

/// Estimated bytes of so many particles with so many pairs of the fluid and of ghosts.
pub(crate) fn bytes_of(particles: f64, fluid_pairs: f64, ghost_pairs: f64) -> f64 {
    let pairs = fluid_pairs * BYTES_PER_FLUID_PAIR + ghost_pairs * BYTES_PER_GHOST_PAIR;
    particles * BYTES_PER_PARTICLE + pairs * SLACK
}

/// A particle meets half as many neighbours again as it reaches: those of the three with which it shares a list.
const MET: f64 = 1.5;

/// What a scene is made of, in areas (m²) or volumes (m³).
struct Contents {
    fluids: f64,
    structures: f64,
    /// Shapes of the walls, and the side of their ghosts.
    walls: Vec<(Shape, Side)>,
    dimension: usize,
    /// Layers of ghosts.
    layers: f64,
    /// Listed neighbours of a particle with fluid all around it.
    neighbours: f64,
}

impl Contents {
    /// What the document of `world` names, read before any of it is made. What is wrong or too large in itself is left to its own
    /// section.
    fn of(world: &World) -> Self {
        let resolution = world.resource::<Resolution>();
        let Resolution { dimension, spacing, .. } = *resolution;
        let kernel = world.resource::<SmoothingKernel>();
        let skin = world.resource::<NeighbourSettings>().skin.unwrap_or(2.0 * FIRST_HALF_SKIN);
        let reach = (1.0 + skin) * kernel.0.radius() / spacing;
        let document = &world.resource::<SceneDocument>().0;
        let is_sound =
            |shape: &Shape| shape.check(dimension).is_ok() && limit_particles(shape.bounds(), resolution).is_ok();
        let size = |shapes: Vec<Shape>| -> f64 {
            shapes.iter().filter(|shape| is_sound(shape)).map(|shape| greatest_measure(shape, dimension)).sum()
        };
        let read_fluids = document.read::<FluidsSection>(FluidsSection::NAME);
        let read_structures = document.read::<StructuresSection>(StructuresSection::NAME);
        let read_walls = document.read::<WallsSection>(WallsSection::NAME);
        let walls = read_walls.map(|walls| walls.shapes()).unwrap_or_default();
        Self {
            fluids: size(read_fluids.map(|fluids| fluids.shapes()).unwrap_or_default()),
            structures: size(read_structures.map(|structures| structures.shapes()).unwrap_or_default()),
            walls: walls.into_iter().filter(|(shape, _)| is_sound(shape)).collect(),
            dimension,
            layers: (kernel.0.radius() / spacing).ceil(),
            neighbours: if dimension == 2 { PI * reach.powi(2) } else { 4.0 / 3.0 * PI * reach.powi(3) },
        }
    }

    /// Particles of fluids, walls and structures at this spacing (m).
    fn particles(&self, spacing: f64) -> [f64; 3] {
        let lining =
            |(shape, side): &(Shape, Side)| lining_measure(shape, *side, self.layers * spacing, self.dimension);
        let walls: f64 = self.walls.iter().map(lining).sum();
        [self.fluids, walls, self.structures].map(|size| size / spacing.powi(self.dimension as i32))
    }

    /// Bytes that they take; ghosts have fluid on one side only.
    fn bytes(&self, spacing: f64) -> f64 {
        let [fluid, wall, structure] = self.particles(spacing);
        let ghosts = wall + structure;
        bytes_of(fluid + ghosts, MET * fluid * self.neighbours, 0.5 * ghosts * self.neighbours)
    }

    /// Refuses what needs more than `available` bytes at this spacing (m).
    fn fit(&self, spacing: f64, available: f64) -> Result<(), Invalid> {
        let needed = self.bytes(spacing);
        if needed <= available {
            return Ok(());
        }
        let mut coarser = spacing;
        while self.bytes(coarser) > available && coarser.is_finite() {
            coarser *= 1.02;
        }
        // Not less after rounding.
        let coarser = short(1.001 * coarser);
        let [fluid, wall, structure] = self.particles(spacing).map(about);
        let memory = if needed < 1e15 { format!("about {}", bytes(needed)) } else { "more than 1000 TB".to_owned() };
        let message = format!(
            "{fluid} fluid, {wall} wall and {structure} structure particles need {memory} of memory, but {} are free: a \
             spacing of {coarser} m would do",
            bytes(available)
        );
        Err(Invalid::new("spacing", message))
    }
}

/// A great number, in a few letters.
fn about(count: f64) -> String {
    // An empty sum is −0.
    if count < 1e15 { short(count.round() + 0.0) } else { "more than 1e15".to_owned() }
}

/// Refuses a scene whose fluids, walls and structures would together need more memory than is free, before any of their
/// particles is made.
pub(crate) fn limit_memory(world: &World) -> Result<(), UserError> {
    let spacing = world.resource::<Resolution>().spacing;
    let contents = Contents::of(world);
    // A small scene fits any machine, and asking takes a moment. No number comes of a spacing whose powers are infinite.
    if contents.particles(spacing).iter().sum::<f64>() > 1e5 {
        let document = &world.resource::<SceneDocument>().0;
        contents.fit(spacing, available_memory()).map_err(|invalid| document.invalid(&invalid))?;
    }
    Ok(())
}

/// Memory (bytes) that the program can have, within the limits of its container.
pub(crate) fn available_memory() -> f64 {
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
    use super::super::geometry::Point;
    use super::*;

    #[test]
    fn memory_is_that_of_all_particles_and_a_coarser_spacing_fits() {
        let cube = |side: f64| Shape::Box { min: Point::space(0.0, 0.0, 0.0), max: Point::space(side, side, side) };
        let contents = Contents {
            fluids: 1.0,
            structures: 0.0,
            walls: vec![(cube(1.0), Side::Outside)],
            dimension: 3,
            layers: 4.0,
            neighbours: 268.0,
        };
        // A cube of 1 m: 10⁶ particles, which meet 402 others at 1.5 bytes, and 108³ − 10⁶ ghosts with 18 bytes a pair.
        let ghosts = 108.0_f64.powi(3) - 1e6;
        let needed = 1e6 * (620.0 + 402.0 * 1.5) + ghosts * (620.0 + 134.0 * 18.0);
        assert_eq!(contents.fit(0.01, needed * 1.001), Ok(()));
        assert!(contents.fit(0.01, needed * 0.999).is_err());
        let refused = contents.fit(0.01, needed / 8.0).map_err(|invalid| invalid.message).err().unwrap_or_default();
        let (_, coarser) = refused.split_once("a spacing of ").unwrap_or_default();
        let coarser: f64 = coarser.split(' ').next().and_then(|text| text.parse().ok()).unwrap_or(f64::NAN);
        // Ghosts become fewer by a factor of 4 only where the fluid has 8 times fewer particles.
        assert!(coarser > 0.02 && coarser < 0.024, "{refused}");
        assert_eq!(contents.fit(coarser, needed / 8.0), Ok(()));
        assert!(contents.fit(1e-12, 8e9).is_err_and(|refused| refused.message.contains("more than 1000 TB")));
        assert!(available_memory() > 1e6);
    }

    #[test]
    fn shapes_without_a_closed_form_are_bounded() {
        let disc = |radius| Shape::Circle { center: Point::plane(0.0, 0.0), radius };
        let ring = Shape::Difference { of: Box::new(disc(2.0)), minus: vec![disc(1.0)] };
        assert!((greatest_measure(&Shape::Union(vec![ring, disc(1.0)]), 2) - 5.0 * PI).abs() < 1e-12);
    }
}
