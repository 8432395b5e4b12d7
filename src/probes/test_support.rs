//! Small scenes for the tests of probes and expectations.

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;

use super::Series;
use crate::app::{PaperPlugins, StopFlag, open, run};
use crate::outputs::OutputTimes;
use crate::particles::{Density, Fluid, Position, Pressure, Velocity};
use crate::scene::Document;

/// Water 0.4 m deep on a floor that is a structure, the lower half of it a phase of its own, in a 2D tank open at the top.
pub(crate) const TANK: &str = r#"
    dimension: 2, spacing: 0.02, gravity: (0, -9.81), end_time: 1.0,
    phases: {
        "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)),
        "brine": (reference_density: 1200.0, rheology: Newtonian(viscosity: 0.001)),
    },
    fluids: [
        (phase: "brine", shape: Box(min: (0, 0), max: (0.4, 0.2))),
        (phase: "water", shape: Box(min: (0, 0.2), max: (0.4, 0.4))),
    ],
    walls: {"sides": (
        shape: Box(min: (0, 0), max: (0.4, 0.5)),
        cut: Union([Box(min: (-1, -1), max: (1, 0)), Box(min: (-1, 0.5), max: (1, 1))]),
    )},
    structures: {"floor": (shape: Box(min: (-0.1, -0.1), max: (0.5, 0)))},
"#;

/// A plastic fluid between no-slip walls at y = 0 and y = 0.1 m, driven along x, where the scene repeats itself.
pub(crate) const CHANNEL: &str = r#"
    dimension: 2, spacing: 0.005, gravity: (0.5, 0), end_time: 1.0, periodic: (x: (0, 0.1)),
    equation_of_state: (max_speed: 1.0),
    phases: {"mud": (
        reference_density: 1000.0,
        rheology: HerschelBulkley(consistency: 2, exponent: 0.5, yield_stress: 10, max_viscosity: 100),
    )},
    fluids: [(phase: "mud", shape: Box(min: (0, 0), max: (0.1, 0.1)), pressure: Uniform(0))],
    walls: {"plates": (shape: Box(min: (-1, 0), max: (1, 0.1)))},
"#;

/// A scene of `fields` and `more` fields.
pub(crate) fn scene(fields: &str, more: &str) -> String {
    format!("Scene({fields} {more})")
}

/// An app at the start of a scene, before anything is measured.
pub(crate) fn opened(scene: &str) -> TestApp {
    let app = Document::parse("test.ron", scene).and_then(|document| open(PaperPlugins, document));
    match app {
        Ok(app) => TestApp(app),
        Err(error) => panic!("{error}"),
    }
}

/// An app at the start of a scene, measured once.
pub(crate) fn measured(scene: &str) -> TestApp {
    let mut app = opened(scene);
    app.measure();
    app
}

/// What the program says about a scene that it refuses.
pub(crate) fn complaint(scene: &str) -> String {
    let app = Document::parse("test.ron", scene).and_then(|document| open(PaperPlugins, document));
    app.err().map(|error| format!("{error} {}", error.render(false))).unwrap_or_default()
}

/// An app with a small scene.
pub(crate) struct TestApp(pub(crate) App);

impl TestApp {
    /// Measures the state as it is.
    pub(crate) fn measure(&mut self) {
        self.0.insert_resource(OutputTimes::default());
        run(self.0.world_mut(), 0.0, &StopFlag::default(), |_| {});
    }

    /// The last value of `series.field`.
    pub(crate) fn value(&mut self, of: &str) -> Option<f64> {
        let (name, field) = of.split_once('.')?;
        let world = self.0.world_mut();
        let mut query = world.query::<&Series>();
        let series = query.iter(world).find(|series| series.name == name)?;
        series.column(series.field(field)?).last().map(|(_, value)| value)
    }

    /// Whether `series.field` is `expected` within `tolerance`.
    #[track_caller]
    pub(crate) fn assert(&mut self, of: &str, expected: f64, tolerance: f64) {
        let value = self.value(of).unwrap_or(f64::NAN);
        assert!((value - expected).abs() <= tolerance, "{of}: {value}, expected {expected} ± {tolerance}");
    }

    /// Gives every fluid particle the velocity, pressure and density that `state` returns for its position.
    pub(crate) fn set_fluid(&mut self, state: impl Fn(DVec3, &mut DVec3, &mut f64, &mut f64)) {
        let world = self.0.world_mut();
        let mut query = world.query_filtered::<(&Position, &mut Velocity, &mut Pressure, &mut Density), With<Fluid>>();
        for (x, mut v, mut p, mut rho) in query.iter_mut(world) {
            state(x.0, &mut v.0, &mut p.0, &mut rho.0);
        }
    }

    /// Moves every fluid particle to the place that `place` returns for its position.
    pub(crate) fn move_fluid(&mut self, place: impl Fn(DVec3) -> DVec3) {
        let world = self.0.world_mut();
        let mut query = world.query_filtered::<&mut Position, With<Fluid>>();
        for mut x in query.iter_mut(world) {
            x.0 = place(x.0);
        }
    }
}
