//! Pressure force between two particles, first sum of Eq. 6.
//!
//! `m_i dv_i/dt = −Σ_j (p_i V_i² + p_j V_j²) ∇_iW_ij`, antisymmetric in i and j; or, after Adami et al. 2012,
//! `−Σ_j (V_i² + V_j²) p̃_ij ∇_iW_ij`, `p̃_ij = (ρ_j p_i + ρ_i p_j)/(ρ_i + ρ_j)`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::momentum::Momentum;
use crate::lanes::Real;

/// Which average of the two pressures drives a pair apart.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum PressureForm {
    /// p_i V_i² + p_j V_j² (Eq. 6).
    #[default]
    VolumeWeighted,
    /// (V_i² + V_j²) (ρ_j p_i + ρ_i p_j)/(ρ_i + ρ_j) (Adami et al. 2012).
    DensityWeighted,
}

/// The factor of −∇_iW_ij in the force on particle i (Pa m^(2d)).
pub trait PressureAverage: 'static {
    /// Average for the pair i, j.
    fn average<const D: usize, R: Real>(i: &Momentum<D, R>, j: &Momentum<D, R>) -> R;
}

/// [`PressureForm::VolumeWeighted`].
pub struct VolumeWeighted;

impl PressureAverage for VolumeWeighted {
    #[inline(always)]
    fn average<const D: usize, R: Real>(i: &Momentum<D, R>, j: &Momentum<D, R>) -> R {
        j.pressure.mul_add(j.squared_volume, i.pressure * i.squared_volume)
    }
}

/// [`PressureForm::DensityWeighted`].
pub struct DensityWeighted;

impl PressureAverage for DensityWeighted {
    #[inline(always)]
    fn average<const D: usize, R: Real>(i: &Momentum<D, R>, j: &Momentum<D, R>) -> R {
        let p_ij = (j.density * i.pressure + i.density * j.pressure) / (i.density + j.density);
        (i.squared_volume + j.squared_volume) * p_ij
    }
}
