//! The books of energy and momentum: entries against what they must be, and what is left.

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{End, PaperPlugins, StopFlag, StoreggaApp, open, run};
use storegga::boundary::Load;
use storegga::clock::Clock;
use storegga::particles::{Acceleration, Density, Fluid};
use storegga::probes::Series;
use storegga::scene::Document;
use storegga::schedule::{Stage, Step};

use crate::support::{cube, disturb, press, tank};

/// The scene `text` with books, and with a plugin.
fn opened(text: &str, plugin: fn(&mut App)) -> App {
    let document = Document::parse("test.ron", text).and_then(|scene| scene.set("probes", r#"{"books": Books()}"#));
    let document = document.and_then(|scene| scene.set("log", "(series: 0.01)")).expect("a right scene");
    open((PaperPlugins, plugin), document).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// Runs to `end` (s).
fn run_to(app: &mut App, end: f64) {
    assert_eq!(run(app.world_mut(), end, &StopFlag::default(), |_| {}), End::Done);
}

/// The last value of a field of the books.
#[track_caller]
fn last(app: &mut App, field: &str) -> f64 {
    let world = app.world_mut();
    let mut series = world.query::<&Series>();
    let books = series.iter(world).find(|series| series.name == "books").expect("the books");
    let index = books.field(field).unwrap_or_else(|| panic!("no field {field}"));
    books.column(index).last().expect("a row").1
}

/// A column of water, 0.4 m by 0.4 m, that collapses in a tank, up to the time when it has reached no wall yet.
fn collapse(sound: f64) -> App {
    let text = tank(2)
        .replace("Box(min: (0.0, 0.0), max: (1.0, 0.5))", "Box(min: (0.0, 0.0), max: (0.4, 0.4))")
        .replace("phases:", &format!("time_step: (sound: {sound:?}), phases:"));
    let mut app = opened(&text, |_| {});
    run_to(&mut app, 0.2);
    app
}

/// What is left is the error of the integration in time: of second order in Δt.
#[test]
fn half_the_time_step_leaves_a_quarter_of_the_residual() {
    let [coarse, fine] = [0.25, 0.125].map(|sound| {
        let mut app = collapse(sound);
        assert!(last(&mut app, "turnover") > 20.0, "the column falls");
        assert!(last(&mut app, "relative_momentum_residual") < 1e-12);
        last(&mut app, "relative_residual").abs()
    });
    assert!(coarse < 1e-4, "{coarse}");
    assert!((fine / coarse - 0.25).abs() < 0.1, "{coarse} {fine}");
}

/// A liquid under tension in empty space draws itself together; what the control of tension does is all that is no pair force.
#[test]
fn the_control_of_tension_has_its_entry() {
    let residual = [0.25, 0.125].map(|sound| {
        let control = format!("tensile_control: PressureDifference, time_step: (sound: {sound:?}),");
        let mut app = opened(&cube(2, 24, &control), |_| {});
        press(app.world_mut(), |_| -1000.0);
        disturb(app.world_mut(), 2, 0.01, |_| DVec3::ZERO);
        run_to(&mut app, 0.05);
        let tensile = last(&mut app, "tensile");
        assert!(last(&mut app, "body").abs() < 1e-10 * tensile.abs());
        last(&mut app, "residual").abs() / tensile.abs()
    });
    assert!(residual[1] < 0.05, "{residual:?}");
    assert!((residual[1] / residual[0] - 0.25).abs() < 0.1, "of second order in Δt: {residual:?}");
}

/// A block of a very viscous liquid on a plate that moves under it: the work of the plate is force times speed.
#[test]
fn work_of_a_moving_structure_is_its_load_times_its_speed() {
    let text = cube(
        2,
        10,
        r#"structures: { "plate": (
        shape: Box(min: (-0.5, -0.2), max: (1.5, 0.0)), motion: Translation(velocity: (0.5, 0.25))) },"#,
    );
    let mut app = opened(&text, |_| {});
    let world = app.world_mut();
    let velocity = DVec3::new(0.5, 0.25, 0.0);
    let load = |world: &mut World| world.query::<&Load>().single(world).expect("one structure").force();
    let (mut work, mut impulse, mut before) = (0.0, DVec3::ZERO, load(world));
    for _ in 0..100 {
        world.resource_mut::<Clock>().begin_step(f64::INFINITY);
        world.run_schedule(Step);
        // Each force acts in the second half of its step and in the first half of the next one.
        let (now, dt) = (load(world), world.resource::<Clock>().time_step);
        work -= 0.5 * dt * (before + now).dot(velocity);
        impulse -= 0.5 * dt * (before + now);
        before = now;
    }
    let now = world.resource::<Clock>().time;
    run_to(&mut app, now);
    let books = ["walls", "kinetic", "impulse_structures_x", "impulse_structures_y"].map(|field| last(&mut app, field));
    let [walls, kinetic, x, y] = books;
    assert!(kinetic > 0.1 * walls, "the plate sets the block in motion: {kinetic} of {walls} J/m");
    assert!((walls / work - 1.0).abs() < 1e-10, "{walls} J/m, by the load {work} J/m");
    assert!((DVec3::new(x, y, 0.0) - impulse).length() < 1e-10 * impulse.length(), "{impulse}");
    assert_eq!(last(&mut app, "impulse_walls_x"), 0.0);
    assert!(last(&mut app, "viscous") < 0.0);
    let left = last(&mut app, "residual").abs();
    assert!(left < 0.01 * last(&mut app, "turnover"), "{left}");
}

/// A block in empty space that a plugin accelerates by 3 m/s²: after t it has the speed 3t and the energy ½ m (3t)².
#[test]
fn the_force_of_a_plugin_is_in_the_books() {
    fn push(mut fluid: Query<&mut Acceleration, With<Fluid>>) {
        fluid.iter_mut().for_each(|mut a| a.0 += DVec3::X * 3.0);
    }
    let mut app = opened(&cube(2, 10, ""), |app| {
        app.add_systems(Step, push.after(Stage::BodyForce).before(Stage::Loads));
    });
    run_to(&mut app, 0.1);
    let mass = last(&mut app, "mass");
    let (speed, energy) = (0.3, 0.5 * mass * 0.09);
    for (field, exact) in [("kinetic", energy), ("body", energy), ("impulse_body_x", mass * speed)] {
        let value = last(&mut app, field);
        assert!((value / exact - 1.0).abs() < 1e-9, "{field}: {value}, exact {exact}");
    }
    assert!(last(&mut app, "residual").abs() < 1e-9 * energy);
    assert!((last(&mut app, "turnover") / energy - 1.0).abs() < 1e-9);
}

/// The damping of a settling phase takes e^(−2kt) of the kinetic energy of a block that flies, and e^(−kt) of its momentum.
#[test]
fn damping_is_in_the_books() {
    let text = cube(2, 10, "settling: Damping(until: 1.0, rate: 5.0),")
        .replace("pressure: Uniform(0.0)", "velocity: (0.5, 0.0), pressure: Uniform(0.0)");
    let mut app = opened(&text, |_| {});
    run_to(&mut app, 0.1);
    let mass = last(&mut app, "mass");
    let (kinetic, momentum) = (0.5 * mass * 0.25, mass * 0.5);
    assert!((last(&mut app, "damping") / (kinetic * ((-1.0_f64).exp() - 1.0)) - 1.0).abs() < 1e-9);
    assert!((last(&mut app, "impulse_damping_x") / (momentum * ((-0.5_f64).exp() - 1.0)) - 1.0).abs() < 1e-9);
    assert!(last(&mut app, "residual").abs() < 1e-9 * kinetic && last(&mut app, "turnover") == kinetic);
}

/// A plugin that sets densities anew: what that does to the compression is an entry of its own, exact by Eq. 7.
#[test]
fn densities_that_are_set_anew_are_in_the_books() {
    fn reset(clock: Res<Clock>, mut fluid: Query<&mut Density, With<Fluid>>) {
        if clock.step == 3 {
            fluid.iter_mut().for_each(|mut rho| rho.0 = 1010.0);
        }
    }
    // The corners of the cube would be set anew as spray.
    let mut app = opened(&cube(2, 10, "free_surface: Off,"), |app| {
        app.add_to_stage(Stage::FirstKick, reset);
    });
    run_to(&mut app, 0.01);
    // B = 1000 · 10² Pa: e = (B/ρ0) (ln β + 1/β − 1) = 100 · 4.918·10⁻⁵ J/kg.
    let exact = last(&mut app, "mass") * 100.0 * (1.01_f64.ln() + 1.0 / 1.01 - 1.0);
    let resets = last(&mut app, "resets");
    assert!((resets / exact - 1.0).abs() < 1e-6, "{resets} J/m, exact {exact} J/m");
    assert!(last(&mut app, "residual").abs() < 0.01 * exact);
}
