//! Fluids whose particles are placed along the surface of their shape.

use bevy_ecs::prelude::*;
use storegga::particles::{Fluid, Mass, Position};

use crate::support::{app, refusal};

const DROP: &str = r#"Scene(
    dimension: 2, spacing: 0.05, gravity: (0.0, 0.0), end_time: 1.0, equation_of_state: (max_speed: 1.0),
    phases: { "oil": (reference_density: 800.0, rheology: Newtonian(viscosity: 2.0)) },
    fluids: [(
        phase: "oil", shape: Circle(center: (0.3, 0.2), radius: 0.51), pressure: Uniform(0.0), filling: Fitted,
    )],
)"#;

#[test]
fn a_fitted_drop_has_its_exact_mass_and_an_even_edge() {
    let mut app = app(DROP, &[]);
    let world = app.world_mut();
    let (mut mass, mut edge) = (0.0, 0);
    for (x, m) in world.query_filtered::<(&Position, &Mass), With<Fluid>>().iter(world) {
        mass += m.0;
        let radius = x.0.distance(glam::DVec3::new(0.3, 0.2, 0.0));
        assert!(radius < 0.51, "{} lies outside", x.0);
        // Ten rings 0.051 m thick: the middle of the outermost one.
        edge += u32::from((radius - (0.51 - 0.0255)).abs() < 1e-9);
    }
    let exact = 800.0 * std::f64::consts::PI * 0.51 * 0.51;
    assert!((mass / exact - 1.0).abs() < 1e-12, "{mass} kg/m, exact {exact} kg/m");
    assert_eq!(edge, 60, "2π · 0.4845 m / 0.051 m = 59.7 particles");
}

#[test]
fn fitted_places_have_no_layers_above_them() {
    let said = refusal(DROP, &["fluids.0.pressure=Hydrostatic", "gravity.1=-9.81"]);
    assert!(said.contains("no columns of layers"), "{said}");
}
