//! What lies next to the fluids at the start: free surfaces, and gaps that are too thin to be one.

use std::collections::{BTreeMap, HashMap};

use bevy_ecs::prelude::*;
use glam::DVec3;

use crate::boundary::{BodyShape, body_shapes};
use crate::neighbours::PeriodicSides;
use crate::particles::{Fluid, Position};
use crate::physics::StateSettings;
use crate::scene::geometry::{LatticeIndex, Shape};
use crate::scene::{FilledFluids, Invalid, Resolution, WALL_CLEARANCE};

/// A gap is a mistake if it is so many empty cells wide, and no wider.
const WIDEST_GAP: i64 = 2;

/// A gap is a mistake if it lies along more than this part of a fluid's free face.
const GAP_SHARE: f64 = 0.5;

/// The cells of the lattice and what is in them.
struct Cells {
    fluid: CellSet,
    /// The shapes of the fluids: `Fitted` ones have no particle in some cells, and two in others.
    shapes: Vec<Shape>,
    bodies: Vec<(String, BodyShape, bool)>,
    periodic: PeriodicSides,
    resolution: Resolution,
}

/// A set of cells, block by block of eight along each axis: a bit for each cell, so that the set of a million fits a cache.
#[derive(Default)]
struct CellSet {
    blocks: HashMap<LatticeIndex, [u64; 8]>,
}

impl CellSet {
    fn of(cells: impl Iterator<Item = LatticeIndex>) -> Self {
        let mut blocks: HashMap<LatticeIndex, [u64; 8]> = HashMap::new();
        for cell in cells {
            let (block, word, bit) = Self::place(cell);
            blocks.entry(block).or_default()[word] |= bit;
        }
        Self { blocks }
    }

    fn contains(&self, cell: LatticeIndex) -> bool {
        let (block, word, bit) = Self::place(cell);
        self.blocks.get(&block).is_some_and(|words| words[word] & bit != 0)
    }

    /// Block, word in it, bit in that.
    fn place(cell: LatticeIndex) -> (LatticeIndex, usize, u64) {
        let [i, j, k] = cell.map(|index| index.rem_euclid(8));
        (cell.map(|index| index.div_euclid(8)), k as usize, 1 << (8 * j + i))
    }
}

/// What is in a cell.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Content {
    Nothing,
    Fluid,
    Body(String),
}

impl Cells {
    fn of(world: &mut World) -> Self {
        let resolution = *world.resource::<Resolution>();
        let bodies = body_shapes(world);
        let periodic = *world.resource::<PeriodicSides>();
        let shapes = world.resource::<FilledFluids>().fluids.iter().map(|(shape, _)| shape.clone()).collect();
        let mut cells = Self { fluid: CellSet::default(), shapes, bodies, periodic, resolution };
        let mut fluid = world.query_filtered::<&Position, With<Fluid>>();
        cells.fluid = CellSet::of(fluid.iter(world).map(|x| cells.index(x.0)));
        cells
    }

    fn index(&self, x: DVec3) -> LatticeIndex {
        let index = (x / self.resolution.spacing).floor().to_array().map(|cell| cell as i64);
        if self.resolution.dimension == 2 { [index[0], index[1], 0] } else { index }
    }

    fn content(&self, x: DVec3) -> Content {
        let x = self.periodic.wrap(x);
        if self.fluid.contains(self.index(x)) {
            return Content::Fluid;
        }
        let solid =
            |body: &BodyShape| body.clearance_through(&self.periodic, x) < WALL_CLEARANCE * self.resolution.spacing;
        let body = self.bodies.iter().find(|(_, body, _)| solid(body));
        match body {
            Some((name, _, true)) => Content::Body(format!("the structure `{name}`")),
            Some((name, ..)) => Content::Body(format!("the wall `{name}`")),
            None if self.shapes.iter().any(|shape| shape.contains(x)) => Content::Fluid,
            None => Content::Nothing,
        }
    }

    /// The directions in which cells have neighbours.
    fn directions(&self) -> impl Iterator<Item = (usize, DVec3)> {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().take(self.resolution.dimension);
        axes.flat_map(|axis| [axis, -axis]).map(|e| e * self.resolution.spacing).enumerate()
    }
}

/// Free faces of a fluid in one direction.
#[derive(Default)]
struct Face {
    free: usize,
    /// What lies behind a thin gap, how often, and how many cells the narrowest is wide.
    gaps: BTreeMap<Content, (usize, i64)>,
}

/// Gaps of a cell or two between the whole free face of a fluid and what it faces.
pub(super) fn gaps(world: &mut World) -> Vec<Invalid> {
    let cells = Cells::of(world);
    let fluids = world.resource::<FilledFluids>().fluids.clone();
    let mut faces: BTreeMap<(usize, usize), Face> = BTreeMap::new();
    let mut query = world.query_filtered::<&Position, With<Fluid>>();
    for x in query.iter(world) {
        for (direction, step) in cells.directions() {
            if cells.content(x.0 + step) != Content::Nothing {
                continue;
            }
            let Some(k) = fluids.iter().position(|(shape, _)| shape.contains(x.0)) else { continue };
            let face = faces.entry((k, direction)).or_default();
            face.free += 1;
            let behind = (2..=WIDEST_GAP + 1).map(|n| (n - 1, cells.content(x.0 + n as f64 * step)));
            if let Some((width, content)) = behind.into_iter().find(|(_, content)| *content != Content::Nothing) {
                let (count, narrowest) = face.gaps.entry(content).or_insert((0, width));
                (*count, *narrowest) = (*count + 1, width.min(*narrowest));
            }
        }
    }
    let mut found = Vec::new();
    for ((k, direction), face) in faces {
        for (content, (count, width)) in face.gaps {
            if (count as f64) < GAP_SHARE * face.free as f64 {
                continue;
            }
            let side = ["right (+x)", "left (−x)", "top (+y)", "bottom (−y)", "front (+z)", "back (−z)"][direction];
            let other = match content {
                Content::Body(name) => name,
                _ => "the next fluid".to_owned(),
            };
            let gap =
                if width == 1 { "a gap one particle wide".to_owned() } else { format!("a gap {width} particles wide") };
            let message = format!("on its {side} it leaves {gap} before {other}: should they touch?");
            found.push(Invalid::new(format!("fluids.{k}.shape"), message));
        }
    }
    found
}

/// A background pressure where there is a free surface, which it blows apart.
pub(super) fn background_pressure(world: &mut World) -> Vec<Invalid> {
    if world.resource::<StateSettings>().background_pressure <= 0.0 {
        return Vec::new();
    }
    let cells = Cells::of(world);
    let mut query = world.query_filtered::<&Position, With<Fluid>>();
    let is_free = |x: &&Position| cells.directions().any(|(_, step)| cells.content(x.0 + step) == Content::Nothing);
    let Some(x) = query.iter(world).filter(is_free).map(|x| x.0).reduce(|a, b| if b.y > a.y { b } else { a }) else {
        return Vec::new();
    };
    let message = format!(
        "there is a free surface, as at x = {:.4} m, y = {:.4} m, z = {:.4} m: χ presses on it from one side only and drives the \
         fluid apart; leave it at 0 or fill the scene",
        x.x, x.y, x.z
    );
    vec![Invalid::new("equation_of_state.background_pressure", message)]
}
