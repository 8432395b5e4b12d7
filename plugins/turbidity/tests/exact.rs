//! The plugins of the tutorial against exact solutions and conservation laws, in the program too.

use std::f64::consts::PI;
use std::path::Path;
use std::process::Command;

use bevy_app::{App, PluginGroup, Plugins};
use bevy_ecs::prelude::*;
use storegga::app::{End, PaperPlugins, StopFlag, open, run};
use storegga::checkpoint::{check_state, restore_state, save_state};
use storegga::clock::{Clock, Limit};
use storegga::particles::{Density, Fluid, Mass, Position, Pressure, ReferenceDensity};
use storegga::physics::EquationOfState;
use storegga::scene::Document;
use storegga_standard::StandardPlugins;
use turbidity::{FineSediment, TaitPlugin, TurbidityPlugin};

fn opened<M>(plugins: impl Plugins<M>, scene: &str) -> App {
    let document = Document::parse("test.ron", scene).unwrap_or_else(|error| panic!("{}", error.render(false)));
    open(plugins, document).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

fn refusal(scene: &str) -> String {
    let document = Document::parse("test.ron", scene).unwrap_or_else(|error| panic!("{}", error.render(false)));
    match open(PaperPlugins.build().add(TurbidityPlugin), document) {
        Ok(_) => panic!("the scene was accepted"),
        Err(error) => error.render(false),
    }
}

/// Two halves of one liquid at rest without gravity, fine sediment in the left one; nothing moves.
const HALVES: &str = r#"Scene(
    dimension: 2, spacing: 0.02, gravity: (0.0, 0.0), end_time: 1.0,
    phases: {
        "left": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)),
        "right": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)),
    },
    fluids: [
        (phase: "left", shape: Box(min: (0.0, 0.0), max: (0.5, 0.2)), pressure: Uniform(0.0)),
        (phase: "right", shape: Box(min: (0.5, 0.0), max: (1.0, 0.2)), pressure: Uniform(0.0)),
    ],
    periodic: (y: (0.0, 0.2)),
    equation_of_state: (max_speed: 0.1),
    turbidity: (diffusivity: 0.01, fractions: {"left": 0.2}),
    log: (particles: 1.0, series: 0.1),
)"#;

/// c(x, t) of a step at the middle of a closed box of length 1 m, by separation of variables.
fn exact(x: f64, kappa_t: f64) -> f64 {
    let mode =
        |n: f64| 2.0 / (n * PI) * (0.5 * n * PI).sin() * (n * PI * x).cos() * (-kappa_t * (n * PI).powi(2)).exp();
    0.2 * (0.5 + (1..400).map(|n| mode(f64::from(n))).sum::<f64>())
}

fn mass(world: &mut World) -> f64 {
    world.query_filtered::<(&Mass, &FineSediment), With<Fluid>>().iter(world).map(|(m, c)| m.0 * c.0).sum()
}

/// L2 error of c (relative) against the exact solution at `times` (s), with this distance of particles (m).
fn errors(spacing: &str, times: [f64; 2]) -> [f64; 2] {
    let scene = HALVES.replace("spacing: 0.02", &format!("spacing: {spacing}"));
    let mut app = opened(PaperPlugins.build().add(TurbidityPlugin), &scene);
    let world = app.world_mut();
    let before = mass(world);
    assert!((before - 0.2 * 1000.0 * 0.5 * 0.2).abs() < 1e-9, "{before}");
    let errors = times.map(|time| {
        assert_eq!(run(world, time, &StopFlag::default(), |_| {}), End::Done);
        let mut fluid = world.query_filtered::<(&Position, &FineSediment), With<Fluid>>();
        let errors = fluid.iter(world).map(|(x, c)| (c.0 - exact(x.0.x, 0.01 * time), exact(x.0.x, 0.01 * time)));
        let (error, size) = errors.fold((0.0, 0.0), |sum, (e, c)| (sum.0 + e * e, sum.1 + c * c));
        (error / size).sqrt()
    });
    assert!((mass(world) / before - 1.0).abs() < 1e-12);
    errors
}

#[test]
fn sediment_spreads_as_the_diffusion_equation_says() {
    let [coarse, fine] = ["0.02", "0.01"].map(|spacing| errors(spacing, [0.25, 1.0]));
    assert!(coarse.iter().chain(&fine).all(|error| *error < 0.01), "{coarse:?} {fine:?}");
    assert!(fine[0] < coarse[0] && fine[1] < coarse[1], "{fine:?} against {coarse:?}");
}

#[test]
fn the_time_step_keeps_the_diffusion_stable() {
    let mut app = opened(PaperPlugins.build().add(TurbidityPlugin), &HALVES.replace("0.01, frac", "1.0, frac"));
    let world = app.world_mut();
    let clock = *world.resource::<Clock>();
    assert_eq!(clock.stable_limit, Limit::Plugin);
    assert!((clock.stable_time_step - 0.1 * 0.024_f64.powi(2)).abs() < 1e-12);
    assert_eq!(run(world, 0.01, &StopFlag::default(), |_| {}), End::Done);
    // No new extremes: c stays between its bounds.
    let mut fluid = world.query_filtered::<&FineSediment, With<Fluid>>();
    assert!(fluid.iter(world).all(|c| (-1e-15..=0.2 + 1e-15).contains(&c.0)));
}

#[test]
fn a_wrong_section_is_told_in_its_place() {
    let told = refusal(&HALVES.replace("\"left\": 0.2", "\"lefd\": 0.2"));
    assert!(told.contains("did you mean `left`?") && told.contains("fractions"), "{told}");
    let told = refusal(&HALVES.replace("\"left\": 0.2", "\"left\": 1.2"));
    assert!(told.contains("must lie between 0 and 1, got 1.2") && told.contains("test.ron:13:"), "{told}");
    let told = refusal(&HALVES.replace("diffusivity", "difusivity"));
    assert!(told.contains("did you mean `diffusivity`?"), "{told}");
}

/// A column of water that is compressed by its weight more than usual, so that equations of state differ.
const COLUMN: &str = r#"Scene(
    dimension: 2, spacing: 0.02, gravity: (0.0, -9.81), end_time: 1.5,
    phases: { "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 5.0)) },
    fluids: [(phase: "water", shape: Box(min: (0.0, 0.0), max: (0.2, 0.4)))],
    walls: { "tank": (shape: Box(min: (0.0, 0.0), max: (0.2, 0.6))) },
    equation_of_state: (max_speed: 1.0, max_pressure: 3924.0, sound_speed_ratio: 4.0),
    settling: Damping(until: 1.5, rate: 20.0),
    log: (particles: 1.5, series: 1.5),
)"#;

/// At rest a particle carries what is above it, whatever the equation of state; its density is what that equation makes of it.
/// Returns the mean of |p − weight| and of |ρ/ρ0 − 1 − `compression`(weight)|, both relative to the greatest of the exact ones.
fn at_rest<M>(plugins: impl Plugins<M>, compression: fn(f64) -> f64) -> [f64; 2] {
    let mut app = opened(plugins, COLUMN);
    let world = app.world_mut();
    assert_eq!(run(world, 1.5, &StopFlag::default(), |_| {}), End::Done);
    let bulk_modulus = world.resource::<EquationOfState>().bulk_modulus;
    let mut query = world.query_filtered::<(&Position, &Mass, &Density, &ReferenceDensity, &Pressure), With<Fluid>>();
    let fluid: Vec<_> = query.iter(world).collect();
    let mut sums = [0.0; 4];
    for (x, _, rho, rho0, p) in &fluid {
        // Half of the particles at the same height, all that are higher.
        let share = |other: f64| (0.5 + (other - x.0.y) / 0.02).clamp(0.0, 1.0);
        let above: f64 = fluid.iter().map(|(other, m, ..)| m.0 * share(other.0.y)).sum();
        let weight = 9.81 * above / 0.2;
        let exact = compression(weight / bulk_modulus);
        let error = [(p.0 - weight).abs(), (rho.0 / rho0.0 - 1.0 - exact).abs()];
        sums = [sums[0] + error[0], sums[1] + error[1], weight.max(sums[2]), exact.max(sums[3])];
    }
    [sums[0] / (sums[2] * fluid.len() as f64), sums[1] / (sums[3] * fluid.len() as f64)]
}

#[test]
fn another_equation_of_state_compresses_water_its_own_way() {
    let linear = |p_over_b: f64| p_over_b;
    let tait = |p_over_b: f64| (1.0 + 7.0 * p_over_b).powf(1.0 / 7.0) - 1.0;
    let [pressure, density] = at_rest(PaperPlugins.build().add(TaitPlugin), tait);
    assert!(pressure < 0.03 && density < 0.03, "Tait: {pressure}, {density}");
    let [_, other] = at_rest(PaperPlugins.build().add(TaitPlugin), linear);
    assert!(other > 2.0 * density, "the two equations cannot be told apart: {other} against {density}");
    let [pressure, density] = at_rest(PaperPlugins, linear);
    assert!(pressure < 0.03 && density < 0.03, "Eq. 7: {pressure}, {density}");
}

#[test]
fn the_program_knows_the_section_and_writes_the_channel() {
    let folder = std::env::temp_dir().join(format!("storegga-turbidity-{}", std::process::id()));
    let log = folder.join("plume.mcap");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("plume.ron");
    let arguments =
        ["run", &scene.display().to_string(), "--until", "0.05", "--quiet", "--out", &log.display().to_string()];
    let ran = Command::new(env!("CARGO_BIN_EXE_turbidity")).args(arguments).output().unwrap();
    assert_eq!(ran.status.code(), Some(0), "{}", String::from_utf8_lossy(&ran.stderr));
    let bytes = std::fs::read(&log).unwrap();
    std::fs::remove_dir_all(folder).unwrap();
    let rows: Vec<serde_json::Value> = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap)
        .filter(|message| message.channel.topic == "/turbidity")
        .map(|message| serde_json::from_slice(&message.data).unwrap())
        .collect();
    assert_eq!(rows.len(), 6);
    let mass = |row: &serde_json::Value| row["mass"].as_f64().unwrap();
    assert!(mass(&rows[0]) > 1.0 && (mass(&rows[5]) / mass(&rows[0]) - 1.0).abs() < 1e-12, "{rows:?}");
    assert!(rows[5]["greatest"].as_f64() < Some(0.1) && rows[5]["height"].as_f64() < rows[0]["height"].as_f64());
}

/// What the page shows is what is compiled and run here.
#[test]
fn the_page_shows_these_files() {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(own.join("../../docs/plugin.md")).unwrap();
    let files = [
        "Cargo.toml",
        "plume.ron",
        "src/channel.rs",
        "src/diffusion.rs",
        "src/lib.rs",
        "src/main.rs",
        "src/section.rs",
    ];
    let files: Vec<String> =
        files.iter().chain(&["src/tait.rs", "tests/exact.rs"]).map(|file| read(&own.join(file))).collect();
    let mut blocks = 0;
    for fenced in page.split("\n```").skip(1).step_by(2) {
        let (language, code) = fenced.split_once('\n').unwrap();
        if language != "sh" {
            blocks += 1;
            assert!(files.iter().any(|file| file.contains(code)), "not in the crate:\n{code}");
        }
    }
    assert!(blocks >= 10, "only {blocks} blocks of code");
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// A plume that goes on from what a checkpoint holds of it, against one that was not stopped.
#[test]
fn fine_sediment_goes_on_from_a_checkpoint_with_the_same_bits() {
    let plume =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("plume.ron")).expect("the scene is there");
    let [mut straight, mut resumed] = [(); 2].map(|()| opened(StandardPlugins.build().add(TurbidityPlugin), &plume));
    let go_on =
        |app: &mut App, time: f64| assert_eq!(run(app.world_mut(), time, &StopFlag::default(), |_| {}), End::Done);
    let fractions = |app: &mut App| {
        let world = app.world_mut();
        world.query_filtered::<&FineSediment, With<Fluid>>().iter(world).map(|c| c.0.to_bits()).collect::<Vec<_>>()
    };
    let before = fractions(&mut straight);
    go_on(&mut straight, 0.05);
    assert_eq!(check_state(straight.world()), Ok(()), "neither saved nor rebuilt");
    let saved = save_state(straight.world_mut()).expect("it can be saved");
    restore_state(resumed.world_mut(), &saved).expect("it fits");
    let [straight, resumed] = [straight, resumed].map(|mut app| {
        go_on(&mut app, 0.1);
        (fractions(&mut app), save_state(app.world_mut()).expect("it can be saved"))
    });
    assert_ne!(before, straight.0, "nothing spread");
    assert!(straight == resumed, "the resumed run went another way");
}
