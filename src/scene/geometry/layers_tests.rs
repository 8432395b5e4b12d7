//! Ghost layers against lattices, densities and distances worked out independently.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use super::super::test_support::{L_SHAPE, SLOPE_TANK, corners};
use super::*;

/// Lattice cells of the ghosts; every ghost must sit on a centre, each centre once.
fn cells(ghosts: &[DVec3], spacing: f64, plane: bool) -> BTreeSet<[i64; 3]> {
    let mut found = BTreeSet::new();
    for ghost in ghosts {
        let cell = (*ghost / spacing).floor();
        let centre = (cell + 0.5) * spacing;
        let centre = if plane { centre.truncate().extend(0.0) } else { centre };
        assert!(ghost.distance(centre) < 1e-12, "{ghost} is off the lattice");
        assert!(found.insert([cell.x as i64, cell.y as i64, cell.z as i64]), "{ghost} is there twice");
    }
    found
}

/// Cells of the frame between two boxes of cells.
fn rim(outer: std::ops::Range<i64>, inner: &std::ops::Range<i64>, plane: bool) -> BTreeSet<[i64; 3]> {
    let zs = if plane { 0..1 } else { outer.clone() };
    let hollow = |cell: &[i64; 3]| cell.iter().take(if plane { 2 } else { 3 }).all(|i| inner.contains(i));
    let xs = outer.clone();
    let columns = xs.flat_map(|i| outer.clone().map(move |j| (i, j)));
    columns.flat_map(|(i, j)| zs.clone().map(move |k| [i, j, k])).filter(|cell| !hollow(cell)).collect()
}

fn unit_square() -> (Shape, Shape) {
    let as_box = Shape::Box { min: Point::plane(0.0, 0.0), max: Point::plane(1.0, 1.0) };
    (as_box, Shape::Polygon(corners(&[(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)])))
}

#[test]
fn square_continues_the_lattice_as_box_and_as_polygon() {
    let (as_box, as_polygon) = unit_square();
    for shape in [as_box, as_polygon] {
        let outside = ghost_layers(&shape, Side::Outside, 4, 0.1, 2, None);
        assert_eq!(cells(&outside, 0.1, true), rim(-4..14, &(0..10), true));
        let inside = ghost_layers(&shape, Side::Inside, 3, 0.1, 2, None);
        assert_eq!(cells(&inside, 0.1, true), rim(0..10, &(3..7), true));
        let solid = ghost_layers(&shape, Side::Inside, 5, 0.1, 2, None);
        assert_eq!(cells(&solid, 0.1, true).len(), 100);
    }
}

#[test]
fn cube_continues_the_lattice_as_box_and_as_prism() {
    let as_box = Shape::Box { min: Point::space(0.0, 0.0, 0.0), max: Point::space(1.0, 1.0, 1.0) };
    let outline = corners(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
    for shape in [as_box, Shape::Prism { polygon: outline, z: (0.0, 1.0) }] {
        let outside = ghost_layers(&shape, Side::Outside, 3, 0.1, 3, None);
        assert_eq!(cells(&outside, 0.1, false), rim(-3..13, &(0..10), false));
        let inside = ghost_layers(&shape, Side::Inside, 3, 0.1, 3, None);
        assert_eq!(cells(&inside, 0.1, false), rim(0..10, &(3..7), false));
    }
}

#[test]
fn reflex_corner_on_the_lattice_stays_on_the_lattice() {
    let outline = Shape::Polygon(corners(&L_SHAPE));
    let ghosts = ghost_layers(&outline, Side::Outside, 4, 0.1, 2, None);
    // The frame of the 2 m square, with the notch of 10 x 10 cells lined by 4 cells along its two sides.
    let mut expected = rim(-4..24, &(0..20), true);
    expected.retain(|&[i, j, _]| i < 14 || j < 14);
    expected.extend((10..24).flat_map(|i| (10..24).map(move |j| [i, j, 0])).filter(|&[i, j, _]| i < 14 || j < 14));
    assert_eq!(cells(&ghosts, 0.1, true), expected);
}

/// Wendland's quintic in the plane with support radius `reach`, in 1/m².
fn kernel(distance: f64, reach: f64) -> f64 {
    let q = 2.0 * distance / reach;
    7.0 / (PI * reach * reach) * (1.0 - 0.5 * q).max(0.0).powi(4) * (2.0 * q + 1.0)
}

/// Integral of the kernel round a point over what lies outside the shape, sampled 8 times as finely as the ghosts.
fn kernel_outside(shape: &Shape, point: DVec2, reach: f64, spacing: f64) -> f64 {
    let step = spacing / 8.0;
    let steps = (reach / step).ceil() as i32;
    let samples = (-steps..steps).flat_map(|i| (-steps..steps).map(move |j| (i, j)));
    let offsets = samples.map(|(i, j)| step * (DVec2::new(f64::from(i), f64::from(j)) + 0.5));
    let outside = offsets.filter(|offset| !shape.contains((point + *offset).extend(0.0)));
    outside.map(|offset| kernel(offset.length(), reach) * step * step).sum()
}

#[test]
fn walls_and_corners_complete_the_kernel() {
    let (spacing, reach) = (0.02, 3.6 * 0.02);
    for outline in [SLOPE_TANK, L_SHAPE] {
        let polygon = Shape::Polygon(corners(&outline));
        let ghosts = ghost_layers(&polygon, Side::Outside, 4, spacing, 2, None);
        for (number, &(x, y)) in outline.iter().enumerate() {
            let (start, end) = (DVec2::new(x, y), DVec2::from(outline[(number + 1) % outline.len()]));
            let length = start.distance(end);
            // Every tenth of a spacing next to the corner, then along the wall.
            for place in (0..60).map(|i| 0.002 * f64::from(i)).chain((1..20).map(|i| 0.0513 * f64::from(i) * length)) {
                let point = start.lerp(end, place / length);
                let near = ghosts.iter().map(|ghost| kernel(ghost.truncate().distance(point), reach));
                let found = near.sum::<f64>() * spacing * spacing;
                let expected = kernel_outside(&polygon, point, reach, spacing);
                assert!((found - expected).abs() < 0.03, "{point}: {found}, not {expected}");
            }
        }
    }
}

#[test]
fn circle_gets_rings() {
    let shape = Shape::Circle { center: Point::plane(1.0, 2.0), radius: 0.5 };
    for (side, radii) in [(Side::Outside, [0.525, 0.575]), (Side::Inside, [0.475, 0.425])] {
        let ghosts = ghost_layers(&shape, side, 2, 0.05, 2, None);
        for radius in radii {
            let on_ring = |ghost: &&DVec3| (ghost.distance(DVec3::new(1.0, 2.0, 0.0)) - radius).abs() < 1e-12;
            assert_eq!(ghosts.iter().filter(on_ring).count(), (TAU * radius / 0.05).round() as usize);
        }
    }
    let pin = Shape::Circle { center: Point::plane(0.0, 0.0), radius: 0.1 };
    assert_eq!(ghost_layers(&pin, Side::Inside, 4, 0.05, 2, None).len(), 9 + 3);
}

/// The ghosts of a solid shape fill the shell behind its surface at one per cell.
#[test]
fn round_walls_have_the_density_of_the_lattice() {
    let (center, spacing, layers) = (Point::space(0.3, 0.2, 0.1), 0.05, 4);
    let depth = 4.0 * spacing;
    let ball = |radius: f64| 4.0 / 3.0 * PI * radius.powi(3);
    let drum = |radius: f64, length: f64| PI * radius * radius * length;
    let (radius, length) = (0.6, 1.0);
    let sphere = Shape::Sphere { center, radius };
    let cylinder = Shape::Cylinder { center, axis: Axis::Y, radius, length };
    let grown = drum(radius + depth, length + 2.0 * depth) - drum(radius, length);
    let shrunk = drum(radius, length) - drum(radius - depth, length - 2.0 * depth);
    for (shape, side, volume) in [
        (&sphere, Side::Outside, ball(radius + depth) - ball(radius)),
        (&sphere, Side::Inside, ball(radius) - ball(radius - depth)),
        (&cylinder, Side::Outside, grown),
        (&cylinder, Side::Inside, shrunk),
    ] {
        let ghosts = ghost_layers(shape, side, layers, spacing, 3, None);
        let expected = volume / spacing.powi(3);
        assert!((ghosts.len() as f64 / expected - 1.0).abs() < 0.01, "{shape:?} {side:?}: {} {expected}", ghosts.len());
        assert!(ghosts.iter().all(|ghost| side.depth(shape.signed_distance(*ghost)) > 0.49 * spacing));
    }
}

#[test]
fn prism_with_a_slope_has_even_caps() {
    let spacing = 0.06;
    let prism = Shape::Prism { polygon: corners(&SLOPE_TANK), z: (0.0, 0.3) };
    let ghosts = ghost_layers(&prism, Side::Outside, 2, spacing, 3, None);
    let cap: Vec<_> = ghosts.iter().filter(|ghost| (ghost.z + 0.5 * spacing).abs() < 1e-12).collect();
    let section = Shape::Polygon(corners(&SLOPE_TANK));
    let within = cap.iter().filter(|ghost| section.contains(***ghost)).count() as f64;
    assert!((within * spacing * spacing / 5.375 - 1.0).abs() < 0.02, "{within}");
    for i in 0..200 {
        let point = DVec3::new(f64::from(i) * 0.02, 1.75, -0.5 * spacing);
        assert!(cap.iter().any(|ghost| ghost.distance(point) < 0.9 * spacing), "{point}");
    }
}

#[test]
fn combined_shapes_are_lined_on_the_lattice() {
    let (square, _) = unit_square();
    let step = Shape::Box { min: Point::plane(1.0, 0.0), max: Point::plane(2.0, 0.5) };
    let union = Shape::Union(vec![square.clone(), step.clone()]);
    let ghosts = ghost_layers(&union, Side::Outside, 1, 0.1, 2, None);
    // Along 6 m of outline, none over the outer corners (0.7 spacings off, within one layer: 5 of them), one saved
    // in the inner corner.
    assert_eq!(cells(&ghosts, 0.1, true).len(), 60 + 5 - 1);
    let notch = Shape::Difference { of: Box::new(square), minus: vec![step] };
    assert_eq!(ghost_layers(&notch, Side::Inside, 1, 0.1, 2, None).len(), 36);
}

#[test]
fn cut_opens_the_top() {
    let (tank, _) = unit_square();
    let lid = Shape::Box { min: Point::plane(-1.0, 1.0), max: Point::plane(2.0, 2.0) };
    let ghosts = ghost_layers(&tank, Side::Outside, 4, 0.1, 2, Some(&lid));
    let mut expected = rim(-4..14, &(0..10), true);
    expected.retain(|&[_, j, _]| j < 10);
    assert_eq!(cells(&ghosts, 0.1, true), expected);
}
