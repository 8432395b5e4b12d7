//! The log of a run: one [MCAP](https://mcap.dev) file that any MCAP player or reader opens.
//!
//! | what in the log | how it is written | encoding and schema |
//! |---|---|---|
//! | one topic per cloud of particles (fluid, walls, structures) | [`LogWriter::add_points`], [`LogWriter::write_points`] | protobuf `foxglove.PointCloud`, frame `world`, rows described by [`PointField`]s |
//! | one topic per series of numbers and words (energies, gauges, step records) | [`LogWriter::add_series`], [`LogWriter::write_series`], [`LogWriter::write_record`] | JSON object with a `jsonschema` that names each property and its unit |
//! | `/log`, what the run has to say | [`LogWriter::message`] | protobuf `foxglove.Log` |
//! | attachments, such as the text of the scene | [`LogWriter::attach`] | the bytes as given |
//! | metadata records, such as versions and settings | [`LogWriter::metadata`] | text keys and values |
//!
//! Log time and publish time of every message are the **simulated** time in nanoseconds, so a player shows
//! simulated time; no wall-clock time is written, and two equal runs leave equal logs.
//!
//! Everything before the last [`LogWriter::flush`] stays readable if the process is killed; such a torn log has
//! no summary and must be read from its start: [`read_log`] does, and [`recover_log`] makes a whole log of it.

mod chunk;
mod doctor;
mod error;
mod facts;
mod frames;
mod particle_fields;
mod place;
mod plugin;
mod points;
mod read;
mod record;
mod recover;
mod reopen;
mod resync;
mod series;
mod writer;

#[cfg(test)]
mod tests;

pub use doctor::{ChannelReport, Examination, examine_log};
pub use error::LogError;
pub use facts::{Fact, ParticleCounts, derived_numbers, fixed_numbers};
pub use plugin::{Log, LogFailure, LogPlugin, LogSection, close_log, log_message, open_log};
pub use points::{BODY_FIELDS, Column, FLUID_FIELDS, PointField, PointKind, PointsId};
pub use read::{Damage, Ending, Piece, read_log};
pub use recover::{Copied, CopiedChannel, copy_log, recover_log};
pub use reopen::LogMark;
pub use series::{Field, SeriesId, Value};
pub use writer::{Level, LogWriter};

pub(crate) use place::is_being_written;
pub(crate) use reopen::{log_program, mark_log, reopen_log};
pub(crate) use series::described_fields;

use facts::program_facts;
pub(crate) use particle_fields::ParticleFields;
