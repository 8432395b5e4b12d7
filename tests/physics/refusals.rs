//! Scenes that would hang, burst or mislead are refused with their place.

use crate::support::{app, periodic_box, refusal, tank};

#[test]
fn a_period_shorter_than_the_kernel_reaches() {
    let said = refusal(&periodic_box(2), &["periodic.x=(0.0, 0.15)", "fluids.0.shape.max.0=0.15"]);
    assert!(said.contains("test.ron:") && said.contains("a period of 0.15 m is too short"), "{said}");
}

#[test]
fn more_particles_than_any_machine_holds() {
    for overrides in
        [["spacing=1e-9"], ["spacing=1e-320"], ["fluids.0.shape.max.0=1e300"], ["walls.tank.shape.max.0=1e9"]]
    {
        let said = refusal(&tank(2), &overrides);
        assert!(said.contains("particles at a spacing of"), "{overrides:?}: {said}");
    }
}

#[test]
fn outputs_that_never_end() {
    let said = refusal(&tank(2).replace("phases:", "log: (series: 1e-300), phases:"), &[]);
    assert!(said.contains("must be greater than 1.0e-7 s"), "{said}");
}

#[test]
fn weight_before_gravity() {
    let said = refusal(&tank(2).replace("phases:", "settling: GravityRamp(until: 0.5), phases:"), &[]);
    assert!(said.contains("no hydrostatic pressure yet"), "{said}");
}

#[test]
fn time_steps_that_never_come_to_an_end() {
    for (path, word) in [
        ("phases.water.rheology.viscosity=1e200", "would never end"),
        ("equation_of_state.max_speed=1e300", "infinite"),
    ] {
        let said = refusal(&tank(2).replace("phases:", "equation_of_state: (), phases:"), &[path]);
        assert!(said.contains(word), "{path}: {said}");
    }
}

#[test]
fn motions_that_make_no_sense() {
    for (motion, word) in [
        ("Translation(velocity: (1.0, 0.0), from: 2.0, until: 1.0)", "later than `from`"),
        ("Translation(velocity: (1.0, 0.0), from: -1.0)", "negative"),
        (
            "Table(center: (0.0, 0.0), rows: [(time: 0.0, displacement: (0.0, 0.0)), (time: 1.0, displacement: (0.0, 0.0, 5.0))])",
            "rows.1.displacement",
        ),
        (
            "Table(center: (0.0, 0.0), rows: [(time: 0.0, displacement: (0.3, 0.0)), (time: 1.0, displacement: (0.0, 0.0))])",
            "at t = 0",
        ),
    ] {
        let text = tank(2).replace(r#""tank": ("#, &format!(r#""tank": (motion: {motion}, "#));
        let said = refusal(&text, &[]);
        assert!(said.contains(word), "{motion}: {said}");
    }
}

#[test]
fn pressures_that_no_fluid_has() {
    for pressure in ["-1e9", "1e9"] {
        let text = tank(2).replace("fluids: [(", &format!("fluids: [(pressure: Uniform({pressure}), "));
        let said = refusal(&text, &[]);
        assert!(said.contains("fluids.0.pressure") && said.contains("times the reference density"), "{said}");
    }
}

#[test]
fn structures_that_overlap() {
    let two = |x: f64| {
        let circle = |x: f64| format!("(shape: Circle(center: ({x:?}, 0.25), radius: 0.1))");
        let structures = format!(r#"structures: {{ "a": {}, "b": {} }}, phases:"#, circle(0.3), circle(x));
        tank(2).replace("phases:", &structures)
    };
    let said = refusal(&two(0.4), &[]);
    assert!(said.contains("structures.b.shape") && said.contains("overlaps the structure `a`"), "{said}");
    // Side by side they are no mistake.
    let _ = app(&two(0.55), &[]);
}

/// Walls alone can need more memory than any machine has: that is said before the first ghost is made.
#[test]
fn walls_count_before_they_are_made() {
    // Each has six sides of 340 by 340 ghosts, four deep: 3 million.
    let wall = |k: i32| {
        let x = 10.0 * f64::from(k);
        format!(r#""{k}": (shape: Box(min: ({x:?}, 5.0, 0.0), max: ({:?}, 8.4, 3.4)), fluid: Outside),"#, x + 3.4)
    };
    let walls: String = (0..2000).map(wall).collect();
    let scene = tank(3).replace("spacing: 0.05", "spacing: 0.01").replace("walls: {", &format!("walls: {{ {walls}"));
    let said = refusal(&scene, &[]);
    assert!(
        said.contains("`spacing`") && said.contains("of memory") && said.contains(" wall and 0 structure"),
        "{said}"
    );
}
