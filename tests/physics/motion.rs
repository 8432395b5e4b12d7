//! Prescribed motions: velocity and acceleration are the derivatives of the position, and tables go through their rows.

use bevy_ecs::prelude::*;
use glam::DVec3;
use storegga::boundary::{Motion, TableRow};
use storegga::clock::Clock;
use storegga::particles::{Position, RestPosition, Solid, Wall, WallAcceleration, WallVelocity};
use storegga::scene::geometry::Point;

use crate::support::{advance, app, tank};

const REST: [DVec3; 3] = [DVec3::new(0.3, -0.2, 0.0), DVec3::new(-1.1, 0.7, 0.4), DVec3::new(0.5, 0.25, -2.0)];

fn rows(dimension: usize) -> Vec<TableRow> {
    let at = |x: f64, y: f64, z: f64| if dimension == 2 { Point::plane(x, y) } else { Point::space(x, y, z) };
    let row = |time: f64, displacement: Point, angle: f64| TableRow { time, displacement, angle };
    vec![
        row(0.5, at(0.0, 0.0, 0.0), 0.1),
        row(0.7, at(0.1, 0.3, -0.2), 0.4),
        row(1.3, at(-0.2, 0.5, 0.1), -0.8),
        row(1.6, at(0.4, 0.2, 0.6), 1.5),
        row(2.4, at(0.6, -0.1, 0.3), 2.0),
    ]
}

fn motions() -> Vec<Motion> {
    let (center, axis) = (Point::space(0.5, -0.25, 1.0), Some(Point::space(1.0, -2.0, 0.5)));
    vec![
        Motion::Translation { velocity: Point::space(0.3, -1.2, 0.7), from: 0.4, until: Some(1.1) },
        Motion::Translation { velocity: Point::plane(0.3, -1.2), from: 0.0, until: None },
        Motion::Rotation { center: Point::plane(0.5, 0.25), axis: None, rate: 2.0 },
        Motion::Rotation { center, axis, rate: -1.7 },
        Motion::Table { center: Point::plane(0.2, 0.1), axis: None, rows: rows(2) },
        Motion::Table { center, axis, rows: rows(3) },
    ]
}

#[test]
fn velocity_and_acceleration_are_the_derivatives_of_the_position() {
    let dt = 1e-5;
    // Away from the times at which a velocity jumps or a cubic ends.
    for t in [0.2, 0.55, 0.82, 1.05, 1.2, 1.45, 2.0, 3.0] {
        for motion in motions() {
            let at = |t: f64, rest: DVec3| motion.at(t).expect("it moves").of(rest);
            for rest in REST {
                let ((before, v_before, _), (after, v_after, _)) = (at(t - dt, rest), at(t + dt, rest));
                let (_, v, a) = at(t, rest);
                let (slope, curvature) = ((after - before) / (2.0 * dt), (v_after - v_before) / (2.0 * dt));
                assert!(
                    (v - slope).length() < 1e-7 * (1.0 + v.length()),
                    "{motion:?} at {t} s: {v}, by differences {slope}"
                );
                assert!(
                    (a - curvature).length() < 1e-7 * (1.0 + a.length()),
                    "{motion:?} at {t} s: {a}, by differences {curvature}"
                );
            }
        }
    }
}

#[test]
fn a_translation_covers_its_time() {
    let velocity = Point::plane(2.0, -1.0);
    let motion = Motion::Translation { velocity, from: 0.5, until: Some(1.5) };
    for (t, travelled) in [(0.0, 0.0), (0.5, 0.0), (1.0, 0.5), (1.5, 1.0), (9.0, 1.0)] {
        let (x, ..) = motion.at(t).expect("it moves").of(REST[0]);
        assert!((x - REST[0] - velocity.position() * travelled).length() < 1e-14, "at {t} s");
    }
}

#[test]
fn a_third_of_a_turn_about_the_diagonal_permutes_the_axes() {
    let third = std::f64::consts::TAU / 3.0;
    let center = DVec3::new(0.2, -0.3, 0.9);
    let (point, axis) = (Point::space(center.x, center.y, center.z), Some(Point::space(2.0, 2.0, 2.0)));
    let rotation = Motion::Rotation { center: point, axis, rate: third };
    let (x, v, _) = rotation.at(1.0).expect("it moves").of(center + DVec3::new(1.0, 2.0, 3.0));
    // Counter-clockwise about (1, 1, 1): x to y, y to z, z to x.
    let arm = DVec3::new(3.0, 1.0, 2.0);
    assert!((x - center - arm).length() < 1e-14, "{x}");
    assert!((v - third / 3.0_f64.sqrt() * DVec3::ONE.cross(arm)).length() < 1e-14, "{v}");
}

#[test]
fn a_table_goes_exactly_through_its_rows() {
    let center = DVec3::new(0.2, 0.1, 0.0);
    let motion = Motion::Table { center: Point::plane(0.2, 0.1), axis: None, rows: rows(2) };
    let of = |t: f64, rest: DVec3| motion.at(t).expect("it moves").of(rest);
    for row in rows(2) {
        for rest in REST {
            let ((sin, cos), arm) = (row.angle.sin_cos(), rest - center);
            let turned = DVec3::new(arm.x * cos - arm.y * sin, arm.x * sin + arm.y * cos, arm.z);
            let exact = center + turned + row.displacement.position();
            assert!((of(row.time, rest).0 - exact).length() < 1e-14, "at {} s: {}", row.time, of(row.time, rest).0);
            // Two cubics meet without a jump of the position or of the velocity.
            let ((x0, v0, _), (x1, v1, _)) = (of(row.time - 1e-9, rest), of(row.time + 1e-9, rest));
            assert!((x0 - x1).length() < 1e-7 && (v0 - v1).length() < 1e-6, "at {} s: {v0}, {v1}", row.time);
        }
    }
    for (outside, row) in [(0.0, 0), (99.0, 4)] {
        let ((x, v, a), (end, ..)) = (of(outside, REST[1]), of(rows(2)[row].time, REST[1]));
        assert_eq!((x, v, a), (end, DVec3::ZERO, DVec3::ZERO), "at {outside} s the body rests");
    }
}

#[test]
fn particles_of_walls_and_structures_move_as_their_bodies() {
    let motion = Motion::Rotation { center: Point::plane(0.5, 0.25), axis: None, rate: 0.5 };
    let table = "Table(center: (0.5, 0.3), rows: [
        (time: 0.0, displacement: (0.0, 0.0)), (time: 0.02, displacement: (0.02, 0.0), angle: 0.3)])";
    let text =
        tank(2).replace(r#""tank": ("#, r#""tank": (motion: Rotation(center: (0.5, 0.25), rate: 0.5), "#).replace(
            "walls:",
            &format!(
                r#"structures: {{ "disc": (shape: Circle(center: (0.5, 0.3), radius: 0.1), motion: {table}) }}, walls:"#
            ),
        );
    let mut app = app(&text, &[]);
    let world = app.world_mut();
    advance(world, 20);
    let t = world.resource::<Clock>().time;
    let row = |time, x, angle| TableRow { time, displacement: Point::plane(x, 0.0), angle };
    let table = Motion::Table {
        center: Point::plane(0.5, 0.3),
        axis: None,
        rows: vec![row(0.0, 0.0, 0.0), row(0.02, 0.02, 0.3)],
    };
    type Moved = (&'static RestPosition, &'static Position, &'static WallVelocity, &'static WallAcceleration);
    let walls: Vec<_> = world.query_filtered::<Moved, With<Wall>>().iter(world).map(owned).collect();
    let solids: Vec<_> = world.query_filtered::<Moved, With<Solid>>().iter(world).map(owned).collect();
    for (motion, particles) in [(motion, walls), (table, solids)] {
        let body = motion.at(t).expect("it moves");
        assert!(particles.len() > 10 && particles.iter().any(|[rest, x, ..]| rest.distance(*x) > 1e-4));
        for [rest, x, v, a] in particles {
            assert_eq!((x, v, a), body.of(rest));
        }
    }
}

fn owned((rest, x, v, a): (&RestPosition, &Position, &WallVelocity, &WallAcceleration)) -> [DVec3; 4] {
    [rest.0, x.0, v.0, a.0]
}
