//! Shaking: the frame of the ground, in which gravity is g − a(t).

use std::fs;
use std::path::PathBuf;

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::outputs::OutputTimes;
use storegga::particles::{Acceleration, Fluid, Position, Pressure, Wall};

use crate::support::{app, app_in, motion, press, refusal, run_until};

/// A folder of the test `name` with an accelerogram in it; the file of the scene beside it.
pub fn beside(name: &str, csv: &str) -> String {
    let folder: PathBuf = std::env::temp_dir().join(format!("storegga-shaking-{}-{name}", std::process::id()));
    assert!(fs::create_dir_all(&folder).and_then(|()| fs::write(folder.join("quake.csv"), csv)).is_ok());
    folder.join("scene.ron").display().to_string()
}

const FILE: &str = "file: \"quake.csv\", time: \"t\"";

#[test]
fn a_particle_that_touches_nothing_falls_with_g_less_the_ground() {
    let text = format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: (0.0, -10.0), end_time: 1.0, equation_of_state: (max_speed: 20.0),
            phases: {{ "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)) }},
            fluids: [(phase: "water", shape: Box(min: (0.0, 0.0), max: (0.05, 0.05)), pressure: Uniform(0.0))],
            shaking: Accelerogram({FILE}, scale: 2.0, columns: [
                (name: "ns", direction: (3.0, 0.0)), (name: "ud", direction: (0.0, 0.5))]),
        )"#
    );
    // a_x = 2 (10 t) up to 0.2 s, then 2 (2 − 10 (t − 0.2)) up to 0.4 s, then none; a_y = 2 up to 0.4 s.
    let file = beside("falls", "# a quake\nt, ns, ud\n0.0, 0.0, 1.0\n0.2, 2.0, 1.0\n0.4, 0.0, 1.0\n");
    let mut app = app_in(&file, &text);
    let world = app.world_mut();
    // Steps end at the rows, so that a(t) is linear over each.
    world.insert_resource(OutputTimes::new(f64::INFINITY, 0.2));
    let start = motion(world)[0].0;
    run_until(world, 0.6);
    let (x, v) = motion(world)[0];
    // v_x = −∫ a = −2 · 0.4; x = −(its integral): 0.4 s · 0.4 m/s on average, then 0.2 s · 0.8 m/s.
    let exact_v = DVec3::new(-0.8, -10.0 * 0.6 - 2.0 * 0.4, 0.0);
    let exact_x = DVec3::new(-0.4 * 0.4 - 0.2 * 0.8, -5.0 * 0.36 - 0.16 - 0.8 * 0.2, 0.0);
    // In the step that begins at the last row the ground stops at once: its acceleration along y counts for half of it.
    assert!((v - exact_v).length() < 2e-3, "{v}, exact {exact_v} m/s");
    assert!((x - start - exact_x).length() < 2e-3, "{}, exact {exact_x} m", x - start);
}

/// A closed tank full of oil, 1 m by 0.5 m, shaken by the accelerogram beside it; `more` are sections.
pub fn tank(gravity: &str, more: &str) -> String {
    format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: {gravity}, end_time: 1.0,
            equation_of_state: (max_speed: 2.5, background_pressure: 10000.0),
            phases: {{ "oil": (reference_density: 1000.0, rheology: Newtonian(viscosity: 20.0)) }},
            fluids: [(phase: "oil", shape: Box(min: (0.0, 0.0), max: (1.0, 0.5)), pressure: Uniform(0.0))],
            {more}
        )"#
    )
}

const WALLS: &str = "walls: { \"tank\": (shape: Box(min: (0.0, 0.0), max: (1.0, 0.5))) },";

pub fn shaken() -> String {
    format!("{WALLS} shaking: Accelerogram({FILE}, columns: [(name: \"a\", direction: (1.0, 0.0))]),")
}

#[test]
fn a_closed_tank_at_rest_on_the_ground_has_the_pressure_of_g_less_a() {
    let file = beside("rest", "t,a\n0.0,5.0\n1.0,5.0\n");
    let mut app = app_in(&file, &tank("(0.0, -8.0)", &shaken()).replace("max_speed: 2.5", "max_speed: 50.0"));
    let world = app.world_mut();
    let slope = 1000.0 * DVec3::new(-5.0, -8.0, 0.0);
    let exact = |x: DVec3| 20e3 + slope.dot(x);
    press(world, exact);
    // Ghosts continue it, so that every particle is in balance, at the walls too, and the density diffuses nowhere.
    let mut wet = 0;
    for (x, p) in world.query_filtered::<(&Position, &Pressure), With<Wall>>().iter(world) {
        if p.0 != 10e3 {
            wet += 1;
            assert!((p.0 - exact(x.0)).abs() < 5.0, "at {}: {} Pa, exact {} Pa", x.0, p.0, exact(x.0));
        }
    }
    assert!(wet > 50, "only {wet} ghosts compared");
    for a in world.query_filtered::<&Acceleration, With<Fluid>>().iter(world) {
        assert!(a.0.length() < 0.02, "{} m/s² is left of (−5, −8) m/s²", a.0);
    }
    run_until(world, 0.05);
    for (x, p) in world.query_filtered::<(&Position, &Pressure), With<Fluid>>().iter(world) {
        assert!((p.0 - exact(x.0)).abs() < 60.0, "at {} after 0.05 s: {} Pa, exact {} Pa", x.0, p.0, exact(x.0));
    }
}

/// On moving walls the diffusion does not know that they are accelerated. And there the walls' velocity in the continuity
/// equation is that of the end of the step, the fluid's that of its middle: short steps make the difference small.
const ALIKE: &str = "diffusion: Off, time_step: (sound: 0.05),";

#[test]
fn a_shaken_tank_does_what_a_tank_on_moving_walls_does() {
    // ½ a t² with a = 5 m/s² as cubics, but for the first and last pieces.
    let rows: Vec<String> = (-2..=8)
        .map(|k| f64::from(k) * 0.1)
        .map(|t| format!("(time: {t:?}, displacement: ({:?}, 0.0))", 2.5 * t * t))
        .collect();
    let moving = format!(
        "walls: {{ \"tank\": (shape: Box(min: (0.0, 0.0), max: (1.0, 0.5)), \
         motion: Table(center: (0.0, 0.0), rows: [{}])) }}, {ALIKE}",
        rows.join(", ")
    );
    let file = beside("moving", "t,a\n0.0,5.0\n1.0,5.0\n");
    let mut on_ground = app_in(&file, &tank("(0.0, 0.0)", &(shaken() + ALIKE)));
    let mut in_space = app(&tank("(0.0, 0.0)", &moving));
    // From rest without a pressure gradient: sound runs up and down.
    let time = 0.2;
    for world in [on_ground.world_mut(), in_space.world_mut()] {
        run_until(world, time);
    }
    let (travelled, speed) = (2.5 * time * time, 5.0 * time);
    let (seen, moved) = (motion(on_ground.world_mut()), motion(in_space.world_mut()));
    let mut sloshing: f64 = 0.0;
    for ((x, v), (x_space, v_space)) in seen.into_iter().zip(moved) {
        let (x_moved, v_moved) = (x_space - travelled * DVec3::X, v_space - speed * DVec3::X);
        sloshing = sloshing.max(v_moved.length());
        assert!((x - x_moved).length() < 2e-4, "at {x} m, moving walls {x_moved} m");
        assert!((v - v_moved).length() < 5e-3, "{v} m/s at {x}, moving walls {v_moved} m/s");
    }
    assert!(sloshing > 0.02, "nothing happened: {sloshing} m/s");
}

#[test]
fn accelerograms_that_cannot_be_used_are_refused_with_their_line() {
    let refused = |name: &str, csv: &str, from: &str, to: &str| {
        let text = tank("(0.0, 0.0)", &shaken()).replace(from, to);
        refusal(&beside(name, csv), &text)
    };
    let good = "t,a\n0.0,1.0\n1.0,2.0\n";
    for (name, csv, from, to, words) in [
        (
            "word",
            "t,a\n0.0,1.0\n0.5,strong\n",
            "",
            "",
            ["quake.csv, line 3: `strong` in `a` is no number", "`shaking.file`"],
        ),
        ("nan", "t,a\n0.0,1.0\n0.5,NaN\n", "", "", ["quake.csv, line 3", "is no number"]),
        ("short", "t,a\n0.0,1.0\n0.5\n", "", "", ["line 3: found 1 columns", "scene.ron:"]),
        (
            "back",
            "t,a\n0.0,1.0\n0.5,2.0\n0.4,2.0\n",
            "",
            "",
            ["line 4: the time 0.4 s must lie after 0.5 s", "scene.ron:"],
        ),
        ("empty", "t,a\n", "", "", ["has no rows", "`shaking.file`"]),
        ("missing", good, "quake.csv", "quack.csv", ["quack.csv cannot be read", "`shaking.file`"]),
        ("column", good, "name: \"a\"", "name: \"b\"", ["no column is called `b`", "`shaking.columns.0.name`"]),
        ("time", good, "time: \"t\"", "time: \"time\"", ["no column is called `time`", "`shaking.time`"]),
        (
            "null",
            good,
            "direction: (1.0, 0.0)",
            "direction: (0.0, 0.0)",
            ["null vector", "`shaking.columns.0.direction`"],
        ),
        ("space", good, "direction: (1.0, 0.0)", "direction: (0.0, 0.0, 1.0)", ["expected 2 numbers", "scene.ron:"]),
        ("none", good, "(name: \"a\", direction: (1.0, 0.0))", "", ["at least one column", "`shaking.columns`"]),
        ("field", good, "columns:", "scale: 1.0, colums:", ["did you mean `columns`?", "scene.ron:"]),
    ] {
        let said = refused(name, csv, from, to);
        assert!(words.iter().all(|word| said.contains(word)), "{name}: {said}");
    }
}
