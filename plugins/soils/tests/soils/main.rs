//! Soils against their exact flows.

mod granular;
mod softening;
mod support;
