//! Scenes: RON text, read strictly, and what becomes of it.

mod columns;
mod disturbance;
pub mod document;
mod files;
mod fluids;
pub mod geometry;
mod header;
mod hydrostatics;
pub mod invalid;
mod limits;
mod load;
mod places;
pub mod schema;
mod section;
mod state;
mod variant;

pub(crate) use columns::vertical;
pub use disturbance::{Disturbance, WaveMode};
pub use document::{Document, Named, Node, flatten, nearest};
pub use files::{SceneFile, SceneFiles, scene_file};
pub(crate) use fluids::NOTHING_LEFT;
pub use fluids::{FilledFluids, Filling, FluidSpec, FluidsSection, InitialPressure};
pub use header::{Header, Periodic, Resolution, SceneInfo};
pub use hydrostatics::{Column, Layer};
pub use invalid::Invalid;
pub(crate) use limits::{available_memory, bytes_of, limit_memory, limit_particles};
pub(crate) use load::load_section;
pub use load::{Deferred, SceneDocument, load_scene, read_header};
pub(crate) use places::WALL_CLEARANCE;
pub use section::{SceneFacts, SceneSection, SceneSettings, SectionError, SectionRegistry};
pub use variant::open_document;
pub(crate) use variant::{Setting, clean, read_text, settings};

/// The complaint that nothing called `found` exists among the `known` names of `what`.
#[must_use]
pub fn unknown<'a>(path: &str, what: &str, found: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> Invalid {
    let mut names: Vec<&str> = known.clone().into_iter().collect();
    names.sort_unstable();
    let hint = nearest(found, known).map(|name| format!("; did you mean `{name}`?")).unwrap_or_default();
    let list = if names.is_empty() { "there is none".to_owned() } else { format!("known: {}", names.join(", ")) };
    Invalid::new(path, format!("no {what} is called `{found}`{hint} ({list})"))
}
