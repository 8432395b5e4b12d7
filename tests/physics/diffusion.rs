//! Diffusion of density against its continuum limit, and where it must not act.

use std::f64::consts::TAU;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{PaperPlugins, StoreggaApp, open};
use storegga::particles::{DensityRate, Fluid, Position, ReferenceDensity};
use storegga::physics::{CompressionGradients, EquationOfState};
use storegga::scene::{Document, Resolution};
use storegga::schedule::Stage;

use crate::support::{app, cube, disturb, evaluate, is_inside_cube, periodic_box, press, tank};

/// A periodic bar 2 m long.
fn bar(dimension: usize) -> String {
    let (spacing, gravity, sides, max) = if dimension == 2 {
        (0.04, "(0.0, 0.0)", "y: (0.0, 0.4)", "(2.0, 0.4)")
    } else {
        (0.0625, "(0.0, 0.0, 0.0)", "y: (0.0, 0.5), z: (0.0, 0.5)", "(2.0, 0.5, 0.5)")
    };
    let min = if dimension == 2 { "(0.0, 0.0)" } else { "(0.0, 0.0, 0.0)" };
    format!(
        r#"Scene(
            dimension: {dimension}, spacing: {spacing}, gravity: {gravity}, end_time: 1.0,
            periodic: (x: (0.0, 2.0), {sides}), equation_of_state: (max_speed: 1.0), diffusion: Molteni(delta: 0.1),
            phases: {{ "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)) }},
            fluids: [(phase: "water", shape: Box(min: {min}, max: {max}), pressure: Uniform(0.0))],
        )"#
    )
}

/// Expand β_j about x_i in D_i = 2 δ h c ρ0 Σ_j V_j (β_i − β_j) (r·∇W)/r²: the linear part vanishes by symmetry, and
/// with ∫ r_a ∂_b W = −δ_ab the quadratic part −½ r r:∇∇β leaves +½ ∇²β. So D = δ h c ρ0 ∇²β, which damps a wave.
#[test]
fn a_wave_of_compression_is_damped_as_by_its_laplacian() {
    for dimension in [2, 3] {
        let mut app = app(&bar(dimension), &[]);
        let world = app.world_mut();
        let (wave_number, amplitude) = (TAU / 2.0, 1e-3);
        let b = world.resource::<EquationOfState>().bulk_modulus;
        press(world, |x| amplitude * b * (wave_number * x.x).sin());
        evaluate(world);
        let (mut along, mut norm) = (0.0, 0.0);
        for (x, rate) in world.query_filtered::<(&Position, &DensityRate), With<Fluid>>().iter(world) {
            let wave = (wave_number * x.0.x).sin();
            (along, norm) = (along + rate.0 * wave, norm + wave * wave);
        }
        let (h, c) = (world.resource::<Resolution>().smoothing_length, 10.0);
        let exact = -0.1 * h * c * 1000.0 * wave_number * wave_number * amplitude;
        let found = along / norm;
        assert!((found / exact - 1.0).abs() < 0.03, "{dimension}D: {found} kg/m³/s, exact {exact} kg/m³/s");
    }
}

#[test]
fn two_liquids_under_one_pressure_do_not_diffuse_into_each_other() {
    for diffusion in ["Molteni", "Hydrostatic", "Antuono"] {
        let text = periodic_box(2).replace("phases:", &format!("diffusion: {diffusion}(delta: 0.1), phases:"));
        let mut app = app(&text, &[]);
        let world = app.world_mut();
        disturb(world, 2, 0.01, |_| DVec3::ZERO);
        press(world, |_| 7000.0);
        evaluate(world);
        let state = *world.resource::<EquationOfState>();
        let h = world.resource::<Resolution>().smoothing_length;
        for (rho0, rate) in world.query_filtered::<(&ReferenceDensity, &DensityRate), With<Fluid>>().iter(world) {
            let scale = 0.1 * state.sound_speed(rho0.0) * rho0.0 / h;
            assert!(rate.0.abs() < 1e-12 * scale, "{diffusion}: {} kg/m³/s", rate.0);
        }
    }
}

/// Greatest |dρ/dt| in disordered water at rest whose pressure is that of its depth, in units of δ c ρ0 g/(B/ρ0).
fn drift(diffusion: &str, dimension: usize) -> f64 {
    drift_of(app(&tank_with(diffusion, dimension), &[]), dimension)
}

fn tank_with(diffusion: &str, dimension: usize) -> String {
    tank(dimension).replace("phases:", &format!("diffusion: {diffusion}(delta: 0.1), phases:"))
}

fn drift_of(mut app: App, dimension: usize) -> f64 {
    let world = app.world_mut();
    disturb(world, dimension, 0.01, |_| DVec3::ZERO);
    press(world, |x| 1000.0 * 9.81 * (0.5 - x[dimension - 1]));
    evaluate(world);
    let state = *world.resource::<EquationOfState>();
    let scale = 0.1 * state.sound_speed(1000.0) * 1000.0 * 1000.0 * 9.81 / state.bulk_modulus;
    let mut rates = world.query_filtered::<&DensityRate, With<Fluid>>();
    rates.iter(world).fold(0.0, |greatest: f64, rate| greatest.max(rate.0.abs())) / scale
}

#[test]
fn the_corrected_forms_leave_a_column_at_rest_alone() {
    for dimension in [2, 3] {
        let plain = drift("Molteni", dimension);
        assert!(plain > 0.1, "{dimension}D: the plain form drifts by {plain} only: nothing was tested");
        for form in ["Hydrostatic", "Antuono"] {
            let corrected = drift(form, dimension);
            assert!(corrected < 1e-10, "{form} in {dimension}D: {corrected}");
        }
    }
}

/// So many times the slope of β of water at rest takes the place of ⟨∇β⟩.
struct Slope(f64);

impl Plugin for Slope {
    fn build(&self, app: &mut App) {
        let times = self.0;
        let system =
            move |state: Res<EquationOfState>, mut slopes: ResMut<CompressionGradients>, fluid: Query<&Fluid>| {
                let slope = -times * 1000.0 * 9.81 / state.bulk_modulus;
                slopes.0 = vec![slope * DVec3::Y; fluid.iter().count()];
            };
        app.set_stage(Stage::CompressionGradient, system, system);
    }
}

#[test]
fn a_gradient_of_ones_own_takes_the_place_of_antuonos() {
    let drift_with = |times: f64| {
        let document = Document::parse("test.ron", &tank_with("Antuono", 2)).expect("the scene is right");
        drift_of(open((PaperPlugins, Slope(times)), document).expect("the scene is right"), 2)
    };
    let (right, twice) = (drift_with(1.0), drift_with(2.0));
    assert!(right < 1e-10 && twice > 0.1, "{right} with the right slope, {twice} with twice that");
}

/// In a fluid that turns like a rigid body β = 1 + ½ ρ0 ω² r²/B has the Laplacian 2 ρ0 ω²/B: by the plain form it grows by
/// δ h c ρ0 times that everywhere, for ever.
#[test]
fn the_form_of_antuono_leaves_a_rigid_rotation_alone() {
    let (scene, omega) = (cube(2, 20, "diffusion: Molteni(delta: 0.1),"), 1.0);
    for (form, least, most) in [("Molteni", 0.9, 1.1), ("Hydrostatic", 0.9, 1.1), ("Antuono", -0.01, 0.01)] {
        let mut app = app(&scene.replace("Molteni", form), &[]);
        let world = app.world_mut();
        press(world, |x| 0.5 * 1000.0 * omega * omega * x.distance_squared(DVec3::new(0.5, 0.5, 0.0)));
        evaluate(world);
        let (b, h) =
            (world.resource::<EquationOfState>().bulk_modulus, world.resource::<Resolution>().smoothing_length);
        let plain = 0.1 * h * (b / 1000.0_f64).sqrt() * 1000.0 * 2.0 * 1000.0 * omega * omega / b;
        for (x, rate) in world.query_filtered::<(&Position, &DensityRate), With<Fluid>>().iter(world) {
            // Two kernel radii from the surface: the slopes of the neighbours are those of full neighbourhoods too.
            if is_inside_cube(x.0, 2, 20, 0.37) {
                let found = rate.0 / plain;
                assert!(found > least && found < most, "{form} at {}: {found}", x.0);
            }
        }
    }
}
