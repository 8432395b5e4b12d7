//! Shapes that do not fit the lattice of particles, and phases that fill nothing.

use bevy_ecs::prelude::*;
use glam::DVec3;

use crate::boundary::body_shapes;
use crate::neighbours::PeriodicSides;
use crate::number::short;
use crate::phases::phases;
use crate::scene::geometry::{Point, Shape, lattice};
use crate::scene::{FilledFluids, Invalid, Resolution};

/// How far (in spacings) a side may be off the lattice.
const TOLERANCE: f64 = 1e-6;

/// Sides along the axes, of boxes, polygons and prisms, that lie between the cells of the particles. Beside a wall the fluid is then
/// squeezed or has a gap, of up to half a spacing, and its weight makes waves of that. Parts of
/// unions and differences are not looked at.
pub(super) fn off_lattice(world: &mut World) -> Vec<Invalid> {
    let resolution = *world.resource::<Resolution>();
    let filled = world.resource::<FilledFluids>().fluids.clone();
    let fluids = filled.into_iter().enumerate().map(|(k, (shape, _))| (format!("fluids.{k}"), shape));
    // Structures are filled with particles that fit them; only what contains fluid has to fit the lattice.
    let walls = body_shapes(world).into_iter().filter(|(_, _, is_structure)| !is_structure);
    let walls = walls.map(|(name, body, _)| (format!("walls.{name}"), body.shape));
    fluids.chain(walls).filter_map(|(path, shape)| sides_off_lattice(&path, &shape, &resolution)).collect()
}

fn sides_off_lattice(path: &str, shape: &Shape, resolution: &Resolution) -> Option<Invalid> {
    let is_off = |(_, x, _): &(&str, f64, String)| {
        let cells = x / resolution.spacing;
        (cells - cells.round()).abs() > TOLERANCE
    };
    let mut found: Vec<String> = Vec::new();
    for (axis, x, of) in sides(shape, resolution.dimension).into_iter().filter(is_off) {
        let side = format!("{axis} = {} m{of}", short(x));
        if !found.contains(&side) {
            found.push(side);
        }
    }
    let (sides, spacing) = (found.join(", "), short(resolution.spacing));
    let verb = if found.len() == 1 { "is not a multiple" } else { "are not multiples" };
    let beside = if path.starts_with("walls.") { ": fluid that starts beside it is squeezed or has a gap" } else { "" };
    (!found.is_empty())
        .then(|| Invalid::new(format!("{path}.shape"), format!("{sides} {verb} of the spacing {spacing} m{beside}")))
}

/// Sides of a shape across an axis: the axis, the place (m) on it, and what has it.
fn sides(shape: &Shape, dimension: usize) -> Vec<(&'static str, f64, String)> {
    let edges = |polygon: &[Point]| {
        let corners = polygon.iter().map(|corner| corner.position());
        let pairs = corners.clone().zip(corners.cycle().skip(1));
        let across = |(from, to): (DVec3, DVec3)| {
            [("x", from.x, to.x), ("y", from.y, to.y)]
                .into_iter()
                .filter(|(_, from, to)| from == to)
                .map(|(axis, x, _)| (axis, x, String::new()))
        };
        pairs.flat_map(across).collect::<Vec<_>>()
    };
    match shape {
        Shape::Box { min, max } => {
            let corner = |name: &str, point: &Point| {
                let of = format!(" of `{name}`");
                let all = ["x", "y", "z"].into_iter().zip(point.position().to_array()).take(dimension);
                all.map(|(axis, x)| (axis, x, of.clone())).collect::<Vec<_>>()
            };
            [corner("min", min), corner("max", max)].concat()
        }
        Shape::Polygon(corners) => edges(corners),
        Shape::Prism { polygon, z } => {
            let ends = [z.0, z.1].map(|z| ("z", z, String::new()));
            edges(polygon).into_iter().chain(ends).collect()
        }
        _ => Vec::new(),
    }
}

/// Periods that are no whole number of spacings: the lattice does not join at the seam.
pub(super) fn periods_off_lattice(world: &mut World) -> Vec<Invalid> {
    let spacing = world.resource::<Resolution>().spacing;
    let axes = ["x", "y", "z"].into_iter().zip(world.resource::<PeriodicSides>().0);
    let off = |(axis, sides): (&str, Option<(f64, f64)>)| {
        let (from, to) = sides?;
        let cells = (to - from) / spacing;
        let message = format!(
            "the period of {} m is not a multiple of the spacing {} m: at the seam particles lie closer together or farther apart",
            short(to - from),
            short(spacing)
        );
        ((cells - cells.round()).abs() > TOLERANCE).then(|| Invalid::new(format!("periodic.{axis}"), message))
    };
    axes.filter_map(off).collect()
}

/// A shape is thin if it is less than this (in spacings) across along some axis.
const THIN: f64 = 3.0;

/// Greatest relative difference between the size of a thin shape and that of its particles.
const THIN_ERROR: f64 = 0.1;

/// Fluids so thin that their particles are much more or less than their shape.
pub(super) fn thin_fluids(world: &mut World) -> Vec<Invalid> {
    let resolution = *world.resource::<Resolution>();
    let Resolution { dimension, spacing, .. } = resolution;
    let thin = |(k, (shape, _)): (usize, &(Shape, f64))| {
        let (low, high) = shape.bounds();
        let across = (high - low).to_array()[..dimension].iter().copied().fold(f64::INFINITY, f64::min) / spacing;
        let exact = shape.measure(dimension).filter(|_| across < THIN)?;
        let cells = lattice(shape, dimension, spacing, DVec3::ZERO, 0.0).len();
        let share = cells as f64 * resolution.particle_volume() / exact;
        let message = format!(
            "it is {} spacings thin, and its particles fill {} % of it: a finer spacing is needed",
            short(across),
            short(100.0 * share)
        );
        ((share - 1.0).abs() > THIN_ERROR).then(|| Invalid::new(format!("fluids.{k}.shape"), message))
    };
    world.resource::<FilledFluids>().fluids.iter().enumerate().filter_map(thin).collect()
}

/// Phases without a particle.
pub(super) fn unused_phases(world: &mut World) -> Vec<Invalid> {
    let all = phases(world);
    let particles = &world.resource::<FilledFluids>().particles;
    let unused = all.iter().filter(|(phase, _)| particles.get(phase.index as usize).is_none_or(|count| *count == 0));
    unused.map(|(phase, _)| Invalid::new(format!("phases.{}", phase.name), "no fluid is of this phase")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tank with a slanted floor: its ends and its lid count, the floor does not, and what fits the lattice is not named.
    #[test]
    fn sides_along_the_axes_are_named_where_they_are_off_the_lattice() {
        let text = "Prism(polygon: [(-0.3, 0.1), (3.75, -0.93), (3.75, 0.25), (-0.3, 0.25)], z: (0.0, 1.85))";
        let shape: Shape = ron::from_str(text).expect("a shape");
        let resolution = |spacing| Resolution { dimension: 3, spacing, smoothing_length: 1.3 * spacing };
        let told = sides_off_lattice("walls.tank", &shape, &resolution(0.1)).expect("it does not fit").message;
        assert!(told.starts_with("x = 3.75 m, y = 0.25 m, z = 1.85 m are not multiples"), "{told}");
        assert!(sides_off_lattice("walls.tank", &shape, &resolution(0.05)).is_none());
    }
}
