//! μ(I), the friction of dense granular flow (Jop, Forterre & Pouliquen 2006, Nature 441, 727–730).
//!
//! `τ = μ(I) p′`,  `μ(I) = μ_s + (μ_2 − μ_s)/(I_0/I + 1)`,  inertial number `I = γ̇ d/√(p′/ρ_s)`
//!
//! p′ is the pressure between the grains. As a viscosity, with the time t = d √(ρ_s/p′) in which a grain is pushed into
//! a gap (I = t γ̇),
//!
//! `μ = μ_s p′/γ̇ + (μ_2 − μ_s) p′ t/(I_0 + t γ̇)`
//!
//! whose first term is a yield stress, [regularised](Regularisation) by name and capped: `μ ← min(μ, μ_max)`.
//!
//! # Which pressure
//!
//! The simulated pressure p is that of the mixture, grains and water together. The grains carry the rest of it beside the
//! pore water, `p′ = max(p − χ − p_w, p_floor)`, and the scene has to say what the pore pressure p_w is:
//!
//! - `Dry`: p_w = 0, for grains in air. Grains under water would be as strong as if the water above pressed on them.
//! - `Hydrostatic`: `p_w = ρ_w g z`, z the depth below a still water level. What is left is the weight of the grains less
//!   their buoyancy, and whatever excess pressure the flow makes counts as carried by the grains: they drain at
//!   once. Pore pressures that build up in fast slides of fine soil are not modelled; waves above do not count. While
//!   the ground shakes, g is what acts along the gravity of the scene: up and down counts, along the ground does not.
//!
//! # Near free surfaces
//!
//! p′, and the viscosity with it, vanishes towards a free surface. The harmonic mean of Eq. 12 then passes on too little
//! stress: the uppermost layers, as many as a kernel reaches, flow too fast, the more the nearer τ/p′ comes to μ_2, and
//! without a steady state close to it. Below them the flow is right.
//!
//! The floor keeps the law finite at free surfaces and where the pressure is negative. The phase's density is that of the
//! mixture. Grains so fine that the water between them holds them up follow a viscous number instead of I, which is
//! another law.

use bevy_ecs::prelude::*;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use storegga::particles::{Fluid, GRAIN, PIECE, PhaseIndex, Position, Pressure, ShearRate, Viscosity};
use storegga::phases::Phase;
use storegga::physics::{EquationOfState, Gravity};
use storegga::rheology::{Bound, Regularisation, Rheology, check_bounds, check_order, models_by_phase};
use storegga::scene::Invalid;

/// Granular flow: friction `τ = μ(I) p′`, `μ(I) = μ_s + (μ_2 − μ_s)/(I_0/I + 1)`, `I = γ̇ d/√(p′/ρ_s)` (Jop, Forterre &
/// Pouliquen 2006), regularised at rest. The pressure between the grains is `p′ = p − χ − p_w`, less that of the pore water, and
/// no less than a floor.
#[derive(Component, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MuI {
    /// Friction coefficient μ_s (dimensionless) of grains about to move: the tangent of the angle of repose.
    #[schemars(range(min = 0.0), extend("unit" = "1"))]
    pub static_friction: f64,
    /// Friction coefficient μ_2 (dimensionless) that fast flow tends to.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub limiting_friction: f64,
    /// Inertial number I_0 (dimensionless) at which the friction is half way between the two.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = 0.0))]
    pub inertial_number: f64,
    /// Diameter d (m) of the grains.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub grain_diameter: f64,
    /// Density ρ_s (kg/m³) of the grains themselves.
    #[schemars(extend("unit" = "kg/m³", "exclusiveMinimum" = 0.0))]
    pub grain_density: f64,
    /// What the pressure of the pore water is.
    pub pore_pressure: PorePressure,
    /// Least pressure p_floor (Pa) between the grains.
    #[schemars(extend("unit" = "Pa", "exclusiveMinimum" = 0.0))]
    pub pressure_floor: f64,
    /// Cap μ_max (Pa s) of the viscosity; it enters the time step (Eq. 19).
    #[schemars(extend("unit" = "Pa s", "exclusiveMinimum" = 0.0))]
    pub max_viscosity: f64,
    /// How the friction at rest is regularised.
    #[serde(default)]
    pub regularisation: Regularisation,
}

/// Pressure p_w of the water between the grains.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum PorePressure {
    /// None: grains in air. Under water they would be too strong, as if the water above pressed on them.
    Dry,
    /// `p_w = ρ_w g z` below a still water level, none above it: grains weigh what their buoyancy leaves, and drain at
    /// once. Excess pore pressure is not modelled.
    Hydrostatic {
        /// Density ρ_w (kg/m³) of the water.
        #[schemars(extend("unit" = "kg/m³", "exclusiveMinimum" = 0.0))]
        density: f64,
        /// Height (m) of the water level, along −g from the origin.
        #[schemars(extend("unit" = "m"))]
        level: f64,
    },
}

impl PorePressure {
    /// p_w (Pa) at a height (m) along −g, under a gravity (m/s²).
    #[must_use]
    pub fn at(self, height: f64, gravity: f64) -> f64 {
        match self {
            Self::Dry => 0.0,
            Self::Hydrostatic { density, level } => density * gravity * (level - height).max(0.0),
        }
    }
}

impl MuI {
    /// Dynamic viscosity μ (Pa s) at shear rate γ̇ (1/s) and pressure p′ (Pa) between the grains, which counts as p_floor if
    /// it is less.
    #[inline]
    #[must_use]
    pub fn viscosity(&self, shear_rate: f64, grain_pressure: f64) -> f64 {
        let p = grain_pressure.max(self.pressure_floor);
        let t = self.grain_diameter * (self.grain_density / p).sqrt();
        let friction = self.regularisation.yield_viscosity(self.static_friction * p, shear_rate);
        let further = self.limiting_friction - self.static_friction;
        (friction + further * p * t / (self.inertial_number + t * shear_rate)).min(self.max_viscosity)
    }
}

impl Rheology for MuI {
    fn check(&self) -> Result<(), Invalid> {
        check_bounds(&[
            ("static_friction", self.static_friction, Bound::NotNegative, ""),
            ("limiting_friction", self.limiting_friction, Bound::Positive, ""),
            ("inertial_number", self.inertial_number, Bound::Positive, ""),
            ("grain_diameter", self.grain_diameter, Bound::Positive, "m"),
            ("grain_density", self.grain_density, Bound::Positive, "kg/m³"),
            ("pressure_floor", self.pressure_floor, Bound::Positive, "Pa"),
            ("max_viscosity", self.max_viscosity, Bound::Positive, "Pa s"),
        ])?;
        if let PorePressure::Hydrostatic { density, .. } = self.pore_pressure {
            check_bounds(&[("pore_pressure.density", density, Bound::Positive, "kg/m³")])?;
        }
        let limiting = ("limiting_friction", self.limiting_friction);
        check_order(("static_friction", self.static_friction), limiting, "")?;
        self.regularisation.check()
    }

    /// The cap: friction grows with the pressure, which has no bound of its own.
    fn greatest_viscosity(&self) -> f64 {
        self.max_viscosity
    }
}

type Columns = (&'static PhaseIndex, &'static Position, &'static ShearRate, &'static Pressure, &'static mut Viscosity);

/// Writes the viscosity of the particles of every granular phase.
pub(crate) fn rub(
    mut models: Local<Vec<Option<MuI>>>,
    state: Res<EquationOfState>,
    gravity: Res<Gravity>,
    phases: Query<(&Phase, Option<&MuI>)>,
    mut fluid: Query<Columns, With<Fluid>>,
) -> Result {
    let models = models_by_phase(&mut models, &phases);
    // Shaking along the ground leaves the weight of the pore water as it is.
    let up = -gravity.full.normalize_or_zero();
    let g = -gravity.now.dot(up);
    for (phase, x, shear_rate, pressure, mut viscosity) in fluid.contiguous_iter_mut()? {
        (phase, x, shear_rate, pressure, viscosity.bypass_change_detection())
            .into_par_iter()
            .with_min_len(GRAIN)
            .with_max_len(PIECE)
            .for_each(|(phase, x, shear_rate, pressure, viscosity)| {
                if let Some(model) = &models[phase.0 as usize] {
                    let pore_pressure = model.pore_pressure.at(x.0.dot(up), g);
                    let grain_pressure = pressure.0 - state.background_pressure - pore_pressure;
                    viscosity.0 = model.viscosity(shear_rate.0, grain_pressure);
                }
            });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Glass beads (Jop et al. 2006), in a flow so thin that caps and floors do not matter.
    const BEADS: MuI = MuI {
        static_friction: 0.38,
        limiting_friction: 0.64,
        inertial_number: 0.28,
        grain_diameter: 5e-4,
        grain_density: 2500.0,
        pore_pressure: PorePressure::Dry,
        pressure_floor: 1e-3,
        max_viscosity: 1e9,
        regularisation: Regularisation::Capped,
    };

    /// τ/p′ at an inertial number, from the viscosity.
    fn friction(beads: &MuI, inertial_number: f64, p: f64) -> f64 {
        let shear_rate = inertial_number * (p / beads.grain_density).sqrt() / beads.grain_diameter;
        beads.viscosity(shear_rate, p) * shear_rate / p
    }

    #[test]
    fn friction_depends_on_the_inertial_number_alone() {
        for p in [10.0, 1e5] {
            for inertial_number in [1e-6, 0.01, 0.1, 0.28, 1.0, 100.0] {
                let exact = 0.38 + 0.26 / (0.28 / inertial_number + 1.0);
                assert!((friction(&BEADS, inertial_number, p) - exact).abs() < 1e-12, "I = {inertial_number}");
            }
        }
        assert!((friction(&BEADS, 0.28, 100.0) - 0.51).abs() < 1e-12);
    }

    #[test]
    fn viscosity_is_finite_at_rest_and_where_nothing_presses() {
        let capped = MuI { max_viscosity: 500.0, ..BEADS };
        assert_eq!(capped.viscosity(0.0, 1e4), 500.0);
        let smooth = MuI { regularisation: Regularisation::Papanastasiou { m: 0.01 }, ..BEADS };
        // μ_s p′ m, and the slope of the second term at rest, (μ_2 − μ_s) p′ t/I_0.
        let exact = 38.0 + 0.26 * 1e4 * 5e-4 * 0.5 / 0.28;
        assert!((smooth.viscosity(0.0, 1e4) - exact).abs() < 1e-9);
        for p in [0.0, -1e5] {
            assert_eq!(BEADS.viscosity(1.0, p), BEADS.viscosity(1.0, 1e-3));
        }
    }

    #[test]
    fn water_at_rest_carries_its_own_weight() {
        let wet = PorePressure::Hydrostatic { density: 1000.0, level: 2.0 };
        assert_eq!((wet.at(1.5, 10.0), wet.at(3.0, 10.0), PorePressure::Dry.at(1.5, 10.0)), (5000.0, 0.0, 0.0));
    }

    #[test]
    fn parameters_that_make_no_sense_are_refused() {
        assert_eq!(BEADS.check(), Ok(()));
        let wet = PorePressure::Hydrostatic { density: -1.0, level: 0.0 };
        for (beads, path) in [
            (MuI { static_friction: -0.1, ..BEADS }, "static_friction"),
            (MuI { static_friction: 0.7, ..BEADS }, "static_friction"),
            (MuI { limiting_friction: f64::NAN, ..BEADS }, "limiting_friction"),
            (MuI { inertial_number: 0.0, ..BEADS }, "inertial_number"),
            (MuI { grain_diameter: 0.0, ..BEADS }, "grain_diameter"),
            (MuI { grain_density: -1.0, ..BEADS }, "grain_density"),
            (MuI { pressure_floor: 0.0, ..BEADS }, "pressure_floor"),
            (MuI { max_viscosity: 0.0, ..BEADS }, "max_viscosity"),
            (MuI { pore_pressure: wet, ..BEADS }, "pore_pressure.density"),
            (MuI { regularisation: Regularisation::Papanastasiou { m: 0.0 }, ..BEADS }, "regularisation.m"),
        ] {
            assert_eq!(beads.check().err().map(|invalid| invalid.path).as_deref(), Some(path));
        }
    }
}
