//! A wave at the start: the flow of one linear mode of an interface or of a free surface.
//!
//! With ζ the height above the level of the interface at rest, h₁ and h₂ the depths below and above it,
//! k = 2π/wavelength, the mode of amplitude A is (Lamb 1932, §§228, 231)
//!
//! `below: (−A sin kx cosh k(ζ + h₁), A cos kx sinh k(ζ + h₁))/sinh kh₁`,
//! `above: (A sin kx cosh k(h₂ − ζ), A cos kx sinh k(h₂ − ζ))/sinh kh₂`,
//!
//! x counted from a crest. It has no divergence, is level with floor and lid, and with vertical walls at its crests and
//! troughs. A is a displacement of the particles, a velocity, or both.

use bevy_ecs::prelude::*;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::geometry::{Axis, axis_exists};
use super::{Invalid, Resolution, SceneSection, SectionError, vertical};
use crate::number::{plain, short};
use crate::particles::{Fluid, Position, Velocity};
use crate::physics::Gravity;

/// What moves the fluids at the start besides their velocities: section `disturbance` of a scene. Pressures stay those of the
/// undisturbed layers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Disturbance {
    /// Nothing.
    #[default]
    Off,
    /// A standing wave of one length.
    Mode(WaveMode),
}

/// A linear standing wave at the start. Heights count along −g from the origin.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WaveMode {
    /// Horizontal axis along which it varies.
    pub along: Axis,
    /// Coordinate (m) of a crest on that axis.
    #[schemars(extend("unit" = "m"))]
    pub crest: f64,
    /// Wavelength (m).
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub wavelength: f64,
    /// Height (m) of the interface, or of the free surface, at rest.
    #[schemars(extend("unit" = "m"))]
    pub level: f64,
    /// Depth h₁ (m) of the fluid below it, down to the floor.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub below: f64,
    /// Depth h₂ (m) of the fluid above it, up to the lid; `None` where it is a free surface.
    #[serde(default)]
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0, "derived" = "a free surface"))]
    pub above: Option<f64>,
    /// Amplitude (m) of the displacement: height of the crest. Less than tanh(k h)/k, at which the fluid would fold over.
    #[serde(default)]
    #[schemars(extend("unit" = "m"))]
    pub displacement: f64,
    /// Amplitude (m/s) of the velocity: upwards at the crest.
    #[serde(default)]
    #[schemars(extend("unit" = "m/s"))]
    pub velocity: f64,
}

impl SceneSection for Disturbance {
    const NAME: &'static str = "disturbance";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn check(&self, world: &World) -> Result<(), Invalid> {
        let Self::Mode(mode) = self else { return Ok(()) };
        axis_exists(mode.along, world.resource::<Resolution>().dimension).map_err(|wrong| wrong.under("along"))?;
        for (name, length) in
            [("wavelength", Some(mode.wavelength)), ("below", Some(mode.below)), ("above", mode.above)]
        {
            if let Some(length) = length.filter(|length| *length <= 0.0) {
                return Err(Invalid::new(name, format!("must be greater than 0, got {length} m")));
            }
        }
        let greatest = mode.greatest_displacement();
        if mode.displacement.abs() >= greatest {
            let message = format!(
                "a crest of {} m would fold the fluid over: at this wavelength and depth it must be less than {} m",
                plain(mode.displacement),
                short(greatest)
            );
            return Err(Invalid::new("displacement", message));
        }
        match vertical(world.resource::<Gravity>().full) {
            Some((axis, _)) if axis == mode.along.index() => {
                Err(Invalid::new("along", "a wave runs across gravity, not along it"))
            }
            Some(_) => Ok(()),
            None => Err(Invalid::new("", "a wave needs a gravity along an axis")),
        }
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let Self::Mode(mode) = self else { return Ok(()) };
        let Some(vertical) = vertical(world.resource::<Gravity>().full) else { return Ok(()) };
        let mut fluid = world.query_filtered::<(&mut Position, &mut Velocity), With<Fluid>>();
        for (mut x, mut v) in fluid.iter_mut(world) {
            let shape = mode.shape(x.0, vertical);
            x.0 += mode.displacement * shape;
            v.0 += mode.velocity * shape;
        }
        Ok(())
    }
}

impl WaveMode {
    /// Amplitude A (m) of the displacement at which neighbours meet: horizontally they approach by up to A k coth(k h), h the lesser depth.
    fn greatest_displacement(&self) -> f64 {
        let k = std::f64::consts::TAU / self.wavelength;
        (k * self.above.map_or(self.below, |above| above.min(self.below))).tanh() / k
    }

    /// The mode of amplitude 1 at the place `x` (m); gravity acts along `axis`, which points up if `up` is 1.
    fn shape(&self, x: DVec3, (axis, up): (usize, f64)) -> DVec3 {
        let k = std::f64::consts::TAU / self.wavelength;
        let (sin, cos) = (k * (x[self.along.index()] - self.crest)).sin_cos();
        let zeta = up * x[axis] - self.level;
        // Depth of the layer, height above its floor or below its lid, and the sense of its horizontal flow.
        let (depth, from_boundary, sense) = match self.above {
            Some(above) if zeta > 0.0 => (above, above - zeta, 1.0),
            _ => (self.below, self.below + zeta, -1.0),
        };
        let mut shape = DVec3::ZERO;
        shape[self.along.index()] = sense * sin * (k * from_boundary).cosh() / (k * depth).sinh();
        shape[axis] = up * cos * (k * from_boundary).sinh() / (k * depth).sinh();
        shape
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODE: WaveMode = WaveMode {
        along: Axis::X,
        crest: 0.1,
        wavelength: 0.8,
        level: 0.3,
        below: 0.3,
        above: Some(0.2),
        displacement: 0.01,
        velocity: 0.0,
    };

    fn shape(mode: &WaveMode, x: f64, y: f64) -> DVec3 {
        mode.shape(DVec3::new(x, y, 0.0), (1, 1.0))
    }

    #[test]
    fn a_mode_has_neither_divergence_nor_vorticity() {
        let d = 1e-5;
        for (x, y) in [(0.17, 0.12), (0.33, 0.29), (0.05, 0.31), (0.6, 0.45)] {
            let dx = (shape(&MODE, x + d, y) - shape(&MODE, x - d, y)) / (2.0 * d);
            let dy = (shape(&MODE, x, y + d) - shape(&MODE, x, y - d)) / (2.0 * d);
            assert!((dx.x + dy.y).abs() < 1e-6, "divergence {} 1/s at ({x}, {y})", dx.x + dy.y);
            assert!((dx.y - dy.x).abs() < 1e-6, "vorticity {} 1/s at ({x}, {y})", dx.y - dy.x);
        }
    }

    #[test]
    fn the_greatest_displacement_is_where_columns_of_fluid_meet() {
        let steepest = |mode: &WaveMode, amplitude: f64| {
            // How far apart neighbours come to be, by how far they were: least next to the interface.
            let gap = |x: f64, y: f64| 1.0 + amplitude * (shape(mode, x + 1e-6, y).x - shape(mode, x, y).x) / 1e-6;
            (0..200)
                .flat_map(|i| [0.0, 0.3, 0.3 + 1e-9, 0.5].map(|y| gap(0.004 * f64::from(i), y)))
                .fold(f64::INFINITY, f64::min)
        };
        let greatest = MODE.greatest_displacement();
        assert!(steepest(&MODE, 0.98 * greatest) > 0.0 && steepest(&MODE, 1.02 * greatest) < 0.0);
    }

    #[test]
    fn it_is_level_with_floor_lid_and_walls_and_one_at_the_crest() {
        for x in [0.0, 0.2, 0.37] {
            assert_eq!(shape(&MODE, x, 0.0).y, 0.0);
            assert!(shape(&MODE, x, 0.5).y.abs() < 1e-12);
        }
        for y in [0.1, 0.4] {
            // A crest and the trough beside it.
            assert!(shape(&MODE, 0.1, y).x.abs() < 1e-12 && shape(&MODE, 0.5, y).x.abs() < 1e-12);
        }
        let [from_below, from_above] = [-1e-9, 1e-9].map(|dz| shape(&MODE, 0.1, 0.3 + dz).y);
        assert!((from_below - 1.0).abs() < 1e-7 && (from_above - 1.0).abs() < 1e-7);
    }
}
