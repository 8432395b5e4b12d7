//! Parameters that several probes share.

use bevy_ecs::prelude::*;
use glam::DVec3;

use crate::boundary::Motion;
use crate::neighbours::PeriodicSides;
use crate::particles::ReferenceDensity;
use crate::phases::{Phase, phase_named};
use crate::physics::Gravity;
use crate::rheology::{Bingham, HerschelBulkley, Newtonian, PowerLaw};
use crate::scene::geometry::{Axis, Point, axis_exists, coordinates};
use crate::scene::{FilledFluids, Invalid, Resolution};

/// Position (m) of the field `name`.
pub(super) fn place(world: &World, name: &str, point: Point) -> Result<DVec3, Invalid> {
    coordinates(point, world.resource::<Resolution>().dimension).map_err(|invalid| invalid.under(name))?;
    Ok(point.position())
}

/// Refuses the axes of the fields `along` and `across` if the scene does not have them, or they are the same.
pub(super) fn plane(world: &World, along: Axis, across: Axis) -> Result<(), Invalid> {
    let dimension = world.resource::<Resolution>().dimension;
    axis_exists(along, dimension).map_err(|wrong| wrong.under("along"))?;
    axis_exists(across, dimension).map_err(|wrong| wrong.under("across"))?;
    if along == across {
        return Err(Invalid::new("across", "must be another axis than that of the flow"));
    }
    Ok(())
}

/// Refuses the position `x` (m) of the field `name` if it lies outside the box around fluids and bodies, but for `free`, an axis
/// along which it does not matter. Where bodies move, the box moves too and nothing is refused.
pub(super) fn inside(world: &mut World, name: &str, x: DVec3, free: DVec3) -> Result<(), Invalid> {
    let still = world.query::<&Motion>().iter(world).all(|motion| *motion == Motion::Still);
    let (mut low, mut high) = world.resource::<FilledFluids>().bounds();
    // Between periodic sides fluid comes everywhere.
    for (axis, sides) in world.resource::<PeriodicSides>().0.into_iter().enumerate() {
        if let Some((from, to)) = sides {
            (low[axis], high[axis]) = (low[axis].min(from), high[axis].max(to));
        }
    }
    let Resolution { spacing, dimension, .. } = *world.resource::<Resolution>();
    let outside = (0..dimension)
        .find(|&axis| free[axis] == 0.0 && !(low[axis] - spacing..=high[axis] + spacing).contains(&x[axis]));
    match outside.filter(|_| still) {
        Some(axis) => {
            let (letter, from, to) = (["x", "y", "z"][axis], low[axis], high[axis]);
            let message = format!("lies outside the scene, which reaches from {letter} = {from} m to {to} m");
            Err(Invalid::new(name, message))
        }
        None => Ok(()),
    }
}

/// Refuses the field `name`, a shape in the box `(low, high)` (m), if it lies outside the box around fluids and bodies altogether,
/// where nothing is ever measured. Where bodies move, the box moves too and nothing is refused.
///
/// # Errors
/// The shape lies outside.
pub fn box_inside(world: &mut World, name: &str, (low, high): (DVec3, DVec3)) -> Result<(), Invalid> {
    let (from, _) = world.resource::<FilledFluids>().bounds();
    // Where the boxes meet, this place lies in both.
    inside(world, name, low.max(from).min(high), DVec3::ZERO)
}

/// Unit vector of the field `direction`.
pub(super) fn direction(world: &World, point: Point) -> Result<DVec3, Invalid> {
    place(world, "direction", point)?
        .try_normalize()
        .ok_or_else(|| Invalid::new("direction", "must not be the null vector"))
}

/// Index of the phase that the field `phase` names.
pub(super) fn phase(world: &mut World, name: &str) -> Result<u32, Invalid> {
    phase_named(world, "phase", name).map(|(phase, _)| phase.index)
}

/// Unit vector against gravity.
pub(super) fn up(world: &World) -> Result<DVec3, Invalid> {
    let against = -world.resource::<Gravity>().full;
    against.try_normalize().ok_or_else(|| Invalid::new("", "a height needs a gravity that is not zero"))
}

/// Herschel–Bulkley's law `τ = τ_y + η γ̇^K` of a phase, for exact flows.
pub(super) struct FlowLaw {
    /// Reference density ρ0 (kg/m³).
    pub reference_density: f64,
    /// Consistency η (Pa s^K).
    pub consistency: f64,
    /// Exponent K (dimensionless).
    pub exponent: f64,
    /// Yield stress τ_y (Pa).
    pub yield_stress: f64,
}

/// The law of the phase with this index, whose rheology must be Herschel–Bulkley or a special case of it.
pub(super) fn flow_law(world: &mut World, index: u32) -> Result<FlowLaw, Invalid> {
    let mut phases = world.query::<(
        &Phase,
        &ReferenceDensity,
        (Option<&HerschelBulkley>, Option<&Newtonian>, Option<&Bingham>, Option<&PowerLaw>),
    )>();
    let Some((_, rho0, models)) = phases.iter(world).find(|(phase, ..)| phase.index == index) else {
        return Err(Invalid::new("phase", "has no rheology"));
    };
    let (consistency, exponent, yield_stress) = match models {
        (Some(fluid), ..) => (fluid.consistency, fluid.exponent, fluid.yield_stress),
        (_, Some(fluid), ..) => (fluid.viscosity, 1.0, 0.0),
        (_, _, Some(fluid), _) => (fluid.plastic_viscosity, 1.0, fluid.yield_stress),
        (.., Some(fluid)) => (fluid.consistency, fluid.exponent, 0.0),
        _ => {
            let message = "its rheology must be Newtonian, HerschelBulkley, Bingham or PowerLaw: \
                 the exact flow of others is not known here";
            return Err(Invalid::new("phase", message));
        }
    };
    if consistency <= 0.0 {
        return Err(Invalid::new("phase", "a fluid without viscosity has no steady flow"));
    }
    Ok(FlowLaw { reference_density: rho0.0, consistency, exponent, yield_stress })
}
