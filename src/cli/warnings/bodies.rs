//! Structures in walls, and walls in one another.

use bevy_ecs::prelude::*;
use glam::DVec3;

use crate::boundary::{Body, BodyShape, LeftOut, Structure, body_shapes};
use crate::kernels::SmoothingKernel;
use crate::neighbours::PeriodicSides;
use crate::number::{count, short};
use crate::particles::{BodyIndex, Position, Solid};
use crate::scene::{Invalid, Resolution};

/// A particle of a structure that lies deeper (in spacings) than this in a wall is out of the fluid's reach.
const BURIED: f64 = 0.75;

/// Structures of which a part lies in a wall: it feels no fluid.
pub(super) fn buried_structures(world: &mut World) -> Vec<Invalid> {
    let walls: Vec<_> = body_shapes(world).into_iter().filter(|(_, _, is_structure)| !is_structure).collect();
    let (sides, depth) = (*world.resource::<PeriodicSides>(), BURIED * world.resource::<Resolution>().spacing);
    let mut structures = world.query_filtered::<&Body, With<Structure>>();
    let mut names: Vec<(u32, String)> = structures.iter(world).map(|body| (body.index, body.name.clone())).collect();
    names.sort();
    let mut particles = world.query_filtered::<(&BodyIndex, &Position), With<Solid>>();
    let mut found = Vec::new();
    for (index, name) in names {
        let own: Vec<DVec3> = particles.iter(world).filter(|(body, _)| body.0 == index).map(|(_, x)| x.0).collect();
        for (wall, shape, _) in &walls {
            let buried = own.iter().filter(|x| shape.clearance_through(&sides, **x) < -depth).count();
            if buried > 0 {
                let share = short(100.0 * buried as f64 / own.len() as f64);
                let message = format!("{share} % of it lies in the wall `{wall}`, where it feels no fluid");
                found.push(Invalid::new(format!("structures.{name}.shape"), message));
            }
        }
    }
    found
}

/// A structure with no particle deeper (in spacings) than this has one or two layers of them.
const THIN: f64 = 0.75;

/// Structures that are one or two particles thin: they lack most of the ghosts by which a wall holds fluid off.
pub(super) fn thin_structures(world: &mut World) -> Vec<Invalid> {
    let Resolution { spacing, .. } = *world.resource::<Resolution>();
    let reach = short((world.resource::<SmoothingKernel>().0.radius() / spacing).ceil());
    let mut structures = world.query_filtered::<(&Body, &BodyShape), With<Structure>>();
    let mut shapes: Vec<_> =
        structures.iter(world).map(|(body, shape)| (body.index, body.name.clone(), shape.clone())).collect();
    shapes.sort_by_key(|(index, ..)| *index);
    let mut particles = world.query_filtered::<(&BodyIndex, &Position), With<Solid>>();
    let sides = *world.resource::<PeriodicSides>();
    let is_thin = |(index, _, shape): &(u32, String, BodyShape)| {
        let mut own = particles.iter(world).filter(|(body, _)| body.0 == *index);
        own.all(|(_, x)| shape.clearance_through(&sides, x.0) > -THIN * spacing)
    };
    let message = |name: String| {
        let message = format!(
            "it is one or two spacings thin: a wall that holds fluid off has {reach} layers of ghosts, and fluid that stands against one side \
             of it can be pressed through, unless a wall lies behind it"
        );
        Invalid::new(format!("structures.{name}.shape"), message)
    };
    shapes.into_iter().filter(is_thin).map(|(_, name, _)| message(name)).collect()
}

/// Walls of which nothing is left, or a part in another wall has that one's slip.
pub(super) fn overlapping_walls(world: &mut World) -> Vec<Invalid> {
    let mut found = Vec::new();
    for (name, left_out) in left_out(world) {
        let LeftOut { ghosts, of, walls, of_other_slip } = left_out;
        if ghosts == of {
            let message = format!("it lies in {} and adds nothing", these(&walls));
            found.push(Invalid::new(format!("walls.{name}.shape"), message));
        } else if !of_other_slip.is_empty() {
            let message = format!(
                "{} of its {} ghosts lie in {}, before it in the scene: there the slip of the first holds",
                count(ghosts as u64),
                count(of as u64),
                these(&of_other_slip)
            );
            found.push(Invalid::new(format!("walls.{name}.slip"), message));
        }
    }
    found
}

/// Walls that have fewer ghosts because they overlap others, in the order of the scene.
pub(in crate::cli) fn left_out(world: &mut World) -> Vec<(String, LeftOut)> {
    let mut query = world.query::<(&Body, &LeftOut)>();
    let mut found: Vec<_> = query.iter(world).collect();
    found.sort_by_key(|(body, _)| body.index);
    found.into_iter().map(|(body, left_out)| (body.name.clone(), left_out.clone())).collect()
}

/// The wall `a`, the walls `a`, `b`.
pub(in crate::cli) fn these(walls: &[String]) -> String {
    let names: Vec<String> = walls.iter().map(|name| format!("`{name}`")).collect();
    format!("the wall{} {}", if names.len() == 1 { "" } else { "s" }, names.join(", "))
}
