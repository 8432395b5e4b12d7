//! Viscous force between two particles, Eq. 12 and the central form.
//!
//! - Eq. 12 (Adami et al. 2010), `m_i dv_i/dt = Σ_j μ̄_ij (V_i² + V_j²) (r_ij·∇_iW_ij)/r² v_ij`,
//!   `μ̄_ij = 2 μ_i μ_j/(μ_i + μ_j)`. It discretises ∇·(μ∇v) and does not conserve angular momentum: very viscous
//!   blocks cannot rotate.
//! - Central form, after Monaghan & Gingold 1983: `Σ_j (d+2) μ̄_ij (V_i² + V_j²) (r_ij·v_ij)/r² ∇_iW_ij`. It discretises
//!   ∇·(2μD) and conserves both momenta.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::momentum::Momentum;
use crate::lanes::Real;
use crate::neighbours::Pair;
use crate::particles::Vector;

/// Which form the viscous force has.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum ViscousForm {
    /// Along v_ij (Eq. 12).
    #[default]
    Laplacian,
    /// Along r_ij: angular momentum is conserved.
    Central,
}

/// The viscous force on particle i from one pair (N; N/m in 2D).
pub trait ViscousForce: 'static {
    /// Adds the force of the pair i, j with mean viscosity `mu_ij` (Pa s).
    fn add_to<const D: usize, R: Real>(
        force: &mut Vector<D, R>,
        mu_ij: R,
        i: &Momentum<D, R>,
        j: &Momentum<D, R>,
        pair: &Pair<D, R>,
    );
}

/// [`ViscousForm::Laplacian`].
pub struct LaplacianForm;

impl ViscousForce for LaplacianForm {
    #[inline(always)]
    fn add_to<const D: usize, R: Real>(
        force: &mut Vector<D, R>,
        mu_ij: R,
        i: &Momentum<D, R>,
        j: &Momentum<D, R>,
        pair: &Pair<D, R>,
    ) {
        let v_ij = i.velocity - j.velocity;
        force.add_product(v_ij, mu_ij * (i.squared_volume + j.squared_volume) * pair.gradient);
    }
}

/// [`ViscousForm::Central`].
pub struct CentralForm;

impl ViscousForce for CentralForm {
    #[inline(always)]
    fn add_to<const D: usize, R: Real>(
        force: &mut Vector<D, R>,
        mu_ij: R,
        i: &Momentum<D, R>,
        j: &Momentum<D, R>,
        pair: &Pair<D, R>,
    ) {
        let v_ij = i.velocity - j.velocity;
        let r_squared = pair.r_ij.dot(pair.r_ij) + f64::MIN_POSITIVE;
        let approach = pair.r_ij.dot(v_ij) * (D as f64 + 2.0) / r_squared;
        force.add_product(pair.r_ij, mu_ij * (i.squared_volume + j.squared_volume) * pair.gradient * approach);
    }
}
