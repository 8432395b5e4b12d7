//! Numbers that shape a run without standing in its scene: what was derived from it.

use bevy_ecs::prelude::*;

use crate::boundary::ghost_layer_count;
use crate::clock::Clock;
use crate::kernels::SmoothingKernel;
use crate::neighbours::Neighbours;
use crate::outputs::{OutputKind, OutputTimes};
use crate::particles::{Fluid, Solid, Wall};
use crate::phases::phases;
use crate::physics::{
    AT_SURFACE, BEHIND, CLEAR_FILLING, EquationOfState, GREATEST_COMPRESSION, LEAST_DETERMINANT, LEAST_FILLING,
    LEAST_RATIO, LONGEST_SHIFT, NEAR_SURFACE, PUSHED, fullness_in_front,
};
use crate::probes::{CLUMPED, DEPTH, DRY, FULL, LEAST_SHARE, RIM};
use crate::scene::{Resolution, SceneInfo, WALL_CLEARANCE};

/// A derived number.
#[derive(Debug, Clone, PartialEq)]
pub struct Fact {
    /// What it is.
    pub name: String,
    /// SI unit; empty for pure numbers and words.
    pub unit: &'static str,
    /// Value, with all its digits.
    pub value: String,
}

impl Fact {
    /// Name and unit, as the key in the log's metadata: `bulk_modulus [Pa]`.
    #[must_use]
    pub fn key(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{} [{}]", self.name, self.unit) }
    }
}

/// Number of particles of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ParticleCounts {
    /// Fluid particles.
    pub fluid: usize,
    /// Ghost particles of walls.
    pub wall: usize,
    /// Particles of structures.
    pub structure: usize,
}

impl ParticleCounts {
    /// Counts the particles of a world.
    pub fn of(world: &mut World) -> Self {
        Self {
            fluid: world.query_filtered::<(), With<Fluid>>().iter(world).count(),
            wall: world.query_filtered::<(), With<Wall>>().iter(world).count(),
            structure: world.query_filtered::<(), With<Solid>>().iter(world).count(),
        }
    }
}

/// Everything that was derived from the scene in `world`, at t = 0.
pub fn derived_numbers(world: &mut World) -> Vec<Fact> {
    let mut facts = Vec::new();
    let mut add = |name: &str, unit, value: String| facts.push(Fact { name: name.to_owned(), unit, value });
    let counts = ParticleCounts::of(world);
    add("particles.fluid", "", counts.fluid.to_string());
    add("particles.wall", "", counts.wall.to_string());
    add("particles.structure", "", counts.structure.to_string());
    let all = phases(world);
    let state = *world.resource::<EquationOfState>();
    for (phase, rho0) in &all {
        add(&format!("phases.{}.sound_speed", phase.name), "m/s", state.sound_speed(*rho0).to_string());
        let viscosity = phase.rheology.greatest_viscosity.to_string();
        add(&format!("phases.{}.greatest_viscosity", phase.name), "Pa s", viscosity);
    }
    add("bulk_modulus", "Pa", state.bulk_modulus.to_string());
    add("max_pressure", "Pa", state.max_pressure.to_string());
    add("max_speed", "m/s", state.max_speed.to_string());
    let resolution = *world.resource::<Resolution>();
    add("smoothing_length", "m", resolution.smoothing_length.to_string());
    add("kernel", "", world.resource::<SceneInfo>().kernel.clone());
    let kernel = world.resource::<SmoothingKernel>().clone();
    add("kernel_support", "m", kernel.0.radius().to_string());
    add("neighbour_reach", "m", world.resource::<Neighbours>().reach().to_string());
    add("ghost_layers", "", ghost_layer_count(&kernel, &resolution).to_string());
    add("greatest_compression", "", GREATEST_COMPRESSION.to_string());
    let clock = *world.resource::<Clock>();
    add("first_time_step", "s", clock.stable_time_step.to_string());
    add("first_time_step_limit", "", clock.stable_limit.to_string());
    let times = world.resource::<OutputTimes>();
    add("frame_interval", "s", times.interval(OutputKind::Frames).to_string());
    add("series_interval", "s", times.interval(OutputKind::Series).to_string());
    facts.extend(fixed_numbers(world));
    facts
}

/// Numbers of the method and of its measures that no scene sets.
pub fn fixed_numbers(world: &World) -> Vec<Fact> {
    let [phi_0, phi_1] = fullness_in_front(world.resource::<SmoothingKernel>(), world.resource::<Resolution>());
    let fixed = [
        ("fluid_clearance_of_bodies", "spacings", WALL_CLEARANCE),
        ("free_surface.least_filling", "", LEAST_FILLING),
        ("free_surface.clear_filling", "", CLEAR_FILLING),
        ("shifting.at_surface", "", AT_SURFACE),
        ("near_surface.least_share", "", NEAR_SURFACE),
        ("shifting.longest", "smoothing lengths", LONGEST_SHIFT),
        ("wall_impact.phi_0", "", phi_0),
        ("wall_impact.phi_1", "", phi_1),
        ("wall_impact.behind", "spacings", BEHIND),
        ("wall_impact.pushed", "spacings", PUSHED),
        ("strain_rate.least_determinant", "", LEAST_DETERMINANT),
        ("diffusion.antuono.least_ratio", "", LEAST_RATIO),
        ("probes.pressure_point.dry_beyond", "spacings", DRY),
        ("probes.density_error.depth", "spacings", DEPTH),
        ("probes.rigid_rotation_error.rim", "spacings", RIM),
        ("probes.particle_disorder.clumped", "spacings", CLUMPED),
        ("probes.particle_disorder.full", "", FULL),
        ("probes.phase_mixing.least_share", "", LEAST_SHARE),
    ];
    fixed.map(|(name, unit, value)| Fact { name: name.to_owned(), unit, value: value.to_string() }).into()
}

/// The program and how it was called: its version, the end of the run (s), and the threads of the pool in which this is
/// called.
pub(super) fn program_facts(end_time: f64) -> [(String, String); 3] {
    [
        ("until [s]".to_owned(), end_time.to_string()),
        ("storegga".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("threads".to_owned(), rayon::current_num_threads().to_string()),
    ]
}
