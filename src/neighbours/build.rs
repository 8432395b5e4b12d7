//! When and how neighbour lists are built.

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::clusters::ClusterList;
use super::grid::Grid;
use super::list::clear_with_room_for_images;
use super::search::Search;
use super::skin::{LEAST_HALF_SKIN, greatest_half_skin, lists_are_stale, set_half_skins};
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
    /// lists serve until a particle has moved by half the skin. `None` for a half that each particle gets from its speed whenever lists
    /// are built: wide where it is fast, narrow where it rests.
    #[schemars(range(min = 0.0, max = 1.0), extend("unit" = "support radii", "derived" = "from 0.005 to 0.4 with the flow"))]
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

impl SceneSection for NeighbourSettings {
    const NAME: &'static str = "neighbours";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let sides = *world.resource::<PeriodicSides>();
        let radius = world.resource::<SmoothingKernel>().0.radius();
        if self.skin.is_none() {
            let [least, greatest] = [LEAST_HALF_SKIN, greatest_half_skin(&sides, radius)].map(|half| 2.0 * half);
            let range = format!("{least} to {greatest} support radii, with the flow");
            world.resource_mut::<SceneFacts>().resolve(&format!("{}.skin", Self::NAME), range);
        }
        // A particle must not meet its own image.
        let reach = (1.0 + self.skin.unwrap_or(2.0 * LEAST_HALF_SKIN)) * radius;
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
    /// Whether the next step needs new lists, wherever particles are.
    pub(super) is_invalid: bool,
    /// Half-skin (m) of every row, images included.
    pub(super) half_skins: Vec<f32>,
    /// Distance (m) that no listed pair exceeds.
    reach: f64,
    sort_every: u32,
    pub(super) plain_loops: bool,
    /// Edges (m) of the cells in which neighbours are looked for.
    pub(super) cell: DVec3,
    /// Where every row was when the lists were built (m).
    pub(super) positions: Vec<DVec3>,
    grid: Grid,
}

impl Neighbours {
    /// Distance (m) that no listed pair exceeds: support radius and twice the widest half-skin.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Forgets the lists, so that the next step builds new ones. (Particles that were put elsewhere need none to say so.)
    pub fn invalidate(&mut self) {
        self.is_invalid = true;
    }

    /// Whether pair loops run one particle at a time.
    pub(crate) fn has_plain_loops(&self) -> bool {
        self.plain_loops
    }

    pub(super) fn sort_is_due(&self) -> bool {
        self.sort_every > 0 && self.builds.is_multiple_of(u64::from(self.sort_every))
    }

    /// Builds the list of every table from the positions and half-skins of all rows; `radius` (m) is that of the support.
    fn build(&mut self, sides: &PeriodicSides, radius: f64, workspace: &mut Workspace) {
        let n = self;
        let (fluid, walls, structures) = (n.rows.fluid, n.rows.walls, n.rows.structures);
        let widest = f64::from(n.half_skins.iter().copied().fold(0.0, f32::max));
        n.reach = radius + 2.0 * widest;
        let reach = |row: usize| radius + f64::from(n.half_skins[row]) + widest;
        add_images(sides, reach, &mut n.positions, &mut n.rows.images);
        for image in &n.rows.images {
            n.half_skins.push(n.half_skins[image.source as usize]);
        }

        // Walls farther from all fluid than a list reaches are left out: they cost nothing.
        let (rows, owned) = (&n.rows, n.rows.owned());
        let is_fluid = |row: usize| row < fluid || (row >= owned && (rows.images[row - owned].source as usize) < fluid);
        let wet = n.positions.iter().enumerate().filter(|(row, _)| is_fluid(*row));
        let (min, max) =
            wet.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), (_, x)| (min.min(*x), max.max(*x)));
        n.grid.lay(min - n.reach, max + n.reach, n.cell, n.positions.len());
        let grid = n.grid.sort(&n.positions, &n.half_skins, is_fluid, workspace);

        let search = Search { grid, positions: &n.positions, half_skins: &n.half_skins, radius, widest };
        n.fluid.build(fluid, |rows, kind, list| search.around_cluster(rows, kind, list));
        n.walls.build(walls, |k, list| search.fluid_around(fluid + k, list));
        n.structures.build(structures, |k, list| search.fluid_around(fluid + walls + k, list));
    }
}

fn take_settings(mut neighbours: ResMut<Neighbours>, settings: Res<NeighbourSettings>, resolution: Res<Resolution>) {
    // Two spacings: four particles in a row of cells sorted along x are then two by two.
    let edge = 2.0 * resolution.spacing;
    neighbours.cell = DVec3::new(edge, edge, if resolution.dimension == 2 { f64::INFINITY } else { edge });
    neighbours.plain_loops = settings.loops == PairLoops::Plain;
    neighbours.sort_every = settings.sort_every;
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
    kernel: Res<SmoothingKernel>,
    fluid: Query<&Position, With<Fluid>>,
    walls: Query<&Position, With<Wall>>,
    structures: Query<&Position, With<Solid>>,
) {
    let n = &mut *neighbours;
    let tables: [&[Position]; 3] = [columns(&fluid), columns(&walls), columns(&structures)];
    let [fluid, walls, structures] = tables.map(<[Position]>::len);
    (n.rows.fluid, n.rows.walls, n.rows.structures) = (fluid, walls, structures);
    clear_with_room_for_images(&mut n.positions, fluid + walls + structures, n.rows.images.len());
    n.positions.extend(tables.iter().flat_map(|table| table.iter().map(|x| x.0)));
    n.build(&sides, kernel.0.radius(), &mut workspace);
    n.is_invalid = false;
    n.builds += 1;
}

/// What the lists follow from: number of builds, whether the next step needs new ones, and of the last build where particles were (m) and their half-skins (m). The order of pairs,
/// and with it the rounding of sums, is that of the last build.
type Origin = (u64, bool, Vec<DVec3>, Vec<f32>);

fn save_lists(world: &mut World, bytes: &mut Vec<u8>) -> Result<(), String> {
    let n = world.resource::<Neighbours>();
    let owned = n.rows.owned();
    encode(&(n.builds, n.is_invalid, &n.positions[..owned], &n.half_skins[..owned]), bytes)
}

fn restore_lists(world: &mut World, bytes: &[u8]) -> Result<(), String> {
    let sides = *world.resource::<PeriodicSides>();
    let (builds, is_invalid, positions, half_skins): Origin = decode(bytes)?;
    let radius = world.resource::<SmoothingKernel>().0.radius();
    world.resource_scope(|world, mut n: Mut<Neighbours>| {
        if positions.len() != n.rows.owned() || half_skins.len() != positions.len() {
            return Err(format!(
                "{} positions and {} half-skins for {} particles",
                positions.len(),
                half_skins.len(),
                n.rows.owned()
            ));
        }
        (n.positions, n.half_skins) = (positions, half_skins);
        n.build(&sides, radius, &mut world.resource_mut::<Workspace>());
        (n.builds, n.is_invalid) = (builds, is_invalid);
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
            (take_settings, (wrap_particles, sort_fluid, set_half_skins, build_lists).chain().run_if(lists_are_stale))
                .chain()
        };
        app.set_stage(Stage::Neighbours, systems(), systems());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::{KernelRegistry, QuinticSpline};

    const RADIUS: f64 = 0.1;
    /// Fluid particles, then ghosts of walls, then of structures.
    const COUNTS: [usize; 3] = [301, 60, 30];

    /// Numbers from 0 to 1, the same in every run (a linear congruential generator).
    fn noise() -> impl FnMut() -> f64 {
        let mut state = 11_u64;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// Lists of rows anywhere between periodic sides hardly farther apart than they may be, with half-skins from nothing to the widest.
    fn scattered(dimension: usize) -> (Neighbours, PeriodicSides) {
        let mut noise = noise();
        let sides = PeriodicSides([Some((0.0, 1.41 * RADIUS)), Some((0.0, 3.0 * RADIUS)), None]);
        let mut n = Neighbours { cell: DVec3::splat(0.4 * RADIUS), ..Neighbours::default() };
        [n.rows.fluid, n.rows.walls, n.rows.structures] = COUNTS;
        for _ in 0..n.rows.owned() {
            let z = if dimension == 3 { 4.0 * noise() } else { 0.0 };
            n.positions.push(RADIUS * DVec3::new(1.41 * noise(), 3.0 * noise(), z));
            n.half_skins.push((0.2 * RADIUS * noise().powi(4)) as f32);
        }
        n.build(&sides, RADIUS, &mut Workspace::default());
        (n, sides)
    }

    #[test]
    fn every_pair_nearer_than_the_support_and_both_half_skins_is_listed() {
        for dimension in [2, 3] {
            let (n, sides) = scattered(dimension);
            let reaches = |i: usize, j: usize| {
                let reach = RADIUS + f64::from(n.half_skins[i]) + f64::from(n.half_skins[j]);
                sides.separation(n.positions[i], n.positions[j]).length() < reach
            };
            let [fluid, walls, _] = COUNTS;
            for i in 0..fluid {
                let listed: Vec<usize> = n.fluid.of(i).rows().map(|row| n.rows.source(row)).collect();
                let missing = (0..n.rows.owned()).find(|&j| reaches(i, j) && !listed.contains(&j));
                assert_eq!(missing, None, "near particle {i}, {dimension}D");
            }
            for b in fluid..n.rows.owned() {
                let list = if b < fluid + walls { n.walls.of(b - fluid) } else { n.structures.of(b - fluid - walls) };
                let listed: Vec<usize> = list.rows.iter().map(|row| n.rows.source(*row)).collect();
                let missing = (0..fluid).find(|&j| reaches(b, j) && !listed.contains(&j));
                assert_eq!(missing, None, "near ghost {b}, {dimension}D");
            }
        }
    }

    #[test]
    fn a_checkpoint_remembers_that_lists_are_to_be_built() {
        let mut registry = KernelRegistry::default();
        registry.register("quintic", QuinticSpline);
        let kernel = registry.scaled("quintic", RADIUS / 3.0, 2).expect("registered above");
        for is_invalid in [false, true] {
            let (mut n, sides) = scattered(2);
            n.is_invalid = is_invalid;
            let mut world = World::new();
            world.insert_resource(n);
            world.insert_resource(sides);
            world.insert_resource(kernel.clone());
            world.init_resource::<Workspace>();
            let mut bytes = Vec::new();
            save_lists(&mut world, &mut bytes).expect("it can be written");
            world.resource_mut::<Neighbours>().is_invalid = !is_invalid;
            restore_lists(&mut world, &bytes).expect("it was written so");
            assert_eq!(world.resource::<Neighbours>().is_invalid, is_invalid);
        }
    }
}
