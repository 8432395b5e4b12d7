//! Walls that overlap: what they share is lined once, by the wall that stands first in the scene.
//!
//! Ghosts in one place twice would weigh twice in every sum over neighbours, and the pressure beside them would be wrong.

use std::collections::HashMap;

use bevy_ecs::prelude::*;
use glam::DVec3;

use super::Motion;
use super::body::BodyShape;
use crate::neighbours::PeriodicSides;
use crate::particles::Slip;
use crate::scene::geometry::LatticeIndex;
use crate::scene::{Resolution, WALL_CLEARANCE};

/// Ghosts nearer (in spacings) than this to a ghost of an earlier wall are left out, besides those in its lining.
const LEAST_GAP: f64 = 0.5;

/// Ghosts of a wall that were left out because earlier walls line the same place.
#[derive(Component, Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// How many.
    pub ghosts: usize,
    /// Of how many.
    pub of: usize,
    /// The earlier walls, in the order of the scene.
    pub walls: Vec<String>,
    /// Those of them with another slip, which holds there.
    pub of_other_slip: Vec<String>,
}

/// A wall whose ghosts are placed.
struct Earlier {
    name: String,
    shape: BodyShape,
    motion: Motion,
    slip: Slip,
}

/// The walls before one, and where their ghosts are.
pub(super) struct EarlierWalls {
    walls: Vec<Earlier>,
    /// Ghosts with the index of their wall, by cells half a spacing wide.
    ghosts: HashMap<LatticeIndex, Vec<(DVec3, usize)>>,
    spacing: f64,
    /// Depth (m) of a lining.
    depth: f64,
    periodic: PeriodicSides,
}

impl EarlierWalls {
    pub(super) fn new(resolution: &Resolution, layers: usize, periodic: PeriodicSides) -> Self {
        let spacing = resolution.spacing;
        Self { walls: Vec::new(), ghosts: HashMap::new(), spacing, depth: layers as f64 * spacing, periodic }
    }

    /// Adds a wall with those of its ghosts that were not left out.
    pub(super) fn add(&mut self, name: &str, shape: &BodyShape, motion: &Motion, slip: Slip, ghosts: &[DVec3]) {
        let wall = self.walls.len();
        for x in ghosts {
            let x = self.periodic.wrap(*x);
            self.ghosts.entry(self.cell(x)).or_default().push((x, wall));
        }
        self.walls.push(Earlier { name: name.to_owned(), shape: shape.clone(), motion: motion.clone(), slip });
    }

    /// Takes out of `ghosts`, those of a further wall, what the walls before it line; says what that was, or the name of a
    /// wall that moves otherwise: the two would part, and leave a hole.
    pub(super) fn leave_out(
        &self,
        ghosts: &mut Vec<DVec3>,
        motion: &Motion,
        slip: Slip,
    ) -> Result<Option<LeftOut>, &str> {
        let mut counts = vec![0; self.walls.len()];
        let of = ghosts.len();
        ghosts.retain(|x| match self.lined_by(*x) {
            Some(wall) => {
                counts[wall] += 1;
                false
            }
            None => true,
        });
        let overlapped = || self.walls.iter().zip(&counts).filter(|(_, count)| **count > 0).map(|(wall, _)| wall);
        if let Some(other) = overlapped().find(|wall| wall.motion != *motion) {
            return Err(&other.name);
        }
        let names = |walls: &mut dyn Iterator<Item = &Earlier>| walls.map(|wall| wall.name.clone()).collect();
        Ok((ghosts.len() < of).then(|| LeftOut {
            ghosts: of - ghosts.len(),
            of,
            walls: names(&mut overlapped()),
            of_other_slip: names(&mut overlapped().filter(|wall| wall.slip != slip)),
        }))
    }

    /// The wall that has `x` (m) in its lining, or a ghost next to it, as in corners beyond the lining's depth.
    fn lined_by(&self, x: DVec3) -> Option<usize> {
        // Beyond a periodic side a container has no ghosts: what is there continues on the other side.
        let x = self.periodic.wrap(x);
        let (surface, floor) = (-WALL_CLEARANCE * self.spacing, -self.depth);
        let in_lining = |wall: &Earlier| (floor..surface).contains(&wall.shape.clearance_through(&self.periodic, x));
        self.walls.iter().position(in_lining).or_else(|| self.beside(x))
    }

    /// The wall of the first ghost nearer than [`LEAST_GAP`] spacings to `x` (m).
    fn beside(&self, x: DVec3) -> Option<usize> {
        if self.ghosts.is_empty() {
            return None;
        }
        let [i, j, k] = self.cell(x);
        let around = (-1..=1).flat_map(|a| (-1..=1).flat_map(move |b| (-1..=1).map(move |c| [i + a, j + b, k + c])));
        let mut near = around.filter_map(|cell| self.ghosts.get(&cell)).flatten();
        near.find(|(ghost, _)| ghost.distance(x) < LEAST_GAP * self.spacing).map(|(_, wall)| *wall)
    }

    fn cell(&self, x: DVec3) -> LatticeIndex {
        (x / (LEAST_GAP * self.spacing)).floor().to_array().map(|cell| cell as i64)
    }
}
