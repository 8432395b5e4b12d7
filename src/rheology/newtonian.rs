//! A Newtonian fluid: μ is constant.

use bevy_ecs::prelude::Component;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FlowCurve, Rheology};

/// `μ = const`.
#[derive(Component, Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Newtonian {
    /// Dynamic viscosity μ (Pa s).
    #[schemars(range(min = 0.0), extend("unit" = "Pa s"))]
    pub viscosity: f64,
}

impl Rheology for Newtonian {
    fn greatest_viscosity(&self) -> f64 {
        self.viscosity
    }
}

impl FlowCurve for Newtonian {
    fn viscosity(&self, _: f64, _: f64) -> f64 {
        self.viscosity
    }
}
