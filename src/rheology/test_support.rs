//! What the tests of all rheologies ask.

use super::{FlowCurve, Rheology};

/// Whether the greatest viscosity that a model says it has is the greatest of its curve.
#[track_caller]
pub(super) fn assert_greatest_viscosity(model: &impl FlowCurve) {
    let sweep = (-300..=300).map(|k| model.viscosity(10_f64.powi(k) * 0.999, 0.0));
    let (found, said) = (sweep.fold(model.viscosity(0.0, 0.0), f64::max), model.greatest_viscosity());
    assert!((found / said - 1.0).abs() < 1e-9, "{found} Pa s, not {said} Pa s");
}

/// The parameter that a model refuses and why, without the value that it got.
pub(super) fn refused(model: &impl Rheology) -> String {
    let complaint = model.check().map_err(|invalid| format!("{}: {}", invalid.path, invalid.message));
    complaint.err().unwrap_or_default().split(", got").next().unwrap_or_default().to_owned()
}
