//! What a scene expects of its own run: section `expect`, checked at the end.
//!
//! ```ron
//! expect: [
//!     (name: "floor force", of: "floor.force_y", take: Mean(from: 1.3, to: 1.5), is: FluidWeight, within: Relative(0.003)),
//! ]
//! ```
//!
//! `of` names a number of a [`Series`](crate::probes::Series), `take` makes one value of it, `is` says what that should be
//! and `within` how near.

mod check;
mod displaced;
mod fit;
mod reference;
mod section;
mod table;
mod take;

pub use check::{Check, evaluate, has_expectations};
pub use reference::Reference;
pub(crate) use section::find as find_number;
pub use section::{ExpectSection, Expectation, Within};
pub use table::CsvTable;
pub use take::Take;

use bevy_app::{App, Plugin};

use crate::app::StoreggaApp;

/// Expectations. Their section is read after those of all other plugins, whose series it may name.
pub struct ExpectPlugin;

impl Plugin for ExpectPlugin {
    fn build(&self, app: &mut App) {
        app.register_rebuilt::<check::Expectations>();
    }

    fn finish(&self, app: &mut App) {
        app.register_scene_section::<ExpectSection>();
    }
}
