//! When and how neighbour lists are built.

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::clusters::{ClusterList, Kind};
use super::grid::Grid;
use super::sort::sort_fluid;
use super::{PairList, PeriodicSides, Rows, add_images};
use crate::app::StoreggaApp;
use crate::checkpoint::{SavedState, decode, encode};
use crate::kernels::SmoothingKernel;
use crate::particles::{Fluid, PeriodShift, Position, RestPosition, Solid, Wall, Workspace, columns};
use crate::scene::{Invalid, Resolution, SceneDocument, SceneFacts, SceneSection, SectionError};
use crate::schedule::Stage;

/// How neighbour lists are kept: section `neighbours` of a scene. It decides about speed; results change by rounding
/// only.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct NeighbourSettings {
    /// Width of the skin, in units of the kernel's support radius: pairs up to (1 + skin) radii apart are listed, and
    /// lists serve until a particle has moved by half the skin. `None` for one that each list gets from how far particles moved
    /// in a step since the last: wide where they are fast, narrow where they rest.
    #[schemars(range(min = 0.0, max = 1.0), extend("unit" = "support radii", "derived" = "from 0.005 to 0.15 with the flow"))]
    pub skin: Option<f64>,
    /// Fluid particles are re-sorted in memory at every so many-th build of the lists; 0 for never. Four that follow one
    /// another share a list: it is short where they lie side by side.
    #[schemars(extend("unit" = "builds of lists"))]
    pub sort_every: u32,
    /// How pair loops run.
    pub loops: PairLoops,
}

/// How pair loops run. The results are the same to the bit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum PairLoops {
    /// One particle at a time: the formulas as they stand.
    Plain,
    /// Four particles side by side.
    #[default]
    Fast,
}

impl Default for NeighbourSettings {
    fn default() -> Self {
        Self { skin: None, sort_every: 1, loops: PairLoops::Fast }
    }
}

/// The skins that lists get if the scene gives none: what the first has, and the bounds of the others (in support radii).
pub(crate) const FIRST_SKIN: f64 = 0.05;
const LEAST_SKIN: f64 = 0.005;
const GREATEST_SKIN: f64 = 0.15;

/// The greatest skin (in support radii) with which no particle meets its own image.
fn greatest_skin(sides: &PeriodicSides, radius: f64) -> f64 {
    let periods = sides.0.into_iter().flatten().map(|(from, to)| to - from);
    periods.map(|period| period / radius - 1.0).fold(GREATEST_SKIN, f64::min)
}

/// A step costs `C_l 2x/s` for lists and `C_p (1 + a s)` for sweeps, s the skin and x how far particles move in a step, in support
/// radii. That is least with `s = √(2 C_l/(a C_p)) √x`; in the plane `C_l ≈ 0.5 C_p` and a ≈ 1.6 were measured.
const SKIN_FOR_MOTION: f64 = 0.8;

impl SceneSection for NeighbourSettings {
    const NAME: &'static str = "neighbours";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let sides = *world.resource::<PeriodicSides>();
        let radius = world.resource::<SmoothingKernel>().0.radius();
        if self.skin.is_none() {
            let range = format!("{LEAST_SKIN} to {} support radii, with the flow", greatest_skin(&sides, radius));
            world.resource_mut::<SceneFacts>().resolve(&format!("{}.skin", Self::NAME), range);
        }
        // A particle must not meet its own image.
        let reach = (1.0 + self.skin.unwrap_or(LEAST_SKIN)) * radius;
        for (axis, sides) in ["x", "y", "z"].iter().zip(sides.0) {
            if let Some((from, to)) = sides.filter(|(from, to)| to - from < reach) {
                let message = format!("a period of {} m is too short: neighbours are {reach} m away", to - from);
                let document = &world.resource::<SceneDocument>().0;
                return Err(document.invalid(&Invalid::new(format!("periodic.{axis}"), message)).into());
            }
        }
        world.insert_resource(self);
        Ok(())
    }
}

/// Neighbour lists of every table, the numbering of rows they use, and how long they still serve.
#[derive(Resource, Default)]
pub struct Neighbours {
    /// The numbering of rows.
    pub rows: Rows,
    /// What is near each fluid particle: rows of every kind.
    pub fluid: ClusterList,
    /// Fluid neighbours of each wall particle. With W.
    pub walls: PairList,
    /// Fluid neighbours of each structure particle. With W and ∇W.
    pub structures: PairList,
    /// Number of times that lists were built.
    pub builds: u64,
    /// Greatest distance (m) that any particle can have moved since the last build.
    travelled: f64,
    /// Distance (m) up to which pairs are listed.
    reach: f64,
    /// Width of the skin (m).
    skin: f64,
    /// Steps since the last build.
    steps: u64,
    sort_every: u32,
    pub(super) plain_loops: bool,
    /// Edges (m) of the cells in which neighbours are looked for.
    pub(super) cell: DVec3,
    positions: Vec<DVec3>,
    grid: Grid,
}

impl Neighbours {
    /// Takes into account that particles moved by at most `distance` (m).
    pub fn moved(&mut self, distance: f64) {
        self.travelled += distance;
    }

    /// Distance (m) up to which pairs are listed: support radius and skin.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Forgets the lists, so that the next step builds new ones (after particles were put elsewhere).
    pub fn invalidate(&mut self) {
        self.travelled = f64::INFINITY;
    }

    /// Whether pair loops run one particle at a time.
    pub(crate) fn has_plain_loops(&self) -> bool {
        self.plain_loops
    }

    pub(super) fn sort_is_due(&self) -> bool {
        self.sort_every > 0 && self.builds.is_multiple_of(u64::from(self.sort_every))
    }

    fn set_skin(&mut self, skin: f64, radius: f64) {
        self.skin = skin;
        self.reach = radius + skin;
    }

    /// Builds the list of every table from the positions of all rows.
    fn build(&mut self, sides: &PeriodicSides, workspace: &mut Workspace) {
        let n = self;
        let (fluid, walls, structures) = (n.rows.fluid, n.rows.walls, n.rows.structures);
        add_images(sides, n.reach, &mut n.positions, &mut n.rows.images);

        // Walls farther from all fluid than a list reaches are left out: they cost nothing.
        let (rows, owned) = (&n.rows, n.rows.owned());
        let is_fluid = |row: usize| row < fluid || (row >= owned && (rows.images[row - owned].source as usize) < fluid);
        let wet = n.positions.iter().enumerate().filter(|(row, _)| is_fluid(*row));
        let (min, max) =
            wet.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), (_, x)| (min.min(*x), max.max(*x)));
        n.grid.lay(min - n.reach, max + n.reach, n.cell, n.positions.len());
        let grid = n.grid.sort(&n.positions, is_fluid, workspace);

        let (positions, reach, reach_squared) = (&n.positions, n.reach, n.reach * n.reach);
        n.fluid.build(fluid, |rows, kind, list| {
            let cluster = &positions[rows];
            let (min, max) = cluster.iter().fold((cluster[0], cluster[0]), |(min, max), x| (min.min(*x), max.max(*x)));
            let near = |x: DVec3| {
                (x.clamp(min, max) - x).length_squared() < reach_squared
                    && cluster.iter().any(|x_i| x_i.distance_squared(x) < reach_squared)
            };
            grid.around((min - reach, max + reach), |entries| {
                let of_kind = entries.iter().filter(|e| e.is_fluid() == (kind == Kind::Fluid));
                list.extend(of_kind.filter(|e| near(e.position())).map(|e| e.row));
            });
        });
        let fluid_near = |row: usize, list: &mut Vec<u32>| {
            let x = positions[row];
            grid.around((x - reach, x + reach), |entries| {
                let fluid = entries.iter().filter(|e| e.is_fluid());
                list.extend(fluid.filter(|e| e.position().distance_squared(x) < reach_squared).map(|e| e.row));
            });
        };
        n.walls.build(walls, |k, list| fluid_near(fluid + k, list));
        n.structures.build(structures, |k, list| fluid_near(fluid + walls + k, list));
    }
}

/// Two particles that approach each other use up the skin twice as fast as one.
fn lists_are_stale(neighbours: Res<Neighbours>) -> bool {
    neighbours.builds == 0 || 2.0 * neighbours.travelled > neighbours.skin
}

fn count_step(mut neighbours: ResMut<Neighbours>, settings: Res<NeighbourSettings>, resolution: Res<Resolution>) {
    // Two spacings: four particles in a row of cells sorted along x are then two by two.
    let edge = 2.0 * resolution.spacing;
    neighbours.cell = DVec3::new(edge, edge, if resolution.dimension == 2 { f64::INFINITY } else { edge });
    neighbours.plain_loops = settings.loops == PairLoops::Plain;
    neighbours.sort_every = settings.sort_every;
    neighbours.steps += 1;
}

/// Gives the lists to be built their skin.
fn set_skin(
    mut neighbours: ResMut<Neighbours>,
    settings: Res<NeighbourSettings>,
    sides: Res<PeriodicSides>,
    kernel: Res<SmoothingKernel>,
) {
    let radius = kernel.0.radius();
    let greatest = greatest_skin(&sides, radius);
    let travelled_a_step = neighbours.travelled / neighbours.steps as f64;
    let with_flow = || match neighbours.builds {
        0 => FIRST_SKIN.min(greatest),
        // Particles were put elsewhere: how fast they are is not known.
        _ if travelled_a_step.is_infinite() => neighbours.skin / radius,
        _ => (SKIN_FOR_MOTION * (travelled_a_step / radius).sqrt()).min(greatest).max(LEAST_SKIN),
    };
    let skin = settings.skin.unwrap_or_else(with_flow) * radius;
    neighbours.set_skin(skin, radius);
}

/// Puts particles that left through a periodic side back in at the other.
fn wrap_particles(
    sides: Res<PeriodicSides>,
    mut fluid: Query<&mut Position, With<Fluid>>,
    mut ghosts: Query<(&mut Position, &mut RestPosition, &mut PeriodShift), Without<Fluid>>,
) {
    if !sides.any() {
        return;
    }
    fluid.iter_mut().for_each(|mut x| x.0 = sides.wrap(x.0));
    for (mut x, mut rest, mut shifted) in &mut ghosts {
        // The whole motion of a ghost starts from its rest position: it goes round with it.
        let shift = sides.wrap(x.0) - x.0;
        x.0 += shift;
        rest.0 += shift;
        shifted.0 += shift;
    }
}

/// Collects the positions of every table and builds the lists.
fn build_lists(
    mut neighbours: ResMut<Neighbours>,
    mut workspace: ResMut<Workspace>,
    sides: Res<PeriodicSides>,
    fluid: Query<&Position, With<Fluid>>,
    walls: Query<&Position, With<Wall>>,
    structures: Query<&Position, With<Solid>>,
) {
    let n = &mut *neighbours;
    let tables: [&[Position]; 3] = [columns(&fluid), columns(&walls), columns(&structures)];
    let [fluid, walls, structures] = tables.map(<[Position]>::len);
    (n.rows.fluid, n.rows.walls, n.rows.structures) = (fluid, walls, structures);
    n.positions.clear();
    // Images, of which there are now more and now fewer, follow.
    let images = n.rows.images.len();
    n.positions.reserve_exact(fluid + walls + structures + images + images / 4);
    n.positions.extend(tables.iter().flat_map(|table| table.iter().map(|x| x.0)));
    n.build(&sides, &mut workspace);
    (n.travelled, n.steps) = (0.0, 0);
    n.builds += 1;
}

/// What the lists follow from: number of builds, steps since the last one and how far particles have moved in them (m), the skin
/// (m), and where particles were at the last build (m). The order of pairs, and with it the rounding of sums, is that of the last build.
type Origin = (u64, u64, f64, f64, Vec<DVec3>);

fn save_lists(world: &mut World, bytes: &mut Vec<u8>) -> Result<(), String> {
    let n = world.resource::<Neighbours>();
    encode(&(n.builds, n.steps, n.travelled, n.skin, &n.positions[..n.rows.owned()]), bytes)
}

fn restore_lists(world: &mut World, bytes: &[u8]) -> Result<(), String> {
    let sides = *world.resource::<PeriodicSides>();
    let (builds, steps, travelled, skin, positions): Origin = decode(bytes)?;
    let radius = world.resource::<SmoothingKernel>().0.radius();
    world.resource_scope(|world, mut n: Mut<Neighbours>| {
        if positions.len() != n.rows.owned() {
            return Err(format!("{} positions for {} particles", positions.len(), n.rows.owned()));
        }
        n.positions = positions;
        n.set_skin(skin, radius);
        n.build(&sides, &mut world.resource_mut::<Workspace>());
        (n.builds, n.steps, n.travelled) = (builds, steps, travelled);
        Ok(())
    })
}

/// Neighbour lists and their stage.
pub struct NeighboursPlugin;

impl Plugin for NeighboursPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Neighbours>().init_resource::<Workspace>().register_rebuilt::<Workspace>();
        // It holds nothing from one system to the next.
        app.allow_ambiguous_resource::<Workspace>();
        app.register_rebuilt::<PeriodicSides>();
        SavedState::register_with::<Neighbours>(app.world_mut(), save_lists, restore_lists);
        app.register_scene_section::<NeighbourSettings>();
        let systems = || {
            (count_step, (set_skin, wrap_particles, sort_fluid, build_lists).chain().run_if(lists_are_stale)).chain()
        };
        app.set_stage(Stage::Neighbours, systems(), systems());
    }
}
