//! A run that leaves the range of the model ends, and says at which particle, by which limit, and what to try.

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::app::{End, PaperPlugins, StopFlag, open, run};
use storegga::clock::Limit;
use storegga::particles::{Density, Fluid, ParticleId, Position, Velocity, Viscosity};
use storegga::physics::{BrokenLimit, Cause, DivergenceReport};
use storegga::scene::Document;
use storegga::schedule::{Stage, Step};

use crate::support::{app, cube, tank};

/// What is said of the run of `world`, which must diverge.
#[track_caller]
fn report(world: &mut World) -> DivergenceReport {
    match run(world, 1.0, &StopFlag::default(), |_| {}) {
        End::Diverged(report) => *report,
        end => panic!("the run did not diverge: {end:?}"),
    }
}

fn causes(report: &DivergenceReport) -> Vec<Cause> {
    report.advice.iter().map(|advice| advice.cause).collect()
}

/// Does `change` to particles, chosen by their identity, before the first step, and runs the scene.
fn after_change(
    scene: &str,
    chosen: impl Fn(u32) -> bool,
    change: impl Fn(&mut Position, &mut Velocity, &mut Density),
) -> DivergenceReport {
    let mut app = app(scene, &[]);
    let world = app.world_mut();
    let mut fluid = world.query_filtered::<(&ParticleId, &mut Position, &mut Velocity, &mut Density), With<Fluid>>();
    for (id, mut x, mut v, mut rho) in fluid.iter_mut(world) {
        if chosen(id.0) {
            change(&mut x, &mut v, &mut rho);
        }
    }
    report(world)
}

/// The whole block is five times as fast as sound, 10 m/s: the scene's v_max is wrong.
#[test]
fn a_flow_faster_than_sound_asks_for_a_greater_sound_speed() {
    let text = cube(2, 10, "").replace("pressure: Uniform(0.0)", "velocity: (50.0, 0.0), pressure: Uniform(0.0)");
    let report = report(app(&text, &[]).world_mut());
    assert!(
        matches!(report.broken, BrokenLimit::Speed { value, sound }
        if (value - 50.0).abs() < 1.0 && (sound - 10.0).abs() < 1e-9),
        "{report}"
    );
    assert_eq!(causes(&report)[0], Cause::SoundSpeed, "{report}");
    assert_eq!((report.phase.as_str(), report.step), ("oil", 1));
    let neighbours = &report.neighbours[0];
    assert_eq!((neighbours.kind, neighbours.name.as_str()), ("fluid", "oil"));
    assert!((neighbours.nearest - 1.0).abs() < 0.1 && (neighbours.speed - 50.0).abs() < 1.0, "{report}");
    // Within 3.6 spacings there are 36 neighbours, and at a corner a quarter of the circle: at most all of them.
    assert!((8..=37).contains(&neighbours.count), "{report}");
}

#[test]
fn a_drop_by_itself_is_spray() {
    let text = cube(2, 1, "").replace("pressure: Uniform(0.0)", "velocity: (50.0, 0.0), pressure: Uniform(0.0)");
    let report = report(app(&text, &[]).world_mut());
    assert_eq!(causes(&report)[0], Cause::Spray, "{report}");
    assert!(report.neighbours.is_empty() && report.full_neighbourhood == 39, "{report}");
}

/// The whole block is compressed to 2.5 ρ0.
#[test]
fn a_pressure_beyond_the_stiffness_asks_for_a_greater_sound_speed() {
    // So dense, every particle fills less than half of its neighbourhood, and would be set anew as spray.
    let report = after_change(&cube(2, 10, "free_surface: Off,"), |_| true, |_, _, rho| rho.0 *= 2.5);
    assert!(matches!(report.broken, BrokenLimit::Density { range: (500.0, 2000.0), .. }), "{report}");
    assert_eq!(causes(&report)[0], Cause::SoundSpeed, "{report}");
}

#[test]
fn steps_that_are_too_long_are_named() {
    let sets = ["phases.water.rheology.viscosity=100000.0", "time_step=(viscosity: 2.0)"];
    let report = report(app(&tank(2), &sets).world_mut());
    assert_eq!(causes(&report)[0], Cause::TimeStep, "{report}");
    assert!(report.advice[0].text.contains("--set time_step.viscosity=0.125"), "{report}");
    assert!(report.neighbours.iter().any(|group| group.kind == "fluid" && group.name == "water"), "{report}");
}

/// One particle of a fluid at rest is compressed to 2.5 ρ0: nothing around it is like it.
#[test]
fn a_single_particle_out_of_range_asks_for_shorter_steps() {
    let report = after_change(&tank(2), |id| id == 100, |_, _, rho| rho.0 *= 2.5);
    assert!(matches!(report.broken, BrokenLimit::Density { value, .. } if value > 2000.0), "{report}");
    assert_eq!((report.particle, causes(&report)[0]), (100, Cause::TimeStep), "{report}");
}

#[test]
fn a_viscosity_that_asks_for_too_short_steps_is_named() {
    // Δt = 0.125 h² ρ/μ = 2.25·10⁻⁴ s of h = 0.06 m and μ = 2000 Pa s.
    let sets = ["phases.water.rheology.viscosity=2000.0", "time_step=(least: 0.001)"];
    let report = report(app(&tank(2), &sets).world_mut());
    let BrokenLimit::TimeStep { value, least, .. } = report.broken else { panic!("{report}") };
    assert!((value - 2.25e-4).abs() < 1e-5 && least == 1e-3, "{report}");
    assert_eq!(causes(&report)[0], Cause::Viscosity, "{report}");
    assert!(report.advice[0].text.contains("max_viscosity"), "{report}");
}

/// A system that gives 10⁹ Pa s where the rheology promised 10⁻³: Δt falls far below what the scene can ask for.
#[test]
fn a_time_step_that_collapses_ends_the_run() {
    fn stiffen(mut fluid: Query<&mut Viscosity, With<Fluid>>) {
        fluid.iter_mut().for_each(|mut mu| mu.0 = 1e9);
    }
    let document = Document::parse("test.ron", &tank(2)).expect("a right scene");
    let plugin = |app: &mut App| {
        app.add_systems(Step, stiffen.after(Stage::Loads).before(Stage::TimeStep));
    };
    let mut app = open((PaperPlugins, plugin), document).unwrap_or_else(|error| panic!("{}", error.render(false)));
    let report = report(app.world_mut());
    assert!(matches!(report.broken, BrokenLimit::TimeStep { by: Limit::Viscosity, .. }), "{report}");
    assert_eq!(causes(&report)[0], Cause::Viscosity, "{report}");
}

/// A particle by itself touches nothing: only its own position shows that it is lost.
#[test]
fn values_that_are_no_numbers_are_found_wherever_they_are() {
    for (quantity, scene) in [("position", cube(2, 1, "")), ("position", tank(2)), ("velocity", tank(2))] {
        let report = after_change(
            &scene,
            |id| id == 0,
            |x, v, _| match quantity {
                "position" => x.0 = DVec3::NAN,
                _ => v.0 = DVec3::NAN,
            },
        );
        assert!(matches!(report.broken, BrokenLimit::NotFinite { .. }), "{report}");
        assert_eq!((report.step, causes(&report)[0]), (1, Cause::NotANumber), "{report}");
    }
}

/// The particle in the corner, compressed, and put a tenth of a spacing from its neighbour or from a ghost of the floor.
#[test]
fn particles_on_one_another_and_in_walls_are_named() {
    for (place, cause) in
        [(DVec3::new(0.07, 0.025, 0.0), Cause::Overlap), (DVec3::new(0.025, -0.02, 0.0), Cause::InBody)]
    {
        let squeeze = |x: &mut Position, _: &mut Velocity, rho: &mut Density| (x.0, rho.0) = (place, rho.0 * 2.5);
        let report = after_change(&tank(2), |id| id == 0, squeeze);
        assert_eq!((report.particle, causes(&report)[0]), (0, cause), "{report}");
    }
}
