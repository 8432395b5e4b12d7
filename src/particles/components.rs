//! The state: one component a quantity, named by its physics term. SI units.
//!
//! A column of `TransparentWrapper`s is one of the numbers in them: the log takes it as it lies.

use bevy_ecs::prelude::*;
use bytemuck::TransparentWrapper;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Marks a fluid particle.
#[derive(Component, Debug, Clone, Copy, Default)]
#[require(
    ParticleId,
    PhaseIndex,
    Position,
    Velocity,
    Acceleration,
    Mass,
    ReferenceDensity,
    Density,
    DensityRate,
    Pressure,
    Viscosity,
    ShearRate
)]
pub struct Fluid;

/// Marks a ghost particle of a wall.
#[derive(Component, Debug, Clone, Copy, Default)]
#[require(Ghost)]
pub struct Wall;

/// Marks a solid particle of a structure, whose load is reported.
#[derive(Component, Debug, Clone, Copy, Default)]
#[require(Ghost, ForceOnParticle)]
pub struct Solid;

/// What wall and structure particles have in common: they carry a fluid state extrapolated from the fluid beside
/// them (Eqs. 15, 16) and move as their body prescribes.
#[derive(Component, Debug, Clone, Copy, Default)]
#[require(
    BodyIndex,
    Slip,
    Position,
    RestPosition,
    PeriodShift,
    WallVelocity,
    WallAcceleration,
    WallAngularVelocity,
    GhostVelocity,
    Volume,
    Density,
    Pressure
)]
pub struct Ghost;

/// By how much (m) a ghost was put elsewhere when it left through a periodic side: whole periods, which its body did not
/// go.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PeriodShift(pub DVec3);

/// Identity of a fluid particle. Rows are re-sorted in memory now and then; this number stays.
#[derive(
    Component, Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, TransparentWrapper,
)]
#[repr(transparent)]
pub struct ParticleId(pub u32);

/// Which phase a fluid particle belongs to: the index of a [`Phase`](crate::phases::Phase).
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PhaseIndex(pub u32);

/// Which wall or structure a ghost particle belongs to: index of a body in the order of the scene, counted apart for
/// walls and for structures.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BodyIndex(pub u32);

/// Position x (m). In 2D z = 0.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, TransparentWrapper)]
#[repr(transparent)]
pub struct Position(pub DVec3);

/// Velocity v (m/s).
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, TransparentWrapper)]
#[repr(transparent)]
pub struct Velocity(pub DVec3);

/// Acceleration dv/dt (m/s²) of Eq. 6.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Acceleration(pub DVec3);

/// Mass m (kg; per metre of out-of-plane length in 2D).
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Mass(pub f64);

/// Reference density ρ0 (kg/m³) of the particle's phase.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ReferenceDensity(pub f64);

/// Density ρ (kg/m³).
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, TransparentWrapper)]
#[repr(transparent)]
pub struct Density(pub f64);

/// Rate of change of density dρ/dt (kg/m³/s) of Eq. 5, diffusion included.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct DensityRate(pub f64);

/// Pressure p (Pa).
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, TransparentWrapper)]
#[repr(transparent)]
pub struct Pressure(pub f64);

/// Dynamic viscosity μ (Pa s).
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, TransparentWrapper)]
#[repr(transparent)]
pub struct Viscosity(pub f64);

/// Shear rate γ̇ (1/s) of Eq. 14.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, TransparentWrapper)]
#[repr(transparent)]
pub struct ShearRate(pub f64);

/// Position (m) of a ghost particle before its body moved.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct RestPosition(pub DVec3);

/// Velocity v_w (m/s) with which a ghost particle moves with its body.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, TransparentWrapper)]
#[repr(transparent)]
pub struct WallVelocity(pub DVec3);

/// Acceleration a_w (m/s²) with which a ghost particle moves with its body.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct WallAcceleration(pub DVec3);

/// Angular velocity ω_w (rad/s) with which the body of a ghost particle turns.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct WallAngularVelocity(pub DVec3);

/// Velocity v_b (m/s) that the fluid feels in ∇v and in the viscous force (Eq. 16).
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct GhostVelocity(pub DVec3);

/// Volume V (m³; m² in 2D) that a ghost particle fills: dp^d, or its part of a round body.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq)]
pub struct Volume(pub f64);

/// Whether the fluid sticks to a wall or slides along it.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Slip {
    /// The fluid sticks: at the wall its velocity is the wall's.
    #[default]
    NoSlip,
    /// No viscous force from the wall, and the wall does not enter ∇v.
    FreeSlip,
}

/// Force of the fluid on one solid particle (N; N/m in 2D), Eqs. 17 and 18.
#[derive(Component, Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ForceOnParticle {
    /// Part from the pressure.
    pub pressure: DVec3,
    /// Part from the viscous stress.
    pub viscous: DVec3,
}
