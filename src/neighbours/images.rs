//! Periodic sides: images of the particles near one side, beyond the other.
//!
//! Images are rows like any other, so that no pair loop has to know about periodicity. They are chosen when neighbour
//! lists are built and follow their source until the next build; only then are particles that left through one side
//! put back in at the other.

use bevy_ecs::prelude::*;
use glam::DVec3;

use super::clear_with_room;

/// A periodic image: row `source`, moved by `shift`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Image {
    /// Row of the particle that this is an image of.
    pub source: u32,
    /// Displacement of the image (m): a whole number of periods along each periodic axis.
    pub shift: DVec3,
}

/// The axes along which the scene repeats itself, with the two sides (m) that are one and the same.
#[derive(Resource, Debug, Clone, Copy, Default, PartialEq)]
pub struct PeriodicSides(pub [Option<(f64, f64)>; 3]);

impl PeriodicSides {
    /// `position` moved by whole periods until it lies between the sides.
    #[must_use]
    pub fn wrap(&self, position: DVec3) -> DVec3 {
        let mut wrapped = position.to_array();
        for (x, sides) in wrapped.iter_mut().zip(self.0) {
            if let Some((from, to)) = sides {
                let period = to - from;
                *x -= period * ((*x - from) / period).floor();
                // Rounding can leave x at `to` itself, which is the same place as `from`.
                if *x >= to {
                    *x = from;
                }
            }
        }
        DVec3::from_array(wrapped)
    }

    /// The images of `position` beyond every periodic side, one period away along one axis or more.
    pub fn images_of(&self, position: DVec3) -> impl Iterator<Item = DVec3> {
        let sides = self.0;
        let shifts = move |axis: usize| {
            let period = sides[axis].map_or(0.0, |(from, to)| to - from);
            [0.0, -period, period].into_iter().take(if period > 0.0 { 3 } else { 1 })
        };
        let shifts =
            shifts(0).flat_map(move |x| shifts(1).flat_map(move |y| shifts(2).map(move |z| DVec3::new(x, y, z))));
        shifts.filter(|shift| *shift != DVec3::ZERO).map(move |shift| position + shift)
    }

    /// Whether the scene repeats itself along any axis.
    #[must_use]
    pub fn any(&self) -> bool {
        self.0.iter().any(Option::is_some)
    }

    /// Whether `position` lies between the sides of every periodic axis.
    #[must_use]
    pub fn contains(&self, position: DVec3) -> bool {
        position.to_array().iter().zip(self.0).all(|(x, sides)| sides.is_none_or(|(from, to)| (from..to).contains(x)))
    }

    /// The shortest of the vectors from `b` to `a` through any side.
    #[must_use]
    pub fn separation(&self, a: DVec3, b: DVec3) -> DVec3 {
        let mut r = (a - b).to_array();
        for (x, sides) in r.iter_mut().zip(self.0) {
            if let Some((from, to)) = sides {
                let period = to - from;
                *x -= period * (*x / period).round();
            }
        }
        DVec3::from_array(r)
    }
}

/// Appends to `positions` an image of every row nearer than `reach(row)` (m) to a periodic side, and to `images` where it
/// comes from. Axis by axis, so that edges and corners get the images of images.
pub(super) fn add_images(
    sides: &PeriodicSides,
    reach: impl Fn(usize) -> f64,
    positions: &mut Vec<DVec3>,
    images: &mut Vec<Image>,
) {
    clear_with_room(images);
    let owned = positions.len();
    for (axis, sides) in sides.0.iter().enumerate() {
        let Some((from, to)) = *sides else { continue };
        let mut period = DVec3::ZERO;
        period[axis] = to - from;
        for row in 0..positions.len() {
            let source = if row < owned { row } else { images[row - owned].source as usize };
            let (x, reach) = (positions[row][axis], reach(source));
            for (near, shift) in [(x < from + reach, period), (x >= to - reach, -period)] {
                if near {
                    let earlier = if row < owned { DVec3::ZERO } else { images[row - owned].shift };
                    images.push(Image { source: source as u32, shift: earlier + shift });
                    positions.push(positions[row] + shift);
                }
            }
        }
    }
}
