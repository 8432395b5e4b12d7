//! Fluids of a scene: shapes filled with particles of a phase.

use std::collections::{BTreeMap, HashMap};

use bevy_ecs::prelude::*;
use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::geometry::{LatticeIndex, Point, Shape, coordinates, lattice};
use super::hydrostatics::Column;
use super::{Invalid, Resolution, SceneSection, SectionError};
use crate::boundary::{BodyShape, body_shapes};
use crate::neighbours::PeriodicSides;
use crate::particles::{Density, Fluid, Mass, ParticleId, PhaseIndex, Position, Pressure, ReferenceDensity, Velocity};
use crate::phases::{phase_named, phases};
use crate::physics::{EquationOfState, Gravity, StateSettings};

/// Section `fluids`: what is filled with which phase.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FluidsSection(Vec<FluidSpec>);

/// A body of fluid at the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FluidSpec {
    /// Name of its phase.
    pub phase: String,
    /// What it fills (m). Structures displace it.
    pub shape: Shape,
    /// Velocity (m/s) at the start; `None` for rest.
    #[serde(default)]
    pub velocity: Option<Point>,
    /// Pressure at the start.
    #[serde(default)]
    pub pressure: InitialPressure,
}

/// Pressure of a fluid at the start; its density follows from Eq. 7, and the mass of a particle from its density, so
/// that the fluid fills its space.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum InitialPressure {
    /// That of the stacked layers above it, at rest and compressed by their weight.
    #[default]
    Hydrostatic,
    /// One value above the background pressure (Pa).
    Uniform(f64),
}

/// What was filled: shape and reference density (kg/m³) of each fluid, for exact solutions.
#[derive(Resource, Debug, Clone, Default)]
pub struct FilledFluids {
    /// Shape and reference density.
    pub fluids: Vec<(Shape, f64)>,
    /// Number of particles of each phase.
    pub particles: Vec<usize>,
}

/// A particle may not be nearer (in spacings) to the surface of a wall or structure than this: on a slanted wall the
/// lattice has places exactly on the surface.
const WALL_CLEARANCE: f64 = 0.25;

/// Fluid that reaches deeper (in spacings) into a wall than this is a mistake in the scene.
const OVERLAP: f64 = 0.75;

/// Cells whose centre lies on the edge of a shape, to rounding (in spacings), belong to it.
const EDGE: f64 = 1e-9;

/// A particle to be.
struct Seed {
    index: LatticeIndex,
    position: DVec3,
    fluid: usize,
}

impl SceneSection for FluidsSection {
    const NAME: &'static str = "fluids";

    fn check(&self, world: &World) -> Result<(), Invalid> {
        let dimension = world.resource::<Resolution>().dimension;
        if self.0.is_empty() {
            return Err(Invalid::new("", "a scene needs at least one fluid"));
        }
        for (k, fluid) in self.0.iter().enumerate() {
            fluid.shape.check(dimension).map_err(|invalid| invalid.under("shape").under(&k.to_string()))?;
            if let Some(velocity) = fluid.velocity {
                coordinates(velocity, dimension).map_err(|invalid| invalid.under(&format!("{k}.velocity")))?;
            }
        }
        Ok(())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let mut kinds = Vec::new();
        for (k, fluid) in self.0.iter().enumerate() {
            kinds.push(phase_named(world, &format!("{k}.phase"), &fluid.phase)?);
        }
        let seeds = self.seeds(world)?;
        let filled = FilledFluids {
            fluids: self.0.iter().zip(&kinds).map(|(fluid, (_, rho0))| (fluid.shape.clone(), *rho0)).collect(),
            particles: count(&seeds, kinds.iter().map(|(phase, _)| phase.index as usize)),
        };
        let depths = Depths::of(world, &seeds, |fluid| kinds[fluid].1);
        let state = choose_state(world, depths.as_ref(), &self.0)?;
        let volume = world.resource::<Resolution>().particle_volume();
        let mut particles = Vec::with_capacity(seeds.len());
        for (id, seed) in seeds.iter().enumerate() {
            let spec = &self.0[seed.fluid];
            let (phase, rho0) = &kinds[seed.fluid];
            let p = match (spec.pressure, &depths) {
                (InitialPressure::Uniform(p), _) => p + state.background_pressure,
                (InitialPressure::Hydrostatic, Some(depths)) => depths.pressure(seed, &state),
                (InitialPressure::Hydrostatic, None) => {
                    let message =
                        "a hydrostatic start needs gravity along an axis that is not periodic; use Uniform(0.0)";
                    return Err(Invalid::new(format!("{}.pressure", seed.fluid), message).into());
                }
            };
            let rho = rho0 * state.compression(p);
            particles.push((
                Fluid,
                (ParticleId(id as u32), PhaseIndex(phase.index), Position(seed.position)),
                Velocity(spec.velocity.map_or(DVec3::ZERO, Point::position)),
                (ReferenceDensity(*rho0), Density(rho), Mass(rho * volume), Pressure(p)),
            ));
        }
        world.spawn_batch(particles);
        world.insert_resource(state);
        world.insert_resource(filled);
        Ok(())
    }
}

impl FluidsSection {
    /// Centres of the particles of every fluid.
    fn seeds(&self, world: &mut World) -> Result<Vec<Seed>, Invalid> {
        let resolution = *world.resource::<Resolution>();
        let periodic = *world.resource::<PeriodicSides>();
        let bodies = body_shapes(world);
        let mut taken: HashMap<LatticeIndex, usize> = HashMap::new();
        let mut seeds = Vec::new();
        for (k, fluid) in self.0.iter().enumerate() {
            let before = seeds.len();
            let points = lattice(
                &fluid.shape,
                resolution.dimension,
                resolution.spacing,
                DVec3::ZERO,
                -EDGE * resolution.spacing,
            );
            for point in points.into_iter().filter(|point| periodic.contains(point.position)) {
                if !is_free(point.position, &bodies, resolution.spacing)
                    .map_err(|wall| overlap(k, fluid, point.position, &wall))?
                {
                    continue;
                }
                if let Some(&other) = taken.get(&point.index) {
                    // A cell whose centre lies on the common edge of two fluids belongs to the first.
                    if fluid.shape.signed_distance(point.position).abs() < 2.0 * EDGE * resolution.spacing {
                        continue;
                    }
                    let (other, x) = (&self.0[other].phase, point.position);
                    let message = format!("overlaps the fluid of phase `{other}` at {}; use a Difference", place(x));
                    return Err(Invalid::new(format!("{k}.shape"), message));
                }
                taken.insert(point.index, k);
                seeds.push(Seed { index: point.index, position: point.position, fluid: k });
            }
            if seeds.len() == before {
                let message = format!("holds no particle at a spacing of {} m", resolution.spacing);
                return Err(Invalid::new(format!("{k}.shape"), message));
            }
        }
        Ok(seeds)
    }
}

/// Whether a fluid particle can be at `x`; the name of the wall that it would be deep in is an error.
fn is_free(x: DVec3, bodies: &[(String, BodyShape, bool)], spacing: f64) -> Result<bool, String> {
    let mut free = true;
    for (name, shape, is_structure) in bodies {
        let clearance = shape.clearance(x) / spacing;
        if clearance < -OVERLAP && !is_structure {
            return Err(name.clone());
        }
        free &= clearance >= WALL_CLEARANCE;
    }
    Ok(free)
}

fn overlap(k: usize, fluid: &FluidSpec, x: DVec3, wall: &str) -> Invalid {
    let message = format!("the fluid of phase `{}` lies in the wall `{wall}` at {}", fluid.phase, place(x));
    Invalid::new(format!("{k}.shape"), message)
}

fn place(x: DVec3) -> String {
    format!("x = {:.4} m, y = {:.4} m, z = {:.4} m", x.x, x.y, x.z)
}

fn count(seeds: &[Seed], phase_of_fluid: impl Iterator<Item = usize>) -> Vec<usize> {
    let phase_of_fluid: Vec<usize> = phase_of_fluid.collect();
    let mut particles = vec![0; phase_of_fluid.iter().max().map_or(0, |most| most + 1)];
    seeds.iter().for_each(|seed| particles[phase_of_fluid[seed.fluid]] += 1);
    particles
}

/// The columns of fluid above each place, along gravity.
struct Depths {
    axis: usize,
    /// +1 if the axis points up, −1 if it points down.
    up: f64,
    columns: BTreeMap<LatticeIndex, Column>,
}

impl Depths {
    /// Stacks the cells of every column; `None` if gravity vanishes, is oblique, or acts along a periodic axis.
    fn of(world: &World, seeds: &[Seed], reference_density: impl Fn(usize) -> f64) -> Option<Self> {
        let gravity = world.resource::<Gravity>().full;
        let (axis, up) = vertical(gravity)?;
        if world.resource::<PeriodicSides>().0[axis].is_some() {
            return None;
        }
        let spacing = world.resource::<Resolution>().spacing;
        let chi = world.resource::<StateSettings>().background_pressure;
        let mut from_the_top: Vec<&Seed> = seeds.iter().collect();
        from_the_top.sort_by(|a, b| (up * b.position[axis]).total_cmp(&(up * a.position[axis])));
        let mut columns: BTreeMap<LatticeIndex, Column> = BTreeMap::new();
        for seed in from_the_top {
            let column = columns.entry(foot(seed.index, axis)).or_insert_with(|| Column {
                gravity: gravity.length(),
                surface_pressure: chi,
                ..Column::default()
            });
            column.push(up * seed.position[axis] + 0.5 * spacing, spacing, reference_density(seed.fluid));
        }
        Some(Self { axis, up, columns })
    }

    fn pressure(&self, seed: &Seed, state: &EquationOfState) -> f64 {
        let height = self.up * seed.position[self.axis];
        self.columns.get(&foot(seed.index, self.axis)).map_or(state.background_pressure, |column| {
            column.compressible(height, state.bulk_modulus, state.background_pressure)
        })
    }

    /// Greatest incompressible pressure (Pa) above χ, and the height (m) from the lowest to the highest fluid.
    fn extremes(&self) -> (f64, f64) {
        let (mut pressure, mut top, mut bottom) = (0.0_f64, f64::NEG_INFINITY, f64::INFINITY);
        for column in self.columns.values() {
            let (Some(first), Some(last)) = (column.layers.first(), column.layers.last()) else { continue };
            pressure = pressure.max(column.incompressible(last.bottom) - column.surface_pressure);
            (top, bottom) = (top.max(first.top), bottom.min(last.bottom));
        }
        (pressure, top - bottom)
    }
}

/// Index of a column: that of its cells, without the one along the axis.
fn foot(mut index: LatticeIndex, axis: usize) -> LatticeIndex {
    index[axis] = 0;
    index
}

/// The axis along which gravity acts and whether it points up (+1) or down (−1); `None` if gravity is oblique or zero.
pub(crate) fn vertical(gravity: DVec3) -> Option<(usize, f64)> {
    let axis = (0..3).max_by(|a, b| gravity[*a].abs().total_cmp(&gravity[*b].abs()))?;
    let along = gravity[axis].abs();
    (along > 0.0 && (gravity.length() - along) < 1e-12 * along).then(|| (axis, -gravity[axis].signum()))
}

/// Eq. 8, with p_max and v_max of the scene or estimated from it.
fn choose_state(
    world: &mut World,
    depths: Option<&Depths>,
    fluids: &[FluidSpec],
) -> Result<EquationOfState, SectionError> {
    let settings = *world.resource::<StateSettings>();
    let densities: Vec<f64> = phases(world).into_iter().map(|(_, rho0)| rho0).collect();
    let (depth_pressure, height) = depths.map_or((0.0, 0.0), Depths::extremes);
    let start_speed =
        fluids.iter().filter_map(|fluid| fluid.velocity).map(|v| v.position().length()).fold(0.0, f64::max);
    let dam_break_speed = 2.0 * (world.resource::<Gravity>().full.length() * height).sqrt();
    let max_pressure = settings.max_pressure.unwrap_or(depth_pressure);
    let max_speed = settings.max_speed.unwrap_or(dam_break_speed.max(start_speed));
    let state = EquationOfState::new(&densities, &settings, max_pressure, max_speed);
    if state.bulk_modulus > 0.0 {
        return Ok(state);
    }
    let document = &world.resource::<super::SceneDocument>().0;
    let message = "the sound speed cannot be estimated: give `max_speed` (m/s) or `max_pressure` (Pa)";
    Err(document.invalid(&Invalid::new(StateSettings::NAME, message)).into())
}

impl FilledFluids {
    /// The column of layers at rest through the place `x` (m), cell by cell of height `spacing` (m); empty if gravity
    /// is oblique or zero.
    #[must_use]
    pub fn column(&self, x: DVec3, gravity: DVec3, spacing: f64, surface_pressure: f64) -> Column {
        let mut column = Column { gravity: gravity.length(), surface_pressure, ..Column::default() };
        let Some((axis, up)) = vertical(gravity) else { return column };
        let heights =
            self.fluids.iter().map(|(shape, _)| shape.bounds()).flat_map(|(a, b)| [up * a[axis], up * b[axis]]);
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
        let (first, last) = ((high / spacing).ceil() as i64 - 1, (low / spacing).floor() as i64);
        for cell in (last..=first).rev() {
            let height = (cell as f64 + 0.5) * spacing;
            let mut center = x;
            center[axis] = up * height;
            if let Some((_, rho0)) = self.fluids.iter().find(|(shape, _)| shape.contains(center)) {
                column.push(height + 0.5 * spacing, spacing, *rho0);
            }
        }
        column
    }
}
