//! A kernel scaled to a smoothing length and a dimension, evaluated for many pairs at once.

use std::sync::Arc;

use bevy_ecs::prelude::*;
use pulp::Arch;
use schemars::JsonSchema;

use super::Kernel;
use crate::scene::schema::{Describe, OpenEnum, describe};

/// A kernel as the stages see it: scaled to h and d, and evaluated for a whole list of pairs in one call, so that
/// the call through the registry costs nothing a pair and the loop runs in the widest SIMD that the processor has.
/// (Every lane does the same operations in the same order: results do not depend on the width.)
pub trait PairKernel: Send + Sync {
    /// Radius of the support (m).
    fn radius(&self) -> f64;

    /// Replaces each squared distance r² (m²) by W(r) (1/m^d).
    fn values(&self, squared_distances: &mut [f64]);

    /// Replaces each squared distance r² (m²) by (dW/dr)/r (1/m^(d+2)), so that ∇_iW_ij = r_ij (dW/dr)/r.
    fn gradients(&self, squared_distances: &mut [f64]);
}

/// The kernel of the run: the one that the scene named, at its smoothing length and dimension.
#[derive(Resource, Clone)]
pub struct SmoothingKernel(pub Arc<dyn PairKernel>);

impl SmoothingKernel {
    /// W(r) (1/m^d) at one distance r (m).
    #[must_use]
    pub fn value(&self, r: f64) -> f64 {
        let mut one = [r * r];
        self.0.values(&mut one);
        one[0]
    }
}

struct Scaled<K> {
    kernel: K,
    smoothing_length: f64,
    /// α_d / h^d
    value_scale: f64,
    /// α_d / h^(d+2)
    gradient_scale: f64,
}

/// Below this q two particles coincide; it keeps w'(q)/q finite, and w'(0) = 0 makes the result 0.
const COINCIDENT: f64 = 1e-12;

impl<K: Kernel> PairKernel for Scaled<K> {
    fn radius(&self) -> f64 {
        self.kernel.support() * self.smoothing_length
    }

    fn values(&self, squared_distances: &mut [f64]) {
        let inverse_h = 1.0 / self.smoothing_length;
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for x in squared_distances {
                    *x = self.value_scale * self.kernel.w(x.sqrt() * inverse_h);
                }
            },
        );
    }

    fn gradients(&self, squared_distances: &mut [f64]) {
        let inverse_h = 1.0 / self.smoothing_length;
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for x in squared_distances {
                    let q = x.sqrt() * inverse_h;
                    let q = if q > COINCIDENT { q } else { COINCIDENT };
                    *x = self.gradient_scale * self.kernel.dw_dq(q) / q;
                }
            },
        );
    }
}

type Factory = Box<dyn Fn(f64, usize) -> Arc<dyn PairKernel> + Send + Sync>;

/// The kernels that a scene can name.
#[derive(Resource, Default)]
pub struct KernelRegistry {
    entries: Vec<(String, Factory, Describe)>,
}

impl OpenEnum for KernelRegistry {
    const NAME: &'static str = "kernel";

    fn variants(&self) -> impl Iterator<Item = (&str, Describe)> {
        self.entries.iter().map(|(name, _, describe)| (name.as_str(), *describe))
    }
}

impl KernelRegistry {
    /// Makes `kernel` available under `name`, in the place of what had that name.
    pub fn register<K: Kernel + Clone + JsonSchema>(&mut self, name: &str, kernel: K) {
        let factory: Factory = Box::new(move |smoothing_length, dimension| {
            let alpha = kernel.normalisation(dimension);
            Arc::new(Scaled {
                kernel: kernel.clone(),
                smoothing_length,
                value_scale: alpha / smoothing_length.powi(dimension as i32),
                gradient_scale: alpha / smoothing_length.powi(dimension as i32 + 2),
            })
        });
        self.entries.retain(|(known, ..)| known != name);
        self.entries.push((name.to_owned(), factory, describe::<K>));
    }

    /// Names that a scene can use.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(|(name, ..)| name.as_str())
    }

    /// The kernel called `name` for a smoothing length (m) and a dimension (2 or 3), or `None` if nobody registered it.
    #[must_use]
    pub fn scaled(&self, name: &str, smoothing_length: f64, dimension: usize) -> Option<SmoothingKernel> {
        let (_, factory, _) = self.entries.iter().find(|(known, ..)| known == name)?;
        Some(SmoothingKernel(factory(smoothing_length, dimension)))
    }
}
