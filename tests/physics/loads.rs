//! Loads on structures: what χ, `length` and `moment_about` do to them.

use glam::DVec3;
use storegga::boundary::Load;

use crate::support::{Noise, app, disturb, evaluate, periodic_box, press, tank};

/// A periodic box with a structure off the middle of it, whose description ends with `more`.
fn around(dimension: usize, more: &str) -> String {
    let shape = if dimension == 2 {
        "Circle(center: (0.51, 0.47), radius: 0.2)"
    } else {
        "Sphere(center: (0.51, 0.47, 0.48), radius: 0.25)"
    };
    periodic_box(dimension).replace("phases:", &format!(r#"structures: {{ "body": (shape: {shape}{more}) }}, phases:"#))
}

/// The load in a fluid at χ and rest, or in turmoil.
fn load(dimension: usize, more: &str, turmoil: bool) -> Load {
    let mut app = app(&around(dimension, more), &[]);
    let world = app.world_mut();
    let mut noise = Noise(23);
    disturb(world, dimension, 0.01, |_| if turmoil { noise.vector(dimension) } else { DVec3::ZERO });
    if turmoil {
        press(world, |x| 5000.0 + 3000.0 * x.x - 1000.0 * x.y);
    }
    evaluate(world);
    *world.query::<&Load>().single(world).expect("one structure")
}

#[test]
fn a_background_pressure_leaves_no_force() {
    for dimension in [2, 3] {
        let load = load(dimension, "", false);
        // χ on the cross-section of the body.
        let scale = 5000.0 * if dimension == 2 { 0.4 } else { 0.2 };
        assert!(load.force().length() < 1e-10 * scale, "{dimension}D: {} N of {scale} N", load.force());
        assert!(load.moment().length() < 1e-10 * scale, "{dimension}D: {} N m", load.moment());
    }
}

#[test]
fn force_and_moment_are_multiplied_by_the_length() {
    let (metre, cable) = (load(2, "", true), load(2, ", length: 2.5", true));
    for (one, all) in [
        (metre.pressure_force, cable.pressure_force),
        (metre.viscous_force, cable.viscous_force),
        (metre.pressure_moment, cable.pressure_moment),
        (metre.viscous_moment, cable.viscous_moment),
    ] {
        assert!(one.length() > 1e-3, "nothing acts: {one}");
        assert!((all - 2.5 * one).length() < 1e-12 * all.length(), "{one} {all}");
    }
}

#[test]
fn the_moment_about_another_point_differs_by_arm_and_force() {
    for (dimension, points) in [(2, ["(0.2, 0.9)", "(-0.3, 0.4)"]), (3, ["(0.2, 0.9, -0.5)", "(-0.3, 0.4, 0.8)"])] {
        let [a, b] = points.map(|point| load(dimension, &format!(", moment_about: {point}"), true));
        assert_eq!(a.force(), b.force());
        // From a to b.
        let arm = DVec3::new(-0.5, -0.5, if dimension == 3 { 1.3 } else { 0.0 });
        let exact = a.moment() - arm.cross(a.force());
        let scale = arm.length() * a.force().length();
        assert!(scale > 1.0 && arm.cross(a.force()).length() > 0.1 * scale);
        assert!((b.moment() - exact).length() < 1e-12 * scale, "{dimension}D: {}, exact {exact}", b.moment());
    }
}

#[test]
fn buoyancy_turns_a_beam_about_a_point_beside_it() {
    // The point is 0.3 m to the right of its middle, so that the buoyancy turns clockwise about it.
    let text = tank(2).replace(
        "walls:",
        r#"structures: { "beam": (shape: Box(min: (0.3, 0.3), max: (0.7, 0.7)), moment_about: (0.8, 0.5)) }, walls:"#,
    );
    let mut app = app(&text, &["fluids.0.shape.max.1=1.0"]);
    let world = app.world_mut();
    let load = *world.query::<&Load>().single(world).expect("one structure");
    let buoyancy = 1000.0 * 9.81 * 0.16;
    let (f, m) = (load.force().y, load.moment().z);
    assert!((f / buoyancy - 1.0).abs() < 0.05, "{f} N/m, exact {buoyancy} N/m");
    assert!((m / (-0.3 * buoyancy) - 1.0).abs() < 0.05, "{m} N, exact {} N", -0.3 * buoyancy);
}
