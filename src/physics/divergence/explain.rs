//! Which particle broke a limit, and what is around it. Runs once, when a run has diverged.

use bevy_ecs::prelude::*;
use glam::DVec3;

use super::advice::{Circumstances, advice};
use super::{BrokenLimit, Divergence, DivergenceReport, NeighbourGroup};
use crate::boundary::{Body, Structure};
use crate::clock::{Clock, Limit};
use crate::kernels::SmoothingKernel;
use crate::neighbours::Neighbours;
use crate::particles::{
    Acceleration, BodyIndex, Density, Fluid, ParticleId, PhaseIndex, Position, Pressure, ReferenceDensity, Solid,
    Velocity, Viscosity, Wall, WallVelocity,
};
use crate::phases::phases;
use crate::physics::{EquationOfState, TimeStepSettings};
use crate::scene::{Resolution, SceneFacts, SceneInfo};

/// A density below half or above twice ρ0 is no longer that of a weakly compressible fluid.
pub(crate) const GREATEST_COMPRESSION: f64 = 2.0;

/// A Δt below the least that sound and viscosity can ask for, over this, is a collapse.
const COLLAPSE: f64 = 100.0;

/// More steps than this are years on any machine.
pub(crate) const MOST_STEPS: f64 = 1e11;

/// Whether the step in progress broke a limit.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct OutOfRange(pub bool);

/// Decides the least Δt, where the scene leaves it open: a hundredth of `min(C_s h/(2c), C_ν h² ρ0/(2 μ_max))`, or the
/// end time in 10¹¹ steps if that is longer.
pub(crate) fn settle_least_time_step(world: &mut World) {
    let settings = *world.resource::<TimeStepSettings>();
    if settings.least.is_some() {
        return;
    }
    let all = phases(world);
    let state = *world.resource::<EquationOfState>();
    let h = world.resource::<Resolution>().smoothing_length;
    let asked = all.iter().map(|(phase, rho0)| {
        let kinematic = GREATEST_COMPRESSION * phase.rheology.greatest_viscosity / rho0;
        settings.stable_step(h, 2.0 * state.sound_speed(*rho0), kinematic, 0.0).0
    });
    let end_time = world.resource::<SceneInfo>().end_time;
    let least = (asked.fold(f64::INFINITY, f64::min) / COLLAPSE).max(end_time / MOST_STEPS);
    world.resource_mut::<TimeStepSettings>().least = Some(least);
    world.resource_mut::<SceneFacts>().resolve("time_step.least", format!("{least} s"));
}

/// A fluid particle as the report sees it.
#[derive(Clone, Copy)]
struct Particle {
    id: u32,
    phase: u32,
    x: DVec3,
    v: DVec3,
    a: DVec3,
    rho: f64,
    rho0: f64,
    p: f64,
    mu: f64,
}

/// Finds the particle that broke a limit most, and says what is known about it.
pub(in crate::physics) fn explain_divergence(world: &mut World) {
    let fluid = particles(world);
    let Some((row, broken)) = worst(world, &fluid) else { return };
    let particle = fluid[row];
    let clock = *world.resource::<Clock>();
    let names: Vec<String> = phases(world).into_iter().map(|(phase, _)| phase.name).collect();
    let phase = names.get(particle.phase as usize).cloned().unwrap_or_default();
    let neighbours = neighbours(world, &fluid, row, &names);
    let full_neighbourhood = full_neighbourhood(world);
    let circumstances = Circumstances {
        broken,
        phase: &phase,
        viscosity: particle.mu,
        compression: particle.rho / particle.rho0,
        reference_density: particle.rho0,
        speed: particle.v.length(),
        neighbours: &neighbours,
        full_neighbourhood,
        step: clock.step,
        settings: *world.resource::<TimeStepSettings>(),
        max_speed: world.resource::<EquationOfState>().max_speed,
    };
    let advice = advice(&circumstances);
    world.resource_mut::<Divergence>().0 = Some(DivergenceReport {
        time: clock.time,
        step: clock.step,
        time_step: clock.time_step,
        broken,
        particle: particle.id,
        phase,
        position: particle.x,
        velocity: particle.v,
        acceleration: particle.a,
        density: particle.rho,
        reference_density: particle.rho0,
        pressure: particle.p,
        viscosity: particle.mu,
        neighbours,
        full_neighbourhood,
        advice,
    });
}

type ParticleData = (
    &'static ParticleId,
    &'static PhaseIndex,
    &'static Position,
    &'static Velocity,
    &'static Acceleration,
    &'static Density,
    &'static ReferenceDensity,
    &'static Pressure,
    &'static Viscosity,
);

/// The fluid, in the order of its rows.
fn particles(world: &mut World) -> Vec<Particle> {
    let mut fluid = world.query_filtered::<ParticleData, With<Fluid>>();
    let particles = fluid.iter(world).map(|(id, phase, x, v, a, rho, rho0, p, mu)| Particle {
        id: id.0,
        phase: phase.0,
        x: x.0,
        v: v.0,
        a: a.0,
        rho: rho.0,
        rho0: rho0.0,
        p: p.0,
        mu: mu.0,
    });
    particles.collect()
}

/// The row of the particle that exceeds a limit most; of those that are no longer numbers, which are what comes of it, the
/// first by identity, and only if there is no other. If all are in range, it is the time step.
fn worst(world: &World, fluid: &[Particle]) -> Option<(usize, BrokenLimit)> {
    let state = world.resource::<EquationOfState>();
    let found = fluid.iter().enumerate().filter_map(|(row, particle)| {
        let (broken, excess) = particle.broken(state)?;
        Some((row, broken, excess))
    });
    // The greatest excess, then the least identity.
    let found = found.max_by(|a, b| a.2.total_cmp(&b.2).then(fluid[b.0].id.cmp(&fluid[a.0].id)));
    if let Some((row, broken, _)) = found {
        return Some((row, broken));
    }
    let (clock, settings) = (world.resource::<Clock>(), world.resource::<TimeStepSettings>());
    let demand = |particle: &Particle| match clock.stable_limit {
        Limit::Viscosity => particle.mu / particle.rho,
        Limit::Acceleration => particle.a.length(),
        Limit::Sound | Limit::Output | Limit::Plugin => particle.v.length(),
    };
    let row = (0..fluid.len()).max_by(|&a, &b| demand(&fluid[a]).total_cmp(&demand(&fluid[b])))?;
    let (value, by) = (clock.stable_time_step, clock.stable_limit);
    let least = settings.least.filter(|least| value < *least)?;
    Some((row, BrokenLimit::TimeStep { value, least, by }))
}

impl Particle {
    /// The limit that it breaks, and by which factor; none is a number with which to compare where a value is not finite.
    fn broken(&self, state: &EquationOfState) -> Option<(BrokenLimit, f64)> {
        let values = [
            ("position", self.x.is_finite()),
            ("velocity", self.v.is_finite()),
            ("density", self.rho.is_finite()),
            ("acceleration", self.a.is_finite()),
        ];
        if let Some((quantity, _)) = values.into_iter().find(|(_, finite)| !finite) {
            return Some((BrokenLimit::NotFinite { quantity }, 0.0));
        }
        let (speed, sound) = (self.v.length(), state.sound_speed(self.rho0));
        let (least, greatest) = (self.rho0 / GREATEST_COMPRESSION, self.rho0 * GREATEST_COMPRESSION);
        let excess = if self.rho > 0.0 { (self.rho / greatest).max(least / self.rho) } else { f64::INFINITY };
        if speed >= sound && (speed / sound >= excess) {
            return Some((BrokenLimit::Speed { value: speed, sound }, speed / sound));
        }
        (excess >= 1.0).then_some((BrokenLimit::Density { value: self.rho, range: (least, greatest) }, excess))
    }
}

/// Particles per support of the kernel on the lattice of the start, without the one in its middle.
fn full_neighbourhood(world: &World) -> usize {
    let resolution = world.resource::<Resolution>();
    let radius = world.resource::<SmoothingKernel>().0.radius() / resolution.spacing;
    let ball = if resolution.dimension == 2 { radius * radius } else { 4.0 / 3.0 * radius.powi(3) };
    (std::f64::consts::PI * ball) as usize - 1
}

/// What is nearer to the particle in `row` than the kernel reaches, kind by kind.
fn neighbours(world: &mut World, fluid: &[Particle], row: usize, names: &[String]) -> Vec<NeighbourGroup> {
    let mut groups = Groups { list: Vec::new(), spacing: world.resource::<Resolution>().spacing };
    let radius = world.resource::<SmoothingKernel>().0.radius();
    let walls = ghosts::<Wall>(world, false);
    let structures = ghosts::<Solid>(world, true);
    let neighbours = world.resource::<Neighbours>();
    let rows = &neighbours.rows;
    for other in neighbours.fluid.of(row).rows() {
        let source = rows.source(other);
        let (kind, name, x, v, rho) = if source < rows.fluid {
            let other = &fluid[source];
            let name = names.get(other.phase as usize).map_or("", String::as_str);
            ("fluid", name, other.x, other.v, other.rho)
        } else if source < rows.fluid + rows.walls {
            let ghost = &walls[source - rows.fluid];
            ("wall", ghost.name.as_str(), ghost.x, ghost.v, ghost.rho)
        } else {
            let ghost = &structures[source - rows.fluid - rows.walls];
            ("structure", ghost.name.as_str(), ghost.x, ghost.v, ghost.rho)
        };
        let distance = fluid[row].x.distance(x + rows.shift(other));
        if distance < radius && source != row {
            groups.add(kind, name, distance, rho, v.length());
        }
    }
    groups.list
}

struct Ghost {
    name: String,
    x: DVec3,
    v: DVec3,
    rho: f64,
}

fn ghosts<M: Component>(world: &mut World, structures: bool) -> Vec<Ghost> {
    let mut bodies = world.query::<(&Body, Has<Structure>)>();
    let own = bodies.iter(world).filter(|(_, is_structure)| *is_structure == structures);
    let names: Vec<(u32, String)> = own.map(|(body, _)| (body.index, body.name.clone())).collect();
    let name = |index: u32| names.iter().find(|(of, _)| *of == index).map(|(_, name)| name.clone()).unwrap_or_default();
    let mut ghosts = world.query_filtered::<(&BodyIndex, &Position, &WallVelocity, &Density), With<M>>();
    ghosts.iter(world).map(|(index, x, v, rho)| Ghost { name: name(index.0), x: x.0, v: v.0, rho: rho.0 }).collect()
}

/// Groups of neighbours in the order in which they are met.
struct Groups {
    list: Vec<NeighbourGroup>,
    spacing: f64,
}

impl Groups {
    fn add(&mut self, kind: &'static str, name: &str, distance: f64, density: f64, speed: f64) {
        let known = self.list.iter().position(|group| group.kind == kind && group.name == name);
        let index = known.unwrap_or_else(|| {
            let empty = NeighbourGroup {
                kind,
                name: name.to_owned(),
                count: 0,
                nearest: f64::INFINITY,
                density: 0.0,
                speed: 0.0,
                greatest_speed: 0.0,
            };
            self.list.push(empty);
            self.list.len() - 1
        });
        let group = &mut self.list[index];
        group.count += 1;
        let share = 1.0 / group.count as f64;
        group.nearest = group.nearest.min(distance / self.spacing);
        group.density += share * (density - group.density);
        group.speed += share * (speed - group.speed);
        group.greatest_speed = group.greatest_speed.max(speed);
    }
}
