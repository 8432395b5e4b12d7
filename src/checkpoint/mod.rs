//! Checkpoints: a run that was stopped, in whatever way, goes on with the same bits.
//!
//! What lives from one step to the next is registered: [`StoreggaApp::register_saved`](crate::app::StoreggaApp::register_saved)
//! (per-particle columns are registered by themselves). What follows from the scene, or is computed anew before it is
//! read, is registered with [`StoreggaApp::register_rebuilt`](crate::app::StoreggaApp::register_rebuilt); scene sections,
//! rheologies and probes, which the scene brings back, are known. [`check_state`] finds what was forgotten. A system's
//! `Local` is memory to reuse and nothing else: nobody can save it.
//!
//! There is no random number in the program. A plugin that draws some keeps its generator in a resource that it registers
//! as saved.

mod file;
mod place;
mod resume;
mod state;
mod write;

pub use file::{About, Checkpoint, Origin};
pub use place::{checkpoint_of, keep_unfinished, refuse_to_overwrite};
pub use state::{check_state, restore_state, save_state};
pub use write::{Checkpoints, start_checkpoints};

pub(crate) use file::program_checksum;
pub(crate) use resume::changed_line;
pub(crate) use state::{SavedState, decode, encode};
pub(crate) use write::{write_before_end, write_if_due, write_last};
