//! Frames: the particles of each kind as clouds of points.

use bevy_ecs::prelude::*;
use bytemuck::TransparentWrapper;

use super::plugin::{Log, LogFailure};
use super::{Column, LogError, LogWriter, ParticleFields, PointsId};
use crate::boundary::{Body, Motion, Structure};
use crate::clock::Clock;
use crate::particles::{
    BodyIndex, Density, Fluid, ParticleId, PhaseIndex, Position, Pressure, ShearRate, Solid, Velocity, Viscosity, Wall,
    WallVelocity, Workspace, columns,
};

type FluidState = (
    &'static Position,
    &'static Velocity,
    &'static Density,
    &'static Pressure,
    &'static Viscosity,
    &'static ShearRate,
    &'static PhaseIndex,
    &'static ParticleId,
);
type FluidColumns<'a> = (
    &'a [Position],
    &'a [Velocity],
    &'a [Density],
    &'a [Pressure],
    &'a [Viscosity],
    &'a [ShearRate],
    &'a [PhaseIndex],
    &'a [ParticleId],
);

/// Writes the fluid, in the order in which it lies in memory.
pub(super) fn write_particles(
    mut log: ResMut<Log>,
    mut failure: ResMut<LogFailure>,
    clock: Res<Clock>,
    more: Res<ParticleFields>,
    mut workspace: ResMut<Workspace>,
    fluid: Query<FluidState, With<Fluid>>,
) {
    let (position, velocity, density, pressure, viscosity, shear_rate, phase, id): FluidColumns<'_> = columns(&fluid);
    let phase: Vec<_> = phase.iter().map(|phase| byte(phase.0)).collect();
    let own = [
        Column::Vector(Position::peel_slice(position)),
        Column::Vector(Velocity::peel_slice(velocity)),
        Column::Scalar(Density::peel_slice(density)),
        Column::Scalar(Pressure::peel_slice(pressure)),
        Column::Scalar(Viscosity::peel_slice(viscosity)),
        Column::Scalar(ShearRate::peel_slice(shear_rate)),
        Column::U8(&phase),
        Column::U32(ParticleId::peel_slice(id)),
    ];
    let columns: Vec<_> = own.into_iter().chain(more.values().iter().map(|values| Column::Scalar(values))).collect();
    let channel = log.particles;
    failure.note(log.writer.write_points(channel, clock.time, &columns, &mut workspace));
}

type BodyState = (&'static Position, &'static WallVelocity, &'static Pressure, &'static BodyIndex);
type BodyColumns<'a> = (&'a [Position], &'a [WallVelocity], &'a [Pressure], &'a [BodyIndex]);

/// Writes walls and structures: with the first frame, and with every frame if one of them moves.
pub(super) fn write_bodies(
    mut log: ResMut<Log>,
    mut failure: ResMut<LogFailure>,
    clock: Res<Clock>,
    mut workspace: ResMut<Workspace>,
    bodies: Query<(&Motion, Has<Structure>), With<Body>>,
    walls: Query<BodyState, With<Wall>>,
    structures: Query<BodyState, With<Solid>>,
) {
    let log = &mut *log;
    let is_first = log.last_frame.is_none();
    let due =
        |structure: bool| is_first || bodies.iter().any(|(motion, is)| is == structure && *motion != Motion::Still);
    if let Some(channel) = log.walls.filter(|_| due(false)) {
        failure.note(write_cloud(&mut log.writer, channel, clock.time, columns(&walls), &mut workspace));
    }
    if let Some(channel) = log.structures.filter(|_| due(true)) {
        failure.note(write_cloud(&mut log.writer, channel, clock.time, columns(&structures), &mut workspace));
    }
    log.last_frame = Some(clock.time);
}

fn write_cloud(
    writer: &mut LogWriter,
    channel: PointsId,
    time: f64,
    (position, velocity, pressure, body): BodyColumns<'_>,
    workspace: &mut Workspace,
) -> Result<(), LogError> {
    let body: Vec<_> = body.iter().map(|body| byte(body.0)).collect();
    // Particles of bodies keep their rows: the row is their number.
    let id: Vec<_> = (0..).take(body.len()).collect();
    let columns = [
        Column::Vector(Position::peel_slice(position)),
        Column::Vector(WallVelocity::peel_slice(velocity)),
        Column::Scalar(Pressure::peel_slice(pressure)),
        Column::U8(&body),
        Column::U32(&id),
    ];
    writer.write_points(channel, time, &columns, workspace)
}

/// The number of a phase or body in a byte; those beyond share the last.
fn byte(index: u32) -> u8 {
    u8::try_from(index).unwrap_or(u8::MAX)
}
