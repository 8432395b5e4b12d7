//! Ghost particles: the layers behind the surface of a wall.

use glam::{DVec2, DVec3};

use super::axis::{AxisPlace, walled};
use super::rings::{fitted_rings, ring, shell};
use super::rows::{Thinning, rows};
use super::{Axis, Point, Shape, lattice};

/// On which side of a shape's surface the ghost particles lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The fluid is inside the shape (a container), the ghosts lie outside.
    Outside,
    /// The shape is a solid obstacle, the ghosts lie inside it.
    Inside,
}

impl Side {
    /// Distance behind the surface in metres, from a signed distance (negative inside the shape).
    pub(super) fn depth(self, signed_distance: f64) -> f64 {
        match self {
            Self::Outside => signed_distance,
            Self::Inside => -signed_distance,
        }
    }
}

/// Ghost particles `layers` deep behind the surface of a shape, about `spacing` (metres) apart; positions in metres.
///
/// Layer k = 0, 1, … lies (k + ½) spacings off the surface, so that the ghosts of a box whose sides are multiples of
/// the spacing continue the lattice of the fluid; corners are filled. Polygons get rows, circles rings, spheres shells;
/// prisms and cylinders get those in slices along their axis, and caps at their ends. For `Union` and `Difference` the
/// ghosts are the centres of a lattice through the origin whose (bounded) distance is at most `layers` spacings.
///
/// `dimension` is 2 or 3. Ghosts inside `cut` are left out: open tops, doors.
#[must_use]
pub fn ghost_layers(
    shape: &Shape,
    side: Side,
    layers: usize,
    spacing: f64,
    dimension: usize,
    cut: Option<&Shape>,
) -> Vec<DVec3> {
    let wall = Lining { side, layers, spacing };
    let mut ghosts = match shape {
        Shape::Box { min, max } => wall.of_box(min.position(), max.position(), dimension),
        Shape::Polygon(corners) => flat(rows(corners, side, layers, spacing)),
        Shape::Circle { center, radius } => {
            flat(wall.rings(*radius)).into_iter().map(|offset| center.position() + offset).collect()
        }
        Shape::Cylinder { center, axis, radius, length } => {
            wall.of_cylinder(*axis, *radius, *length).into_iter().map(|offset| center.position() + offset).collect()
        }
        Shape::Sphere { center, radius } => {
            let shells = wall.radii(*radius).into_iter().flat_map(|radius| shell(radius, spacing));
            shells.map(|offset| center.position() + offset).collect()
        }
        Shape::Prism { polygon, z } => wall.of_prism(polygon, *z),
        Shape::Union(_) | Shape::Difference { .. } => wall.of_lattice(shape, dimension),
    };
    if let Some(cut) = cut {
        ghosts.retain(|ghost| !cut.contains(*ghost));
    }
    ghosts
}

/// How a surface is lined with ghosts.
#[derive(Clone, Copy)]
struct Lining {
    side: Side,
    layers: usize,
    spacing: f64,
}

impl Lining {
    fn of_box(self, min: DVec3, max: DVec3, dimension: usize) -> Vec<DVec3> {
        let places = |axis: usize| walled(min[axis], max[axis], self.side, self.layers, self.spacing);
        let zs = if dimension == 2 { vec![AxisPlace { at: 0.0, ghost: false }] } else { places(2) };
        let (xs, ys) = (places(0), places(1));
        let mut ghosts = Vec::new();
        for x in &xs {
            for y in &ys {
                let behind = zs.iter().filter(|z| x.ghost || y.ghost || z.ghost);
                ghosts.extend(behind.map(|z| DVec3::new(x.at, y.at, z.at)));
            }
        }
        ghosts
    }

    /// Radii of the layers behind a round wall of the given radius, from the wall on.
    fn radii(self, radius: f64) -> Vec<f64> {
        let offsets = (0..self.layers).map(|layer| (layer as f64 + 0.5) * self.spacing);
        match self.side {
            Side::Outside => offsets.map(|offset| radius + offset).collect(),
            // No layer lies beyond the centre; one on it may be off by the rounding.
            Side::Inside => offsets.map(|offset| radius - offset).take_while(|left| *left >= -1e-9 * radius).collect(),
        }
    }

    fn rings(self, radius: f64) -> Vec<DVec2> {
        self.radii(radius).into_iter().flat_map(|radius| ring(radius, self.spacing)).collect()
    }

    fn of_cylinder(self, axis: Axis, radius: f64, length: f64) -> Vec<DVec3> {
        let mantle = self.rings(radius);
        let mut cap = match self.side {
            Side::Outside => mantle.clone(),
            Side::Inside => Vec::new(),
        };
        cap.extend(self.disc(radius));
        let mut ghosts = Vec::new();
        for place in walled(-0.5 * length, 0.5 * length, self.side, self.layers, self.spacing) {
            let slice = if place.ghost { &cap } else { &mantle };
            ghosts.extend(slice.iter().map(|offset| axis.compose(offset.to_array(), place.at)));
        }
        ghosts
    }

    /// A full disc for the cap of a cylinder.
    fn disc(self, radius: f64) -> Vec<DVec2> {
        match self.side {
            // Rings of their own thickness, so that the cap is even up to its rim.
            Side::Outside => {
                let (inner_radii, thickness) = fitted_rings(radius, self.spacing);
                inner_radii.into_iter().flat_map(|inner| ring(inner + 0.5 * thickness, thickness)).collect()
            }
            // The rings of the mantle, carried on to the axis.
            Side::Inside => Self { layers: (radius / self.spacing).ceil() as usize, ..self }.rings(radius),
        }
    }

    fn of_prism(self, corners: &[Point], (from, to): (f64, f64)) -> Vec<DVec3> {
        let mantle = rows(corners, self.side, self.layers, self.spacing);
        let cap = self.cap(corners, &mantle);
        let mut ghosts = Vec::new();
        for place in walled(from, to, self.side, self.layers, self.spacing) {
            let slice = if place.ghost { &cap } else { &mantle };
            ghosts.extend(slice.iter().map(|offset| offset.extend(place.at)));
        }
        ghosts
    }

    /// The mantle's rows and the whole cross-section of a prism: rows next to its outline, a lattice further in.
    fn cap(self, corners: &[Point], mantle: &[DVec2]) -> Vec<DVec2> {
        let mut places = Thinning::new(0.6 * self.spacing);
        mantle.iter().for_each(|place| places.add(*place));
        let rows_inside = match self.side {
            Side::Outside => 1,
            Side::Inside => self.layers,
        };
        rows(corners, Side::Inside, rows_inside, self.spacing).into_iter().for_each(|place| places.add(place));
        let section = Shape::Polygon(corners.to_vec());
        let (low, _) = section.bounds();
        // The rows stand for the outermost whole spacings; a tenth more keeps the lattice off the last of them.
        let clearance = (rows_inside as f64 + 0.1) * self.spacing;
        for centre in lattice(&section, 2, self.spacing, low, clearance) {
            places.add(centre.position.truncate());
        }
        places.kept
    }

    fn of_lattice(self, shape: &Shape, dimension: usize) -> Vec<DVec3> {
        let rounding = 1e-9 * self.spacing;
        let deepest = self.layers as f64 * self.spacing + rounding;
        let clearance = match self.side {
            Side::Outside => -deepest,
            Side::Inside => rounding,
        };
        lattice(shape, dimension, self.spacing, DVec3::ZERO, clearance)
            .into_iter()
            .map(|point| point.position)
            .filter(|position| {
                let depth = self.side.depth(shape.signed_distance(*position));
                depth > rounding && depth <= deepest
            })
            .collect()
    }
}

fn flat(places: Vec<DVec2>) -> Vec<DVec3> {
    places.into_iter().map(|place| place.extend(0.0)).collect()
}

#[cfg(test)]
#[path = "layers_tests.rs"]
mod tests;
