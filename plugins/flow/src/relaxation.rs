//! Relaxation zones: regions in which the velocity is driven to a profile. Nothing is put in or taken out.
//!
//! `dv_i/dt = … − k f(s_i) (v_i − v*(x_i))`, solved exactly over a step: `v_i ← v* + (v_i − v*) e^(−k f Δt)`, which is stable
//! for any rate k and does not depend on the length of the step. It acts between kick and drift: however great the forces that
//! work against it, particles are carried with what is left of v − v*. v* is the profile, and the weight
//!
//! `f(s) = (e^(s^3.5) − 1)/(e − 1)`, `s = min(depth/ramp, 1)`
//!
//! grows smoothly from 0 on the border of the zone to 1 at the depth `ramp` (1 − α_R of Jacobsen, Fuhrman & Fredsøe 2012, Int. J.
//! Numer. Meth. Fluids 70, 1073; relaxation of the velocity at each step goes back to Mayer, Garapon & Sørensen 1998, ibid. 28,
//! 293). They blend once a step, whatever its length; here α = e^(−k f Δt) makes k a rate.
//!
//! With v* = 0 a zone is a sponge: it absorbs waves. In a channel with periodic sides a zone at the seam is outlet and inlet: it
//! takes the wake out of the flow and sends it in again with the profile, and it does the work that the walls and bodies
//! between take out. The pressure jump Δp that this takes holds the mean velocity of the channel back by `Δp/(ρ k ∫ f dx)` (where
//! kfΔt is small), the integral over the zone: a ramp counts for 0.176 of its length.

use bevy_ecs::prelude::*;
use glam::DVec3;
use indexmap::IndexMap;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use storegga::clock::Clock;
use storegga::neighbours::PeriodicSides;
use storegga::particles::{Fluid, Position, Velocity};
use storegga::physics::EquationOfState;
use storegga::probes::box_inside;
use storegga::scene::geometry::Shape;
use storegga::scene::{Invalid, Resolution, SceneSection, SectionError};

use crate::Profile;

/// Section `relaxation_zones` of a scene: the zones by name. Where several overlap they act one after the other.
///
/// In a zone `v ← v* + (v − v*) e^(−kfΔt)` at every step: exact for any rate k, and nothing is put in or taken out. The weight
/// `f(s) = (e^(s^3.5) − 1)/(e − 1)`, s = depth over `ramp` up to 1, grows smoothly into the zone (Jacobsen et al. 2012). A velocity of
/// 0 makes a sponge that absorbs waves. In a channel with periodic sides a zone at the seam is outlet and inlet: it restores the
/// inflow and does the work that walls and bodies take out. The steady forces in a zone, such as the pressure jump that drives
/// a channel, leave a difference from v* of the force per mass over k (or none, when kΔt is above 1): choose k so that it is
/// small. A pressure jump Δp holds the mean velocity of a channel back by Δp/(ρ k ∫ f dx), where a ramp counts for 0.176 of its
/// length. v_max of Eq. 8 must not be less than the greatest speed of a target.
#[derive(Resource, Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct RelaxationZones(IndexMap<String, RelaxationZone>);

/// A region in which the velocity is driven to a profile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelaxationZone {
    /// Where (m); it reaches through periodic sides.
    #[schemars(extend("unit" = "m"))]
    pub shape: Shape,
    /// Velocity to which the fluid is driven.
    pub target: Profile,
    /// Rate k (1/s) in the depth of the zone.
    #[schemars(extend("unit" = "1/s", "exclusiveMinimum" = 0.0))]
    pub rate: f64,
    /// Depth (m) from the border of the shape at which the rate is reached; 0 for everywhere in it.
    #[serde(default)]
    #[schemars(range(min = 0.0), extend("unit" = "m"))]
    pub ramp: f64,
    /// Start (s).
    #[serde(default)]
    #[schemars(range(min = 0.0), extend("unit" = "s"))]
    pub from: f64,
    /// End (s); `None` for never.
    #[serde(default)]
    #[schemars(extend("unit" = "s", "derived" = "for ever"))]
    pub until: Option<f64>,
    /// Displacements (m) of the shape and its images through periodic sides.
    #[serde(skip)]
    images: Vec<DVec3>,
}

impl SceneSection for RelaxationZones {
    const NAME: &'static str = "relaxation_zones";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn check(&self, world: &World) -> Result<(), Invalid> {
        let dimension = world.resource::<Resolution>().dimension;
        self.0.iter().try_for_each(|(name, zone)| zone.check(dimension).map_err(|wrong| wrong.under(name)))
    }

    fn spawn(mut self, world: &mut World) -> Result<(), SectionError> {
        for (name, zone) in &self.0 {
            zone.check_place(world).map_err(|wrong| wrong.under(name))?;
        }
        let v_max = world.resource::<EquationOfState>().max_speed;
        let sides = world.resource::<PeriodicSides>();
        for (name, zone) in &mut self.0 {
            let speed = zone.target.greatest_speed();
            if speed > v_max * (1.0 + 1e-12) {
                let message = format!(
                    "drives the fluid to {speed} m/s, above the {v_max} m/s of Eq. 8: give `equation_of_state.max_speed`"
                );
                return Err(Invalid::new(format!("{name}.target"), message).into());
            }
            zone.images = std::iter::once(DVec3::ZERO).chain(sides.images_of(DVec3::ZERO)).collect();
        }
        world.insert_resource(self);
        Ok(())
    }
}

impl RelaxationZone {
    fn check(&self, dimension: usize) -> Result<(), Invalid> {
        self.shape.check(dimension).map_err(|wrong| wrong.under("shape"))?;
        self.target.check(dimension).map_err(|wrong| wrong.under("target"))?;
        if self.rate <= 0.0 {
            return Err(Invalid::new("rate", format!("must be greater than 0, got {} 1/s", self.rate)));
        }
        for (name, value, unit) in [("ramp", self.ramp, "m"), ("from", self.from, "s")] {
            if value < 0.0 {
                return Err(Invalid::new(name, format!("must not be negative, got {value} {unit}")));
            }
        }
        match self.until {
            Some(until) if until <= self.from => {
                let message = format!("must be later than `from` ({} s), got {until} s", self.from);
                Err(Invalid::new("until", message))
            }
            _ => Ok(()),
        }
    }

    /// Refuses a zone that, through periodic sides too, never holds any fluid.
    fn check_place(&self, world: &mut World) -> Result<(), Invalid> {
        let (low, high) = self.shape.bounds();
        let images: Vec<DVec3> = world.resource::<PeriodicSides>().images_of(DVec3::ZERO).collect();
        let mut inside = |shift: DVec3| box_inside(world, "shape", (low + shift, high + shift));
        let itself = inside(DVec3::ZERO);
        if images.into_iter().any(|shift| inside(shift).is_ok()) { Ok(()) } else { itself }
    }

    /// Weight f of the rate at the place `x` (m), through periodic sides too.
    fn weight(&self, x: DVec3) -> f64 {
        let depth = self.images.iter().map(|image| -self.shape.signed_distance(x - image)).fold(0.0, f64::max);
        if depth >= self.ramp {
            return if depth > 0.0 { 1.0 } else { 0.0 };
        }
        let s = depth / self.ramp;
        s.powf(3.5).exp_m1() / 1.0_f64.exp_m1()
    }
}

/// Whether the scene has zones.
pub(crate) fn any(zones: Res<RelaxationZones>) -> bool {
    !zones.0.is_empty()
}

/// Particles below which the loop is not split further between threads.
const GRAIN: usize = 256;

/// Drives the velocity to the profile of every zone.
pub fn relax(
    clock: Res<Clock>,
    zones: Res<RelaxationZones>,
    mut fluid: Query<(&Position, &mut Velocity), With<Fluid>>,
) -> Result {
    let dt = clock.time_step;
    // The step began before its time: its middle decides whether a zone acts.
    let now = clock.time - 0.5 * dt;
    for zone in zones.0.values().filter(|zone| zone.from <= now && zone.until.is_none_or(|until| now < until)) {
        for (position, mut velocity) in fluid.contiguous_iter_mut()? {
            let columns = (position, velocity.bypass_change_detection()).into_par_iter().with_min_len(GRAIN);
            columns.for_each(|(x, v)| {
                let weight = zone.weight(x.0);
                if weight > 0.0 {
                    let target = zone.target.at(x.0);
                    v.0 = target + (v.0 - target) * (-zone.rate * weight * dt).exp();
                }
            });
        }
    }
    Ok(())
}
