//! Fluids of a scene: shapes filled with particles of a phase.

use std::collections::HashMap;

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::columns::Depths;
use super::geometry::{Point, RigidRotation, Shape, coordinates, corners, lattice, solid_particles};
use super::limits::limit_particles;
use super::places::{Place, Seed, Taken, place_of};
use super::state::choose_state;
use super::{Invalid, Resolution, SceneSection, SectionError};
use crate::boundary::{Body, BodyShape, Structure, body_shapes};
use crate::neighbours::PeriodicSides;
use crate::number::plain;
use crate::particles::{
    Density, Fluid, Mass, ParticleColumns, ParticleId, PhaseIndex, Position, Pressure, ReferenceDensity, Velocity,
};
use crate::phases::phase_named;
use crate::physics::{EquationOfState, GREATEST_COMPRESSION, Settling};

/// Section `fluids`: what is filled with which phase. Fluids must not overlap (a place on a common edge belongs to the
/// first); walls and structures displace them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct FluidsSection(Vec<FluidSpec>);

/// A body of fluid at the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FluidSpec {
    /// Name of its phase.
    pub phase: String,
    /// What it fills (m). Structures displace it.
    #[schemars(extend("unit" = "m"))]
    pub shape: Shape,
    /// Velocity (m/s) at the start; `None` for rest.
    #[serde(default)]
    #[schemars(extend("unit" = "m/s", "derived" = "at rest"))]
    pub velocity: Option<Point>,
    /// Rigid rotation at the start, besides; `None` for none.
    #[serde(default)]
    #[schemars(extend("derived" = "none"))]
    pub rotation: Option<RigidRotation>,
    /// Pressure at the start.
    #[serde(default)]
    pub pressure: InitialPressure,
    /// How its particles are placed.
    #[serde(default)]
    pub filling: Filling,
}

/// How the particles of a fluid are placed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Filling {
    /// On the lattice that all fluids share, so that there is no seam where they meet.
    #[default]
    Lattice,
    /// Along the surface of the shape, as in structures: rings in a circle or cylinder, shells in a sphere, a lattice stretched to
    /// fit in a box. In a round container it leaves no steps at the wall, whose pressure would be rough. Not with a
    /// `Hydrostatic` pressure.
    Fitted,
}

impl FluidSpec {
    /// The places of its particles, before bodies displace them; it is the fluid number `k` of the scene.
    fn places(&self, k: usize, resolution: &Resolution) -> Vec<Seed> {
        let Resolution { dimension, spacing, .. } = *resolution;
        match self.filling {
            Filling::Lattice => {
                let points = lattice(&self.shape, dimension, spacing, DVec3::ZERO, -EDGE * spacing);
                let volume = resolution.particle_volume();
                points
                    .into_iter()
                    .map(|point| Seed { index: point.index, position: point.position, volume, fluid: k })
                    .collect()
            }
            Filling::Fitted => {
                let cell = |x: DVec3| (x / spacing).to_array().map(|cells| cells.floor() as i64);
                let points = solid_particles(&self.shape, spacing, dimension);
                points
                    .into_iter()
                    .map(|point| Seed {
                        index: cell(point.position),
                        position: point.position,
                        volume: point.volume,
                        fluid: k,
                    })
                    .collect()
            }
        }
    }

    /// Velocity (m/s) at the start of what is at `x` (m).
    fn velocity_at(&self, x: DVec3) -> DVec3 {
        let turning = self.rotation.map_or(DVec3::ZERO, |rotation| rotation.velocity(x));
        self.velocity.map_or(DVec3::ZERO, Point::position) + turning
    }

    /// ½ ρ0 ω² r² (Pa) at `x` (m), of its rotation.
    fn centrifugal_pressure(&self, rho0: f64, x: DVec3) -> f64 {
        self.rotation.map_or(0.0, |rotation| 0.5 * rho0 * (rotation.rate * rotation.radius(x)).powi(2))
    }

    /// Greatest speed (m/s) at the start in the box around its shape: that of a corner.
    fn greatest_speed(&self) -> f64 {
        corners(self.shape.bounds()).map(|x| self.velocity_at(x).length()).fold(0.0, f64::max)
    }
}

/// Pressure of a fluid at the start; its density follows from Eq. 7, and the mass of a particle from its density, so
/// that the fluid fills its space.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum InitialPressure {
    /// That of the stacked layers above it, at rest and compressed by their weight.
    #[default]
    Hydrostatic,
    /// One value above the background pressure (Pa).
    #[schemars(extend("unit" = "Pa"))]
    Uniform(f64),
    /// That of the fluid's own `rotation`: this value above the background pressure (Pa) on the axis, and ½ ρ0 ω² r² more at a
    /// distance r from it.
    #[schemars(extend("unit" = "Pa"))]
    Centrifugal(f64),
}

/// What was filled: shape and reference density (kg/m³) of each fluid, for exact solutions.
#[derive(Resource, Debug, Clone, Default)]
pub struct FilledFluids {
    /// Shape and reference density.
    pub fluids: Vec<(Shape, f64)>,
    /// Number of particles of each phase.
    pub particles: Vec<usize>,
    /// Walls and structures, where there is no fluid.
    pub bodies: Vec<BodyShape>,
    /// Periodic sides, through which bodies reach.
    pub periodic: PeriodicSides,
}

impl FilledFluids {
    /// The box (m) around the fluids of the start, walls, their openings and structures.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let bodies = self.bodies.iter().flat_map(|body| std::iter::once(&body.shape).chain(&body.cut));
        let shapes = self.fluids.iter().map(|(shape, _)| shape).chain(bodies);
        shapes
            .map(Shape::bounds)
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), (from, to)| (low.min(from), high.max(to)))
    }
}

/// Cells whose centre lies on the edge of a shape, to rounding (in spacings), belong to it.
const EDGE: f64 = 1e-9;

/// Said of a `Difference` without a particle.
pub(crate) const NOTHING_LEFT: &str = "nothing is left of it: `minus` takes all of `of` away";

impl SceneSection for FluidsSection {
    const NAME: &'static str = "fluids";

    fn check(&self, world: &World) -> Result<(), Invalid> {
        let dimension = world.resource::<Resolution>().dimension;
        if self.0.is_empty() {
            return Err(Invalid::new("", "a scene needs at least one fluid"));
        }
        for (k, fluid) in self.0.iter().enumerate() {
            let at_shape = |invalid: Invalid| invalid.under("shape").under(&k.to_string());
            fluid.shape.check(dimension).map_err(at_shape)?;
            limit_particles(fluid.shape.bounds(), world.resource::<Resolution>()).map_err(at_shape)?;
            if let Some(velocity) = fluid.velocity {
                coordinates(velocity, dimension).map_err(|invalid| invalid.under(&format!("{k}.velocity")))?;
            }
            if let Some(rotation) = &fluid.rotation {
                rotation.check(dimension).map_err(|invalid| invalid.under(&format!("{k}.rotation")))?;
            } else if matches!(fluid.pressure, InitialPressure::Centrifugal(_)) {
                return Err(Invalid::new(format!("{k}.pressure"), "`Centrifugal` needs a `rotation` of the fluid"));
            }
            if fluid.filling == Filling::Fitted && fluid.pressure == InitialPressure::Hydrostatic {
                let message = "`Fitted` places have no columns of layers above them: give the pressure, Uniform(0.0)";
                return Err(Invalid::new(format!("{k}.filling"), message));
            }
        }
        Ok(())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let mut kinds = Vec::new();
        for (k, fluid) in self.0.iter().enumerate() {
            kinds.push(phase_named(world, &format!("{k}.phase"), &fluid.phase)?);
        }
        self.refuse_weight_before_gravity(world)?;
        let seeds = self.seeds(world)?;
        let filled = FilledFluids {
            fluids: self.0.iter().zip(&kinds).map(|(fluid, (_, rho0))| (fluid.shape.clone(), *rho0)).collect(),
            particles: count(&seeds, kinds.iter().map(|(phase, _)| phase.index as usize)),
            bodies: body_shapes(world).into_iter().map(|(_, shape, _)| shape).collect(),
            periodic: *world.resource::<PeriodicSides>(),
        };
        let depths = Depths::of(world, &seeds, &filled, |fluid| kinds[fluid].1);
        let state = choose_state(world, depths.as_ref(), self.greatest_start_speed())?;
        let mut pressures = Vec::with_capacity(seeds.len());
        for seed in &seeds {
            let rho0 = kinds[seed.fluid].1;
            pressures.push(self.start_pressure(seed, rho0, depths.as_ref(), &state)?);
        }
        ParticleColumns::choose(world);
        world.spawn_batch(seeds.iter().zip(pressures).enumerate().map(|(id, (seed, p))| {
            let (phase, rho0) = &kinds[seed.fluid];
            let rho = rho0 * state.compression(p);
            (
                Fluid,
                (ParticleId(id as u32), PhaseIndex(phase.index), Position(seed.position)),
                Velocity(self.0[seed.fluid].velocity_at(seed.position)),
                (ReferenceDensity(*rho0), Density(rho), Mass(rho * seed.volume), Pressure(p)),
            )
        }));
        world.insert_resource(state);
        world.insert_resource(filled);
        Ok(())
    }
}

impl FluidsSection {
    fn greatest_start_speed(&self) -> f64 {
        self.0.iter().map(FluidSpec::greatest_speed).fold(0.0, f64::max)
    }

    /// Pressure (Pa) of a particle to be.
    fn start_pressure(
        &self,
        seed: &Seed,
        rho0: f64,
        depths: Option<&Depths>,
        state: &EquationOfState,
    ) -> Result<f64, Invalid> {
        let spec = &self.0[seed.fluid];
        let at_pressure = |message: String| Invalid::new(format!("{}.pressure", seed.fluid), message);
        let p = match (spec.pressure, depths) {
            (InitialPressure::Uniform(p), _) => p + state.background_pressure,
            (InitialPressure::Centrifugal(p), _) => {
                p + state.background_pressure + spec.centrifugal_pressure(rho0, seed.position)
            }
            (InitialPressure::Hydrostatic, Some(depths)) => depths.pressure(seed, state),
            (InitialPressure::Hydrostatic, None) => {
                let message = "a hydrostatic start needs gravity along an axis that is not periodic; use Uniform(0.0)";
                return Err(at_pressure(message.to_owned()));
            }
        };
        let beta = state.compression(p);
        if (1.0 / GREATEST_COMPRESSION..=GREATEST_COMPRESSION).contains(&beta) {
            return Ok(p);
        }
        Err(at_pressure(format!(
            "its density would be {beta:.4} times the reference density (bulk modulus {:.4e} Pa)",
            state.bulk_modulus
        )))
    }

    /// The shapes that are filled.
    pub(super) fn shapes(self) -> Vec<Shape> {
        self.0.into_iter().map(|fluid| fluid.shape).collect()
    }

    /// A hydrostatic start under a gravity that has yet to grow would spring up like a released spring.
    fn refuse_weight_before_gravity(&self, world: &World) -> Result<(), Invalid> {
        let ramp = matches!(world.resource::<Settling>(), Settling::GravityRamp { .. });
        match self.0.iter().position(|fluid| ramp && fluid.pressure == InitialPressure::Hydrostatic) {
            Some(k) => {
                let message =
                    "gravity grows from 0 (`settling`), so there is no hydrostatic pressure yet: use Uniform(0.0)";
                Err(Invalid::new(format!("{k}.pressure"), message))
            }
            None => Ok(()),
        }
    }

    /// Centres of the particles of every fluid; tells the structures what they displace.
    fn seeds(&self, world: &mut World) -> Result<Vec<Seed>, Invalid> {
        let resolution = *world.resource::<Resolution>();
        let periodic = *world.resource::<PeriodicSides>();
        let bodies = body_shapes(world);
        let mut taken = Taken::default();
        let mut displaced: HashMap<String, f64> = HashMap::new();
        let mut seeds: Vec<Seed> = Vec::new();
        for (k, fluid) in self.0.iter().enumerate() {
            let before = seeds.len();
            let places = fluid.places(k, &resolution);
            if places.is_empty() && matches!(fluid.shape, Shape::Difference { .. }) {
                return Err(Invalid::new(format!("{k}.shape"), NOTHING_LEFT));
            }
            for point in places {
                if !periodic.contains(point.position) {
                    let message = format!("reaches beyond the periodic sides at {}", place(point.position));
                    return Err(Invalid::new(format!("{k}.shape"), message));
                }
                match place_of(point.position, &bodies, &periodic, resolution.spacing) {
                    Place::Free => {}
                    Place::Beside => continue,
                    Place::InStructure(name) => {
                        *displaced.entry(name.to_owned()).or_default() += point.volume;
                        continue;
                    }
                    Place::InWall(name) => return Err(overlap(k, fluid, point.position, name)),
                }
                // Places along a surface share cells with the lattice beside it.
                let is_in = |other: usize| {
                    other != k && self.0[other].shape.signed_distance(point.position) < 2.0 * EDGE * resolution.spacing
                };
                let meets = (0..k).any(is_in).then(|| taken.by(point.index, &seeds));
                if let Some(other) = meets.flatten().filter(|other| is_in(*other)) {
                    // A cell whose centre lies on the common edge of two fluids belongs to the first.
                    if fluid.shape.signed_distance(point.position).abs() < 2.0 * EDGE * resolution.spacing {
                        continue;
                    }
                    let (other, x) = (&self.0[other].phase, point.position);
                    let message = format!("overlaps the fluid of phase `{other}` at {}; use a Difference", place(x));
                    return Err(Invalid::new(format!("{k}.shape"), message));
                }
                seeds.push(point);
            }
            if seeds.len() == before {
                let message = format!("holds no particle at a spacing of {} m", plain(resolution.spacing));
                return Err(Invalid::new(format!("{k}.shape"), message));
            }
        }
        for (body, mut structure) in world.query::<(&Body, &mut Structure)>().iter_mut(world) {
            structure.displaced = displaced.get(&body.name).copied().unwrap_or_default();
        }
        Ok(seeds)
    }
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
