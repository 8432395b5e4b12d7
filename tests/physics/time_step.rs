//! Eq. 19: each limit binds where it should.

use storegga::clock::{Clock, Limit};
use storegga::physics::TimeStepSettings;

use crate::support::app;

#[test]
fn the_least_of_three_limits_binds() {
    let settings = TimeStepSettings::default();
    // h, c + |v|, ν, |a| and the step by hand.
    for (h, signal, nu, a, exact, binding) in [
        (0.1, 20.0, 1e-6, 9.0, 0.25 * 0.1 / 20.0, Limit::Sound),
        (0.1, 20.0, 4.0, 9.0, 0.125 * 0.01 / 4.0, Limit::Viscosity),
        (0.1, 20.0, 1e-6, 1e5, 0.25 * 1e-3, Limit::Acceleration),
        // No viscosity, no acceleration: no limit, and no 0/0.
        (0.1, 20.0, 0.0, 0.0, 0.25 * 0.1 / 20.0, Limit::Sound),
    ] {
        let (dt, limit) = settings.stable_step(h, signal, nu, a);
        assert!((dt - exact).abs() < 1e-12 * exact, "{dt} s, by hand {exact} s");
        assert_eq!(limit, binding);
    }
}

#[test]
fn coefficients_can_be_set() {
    let settings = TimeStepSettings { sound: 0.4, viscosity: 0.2, acceleration: 0.1, least: None };
    for (nu, a, exact) in [(0.0, 0.0, 0.4 * 0.1 / 20.0), (4.0, 0.0, 0.2 * 0.01 / 4.0), (0.0, 1e5, 0.1 * 1e-3)] {
        let (dt, _) = settings.stable_step(0.1, 20.0, nu, a);
        assert!((dt - exact).abs() < 1e-12 * exact, "{dt} s, by hand {exact} s");
    }
}

/// The first step of a square of two liquids that flies through empty space.
fn first_step(velocity: f64, viscosity: f64, gravity: f64) -> (f64, Limit) {
    let start = format!("velocity: ({velocity:?}, 0.0), pressure: Uniform(0.0)");
    let text = format!(
        r#"Scene(
            dimension: 2, spacing: 0.05, gravity: (0.0, {gravity:?}), end_time: 1.0,
            equation_of_state: (max_speed: 1.0, max_pressure: 0.0),
            phases: {{
                "light": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.0)),
                "heavy": (reference_density: 4000.0, rheology: Newtonian(viscosity: {viscosity:?})),
            }},
            fluids: [
                (phase: "heavy", shape: Box(min: (0.0, 0.0), max: (0.5, 0.25)), {start}),
                (phase: "light", shape: Box(min: (0.0, 0.25), max: (0.5, 0.5)), {start}),
            ],
        )"#
    );
    let app = app(&text, &[]);
    let clock = app.world().resource::<Clock>();
    (clock.stable_time_step, clock.stable_limit)
}

#[test]
fn a_run_takes_the_step_of_its_fastest_stiffest_and_most_viscous_particle() {
    // The heavy phase asks for B = 4000 · 10² Pa, and sound is fastest in the light one: √(B/1000) = 20 m/s.
    let h = 0.06;
    for (velocity, viscosity, gravity, exact, binding) in [
        (3.0, 0.0, -9.81, 0.25 * h / 23.0, Limit::Sound),
        (3.0, 8000.0, -9.81, 0.125 * h * h / 2.0, Limit::Viscosity),
        (3.0, 0.0, -2e4, 0.25 * (h / 2e4_f64).sqrt(), Limit::Acceleration),
    ] {
        let (dt, limit) = first_step(velocity, viscosity, gravity);
        assert!((dt - exact).abs() < 1e-9 * exact, "{dt} s, by hand {exact} s");
        assert_eq!(limit, binding);
    }
}
