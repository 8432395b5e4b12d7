//! Frames: the particles of each kind as clouds of points.

use bevy_ecs::prelude::*;

use super::plugin::{Log, LogFailure};
use super::{Column, LogError, LogWriter, ParticleFields, PointsId};
use crate::boundary::{Body, Motion, Structure};
use crate::clock::Clock;
use crate::particles::{
    BodyIndex, Density, Fluid, ParticleId, PhaseIndex, Position, Pressure, ShearRate, Solid, Velocity, Viscosity, Wall,
    WallVelocity,
};

type FluidColumns = (
    &'static Position,
    &'static Velocity,
    &'static Density,
    &'static Pressure,
    &'static Viscosity,
    &'static ShearRate,
    &'static PhaseIndex,
    &'static ParticleId,
);

/// Writes the fluid, in the order in which it lies in memory.
pub(super) fn write_particles(
    mut log: ResMut<Log>,
    mut failure: ResMut<LogFailure>,
    clock: Res<Clock>,
    more: Res<ParticleFields>,
    fluid: Query<FluidColumns, With<Fluid>>,
) {
    let scalar = |of: fn(<FluidColumns as bevy_ecs::query::QueryData>::Item<'_, '_>) -> f64| -> Vec<f64> {
        fluid.iter().map(of).collect()
    };
    let positions: Vec<_> = fluid.iter().map(|row| row.0.0).collect();
    let velocities: Vec<_> = fluid.iter().map(|row| row.1.0).collect();
    let (density, pressure) = (scalar(|row| row.2.0), scalar(|row| row.3.0));
    let (viscosity, shear_rate) = (scalar(|row| row.4.0), scalar(|row| row.5.0));
    let phase: Vec<_> = fluid.iter().map(|row| byte(row.6.0)).collect();
    let id: Vec<_> = fluid.iter().map(|row| row.7.0).collect();
    let own = [
        Column::Vector(&positions),
        Column::Vector(&velocities),
        Column::Scalar(&density),
        Column::Scalar(&pressure),
        Column::Scalar(&viscosity),
        Column::Scalar(&shear_rate),
        Column::U8(&phase),
        Column::U32(&id),
    ];
    let columns: Vec<_> = own.into_iter().chain(more.values().iter().map(|values| Column::Scalar(values))).collect();
    let channel = log.particles;
    failure.note(log.writer.write_points(channel, clock.time, &columns));
}

type BodyColumns = (&'static Position, &'static WallVelocity, &'static Pressure, &'static BodyIndex);

/// Writes walls and structures: with the first frame, and with every frame if one of them moves.
pub(super) fn write_bodies(
    mut log: ResMut<Log>,
    mut failure: ResMut<LogFailure>,
    clock: Res<Clock>,
    bodies: Query<(&Motion, Has<Structure>), With<Body>>,
    walls: Query<BodyColumns, With<Wall>>,
    structures: Query<BodyColumns, With<Solid>>,
) {
    let log = &mut *log;
    let is_first = log.last_frame.is_none();
    let due =
        |structure: bool| is_first || bodies.iter().any(|(motion, is)| is == structure && *motion != Motion::Still);
    if let Some(channel) = log.walls.filter(|_| due(false)) {
        failure.note(write_cloud(&mut log.writer, channel, clock.time, walls.iter()));
    }
    if let Some(channel) = log.structures.filter(|_| due(true)) {
        failure.note(write_cloud(&mut log.writer, channel, clock.time, structures.iter()));
    }
    log.last_frame = Some(clock.time);
}

fn write_cloud<'a>(
    writer: &mut LogWriter,
    channel: PointsId,
    time: f64,
    rows: impl Iterator<Item = (&'a Position, &'a WallVelocity, &'a Pressure, &'a BodyIndex)> + Clone,
) -> Result<(), LogError> {
    let positions: Vec<_> = rows.clone().map(|row| row.0.0).collect();
    let velocities: Vec<_> = rows.clone().map(|row| row.1.0).collect();
    let pressure: Vec<_> = rows.clone().map(|row| row.2.0).collect();
    let body: Vec<_> = rows.map(|row| byte(row.3.0)).collect();
    // Particles of bodies keep their rows: the row is their number.
    let id: Vec<_> = (0..).take(body.len()).collect();
    let columns = [
        Column::Vector(&positions),
        Column::Vector(&velocities),
        Column::Scalar(&pressure),
        Column::U8(&body),
        Column::U32(&id),
    ];
    writer.write_points(channel, time, &columns)
}

/// The number of a phase or body in a byte; those beyond share the last.
fn byte(index: u32) -> u8 {
    u8::try_from(index).unwrap_or(u8::MAX)
}
