//! Ghost particles: hydrostatic pressure continues into the wall, and the fluid sticks or slips.

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::particles::{Fluid, GhostVelocity, Position, Pressure, Velocity, Wall, WallVelocity};
use storegga::physics::{EquationOfState, Gravity, ImpactPressures};
use storegga::scene::{FilledFluids, Resolution};

use crate::support::{advance, app, evaluate, tank};

#[test]
fn hydrostatic_pressure_continues_into_the_wall() {
    for dimension in [2, 3] {
        let mut app = app(&tank(dimension), &[]);
        let world = app.world_mut();
        let vertical = dimension - 1;
        let (state, gravity) = (*world.resource::<EquationOfState>(), *world.resource::<Gravity>());
        let spacing = world.resource::<Resolution>().spacing;
        let column = world.resource::<FilledFluids>().column(DVec3::splat(0.5), gravity.full, spacing, 0.0);
        let deepest = column.compressible(0.0, state.bulk_modulus, 0.0);
        assert!((deepest - 1000.0 * 9.81 * 0.5).abs() < 0.01 * deepest);
        let mut near = 0;
        for (x, p) in world.query_filtered::<(&Position, &Pressure), With<Wall>>().iter(world) {
            // The first two layers, below the surface by more than the kernel reaches.
            if x.0[vertical] < 0.25 && x.0.min_element() > -0.1 && x.0.truncate().max_element() < 1.1 {
                let exact = column.compressible(x.0[vertical], state.bulk_modulus, 0.0);
                near += 1;
                assert!((p.0 - exact).abs() < 2e-3 * deepest, "{dimension}D at {}: {} Pa, exact {exact} Pa", x.0, p.0);
            }
        }
        assert!(near > 50, "only {near} ghosts compared");
    }
}

#[test]
fn no_slip_mirrors_the_velocity() {
    let mut app = app(&tank(2), &[]);
    let world = app.world_mut();
    let u = DVec3::new(0.3, 0.1, 0.0);
    world.query_filtered::<&mut Velocity, With<Fluid>>().iter_mut(world).for_each(|mut v| v.0 = u);
    evaluate(world);
    let mut mirrored = 0;
    for (x, v) in world.query_filtered::<(&Position, &GhostVelocity), With<Wall>>().iter(world) {
        let wet = v.0 != DVec3::ZERO;
        mirrored += usize::from(wet);
        assert!(!wet || (v.0 + u).length() < 1e-12, "at {}: {}", x.0, v.0);
    }
    assert!(mirrored > 50);
}

#[test]
fn a_moving_wall_carries_its_ghosts() {
    let moving = tank(2).replace(r#""tank": ("#, r#""tank": (motion: Rotation(center: (0.5, 0.5), rate: 2.0), "#);
    let mut app = app(&moving, &[]);
    let world = app.world_mut();
    let before: Vec<DVec3> = world.query_filtered::<&Position, With<Wall>>().iter(world).map(|x| x.0).collect();
    advance(world, 10);
    let angle = 2.0 * world.resource::<storegga::clock::Clock>().time;
    let center = DVec3::new(0.5, 0.5, 0.0);
    let ghosts = world.query_filtered::<(&Position, &WallVelocity), With<Wall>>().iter(world).collect::<Vec<_>>();
    for (start, (x, v)) in before.into_iter().zip(ghosts) {
        let arm = start - center;
        let turned =
            DVec3::new(arm.x * angle.cos() - arm.y * angle.sin(), arm.x * angle.sin() + arm.y * angle.cos(), 0.0);
        assert!((x.0 - center - turned).length() < 1e-12);
        assert!((v.0 - DVec3::new(-2.0 * turned.y, 2.0 * turned.x, 0.0)).length() < 1e-12);
    }
}

/// p^w of the particles in the middle of the floor, after the whole fluid was lowered by `depth` spacings and given `velocity`.
fn impact_on_the_floor(dimension: usize, depth: f64, velocity: f64) -> Vec<f64> {
    let mut app = app(&tank(dimension), &["diffusion=Off"]);
    let world = app.world_mut();
    let vertical = dimension - 1;
    let lowered = depth * world.resource::<Resolution>().spacing;
    for (mut x, mut v) in world.query_filtered::<(&mut Position, &mut Velocity), With<Fluid>>().iter_mut(world) {
        x.0[vertical] -= lowered;
        v.0[vertical] = velocity;
    }
    evaluate(world);
    let first_layer =
        |x: DVec3| x[vertical] < 0.03 && (x.x - 0.5).abs() < 0.3 && (dimension == 2 || (x.y - 0.5).abs() < 0.3);
    let mut fluid = world.query_filtered::<&Position, With<Fluid>>();
    let impact = &world.resource::<ImpactPressures>().0;
    let found: Vec<f64> = fluid.iter(world).zip(impact).filter(|(x, _)| first_layer(x.0)).map(|(_, p)| *p).collect();
    assert!(found.len() > 10, "only {} particles compared", found.len());
    found
}

#[test]
fn walls_stop_only_what_comes_too_near() {
    for dimension in [2, 3] {
        let c = {
            let mut app = app(&tank(dimension), &[]);
            app.world_mut().resource::<EquationOfState>().sound_speed(1000.0)
        };
        let u = 0.1;
        // On the surface the sum over a half-space is the kernel in one dimension: 2h W_1(0) = 2 · 66/120 of ρ c u.
        for p in impact_on_the_floor(dimension, 0.5, -u) {
            assert!(
                (p / (1.1 * 1000.0 * c * u) - 1.0).abs() < 0.15,
                "{dimension}D: {} of 1.1 ρ c u",
                p / (1000.0 * c * u)
            );
        }
        // What leaves the wall is not held back, and the first layer of a fluid is let be.
        assert!(impact_on_the_floor(dimension, 0.5, u).iter().all(|p| *p == 0.0));
        assert!(impact_on_the_floor(dimension, 0.0, -u).iter().all(|p| *p == 0.0));
    }
}

#[test]
fn the_sound_speed_and_the_time_step_know_how_fast_walls_move() {
    // 6 m/s at the corners of the box, faster than a dam break of 0.5 m.
    let rate = 6.0 / 0.5_f64.hypot(0.5);
    let motion = format!(r#""tank": (motion: Rotation(center: (0.5, 0.5), rate: {rate:?}), "#);
    let mut app = app(&tank(2).replace(r#""tank": ("#, &motion), &[]);
    let state = *app.world_mut().resource::<EquationOfState>();
    assert!((state.max_speed - 6.0).abs() < 1e-9, "{} m/s", state.max_speed);
    let clock = *app.world_mut().resource::<storegga::clock::Clock>();
    // Ghosts reach beyond the corners.
    assert!(clock.greatest_speed > 6.0 && clock.greatest_speed < 9.0, "{} m/s", clock.greatest_speed);
    let h = app.world_mut().resource::<Resolution>().smoothing_length;
    let limit = 0.25 * h / (state.sound_speed(1000.0) + clock.greatest_speed);
    assert!((clock.stable_time_step / limit - 1.0).abs() < 1e-12);
}
