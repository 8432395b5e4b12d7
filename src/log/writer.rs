//! The writer of a log.

use std::{collections::BTreeMap, fmt, fs::File, io::BufWriter, path::Path};

pub use foxglove::messages::log::Level;
use foxglove::{
    Encode,
    messages::{Log, PointCloud, Timestamp},
};
use mcap::{
    Attachment, Channel, Compression, McapError, McapResult, WriteOptions, Writer,
    records::{MessageHeader, Metadata},
    write::NoSeek,
};

use super::{
    error::LogError,
    place::Place,
    points::{Column, PointField, Points, PointsId},
    series::{self, Field, Series, SeriesId, Value},
};
use crate::particles::Workspace;

/// Topic of what the run has to say.
const LOG_TOPIC: &str = "/log";

/// Name of the program, in the header of the log and in its messages.
const PROGRAM: &str = "storegga";

/// Uncompressed bytes after which a chunk is closed. A frame of particles is mostly larger and then a chunk by
/// itself; the limit is for the series between two frames.
const CHUNK_SIZE: u64 = 1 << 20;

/// Nanoseconds in a second.
const NANOS: u64 = 1_000_000_000;

type McapFile = Writer<NoSeek<BufWriter<File>>>;

/// Writes the log of a run to an MCAP file.
///
/// Messages are collected into compressed chunks in memory; [`flush`](Self::flush) hands all of them to the
/// operating system. A writer that is dropped before [`finish`](Self::finish) finishes the log as well as it
/// can and keeps quiet about errors. After [`finish`](Self::finish) every write is an error.
///
/// Times are simulated times in seconds. They are stored in whole nanoseconds, rounded; negative ones and NaN
/// as zero.
pub struct LogWriter {
    place: Place,
    /// `None` once the log is finished. Dropping it finishes the file.
    mcap: Option<McapFile>,
    series: Vec<Series>,
    points: Vec<Points>,
    log_channel: u16,
    log_sequence: u32,
    /// The file, to bring it to the disk.
    file: Option<File>,
    /// How many messages there are, and the CRC-32 of them all.
    messages: u64,
    checksum: crc32fast::Hasher,
    /// Next sequence number of channels that were copied and so far belong to nothing else.
    copied: BTreeMap<u16, u32>,
    /// The encoded row of a series or line, kept so that its memory is used again.
    scratch: Vec<u8>,
}

impl fmt::Debug for LogWriter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let finished = self.mcap.is_none();
        f.debug_struct("LogWriter").field("path", &self.place.path).field("finished", &finished).finish_non_exhaustive()
    }
}

impl LogWriter {
    /// Creates the file at `path` and opens a log in it. An old file is overwritten, but only if it can be
    /// opened for writing and no other program is writing a log there.
    pub fn create(path: &Path) -> Result<Self, LogError> {
        let fail = |error: McapError| LogError::new(path, "create", error);
        let (file, place) = Place::create(path)?;
        let handle = file.try_clone().ok();
        let mut mcap = options().create(NoSeek::new(BufWriter::new(file))).map_err(fail)?;
        let log_channel = add_protobuf_channel::<Log>(&mut mcap, LOG_TOPIC).map_err(fail)?;
        Ok(Self {
            place,
            mcap: Some(mcap),
            series: Vec::new(),
            points: Vec::new(),
            log_channel,
            log_sequence: 0,
            file: handle,
            messages: 0,
            checksum: crc32fast::Hasher::new(),
            copied: BTreeMap::new(),
            scratch: Vec::new(),
        })
    }

    /// The file that holds the log.
    pub fn path(&self) -> &Path {
        &self.place.path
    }

    /// Adds a topic of JSON objects, each with `time` \[s\] and the `fields`. `description` says in the schema
    /// what the topic is.
    pub fn add_series(&mut self, topic: &str, description: &str, fields: &[Field]) -> Result<SeriesId, LogError> {
        let title = format!("{PROGRAM}{}", topic.replace('/', "."));
        let schema = series::schema(&title, description, fields).map_err(|error| self.error(error))?;
        let channel = self.mcap(|mcap| {
            let schema = mcap.add_schema(&title, "jsonschema", &schema)?;
            mcap.add_channel(schema, topic, "json", &BTreeMap::new())
        })?;
        let mut series = Series::new(channel, fields).map_err(|error| self.error(error))?;
        series.sequence = self.copied.remove(&channel).unwrap_or(0);
        self.series.push(series);
        Ok(SeriesId(self.series.len() - 1))
    }

    /// Writes numbers, one for each field of a series that has numbers only, at `time` \[s\].
    pub fn write_series(&mut self, id: SeriesId, time: f64, values: &[f64]) -> Result<(), LogError> {
        self.write_values(id, time, values.iter().map(|value| Value::Number(*value)))
    }

    /// Writes numbers and texts, one for each field of a series, at `time` \[s\].
    pub fn write_record(&mut self, id: SeriesId, time: f64, values: &[Value]) -> Result<(), LogError> {
        self.write_values(id, time, values.iter().copied())
    }

    fn write_values<'v>(
        &mut self,
        id: SeriesId,
        time: f64,
        values: impl Iterator<Item = Value<'v>> + Clone,
    ) -> Result<(), LogError> {
        let misfit = "the values of a series are not those its topic was added with";
        let Some(series) = self.series.get_mut(id.0).filter(|series| series.fits(values.clone())) else {
            return Err(self.error(misfit));
        };
        self.scratch.clear();
        let encoded = series.encode(&mut self.scratch, time, values);
        let header = header(series.channel, &mut series.sequence, nanos(time));
        self.write_scratch(encoded, header)
    }

    /// Adds a topic of point clouds whose points have `fields`, at least one.
    pub fn add_points(&mut self, topic: &str, fields: &[PointField]) -> Result<PointsId, LogError> {
        if fields.is_empty() {
            return Err(self.error("a point cloud needs fields"));
        }
        let channel = self.mcap(|mcap| add_protobuf_channel::<PointCloud>(mcap, topic))?;
        let mut points = Points::new(channel, fields);
        points.sequence = self.copied.remove(&channel).unwrap_or(0);
        self.points.push(points);
        Ok(PointsId(self.points.len() - 1))
    }

    /// Writes one frame of points at `time` \[s\]. The `columns` fill the fields in order, a
    /// [`Column::Vector`] three of them, and all have one value per particle. They are packed in the `workspace`.
    pub fn write_points(
        &mut self,
        id: PointsId,
        time: f64,
        columns: &[Column],
        workspace: &mut Workspace,
    ) -> Result<(), LogError> {
        let nanos = nanos(time);
        let Some(points) = self.points.get_mut(id.0) else {
            return Err(self.error("a point cloud belongs to another log"));
        };
        let header = header(points.channel, &mut points.sequence, nanos);
        match points.encode(timestamp(nanos), columns, workspace) {
            Ok(message) => self.write_message(&header, message),
            Err(why) => Err(self.error(why)),
        }
    }

    /// Writes a line for people to read to `/log`, at `time` \[s\].
    pub fn message(&mut self, time: f64, level: Level, text: &str) -> Result<(), LogError> {
        let nanos = nanos(time);
        let log = Log {
            timestamp: Some(timestamp(nanos)),
            level: level as i32,
            message: text.to_owned(),
            name: PROGRAM.to_owned(),
            ..Log::default()
        };
        let encoded = encode(&log, &mut self.scratch);
        let header = header(self.log_channel, &mut self.log_sequence, nanos);
        self.write_scratch(encoded, header)
    }

    /// Attaches a file, such as the text of the scene. `media_type` is its MIME type.
    pub fn attach(&mut self, name: &str, media_type: &str, bytes: &[u8]) -> Result<(), LogError> {
        let attachment = Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: bytes.into(),
        };
        self.attach_raw(&attachment)
    }

    /// Attaches a file as it is.
    pub(super) fn attach_raw(&mut self, attachment: &Attachment) -> Result<(), LogError> {
        self.mcap(|mcap| mcap.attach(attachment))
    }

    /// Writes a metadata record: what `name` is about, as keys and values.
    pub fn metadata(&mut self, name: &str, entries: &[(String, String)]) -> Result<(), LogError> {
        let metadata = Metadata { name: name.to_owned(), metadata: entries.iter().cloned().collect() };
        self.metadata_raw(&metadata)
    }

    /// Writes a metadata record as it is.
    pub(super) fn metadata_raw(&mut self, metadata: &Metadata) -> Result<(), LogError> {
        self.mcap(|mcap| mcap.write_metadata(metadata))
    }

    /// Adds a channel of another log. A series or cloud that is added later with the same topic and schema continues it.
    pub(super) fn copy_channel(&mut self, channel: &Channel) -> Result<u16, LogError> {
        self.mcap(|mcap| {
            let schema = match &channel.schema {
                Some(schema) => mcap.add_schema(&schema.name, &schema.encoding, &schema.data)?,
                None => 0,
            };
            mcap.add_channel(schema, &channel.topic, &channel.message_encoding, &channel.metadata)
        })
    }

    /// Writes a message of another log to a channel that [`copy_channel`](Self::copy_channel) added.
    pub(super) fn copy_message(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), LogError> {
        let next = header.sequence.wrapping_add(1);
        if header.channel_id == self.log_channel {
            self.log_sequence = next;
        } else {
            self.copied.insert(header.channel_id, next);
        }
        self.write_message(header, data)
    }

    /// Closes the chunk and hands everything so far to the operating system. From then on it is readable even
    /// if this process is killed, though not yet if the machine loses its power.
    pub fn flush(&mut self) -> Result<(), LogError> {
        self.mcap(Writer::flush)?;
        self.place.check()
    }

    /// Brings everything so far to the disk: from then on it is readable even if the machine loses its power.
    pub fn sync(&mut self) -> Result<(), LogError> {
        self.flush()?;
        let synced = self.file.as_ref().map_or(Ok(()), File::sync_data);
        synced.map_err(|error| self.error(error))
    }

    /// How many messages were written, and the CRC-32 of their numbers, times and bytes.
    pub(super) fn written(&self) -> (u64, u32) {
        (self.messages, self.checksum.clone().finalize())
    }

    /// The file was given another name.
    pub(super) fn set_path(&mut self, path: &Path) {
        self.place.path = path.to_owned();
    }

    /// Writes the summary that lets players seek, and closes the file. To finish again does nothing.
    pub fn finish(&mut self) -> Result<(), LogError> {
        let Some(mut mcap) = self.mcap.take() else { return Ok(()) };
        mcap.finish().map_err(|error| LogError::new(&self.place.path, "finish", error))?;
        self.place.check()
    }

    fn write_scratch(&mut self, encoded: Result<(), impl ToString>, header: MessageHeader) -> Result<(), LogError> {
        encoded.map_err(|error| self.error(error.to_string()))?;
        let scratch = std::mem::take(&mut self.scratch);
        let written = self.write_message(&header, &scratch);
        self.scratch = scratch;
        written
    }

    fn write_message(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), LogError> {
        self.mcap(|mcap| mcap.write_to_known_channel(header, data))?;
        self.messages += 1;
        self.checksum.update(&header.sequence.to_le_bytes());
        self.checksum.update(&header.log_time.to_le_bytes());
        self.checksum.update(data);
        Ok(())
    }

    /// Does `what` to the file, which must not be finished: the library panics then.
    fn mcap<T>(&mut self, what: impl FnOnce(&mut McapFile) -> McapResult<T>) -> Result<T, LogError> {
        match &mut self.mcap {
            Some(mcap) => what(mcap).map_err(|error| LogError::new(&self.place.path, "write", error)),
            None => Err(self.error("it is finished")),
        }
    }

    fn error(&self, cause: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> LogError {
        LogError::new(&self.place.path, "write", cause)
    }
}

/// How logs are written.
///
/// Chunks are compressed with zstd at level 1, in the calling thread. A frame of 10⁵ fluid particles (4.5 MB,
/// on a disturbed lattice) took, without compression, with lz4, zstd 1 and zstd 3: 3, 11, 15 and 34 ms, and
/// 4.6, 4.5, 3.8 and 3.8 MB. zstd 1 saves a sixth of the disk in a time that no step notices; lz4 saves little,
/// and its encoder cannot be shared between threads, which would keep the writer out of a resource.
fn options() -> WriteOptions {
    WriteOptions::new()
        .library(concat!("storegga ", env!("CARGO_PKG_VERSION")))
        .compression(Some(Compression::Zstd))
        .compression_level(1)
        .compression_threads(0)
        .chunk_size(Some(CHUNK_SIZE))
        // A chunk is put together in memory and written whole. Otherwise its length would be filled in
        // afterwards, and the log of a killed run would end in a chunk of unknown length.
        .disable_seeking(true)
}

fn add_protobuf_channel<T: Encode>(mcap: &mut McapFile, topic: &str) -> McapResult<u16> {
    let schema = match T::get_schema() {
        Some(schema) => mcap.add_schema(&schema.name, &schema.encoding, &schema.data)?,
        None => 0,
    };
    mcap.add_channel(schema, topic, &T::get_message_encoding(), &BTreeMap::new())
}

fn encode<T: Encode>(message: &T, buffer: &mut Vec<u8>) -> Result<(), T::Error> {
    buffer.clear();
    buffer.reserve(message.encoded_len().unwrap_or_default());
    message.encode(buffer)
}

fn header(channel_id: u16, sequence: &mut u32, nanos: u64) -> MessageHeader {
    let header = MessageHeader { channel_id, sequence: *sequence, log_time: nanos, publish_time: nanos };
    *sequence = sequence.wrapping_add(1);
    header
}

/// Seconds to nanoseconds, rounded; exact to the nanosecond for the first 30 days.
pub(super) fn nanos(time: f64) -> u64 {
    (time * NANOS as f64).round() as u64
}

fn timestamp(nanos: u64) -> Timestamp {
    match u32::try_from(nanos / NANOS) {
        Ok(seconds) => Timestamp::new(seconds, (nanos % NANOS) as u32),
        Err(_) => Timestamp::MAX,
    }
}
