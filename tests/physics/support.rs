//! Small scenes, and ways to look into them.

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{PaperPlugins, open};
use storegga::clock::Clock;
use storegga::neighbours::Neighbours;
use storegga::particles::{Density, Fluid, Mass, Position, ReferenceDensity, Velocity};
use storegga::physics::EquationOfState;
use storegga::scene::{Document, Resolution};
use storegga::schedule::Step;

pub use crate::steps::advance;

/// The scene `text` with overrides, at its start.
pub fn app(text: &str, overrides: &[&str]) -> App {
    let mut document = Document::parse("test.ron", text).unwrap_or_else(|error| panic!("{}", error.render(false)));
    for pair in overrides {
        document = document.set_pair(pair).unwrap_or_else(|error| panic!("{}", error.render(false)));
    }
    open(PaperPlugins, document).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// What is said of the scene `text` with overrides.
pub fn refusal(text: &str, overrides: &[&str]) -> String {
    let mut document = Document::parse("test.ron", text).unwrap_or_else(|error| panic!("{}", error.render(false)));
    for pair in overrides {
        document = document.set_pair(pair).unwrap_or_else(|error| panic!("{}", error.render(false)));
    }
    match open(PaperPlugins, document) {
        Ok(_) => panic!("{overrides:?} was accepted"),
        Err(error) => error.render(false),
    }
}

/// Recomputes everything that depends on positions and velocities, without letting time pass.
pub fn evaluate(world: &mut World) {
    world.resource_mut::<Neighbours>().invalidate();
    world.resource_mut::<Clock>().time_step = 0.0;
    world.run_schedule(Step);
}

/// Numbers between −1 and 1, the same in every run (a linear congruential generator).
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self, dimension: usize) -> DVec3 {
        let (x, y, z) = (self.next(), self.next(), self.next());
        DVec3::new(x, y, if dimension == 3 { z } else { 0.0 })
    }
}

/// Moves every fluid particle by up to `amplitude` (m) along each axis and gives it the velocity `velocity(x)`.
pub fn disturb(world: &mut World, dimension: usize, amplitude: f64, mut velocity: impl FnMut(DVec3) -> DVec3) {
    let mut noise = Noise(7);
    let mut fluid = world.query_filtered::<(&mut Position, &mut Velocity), With<Fluid>>();
    for (mut x, mut v) in fluid.iter_mut(world) {
        x.0 += amplitude * noise.vector(dimension);
        v.0 = velocity(x.0);
    }
}

/// A periodic box of two liquids: 20 by 20 particles in 2D, 8 by 8 by 8 in 3D.
pub fn periodic_box(dimension: usize) -> String {
    let (spacing, gravity) = if dimension == 2 { (0.05, "(0.0, 0.0)") } else { (0.125, "(0.0, 0.0, 0.0)") };
    let side = 1.0;
    let box_of = |from: f64, to: f64| {
        let (low, high) = if dimension == 2 { ("", "") } else { (", 0.0", ", 1.0") };
        format!("Box(min: (0.0, {from:?}{low}), max: (1.0, {to:?}{high}))")
    };
    let third = if dimension == 3 { ", z: (0.0, 1.0)" } else { "" };
    format!(
        r#"Scene(
            dimension: {dimension}, spacing: {spacing}, gravity: {gravity}, end_time: 1.0, smoothing_ratio: 1.1,
            periodic: (x: (0.0, {side:?}), y: (0.0, {side:?}){third}),
            equation_of_state: (max_speed: 1.0, background_pressure: 5000.0),
            phases: {{
                "light": (reference_density: 1000.0, rheology: Newtonian(viscosity: 1.0)),
                "heavy": (reference_density: 1950.0, rheology: HerschelBulkley(
                    consistency: 3.0, exponent: 0.7, yield_stress: 50.0, max_viscosity: 100.0)),
            }},
            fluids: [
                (phase: "light", shape: {}, pressure: Uniform(0.0)),
                (phase: "heavy", shape: {}, pressure: Uniform(0.0)),
            ],
        )"#,
        box_of(0.5, 1.0),
        box_of(0.0, 0.5),
    )
}

/// A tank of water, 1 m by 0.5 m or 1 m by 1 m by 0.5 m.
pub fn tank(dimension: usize) -> String {
    let (gravity, fluid, walls) = if dimension == 2 {
        ("(0.0, -9.81)", "Box(min: (0.0, 0.0), max: (1.0, 0.5))", "Box(min: (0.0, 0.0), max: (1.0, 1.0))")
    } else {
        (
            "(0.0, 0.0, -9.81)",
            "Box(min: (0.0, 0.0, 0.0), max: (1.0, 1.0, 0.5))",
            "Box(min: (0.0, 0.0, 0.0), max: (1.0, 1.0, 1.0))",
        )
    };
    format!(
        r#"Scene(
            dimension: {dimension}, spacing: 0.05, gravity: {gravity}, end_time: 1.0,
            phases: {{ "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)) }},
            fluids: [(phase: "water", shape: {fluid})],
            walls: {{ "tank": (shape: {walls}) }},
        )"#
    )
}

/// A cube of liquid in empty space, `cells` particles of 0.05 m along each side, without gravity; `more` are sections.
pub fn cube(dimension: usize, cells: usize, more: &str) -> String {
    let side = 0.05 * cells as f64;
    let (gravity, corner) = if dimension == 2 {
        ("(0.0, 0.0)", format!("min: (0.0, 0.0), max: ({side:?}, {side:?})"))
    } else {
        ("(0.0, 0.0, 0.0)", format!("min: (0.0, 0.0, 0.0), max: ({side:?}, {side:?}, {side:?})"))
    };
    format!(
        r#"Scene(
            dimension: {dimension}, spacing: 0.05, gravity: {gravity}, end_time: 1.0,
            equation_of_state: (max_speed: 1.0), {more}
            phases: {{ "oil": (reference_density: 1000.0, rheology: Newtonian(viscosity: 2.0)) }},
            fluids: [(phase: "oil", shape: Box({corner}), pressure: Uniform(0.0))],
        )"#
    )
}

/// Whether every coordinate of `x` lies farther than `margin` (m) from the sides of a [`cube`].
pub fn is_inside_cube(x: DVec3, dimension: usize, cells: usize, margin: f64) -> bool {
    x.to_array()[..dimension].iter().all(|x| *x > margin && *x < 0.05 * cells as f64 - margin)
}

/// Gives every fluid particle the pressure `pressure(x)` (Pa) and the mass with which it fills its cell of the lattice.
pub fn press(world: &mut World, pressure: impl Fn(DVec3) -> f64) {
    let state = *world.resource::<EquationOfState>();
    let volume = world.resource::<Resolution>().particle_volume();
    let mut fluid = world.query_filtered::<(&Position, &ReferenceDensity, &mut Density, &mut Mass), With<Fluid>>();
    for (x, rho0, mut rho, mut m) in fluid.iter_mut(world) {
        rho.0 = rho0.0 * (1.0 + (pressure(x.0) - state.background_pressure) / state.bulk_modulus);
        m.0 = rho.0 * volume;
    }
}
