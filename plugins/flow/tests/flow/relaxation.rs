//! Relaxation zones: the rate is the one given, waves are absorbed, a channel is driven, mass is kept.

use std::f64::consts::TAU;

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::clock::Clock;
use storegga::kernels::SmoothingKernel;
use storegga::neighbours::Neighbours;
use storegga::outputs::OutputTimes;
use storegga::particles::{Density, Fluid, Mass, Position, Pressure, ReferenceDensity, Velocity};
use storegga::physics::EquationOfState;
use storegga::probes::Series;
use storegga::schedule::Step;

use crate::support::{app, motion, refusal, run_until, stir};

/// One particle that flies up the y axis at x = 0.525 m, where nothing acts on it but the zones.
fn lone_particle(zones: &str) -> String {
    format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 1.0, equation_of_state: (max_speed: 1.0),
            phases: {{ "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)) }},
            fluids: [(phase: "water", shape: Box(min: (0.5, 0.0), max: (0.55, 0.05)), velocity: (0.0, 0.5),
                pressure: Uniform(0.0))],
            relaxation_zones: {{ {zones} }},
        )"#
    )
}

/// Velocity (m/s) of the particle along y at `time` (s), with steps made uneven by outputs.
fn speed_after(zones: &str, time: f64) -> f64 {
    let mut app = app(&lone_particle(zones));
    let world = app.world_mut();
    world.insert_resource(OutputTimes::new(f64::INFINITY, 0.0037));
    run_until(world, time);
    motion(world)[0].1.y
}

const EVERYWHERE: &str = "shape: Box(min: (0.0, -9.0), max: (9.0, 9.0))";
const STILL: &str = "target: Uniform(velocity: (0.0, 0.0))";

#[test]
fn a_particle_slows_down_at_the_rate_given_however_great() {
    for rate in [3.0, 30.0, 3000.0] {
        let left = speed_after(&format!("\"z\": ({EVERYWHERE}, {STILL}, rate: {rate:?})"), 0.1);
        let exact = 0.5 * (-rate * 0.1_f64).exp();
        assert!((left - exact).abs() <= 1e-12 * exact, "rate {rate}/s: {left} m/s, exact {exact} m/s");
    }
}

#[test]
fn the_target_is_approached_at_the_same_rate() {
    let zone = format!("\"z\": ({EVERYWHERE}, target: Uniform(velocity: (0.0, -0.3)), rate: 30.0)");
    let exact = -0.3 + (0.5 + 0.3) * (-30.0 * 0.1_f64).exp();
    assert!((speed_after(&zone, 0.1) - exact).abs() < 1e-12);
}

#[test]
fn the_rate_grows_into_the_zone() {
    // The particle is 0.525 m deep. f(½) = (e^(0.5^3.5) − 1)/(e − 1) = 0.0537818…
    for (ramp, weight) in [(1.05, 0.092_412_0 / 1.718_281_8), (0.525, 1.0), (0.1, 1.0)] {
        let left = speed_after(&format!("\"z\": ({EVERYWHERE}, {STILL}, rate: 30.0, ramp: {ramp:?})"), 0.1);
        let exact = 0.5 * (-30.0 * weight * 0.1_f64).exp();
        assert!((left / exact - 1.0).abs() < 1e-5, "ramp {ramp} m: {left} m/s, exact {exact} m/s");
    }
    let outside = "shape: Box(min: (0.53, -9.0), max: (9.0, 9.0))";
    assert_eq!(speed_after(&format!("\"z\": ({outside}, {STILL}, rate: 30.0)"), 0.1), 0.5);
}

/// Two particles at rest, 3.08 h apart, where lists reach to 3.06 h, are driven towards each other at once: when 3 h are left
/// between them each must be in the other's list, though neither was fast when its first step began.
#[test]
fn lists_follow_what_a_zone_drives() {
    let zone = |name, x, speed| {
        format!(
            "\"{name}\": (shape: Box(min: ({x:?}, 0.0), max: ({:?}, 0.1)), target: Uniform(velocity: ({speed:?}, 0.0)), rate: 1e9),",
            x + 0.1
        )
    };
    let mut app = app(&format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, smoothing_ratio: 1.2987, gravity: (0.0, 0.0), end_time: 1.0,
            equation_of_state: (max_speed: 1.0), neighbours: (skin: 0.02), free_surface: Off,
            phases: {{ "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)) }},
            fluids: [
                (phase: "water", shape: Box(min: (0.0, 0.0), max: (0.05, 0.05)), pressure: Uniform(0.0)),
                (phase: "water", shape: Box(min: (0.2, 0.0), max: (0.25, 0.05)), pressure: Uniform(0.0)),
            ],
            relaxation_zones: {{ {} {} }},
        )"#,
        zone("left", 0.0, 1.0),
        zone("right", 0.15, -1.0)
    ));
    let world = app.world_mut();
    let radius = world.resource::<SmoothingKernel>().0.radius();
    let distance = |world: &mut World| motion(world)[0].0.distance(motion(world)[1].0);
    while distance(world) >= radius {
        world.resource_mut::<Clock>().begin_step(f64::INFINITY);
        world.run_schedule(Step);
    }
    let near = world.resource::<Neighbours>().fluid.of(0);
    assert_eq!(near.fluid.iter().collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn a_zone_acts_between_its_times() {
    // Outputs at multiples of 0.0037 s: steps begin and end there.
    let zone = format!("\"z\": ({EVERYWHERE}, {STILL}, rate: 30.0, from: 0.037, until: 0.074)");
    assert_eq!(speed_after(&zone, 0.037), 0.5);
    let exact = 0.5 * (-30.0 * 0.037_f64).exp();
    assert!((speed_after(&zone, 0.1) - exact).abs() < 1e-12);
}

#[test]
fn a_zone_reaches_through_periodic_sides() {
    // Across the seam at x = 0 = 1 m: the place x = 0.525 m is 0.125 m deep in the image of a zone that begins at −0.6 m.
    let seam = "shape: Box(min: (-0.6, -9.0), max: (0.1, 9.0))";
    let text = lone_particle(&format!("\"z\": ({seam}, {STILL}, rate: 30.0)"));
    let mut app = app(&text.replace("phases:", "periodic: (x: (0.0, 1.0)), phases:"));
    run_until(app.world_mut(), 0.1);
    assert!((motion(app.world_mut())[0].1.y - 0.5 * (-3.0_f64).exp()).abs() < 1e-12);
}

/// A strip of water 2 m long and periodic, without viscosity to speak of; sound goes through it with 10 m/s.
fn strip(zones: &str) -> String {
    format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 1.0, periodic: (x: (0.0, 2.0), y: (0.0, 0.4)),
            equation_of_state: (max_speed: 1.0, max_pressure: 0.0), diffusion: Off,
            phases: {{ "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 1e-6)) }},
            fluids: [(phase: "water", shape: Box(min: (0.0, 0.0), max: (2.0, 0.4)), pressure: Uniform(0.0))],
            relaxation_zones: {{ {zones} }},
        )"#
    )
}

/// Energy (J/m) of sound: `Σ ½ m v² + ½ V p²/B`.
fn sound_energy(world: &mut World) -> f64 {
    let b = world.resource::<EquationOfState>().bulk_modulus;
    let mut fluid = world.query_filtered::<(&Mass, &Velocity, &Density, &Pressure), With<Fluid>>();
    fluid.iter(world).map(|(m, v, rho, p)| 0.5 * m.0 * (v.0.length_squared() + p.0 * p.0 / (b * rho.0))).sum()
}

/// Share of its energy that sound of the velocity `u(x)` (m/s) keeps up to `time` (s).
fn energy_left(zones: &str, time: f64, u: impl Fn(f64) -> f64) -> f64 {
    let mut app = app(&strip(zones));
    let world = app.world_mut();
    stir(world, |x| DVec3::new(u(x.x), 0.0, 0.0));
    let start = sound_energy(world);
    run_until(world, time);
    sound_energy(world) / start
}

#[test]
fn sound_under_damping_loses_energy_as_the_telegraph_equation_says() {
    // u_tt + k u_t = c² u_xx: at whole periods of ω' = √(c²κ² − k²/4) the standing wave is e^(−kt/2) of what it was.
    let (k, omega) = (4.0, 10.0 * TAU / 2.0);
    let period = TAU / (omega * omega - 0.25 * k * k).sqrt();
    let zone = format!("\"all\": (shape: Box(min: (-9.0, -9.0), max: (9.0, 9.0)), {STILL}, rate: {k:?})");
    let wave = |x: f64| 0.01 * (TAU * x / 2.0).sin();
    let free = energy_left("", 2.0 * period, wave);
    let damped = energy_left(&zone, 2.0 * period, wave);
    let exact = (-k * 2.0 * period).exp();
    assert!((free - 1.0).abs() < 0.02, "undamped {free}");
    assert!((damped / exact - 1.0).abs() < 0.05, "{damped}, exact {exact}");
}

#[test]
fn a_sponge_absorbs_a_pulse() {
    // Two pulses run to both sides and meet twice in the sponge around the seam.
    let pulse = |x: f64| 0.01 * (-((x - 1.0) / 0.2).powi(2)).exp();
    let sponge = "\"sponge\": (shape: Box(min: (-0.6, -9.0), max: (0.6, 9.0)), target: Uniform(velocity: (0.0, 0.0)),
        rate: 60.0, ramp: 0.5)";
    let (free, absorbed) = (energy_left("", 0.4, pulse), energy_left(sponge, 0.4, pulse));
    assert!(free > 0.9 && absorbed < 0.05, "without the sponge {free}, with it {absorbed}");
}

/// A channel 0.1 m high, periodic, without gravity: a zone at the seam drives a flow of 0.012 m/s on average.
const CHANNEL: &str = r#"Scene(
    dimension: 2, spacing: 0.005, gravity: (0.0, 0.0), end_time: 8.0, periodic: (x: (-0.06, 0.14)),
    equation_of_state: (max_speed: 0.03, max_pressure: 8.0, background_pressure: 2.0),
    phases: { "oil": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.7)) },
    fluids: [(phase: "oil", shape: Box(min: (-0.06, 0.0), max: (0.14, 0.1)), pressure: Uniform(0.0))],
    walls: { "plates": (shape: Box(min: (-0.2, 0.0), max: (0.3, 0.1))) },
    relaxation_zones: { "seam": (
        shape: Box(min: (-0.06, -1.0), max: (0.0, 1.1)), ramp: 0.02, rate: 2000.0,
        target: Parabolic(mean: (0.012, 0.0), across: Y, walls: (0.0, 0.1)),
    ) },
)"#;

#[test]
fn a_zone_at_the_seam_drives_a_channel_and_keeps_its_mass() {
    let mut app = app(CHANNEL);
    let world = app.world_mut();
    let mass = |world: &mut World| {
        let mut found = world.query_filtered::<&Mass, With<Fluid>>();
        found.iter(world).fold((0, 0.0), |(count, sum), m| (count + 1, sum + m.0))
    };
    let before = mass(world);
    run_until(world, 6.0);
    assert_eq!(mass(world), before);
    // Outside the zone: the same discharge everywhere, and the pressure gradient of the exact flow, −12 μ U/H².
    let (mut flow, mut volume) = ([0.0; 3], [0.0; 3]);
    let mut samples = Vec::new();
    let mut fluid =
        world.query_filtered::<(&Position, &Velocity, &Mass, &Density, &ReferenceDensity, &Pressure), With<Fluid>>();
    for (x, v, m, rho, _, p) in fluid.iter(world) {
        if (0.0..0.135).contains(&x.0.x) {
            let (k, part) = ((x.0.x / 0.045) as usize, m.0 / rho.0);
            (flow[k], volume[k]) = (flow[k] + part * v.0.x, volume[k] + part);
        }
        if (0.02..0.12).contains(&x.0.x) {
            samples.push((x.0.x, p.0));
        }
    }
    for (flow, volume) in flow.iter().zip(volume) {
        assert!((flow / volume / 0.012 - 1.0).abs() < 0.01, "mean velocity {} m/s", flow / volume);
    }
    let n = samples.len() as f64;
    let (x, p) = samples.iter().fold((0.0, 0.0), |(x, p), sample| (x + sample.0 / n, p + sample.1 / n));
    let (above, below) =
        samples.iter().fold((0.0, 0.0), |(a, b), s| (a + (s.0 - x) * (s.1 - p), b + (s.0 - x).powi(2)));
    let exact = -12.0 * 0.7 * 0.012 / (0.1 * 0.1);
    assert!((above / below / exact - 1.0).abs() < 0.06, "{} Pa/m, exact {exact} Pa/m", above / below);
}

#[test]
fn a_weak_zone_holds_the_discharge_back_by_the_pressure_jump() {
    let text = CHANNEL.replace("rate: 2000.0", "rate: 50.0").replace("end_time: 8.0", "end_time: 5.0");
    let text = text.replace(
        "phases:",
        "probes: { \"flow\": MeanVelocity(shape: Box(min: (0.02, 0.0), max: (0.12, 0.1))) }, phases:",
    );
    let mut app = app(&text);
    run_until(app.world_mut(), 5.0);
    let mut series = app.world_mut().query::<&Series>();
    let flow = series.iter(app.world()).find(|series| series.name == "flow").expect("it was asked for");
    let late: Vec<f64> = flow.column(0).filter(|(time, _)| *time > 4.0).map(|(_, u)| u).collect();
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    // The jump makes up for the friction of the whole period, Δp = 12 μ U L/H², and U = U* − Δp/(ρ k ∫ f dx). The zone is 0.06 m
    // long with two ramps of 0.02 m.
    let per_speed = 12.0 * 0.7 * 0.2 / (0.1 * 0.1) / (1000.0 * 50.0 * (0.02 + 2.0 * 0.176_06 * 0.02));
    let exact = 0.012 / (1.0 + per_speed);
    assert!(per_speed > 0.1 && (mean / exact - 1.0).abs() < 0.01, "{mean} m/s, exact {exact} m/s");
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let state = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut app = app(CHANNEL);
            run_until(app.world_mut(), 0.1);
            motion(app.world_mut())
        })
    };
    assert_eq!(state(1), state(3));
}

#[test]
fn zones_that_make_no_sense_are_refused_in_their_place() {
    let zone = format!("{EVERYWHERE}, {STILL}");
    for (fields, word) in [
        (format!("{zone}, rate: 0.0"), "`relaxation_zones.z.rate`: must be greater than 0"),
        (format!("{zone}, rate: 1.0, ramp: -1.0"), "`relaxation_zones.z.ramp`: must not be negative"),
        (format!("{zone}, rate: 1.0, from: 2.0, until: 1.0"), "must be later than `from` (2 s)"),
        (format!("{zone}, rate: 1.0, rmap: 0.1"), "did you mean `ramp`?"),
        (
            format!("{EVERYWHERE}, target: Uniform(velocity: (0.0, 2.0)), rate: 1.0"),
            "give `equation_of_state.max_speed`",
        ),
        (format!("{EVERYWHERE}, target: Uniform(velocity: (0.0, 2.0, 0.0)), rate: 1.0"), "expected 2 numbers"),
        (format!("{EVERYWHERE}, target: Parabola(mean: 1.0), rate: 1.0"), "`Parabolic`"),
    ] {
        let said = refusal("test.ron", &lone_particle(&format!("\"z\": ({fields})")));
        assert!(said.contains(word) && said.contains("test.ron:"), "{fields}: {said}");
    }
}
