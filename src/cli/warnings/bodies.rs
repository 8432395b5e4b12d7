//! Structures in walls.

use bevy_ecs::prelude::*;
use glam::DVec3;

use crate::boundary::{Body, Structure, body_shapes};
use crate::neighbours::PeriodicSides;
use crate::number::short;
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
