//! What a log holds, as numbers: the series of probes, and the particles at the times of its frames.
//!
//! A log is read once for everything but its frames ([`Results::open`]), and again for those of them that are wanted
//! ([`Results::frames`]), one at a time in memory. Torn logs are read as far as they go.

mod facts;
mod fit;
mod frame;
mod profile;
mod record;
mod runout;
mod series;
mod vtk;

pub use facts::RunFacts;
pub use fit::Fit;
pub use frame::{Frame, FrameField};
pub use profile::{line_profile, upper_surface};
pub use record::Record;
pub use runout::{BULK, COLUMN, Envelope, Extent, Extremes, center_height};
pub use series::{SeriesField, TimeSeries};
pub use vtk::{write_collection, write_points};

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use foxglove::Decode;
use foxglove::messages::PointCloud;

use crate::log::{LogError, Piece, read_log};

/// Topic of the frames of the fluid.
pub const PARTICLES: &str = "/particles";

/// Topics of the frames of walls and structures, which have one frame only if nothing moves.
pub const BODIES: [&str; 2] = ["/walls", "/structures"];

/// Schema of frames.
const CLOUD: &str = "foxglove.PointCloud";

/// A log, read for everything but its frames.
#[derive(Debug, Clone)]
pub struct Results {
    path: PathBuf,
    /// What the log says of its run.
    pub facts: RunFacts,
    /// Series, in the order of the log.
    pub series: Vec<TimeSeries>,
    /// Times (ns) of the frames of each topic.
    frames: BTreeMap<String, Vec<u64>>,
}

impl Results {
    /// Reads the log at `path`.
    ///
    /// # Errors
    /// The file cannot be read or is no log.
    pub fn open(path: &Path) -> Result<Self, LogError> {
        let mut metadata = BTreeMap::new();
        let mut series: Vec<TimeSeries> = Vec::new();
        let mut frames: BTreeMap<String, Vec<u64>> = BTreeMap::new();
        read_log(path, |piece| {
            match piece {
                Piece::Metadata(record) => drop(metadata.insert(record.name.clone(), record.metadata.clone())),
                Piece::Message(channel, header, data) => {
                    let schema = channel.schema.as_ref();
                    if schema.is_some_and(|schema| schema.name == CLOUD) {
                        frames.entry(channel.topic.clone()).or_default().push(header.log_time);
                    } else if let Some(schema) = schema.filter(|schema| schema.encoding == "jsonschema") {
                        let known = series.iter().position(|series| series.topic == channel.topic);
                        let index = known.unwrap_or_else(|| {
                            series.push(TimeSeries::new(&channel.topic, &schema.data));
                            series.len() - 1
                        });
                        series[index].push(data);
                    }
                }
                _ => {}
            }
            Ok(())
        })?;
        Ok(Self { path: path.to_owned(), facts: RunFacts::of(&metadata), series, frames })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Times (s) of the frames of `topic`, in their order; none if there is no such topic.
    #[must_use]
    pub fn frame_times(&self, topic: &str) -> Vec<f64> {
        self.frames.get(topic).into_iter().flatten().map(|time| seconds(*time)).collect()
    }

    /// The frame of `topic` that is nearest to `time` (s): its number, or `None` if there are no frames.
    #[must_use]
    pub fn nearest_frame(&self, topic: &str, time: f64) -> Option<usize> {
        let distance = |k: &usize| (seconds(self.frames[topic][*k]) - time).abs();
        let count = self.frames.get(topic)?.len();
        (0..count).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Reads the log again and calls `visit` with the frames of `topic` whose number `wanted` takes, and with that number.
    ///
    /// # Errors
    /// The file cannot be read, or what `visit` says.
    pub fn frames(
        &self,
        topic: &str,
        wanted: impl Fn(usize) -> bool,
        mut visit: impl FnMut(usize, Frame) -> Result<(), LogError>,
    ) -> Result<(), LogError> {
        let mut number = 0;
        let last = self.frames.get(topic).map_or(0, Vec::len);
        read_log(&self.path, |piece| {
            if let Piece::Message(channel, header, data) = piece
                && channel.topic == topic
                && channel.schema.as_ref().is_some_and(|schema| schema.name == CLOUD)
            {
                // A log that is still written may have grown.
                if number < last && wanted(number) {
                    let cloud = PointCloud::decode(data).map_err(|error| self.error(error.to_string()))?;
                    let units = |name: &str| self.facts.units.get(name).cloned().unwrap_or_default();
                    let frame = Frame::new(seconds(header.log_time), &cloud, units);
                    visit(number, frame.map_err(|what| self.error(what))?)?;
                }
                number += 1;
            }
            Ok(())
        })
        .map(drop)
    }

    /// One frame of `topic`, if it is there.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn frame(&self, topic: &str, number: usize) -> Result<Option<Frame>, LogError> {
        let mut found = None;
        self.frames(
            topic,
            |k| k == number,
            |_, frame| {
                found = Some(frame);
                Ok(())
            },
        )?;
        Ok(found)
    }

    /// The particles of walls and structures at `time` (s): those of the last frame of each that is not later.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn bodies_at(&self, time: f64) -> Result<Vec<Frame>, LogError> {
        let mut bodies = Vec::new();
        for topic in BODIES {
            let times = self.frame_times(topic);
            let number = times.iter().rposition(|of_frame| *of_frame <= time + 1e-9).unwrap_or(0);
            bodies.extend(self.frame(topic, number)?);
        }
        Ok(bodies)
    }

    fn error(&self, what: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> LogError {
        LogError::new(&self.path, "read", what)
    }
}

/// Nanoseconds to seconds.
fn seconds(nanos: u64) -> f64 {
    nanos as f64 / 1e9
}
