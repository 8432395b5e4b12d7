//! Weight of the fluid that a structure displaces.

use bevy_ecs::prelude::*;
use glam::DVec3;

use crate::boundary::{Body, BodyShape, Structure};
use crate::physics::{EquationOfState, Gravity};
use crate::scene::geometry::{Point, Shape, coordinates, lattice};
use crate::scene::{Column, FilledFluids, Invalid, Resolution, unknown, vertical};

/// Name, shape, and what is reported, of the structure that the field `structure` names.
pub(super) fn structure(world: &mut World, name: &str) -> Result<(Shape, Structure), Invalid> {
    let mut query = world.query::<(&Body, &BodyShape, &Structure)>();
    let found = query.iter(world).find(|(body, ..)| body.name == name);
    if let Some((_, shape, structure)) = found {
        return Ok((shape.shape.clone(), *structure));
    }
    let mut known: Vec<&str> = query.iter(world).map(|(body, ..)| body.name.as_str()).collect();
    known.sort_unstable();
    Err(unknown("structure", "structure", name, known))
}

/// The column of fluid at rest on the vertical through `x` (m), and the unit vector upwards.
pub(super) fn column(world: &World, x: DVec3) -> Result<(Column, DVec3), Invalid> {
    let gravity = world.resource::<Gravity>().full;
    if vertical(gravity).is_none() {
        return Err(Invalid::new("", "this needs a gravity along an axis"));
    }
    let chi = world.resource::<EquationOfState>().background_pressure;
    let column = world.resource::<FilledFluids>().column(x, gravity, world.resource::<Resolution>().spacing, chi);
    if column.layers.is_empty() {
        return Err(Invalid::new("", format!("no fluid lies on the vertical through {x} m")));
    }
    Ok((column, -gravity.normalize()))
}

/// Cells along the longest side of a shape into which it is cut: enough for 0.01 % of a circle or a ball.
const CELLS: [f64; 2] = [600.0, 150.0];

/// Buoyancy `∫ ρ0 |g| dV` over a structure (N; N/m in 2D where it has no length), as a component along the axis of
/// gravity: Archimedes' law in the layers of the start, of which those above the surface weigh nothing.
pub(super) fn buoyancy(world: &mut World, name: &str, beside: Option<Point>) -> Result<f64, Invalid> {
    let resolution = *world.resource::<Resolution>();
    let (shape, structure) = structure(world, name)?;
    let x = match beside {
        Some(point) => coordinates(point, resolution.dimension).map(|()| point.position())?,
        None => left_end(world),
    };
    let (column, up) = column(world, x).map_err(|invalid| invalid.under("beside"))?;
    let top = column.layers.first().map_or(0.0, |layer| layer.top);
    let (low, high) = shape.bounds();
    let cell = (high - low).max_element() / CELLS[resolution.dimension - 2];
    let (mut weight, mut volume) = (0.0, 0.0);
    for point in lattice(&shape, resolution.dimension, cell, low, 0.0) {
        let height = point.position.dot(up);
        let pressure = |height: f64| column.incompressible(height.min(top));
        let cell_volume = cell.powi(resolution.dimension as i32);
        weight += (pressure(height - 0.5 * cell) - pressure(height + 0.5 * cell)) / cell * cell_volume;
        volume += cell_volume;
    }
    let exactness = shape.measure(resolution.dimension).map_or(1.0, |exact| exact / volume);
    Ok(up.element_sum() * weight * exactness * structure.length)
}

/// A place (m) half a spacing inside the left end of the fluids of the start.
fn left_end(world: &World) -> DVec3 {
    let fluids = &world.resource::<FilledFluids>().fluids;
    let bounds = fluids.iter().map(|(shape, _)| shape.bounds());
    let (low, high) = bounds.min_by(|a, b| a.0.x.total_cmp(&b.0.x)).unwrap_or_default();
    let inside = 0.5 * world.resource::<Resolution>().spacing;
    DVec3::new(low.x + inside, 0.5 * (low.y + high.y), 0.5 * (low.z + high.z))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::probes::test_support::{TANK, opened, scene};

    /// The tank of two layers, the interface at 0.2 m, with a disc of radius 0.06 m at `height`.
    fn tank(height: f64, more: &str) -> String {
        let disc = format!("\"disc\": (shape: Circle(center: (0.2, {height}), radius: 0.06){more}),");
        scene(&TANK.replace("structures: {", &format!("structures: {{{disc}")), "")
    }

    fn buoyancy_of_disc(scene: &str) -> f64 {
        let mut app = opened(scene);
        buoyancy(app.0.world_mut(), "disc", None).unwrap_or(f64::NAN)
    }

    #[test]
    fn buoyancy_is_the_weight_of_each_layer_displaced() {
        let area = PI * 0.06 * 0.06;
        let half = (1000.0 + 1200.0) / 2.0;
        for (height, density, tolerance) in [(0.1, 1200.0, 1e-9), (0.3, 1000.0, 1e-9), (0.2, half, 1e-4)] {
            let buoyancy = buoyancy_of_disc(&tank(height, ""));
            assert!((buoyancy / (density * 9.81 * area) - 1.0).abs() < tolerance, "{height}: {buoyancy}");
        }
    }

    #[test]
    fn what_is_out_of_the_water_displaces_nothing() {
        let buoyancy = buoyancy_of_disc(&tank(0.4, ", length: 2.0"));
        assert!((buoyancy / (1000.0 * 9.81 * PI * 0.06 * 0.06) - 1.0).abs() < 1e-3, "{buoyancy}");
    }
}
