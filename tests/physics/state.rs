//! Eqs. 7–9: one bulk modulus for all phases, as large as the phase needs that asks most.

use storegga::physics::{EquationOfState, StateSettings};

fn state(densities: &[f64], max_pressure: f64, max_speed: f64) -> EquationOfState {
    EquationOfState::new(densities, &StateSettings::default(), max_pressure, max_speed)
}

#[test]
fn the_phase_that_asks_most_sets_the_bulk_modulus_of_all() {
    // (p_max, v_max, B): the speed asks for 100 ρ0 v², most for the heaviest; the pressure for 100 p, for all alike.
    for (p, v, b) in [(0.0, 2.0, 780e3), (5000.0, 1.0, 500e3), (1500.0, 1.0, 195e3)] {
        for densities in [[1000.0, 1950.0], [1950.0, 1000.0]] {
            let state = state(&densities, p, v);
            assert!((state.bulk_modulus - b).abs() < 1e-9 * b, "p {p} Pa, v {v} m/s: {} Pa", state.bulk_modulus);
            for rho0 in densities {
                let c = state.sound_speed(rho0);
                assert!((rho0 * c * c - b).abs() < 1e-9 * b, "B is the same for all phases");
                // Eq. 8, to rounding.
                assert!(c * (1.0 + 1e-12) >= 10.0 * v && c * (1.0 + 1e-12) >= 10.0 * (p / rho0).sqrt());
            }
        }
    }
}

#[test]
fn one_phase_alone_gets_the_sound_speed_that_it_asks_for() {
    for (p, v, c) in [(0.0, 2.0, 20.0), (9000.0, 2.0, 30.0), (4000.0, 2.5, 25.0)] {
        let found = state(&[1000.0], p, v).sound_speed(1000.0);
        assert!((found - c).abs() < 1e-12 * c, "{found} m/s, Eq. 8 gives {c} m/s");
    }
    let stiff = StateSettings { sound_speed_ratio: 20.0, ..StateSettings::default() };
    let found = EquationOfState::new(&[1000.0], &stiff, 0.0, 1.5).sound_speed(1000.0);
    assert!((found - 30.0).abs() < 1e-10, "{found} m/s");
}

#[test]
fn compression_is_the_inverse_of_pressure() {
    let settings = StateSettings { background_pressure: 700.0, ..StateSettings::default() };
    let state = EquationOfState::new(&[1000.0, 1950.0], &settings, 3000.0, 1.0);
    for rho0 in [1000.0, 1950.0] {
        assert_eq!(state.pressure(rho0, rho0), 700.0, "at ρ0 the pressure is χ");
        // Eq. 7: dp/dρ = c².
        let c = state.sound_speed(rho0);
        let slope = (state.pressure(rho0 + 1.0, rho0) - state.pressure(rho0 - 1.0, rho0)) / 2.0;
        assert!((slope - c * c).abs() < 1e-9 * slope);
        for beta in [0.97, 1.0, 1.001, 1.2] {
            assert!((state.compression(state.pressure(beta * rho0, rho0)) - beta).abs() < 1e-14);
        }
    }
}
