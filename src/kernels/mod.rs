//! Smoothing kernels: the contract, the registry, and the scaled form that the pair loops evaluate.

mod cubic;
mod quintic;
mod scaled;
mod wendland;
mod wendland_c4;

pub use cubic::CubicSpline;
pub use quintic::QuinticSpline;
pub use scaled::{KernelRegistry, PairKernel, SmoothingKernel};
pub use wendland::WendlandC2;
pub use wendland_c4::WendlandC4;

/// A radial smoothing kernel W(r, h) = α_d / h^d · w(q), q = r/h.
///
/// To add one, implement this trait and call
/// [`register_kernel`](crate::app::StoreggaApp::register_kernel); scenes then choose it by its name, and its doc comment stands on the
/// reference page of scenes.
pub trait Kernel: Send + Sync + 'static {
    /// Radius of the support in units of h: w(q) = 0 for q ≥ `support`.
    fn support(&self) -> f64;

    /// Normalisation α_d for `dimension` d, such that ∫ α_d w(|x|) d^d x = 1.
    fn normalisation(&self, dimension: usize) -> f64;

    /// Shape w(q), q ≥ 0. Must be 0 beyond the support.
    fn w(&self, q: f64) -> f64;

    /// Derivative dw/dq ≤ 0. Must be 0 beyond the support.
    fn dw_dq(&self, q: f64) -> f64;
}

/// (x)₊ = max(x, 0), one instruction. (`f64::max` takes three, since it does not hand on a NaN.)
#[inline(always)]
fn positive_part(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}
