//! Force coefficients and mean velocity.

use storegga::boundary::Load;
use storegga::probes::Series;

use crate::support::{app, refusal, run_until};

/// Water that flows past a block without gravity.
const PAST: &str = r#"Scene(
    dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 0.02, periodic: (x: (0.0, 1.0), y: (0.0, 1.0)),
    equation_of_state: (max_speed: 1.0, background_pressure: 1000.0),
    phases: { "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 1.0)) },
    fluids: [(phase: "water", shape: Box(min: (0.0, 0.0), max: (1.0, 1.0)), velocity: (0.3, 0.4), pressure: Uniform(0.0))],
    structures: { "block": (shape: Box(min: (0.4, 0.4), max: (0.6, 0.6)), length: 3.0) },
    probes: {
        "force": ForceCoefficients(structure: "block", velocity: (0.0, 0.5), density: 1000.0, frontal: 0.2, phase: "water"),
        "corner": MeanVelocity(shape: Box(min: (0.0, 0.0), max: (0.1, 0.1))),
        "nowhere": MeanVelocity(shape: Box(min: (0.45, 0.45), max: (0.55, 0.55))),
    },
    log: (series: 0.02),
)"#;

#[test]
fn coefficients_are_forces_over_the_dynamic_pressure() {
    let mut app = app(PAST);
    let world = app.world_mut();
    run_until(world, 0.02);
    let load = *world.query::<&Load>().single(world).expect("one structure");
    let series: Vec<&Series> = world.query::<&Series>().iter(world).collect();
    let row = |name: &str, k: usize| {
        let series = series.iter().find(|series| series.name == name).expect("it was asked for");
        series.row(k).to_vec()
    };
    let force = row("force", 1);
    // ½ρU²DL = ½ · 1000 · 0.25 · 0.2 · 3 = 75 N; the flow is along y, and x is to its right.
    let exact = [load.force().y, -load.force().x, load.pressure_force.y, load.viscous_force.y];
    assert!(load.force().y > 1.0, "{} N", load.force());
    for (found, exact) in force.iter().zip(exact) {
        assert!((found - exact / 75.0).abs() < 1e-12, "{force:?}");
    }
    assert!((force[4] + force[5] - force[1]).abs() < 1e-12);
    // ρUD/μ = 1000 · 0.5 · 0.2/1, since τ = μU/D.
    assert!((force[6] - 100.0).abs() < 1e-10, "{}", force[6]);
    let corner = row("corner", 0);
    assert!((corner[0] - 0.3).abs() < 1e-12 && (corner[1] - 0.4).abs() < 1e-12, "{corner:?}");
    assert!(row("nowhere", 1).iter().all(|number| number.is_nan()));
}

#[test]
fn wrong_parameters_are_refused_in_their_place() {
    for (from, to, word) in [
        ("structure: \"block\"", "structure: \"blok\"", "did you mean `block`?"),
        ("velocity: (0.0, 0.5)", "velocity: (0.0, 0.0)", "`probes.force.velocity`: must not be the null vector"),
        ("phase: \"water\")", "phase: \"watr\")", "did you mean `water`?"),
        ("frontal: 0.2", "frontal: -0.2", "`probes.force.frontal`: must be greater than 0, got -0.2 m"),
        ("max: (0.1, 0.1)", "max: (-0.1, 0.1)", "`probes.corner.shape"),
    ] {
        let said = refusal("test.ron", &PAST.replace(from, to));
        assert!(said.contains(word), "{said}");
    }
}
