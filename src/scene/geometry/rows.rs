//! Ghost particles in rows along the sides of a polygon.
//!
//! Each layer is a row on the polygon moved sideways by (k + ½) spacings, corners mitred. Sides that vanish on the way
//! (in a bay narrower than twice the offset) drop out; what still comes too near to another side is left out.

use std::collections::HashMap;

use glam::DVec2;

use super::{Point, Side, polygon};

/// Corners that turn by more than this are points of the rows; along gentler ones the row runs on evenly.
const SHARP_TURN: f64 = std::f64::consts::FRAC_PI_6;

/// Mitres at corners that turn by more than this would reach further than twice the offset: they are cut off square.
const LONGEST_MITRE_TURN: f64 = 2.0 * std::f64::consts::FRAC_PI_3;

/// Ghosts nearer than this many spacings to an earlier one are left out.
const LEAST_GAP: f64 = 0.6;

/// One side of the polygon, walked with the ghosts on the right.
#[derive(Clone, Copy)]
struct Wall {
    start: DVec2,
    direction: DVec2,
}

impl Wall {
    /// Unit vector towards the ghosts.
    fn normal(self) -> DVec2 {
        -self.direction.perp()
    }

    /// Signed angle from this wall's direction to the next one's; positive where the ghosts fan out.
    fn turn_to(self, next: Self) -> f64 {
        self.direction.perp_dot(next.direction).atan2(self.direction.dot(next.direction))
    }

    /// Where this wall and the next one meet once both have moved by `offset`, if that is within `reach` of the
    /// next one's moved start; otherwise (walls in one line) that start.
    fn meeting(self, next: Self, offset: f64, reach: f64) -> DVec2 {
        let (own, other) = (self.normal(), next.normal());
        let sine = own.perp_dot(other);
        let own_offset = offset + own.dot(self.start - next.start);
        let towards = DVec2::new(own_offset * other.y - offset * own.y, offset * own.x - own_offset * other.x) / sine;
        let relative = if sine.abs() > 1e-9 && towards.length() <= reach { towards } else { offset * other };
        next.start + relative
    }
}

/// Ghost particles `layers` deep on one side of a polygon, layer by layer from the wall; metres.
///
/// No ghost is nearer to the polygon than 0.99 of its layer's distance, on the wrong side, or nearer than 0.6 spacings
/// to another.
pub(super) fn rows(corners: &[Point], side: Side, layers: usize, spacing: f64) -> Vec<DVec2> {
    let mut walls = walls(corners, side);
    let reach = polygon::perimeter(corners) + 4.0 * layers as f64 * spacing;
    let mut thinning = Thinning::new(LEAST_GAP * spacing);
    for layer in 0..layers {
        let offset = (layer as f64 + 0.5) * spacing;
        let vertices = drop_vanished(&mut walls, offset, reach, spacing);
        for place in row(&walls, &vertices, spacing) {
            if side.depth(polygon::signed_distance(corners, place)) >= 0.99 * offset {
                thinning.add(place);
            }
        }
    }
    thinning.kept
}

/// The sides of the polygon, with a side of no length added at each corner too acute for a mitre.
fn walls(corners: &[Point], side: Side) -> Vec<Wall> {
    let mut corners = corners.to_vec();
    if (polygon::signed_area(&corners) > 0.0) != (side == Side::Outside) {
        corners.reverse();
    }
    let plain: Vec<Wall> = polygon::sides(&corners)
        .map(|(start, end)| Wall { start, direction: (end - start).normalize_or_zero() })
        .collect();
    let mut walls = Vec::with_capacity(plain.len());
    for (number, &wall) in plain.iter().enumerate() {
        let previous = plain[(number + plain.len() - 1) % plain.len()];
        if previous.turn_to(wall) > LONGEST_MITRE_TURN {
            let direction = (previous.direction + wall.direction).normalize_or(wall.normal());
            walls.push(Wall { start: wall.start, direction });
        }
        walls.push(wall);
    }
    walls
}

/// Takes away the walls that have no length left when all are moved by `offset`, the shortest first, and returns the
/// moved starts of those that remain.
fn drop_vanished(walls: &mut Vec<Wall>, offset: f64, reach: f64, spacing: f64) -> Vec<DVec2> {
    loop {
        let count = walls.len();
        if count < 3 {
            walls.clear();
            return Vec::new();
        }
        let vertices: Vec<DVec2> =
            (0..count).map(|i| walls[(i + count - 1) % count].meeting(walls[i], offset, reach)).collect();
        let length = |i: usize| walls[i].direction.dot(vertices[(i + 1) % count] - vertices[i]);
        match (0..count).min_by(|&a, &b| length(a).total_cmp(&length(b))) {
            Some(shortest) if length(shortest) < -1e-9 * spacing => walls.remove(shortest),
            _ => return vertices,
        };
    }
}

/// One row: the stretches between sharp corners, each in equal steps, every corner once.
fn row(walls: &[Wall], vertices: &[DVec2], spacing: f64) -> Vec<DVec2> {
    let count = walls.len();
    let sharp: Vec<usize> =
        (0..count).filter(|&i| walls[(i + count - 1) % count].turn_to(walls[i]).abs() > SHARP_TURN).collect();
    // A row without sharp corners is one closed stretch that may start anywhere.
    let starts = if sharp.is_empty() && count > 0 { vec![0] } else { sharp };
    let mut places = Vec::new();
    for (number, &start) in starts.iter().enumerate() {
        let end = starts.get(number + 1).map_or(starts[0] + count, |&next| next);
        let stretch: Vec<DVec2> = (start..=end).map(|i| vertices[i % count]).collect();
        places.extend(equal_steps(&stretch, spacing));
    }
    places
}

/// Points along an open line in `round(length/spacing)`, but at least one, equal steps, without the last point; none on a line
/// whose length is beyond all numbers.
fn equal_steps(line: &[DVec2], spacing: f64) -> Vec<DVec2> {
    let length: f64 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    if !length.is_finite() {
        return Vec::new();
    }
    let count = (length / spacing).round().max(1.0);
    let mut places = Vec::with_capacity(count as usize);
    let mut passed = 0.0;
    for pair in line.windows(2) {
        let piece = pair[0].distance(pair[1]);
        // Half a millionth of a step of slack, so that rounding does not push a place beyond the last piece.
        while (places.len() as f64) < count && places.len() as f64 * length / count <= passed + piece * (1.0 + 5e-7) {
            let within = places.len() as f64 * length / count - passed;
            places.push(pair[0].lerp(pair[1], if piece > 0.0 { within / piece } else { 0.0 }));
        }
        passed += piece;
    }
    places
}

/// Keeps points that are far enough from those kept before.
pub(super) struct Thinning {
    gap: f64,
    /// Cells with a diagonal of one gap, so that each holds one kept point at most.
    cells: HashMap<(i64, i64), DVec2>,
    /// The points kept, in the order in which they were added.
    pub(super) kept: Vec<DVec2>,
}

impl Thinning {
    /// Keeps points at least `gap` metres apart.
    pub(super) fn new(gap: f64) -> Self {
        Self { gap, cells: HashMap::new(), kept: Vec::new() }
    }

    /// Keeps the point unless an earlier one is nearer than the gap.
    pub(super) fn add(&mut self, place: DVec2) {
        let cell = (place / (self.gap * std::f64::consts::FRAC_1_SQRT_2)).floor();
        let (column, line) = (cell.x as i64, cell.y as i64);
        let near = |i: i64, j: i64| self.cells.get(&(i, j)).is_some_and(|kept| kept.distance(place) < self.gap);
        if (column - 2..=column + 2).any(|i| (line - 2..=line + 2).any(|j| near(i, j))) {
            return;
        }
        self.cells.insert((column, line), place);
        self.kept.push(place);
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{L_SHAPE, SLOPE_TANK, corners};
    use super::*;

    fn nearest(places: &[DVec2], point: DVec2) -> f64 {
        places.iter().map(|place| place.distance(point)).fold(f64::INFINITY, f64::min)
    }

    /// Rows must keep apart, stay on their side and leave no hole between the wall and their full depth.
    fn assert_sound(outline: &[(f64, f64)], side: Side, spacing: f64, widest_hole: f64) {
        let polygon = corners(outline);
        let places = rows(&polygon, side, 4, spacing);
        for (i, a) in places.iter().enumerate() {
            assert!(side.depth(polygon::signed_distance(&polygon, *a)) >= 0.495 * spacing, "{a}");
            assert!(places.iter().skip(i + 1).all(|b| a.distance(*b) >= 0.5999 * spacing), "{a}");
        }
        let low = polygon.iter().fold(DVec2::INFINITY, |low, corner| low.min(corner.xy())) - 4.0 * spacing;
        let high = polygon.iter().fold(DVec2::NEG_INFINITY, |high, corner| high.max(corner.xy())) + 4.0 * spacing;
        let probe = spacing / 3.0;
        let probes = ((high - low) / probe).ceil();
        for i in 0..probes.x as usize {
            for j in 0..probes.y as usize {
                let point = low + probe * DVec2::new(i as f64, j as f64);
                let depth = side.depth(polygon::signed_distance(&polygon, point)) / spacing;
                if (0.3..=3.7).contains(&depth) {
                    let hole = nearest(&places, point) / spacing;
                    assert!(hole < widest_hole, "{outline:?} {side:?}: {point} is {hole} spacings from any ghost");
                }
            }
        }
    }

    #[test]
    fn at_a_spacing_beyond_all_numbers_nothing_fits() {
        assert!(rows(&corners(&SLOPE_TANK), Side::Outside, 3, 1e300).is_empty());
    }

    #[test]
    fn tanks_are_lined_without_holes() {
        for side in [Side::Outside, Side::Inside] {
            assert_sound(&SLOPE_TANK, side, 0.05, 1.0);
            assert_sound(&L_SHAPE, side, 0.05, 0.7072);
            assert_sound(&L_SHAPE, side, 0.061, 1.0);
        }
    }

    #[test]
    fn awkward_outlines_are_lined_without_holes() {
        let bays = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (2.0, 0.4), (1.6, 0.4), (1.4, 0.95), (1.2, 0.3), (0.0, 1.3)];
        assert_sound(&bays, Side::Outside, 0.04, 1.0);
        let wedge = [(0.0, 0.0), (2.0, 0.0), (0.0, 0.8)];
        assert_sound(&wedge, Side::Outside, 0.05, 1.0);
        let slit = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.1, 1.0), (1.1, 0.2), (0.93, 0.2), (0.93, 1.0), (0.0, 1.0)];
        assert_sound(&slit, Side::Outside, 0.04, 1.0);
    }

    #[test]
    fn finely_drawn_curves_are_as_even_as_circles() {
        let outline: Vec<(f64, f64)> =
            (0..500).map(|i| (f64::from(i) * std::f64::consts::TAU / 500.0).sin_cos()).collect();
        for (side, sign) in [(Side::Outside, 1.0), (Side::Inside, -1.0)] {
            let places = rows(&corners(&outline), side, 4, 0.05);
            for layer in 0..4 {
                let radius = 1.0 + sign * (f64::from(layer) + 0.5) * 0.05;
                let found = places.iter().filter(|place| (place.length() - radius).abs() < 1e-3).count();
                assert_eq!(found, (std::f64::consts::TAU * radius / 0.05).round() as usize);
            }
            assert_sound(&outline, side, 0.05, 0.8);
        }
    }

    #[test]
    fn acute_mitres_are_cut_off() {
        let needle = corners(&[(0.0, -0.1), (4.0, 0.0), (0.0, 0.1)]);
        let furthest = rows(&needle, Side::Outside, 4, 0.05).iter().map(|place| place.x).fold(0.0, f64::max);
        assert!((furthest - 4.175).abs() < 1e-12, "{furthest}");
    }
}
