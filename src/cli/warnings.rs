//! What is probably not meant in a scene that can be run.

use bevy_ecs::prelude::*;

use super::number::short;
use crate::boundary::body_shapes;
use crate::scene::geometry::Shape;
use crate::scene::{FilledFluids, Resolution};

/// How far (in spacings) a side may be off the lattice.
const TOLERANCE: f64 = 1e-6;

/// Warnings about the scene of a world, a line each.
pub(super) fn warnings(world: &mut World) -> Vec<String> {
    let resolution = *world.resource::<Resolution>();
    let filled = world.resource::<FilledFluids>().fluids.clone();
    let fluids = filled.into_iter().enumerate().map(|(k, (shape, _))| (format!("fluids.{k}"), shape));
    // Structures are filled with particles that fit them; only what contains fluid has to fit the lattice.
    let walls = body_shapes(world).into_iter().filter(|(_, _, is_structure)| !is_structure);
    let walls = walls.map(|(name, body, _)| (format!("walls.{name}"), body.shape));
    fluids.chain(walls).filter_map(|(path, shape)| off_lattice(&path, &shape, &resolution)).collect()
}

/// Warnings as they are shown.
pub(super) fn text(warnings: &[String]) -> String {
    warnings.iter().map(|line| format!("Warning: {line}\n")).collect()
}

/// Says which sides of a box lie between the cells of the particles, if any do.
fn off_lattice(path: &str, shape: &Shape, resolution: &Resolution) -> Option<String> {
    let Shape::Box { min, max } = shape else { return None };
    let mut found = Vec::new();
    for (corner, point) in [("min", min.position()), ("max", max.position())] {
        for (axis, name) in ["x", "y", "z"].iter().enumerate().take(resolution.dimension) {
            let cells = point[axis] / resolution.spacing;
            if (cells - cells.round()).abs() > TOLERANCE {
                found.push(format!("{name} = {} m of `{corner}`", short(point[axis])));
            }
        }
    }
    let (sides, spacing) = (found.join(", "), short(resolution.spacing));
    let verb = if found.len() == 1 { "is not a multiple" } else { "are not multiples" };
    (!found.is_empty()).then(|| format!("{path}.shape: {sides} {verb} of the spacing {spacing} m"))
}
