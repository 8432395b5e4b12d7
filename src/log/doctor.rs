//! What a log holds, and whether anything is missing in it.

use std::collections::BTreeMap;
use std::path::Path;

use foxglove::Decode;
use foxglove::messages::PointCloud;
use mcap::Channel;
use mcap::records::{ChunkHeader, MessageHeader};

use super::read::seconds;
use super::recover::END;
use super::series::described_fields;
use super::writer::nanos;
use super::{Damage, Ending, LogError, Piece, read_log};

/// What a log holds.
#[derive(Debug, Clone)]
pub struct Examination {
    /// How the log ended.
    pub ending: Ending,
    /// Library that wrote it.
    pub library: String,
    /// Channels, in the order in which they were met.
    pub channels: Vec<ChannelReport>,
    /// Name, media type and bytes of each attachment.
    pub attachments: Vec<(String, String, u64)>,
    /// Metadata records by name; of several with one name the last.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// Whole chunks: how many, their bytes as they are stored and as they are unpacked.
    pub chunks: [u64; 3],
    /// Parts that could not be read.
    pub damages: Vec<Damage>,
}

/// What a channel holds.
#[derive(Debug, Clone)]
pub struct ChannelReport {
    /// Its topic.
    pub topic: String,
    /// Name of its schema; empty if it has none.
    pub schema: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// Name and SI unit of each field, the unit empty for words and numbers that name something.
    pub fields: Vec<(String, String)>,
    /// Number of messages.
    pub messages: u64,
    /// Bytes of all messages, unpacked.
    pub bytes: u64,
    /// Simulated time (ns) of the first and of the last message.
    pub span: Option<(u64, u64)>,
    /// Least and greatest interval (ns) between messages.
    pub intervals: Option<(u64, u64)>,
    /// Interval (ns) at which the scene asked for messages, if they came at that.
    pub expected: Option<u64>,
    /// Messages that are missing by their numbers.
    pub missing: u64,
    /// Outputs that are missing by their times, against the expected interval; 0 where none is expected.
    pub gaps: u64,
    /// Intervals that are as expected.
    regular: u64,
    /// Number that the next message should have.
    next: u32,
}

/// Metadata record and entries with the intervals of outputs (s).
const DERIVED: &str = "derived";
const FRAME_INTERVAL: &str = "frame_interval [s]";
const SERIES_INTERVAL: &str = "series_interval [s]";

/// Schema of frames of particles.
const CLOUD: &str = "foxglove.PointCloud";

impl Examination {
    /// Whether the log is whole and nothing is missing in it.
    #[must_use]
    pub fn is_healthy(&self) -> bool {
        self.ending.whole && self.channels.iter().all(|channel| channel.missing == 0 && channel.gaps == 0)
    }

    /// Whether there is nothing in it that [`recover_log`](super::recover_log) could keep.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let has_messages = self.channels.iter().any(|channel| channel.messages > 0);
        !has_messages && self.attachments.is_empty() && self.metadata.is_empty()
    }

    /// How the run ended, as it says itself: `done`, `interrupted`, `diverged`, `failed`. `None` if the log does not say.
    #[must_use]
    pub fn run_end(&self) -> Option<&str> {
        self.entry(END, "how")
    }

    /// A metadata entry.
    #[must_use]
    pub fn entry(&self, record: &str, key: &str) -> Option<&str> {
        self.metadata.get(record)?.get(key).map(String::as_str)
    }

    /// Simulated times (s) of the first and of the last message.
    #[must_use]
    pub fn span(&self) -> Option<(f64, f64)> {
        let spans = || self.channels.iter().filter_map(|channel| channel.span);
        let first = spans().map(|span| span.0).min()?;
        Some((seconds(first), spans().map(|span| span.1).max().map(seconds)?))
    }

    fn interval(&self, channel: &ChannelReport) -> Option<u64> {
        let key = match (channel.schema.as_str(), channel.encoding.as_str()) {
            (CLOUD, _) => FRAME_INTERVAL,
            (_, "json") => SERIES_INTERVAL,
            _ => return None,
        };
        let interval = self.entry(DERIVED, key)?.parse().ok().map(nanos)?;
        (0 < interval && interval < u64::MAX).then_some(interval)
    }

    /// Compares the end of each channel with that of the run, and forgets the gaps of those that keep no beat.
    fn finish(&mut self) {
        let newest = self.channels.iter().filter_map(|channel| channel.span).map(|span| span.1).max().unwrap_or(0);
        let end = self.entry(END, "time [s]").and_then(|time| time.parse().ok()).map(nanos);
        for channel in &mut self.channels {
            let intervals = channel.messages.saturating_sub(1);
            if channel.regular == 0 || 2 * channel.regular < intervals {
                (channel.expected, channel.gaps) = (None, 0);
            }
            if let (Some(expected), Some((_, last))) = (channel.expected, channel.span) {
                // A run that ended writes what is due at its end; one that was torn may not have come to write the others.
                channel.gaps += match end {
                    Some(end) => (end.saturating_sub(last) + 2) / expected,
                    None => left_out(newest.saturating_sub(last), expected),
                };
            }
        }
    }
}

/// Outputs that are missing in a time that should be `expected`.
fn left_out(interval: u64, expected: u64) -> u64 {
    // An output that is half an interval late is a different one.
    (interval.saturating_add(expected / 2) / expected).saturating_sub(1)
}

/// Reads the log at `path`, whole or torn, and says what is in it.
///
/// # Errors
/// The file cannot be read or is no log.
pub fn examine_log(path: &Path) -> Result<Examination, LogError> {
    let mut found = Examination {
        ending: Ending { bytes: 0, whole: false },
        library: String::new(),
        channels: Vec::new(),
        attachments: Vec::new(),
        metadata: BTreeMap::new(),
        chunks: [0; 3],
        damages: Vec::new(),
    };
    let ending = read_log(path, |piece| {
        found.take(piece);
        Ok(())
    })?;
    found.ending = ending;
    found.finish();
    Ok(found)
}

/// Most damages that are kept.
const MOST_DAMAGES: usize = 1000;

impl Examination {
    fn take(&mut self, piece: Piece) {
        match piece {
            Piece::Library(library) => library.clone_into(&mut self.library),
            Piece::Channel(channel) => drop(self.channel(channel)),
            Piece::Message(channel, header, data) => self.message(channel, &header, data),
            Piece::Attachment(file) => {
                self.attachments.push((file.name.clone(), file.media_type.clone(), file.data.len() as u64));
            }
            Piece::Metadata(record) => drop(self.metadata.insert(record.name.clone(), record.metadata.clone())),
            Piece::Chunk(ChunkHeader { compressed_size, uncompressed_size, .. }) => {
                self.chunks[0] += 1;
                self.chunks[1] += compressed_size;
                self.chunks[2] += uncompressed_size;
            }
            Piece::Damage(damage) if self.damages.len() < MOST_DAMAGES => self.damages.push(damage),
            Piece::Damage(_) => {}
        }
    }

    fn channel(&mut self, channel: &Channel) -> usize {
        let schema = channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
        let same = |one: &ChannelReport| one.topic == channel.topic && one.schema == schema;
        if let Some(known) = self.channels.iter().position(same) {
            return known;
        }
        let described = channel.schema.as_ref().filter(|schema| schema.encoding == "jsonschema");
        self.channels.push(ChannelReport {
            topic: channel.topic.clone(),
            schema: schema.to_owned(),
            encoding: channel.message_encoding.clone(),
            fields: described.map_or_else(Vec::new, |schema| named(described_fields(&schema.data))),
            messages: 0,
            bytes: 0,
            span: None,
            intervals: None,
            expected: None,
            missing: 0,
            gaps: 0,
            regular: 0,
            next: 0,
        });
        self.channels.len() - 1
    }

    fn message(&mut self, channel: &Channel, header: &MessageHeader, data: &[u8]) {
        let index = self.channel(channel);
        if self.channels[index].messages == 0 {
            self.channels[index].expected = self.interval(&self.channels[index]);
            if self.channels[index].schema == CLOUD {
                self.channels[index].fields = self.cloud_fields(data);
            }
            // Ours count from 0; others may begin where they like.
            if !self.library.starts_with("storegga") {
                self.channels[index].next = header.sequence;
            }
        }
        self.channels[index].message(header, data.len() as u64);
    }

    /// Fields of a cloud, with the units that the metadata give them.
    fn cloud_fields(&self, cloud: &[u8]) -> Vec<(String, String)> {
        let fields = PointCloud::decode(cloud).map(|cloud| cloud.fields).unwrap_or_default();
        let unit = |name: &str| self.entry("units", name).unwrap_or_default().to_owned();
        fields.into_iter().map(|field| (field.name.clone(), unit(&field.name))).collect()
    }
}

impl ChannelReport {
    fn message(&mut self, header: &MessageHeader, bytes: u64) {
        self.messages += 1;
        self.bytes += bytes;
        self.missing += u64::from(header.sequence.saturating_sub(self.next));
        self.next = header.sequence.wrapping_add(1);
        let time = header.log_time;
        let Some((first, last)) = self.span else {
            self.span = Some((time, time));
            return;
        };
        let interval = time.saturating_sub(last);
        let (least, greatest) = self.intervals.unwrap_or((interval, interval));
        self.intervals = Some((least.min(interval), greatest.max(interval)));
        self.span = Some((first.min(time), last.max(time)));
        if let Some(expected) = self.expected {
            // Both times are rounded to a nanosecond.
            self.regular += u64::from(interval.abs_diff(expected) <= 2);
            self.gaps += left_out(interval, expected);
        }
    }
}

/// Names and units of the fields of a series; words have no unit.
fn named(fields: Vec<(String, Option<String>)>) -> Vec<(String, String)> {
    fields.into_iter().map(|(name, unit)| (name, unit.unwrap_or_default())).collect()
}
