//! Flows that are driven and shaken from outside, against exact solutions and conservation laws.

mod checkpoint;
mod probes;
mod relaxation;
mod shaking;
mod support;
