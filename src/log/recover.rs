//! Making a whole log of a torn one.

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::Path;

use mcap::Channel;
use mcap::records::MessageHeader;

use super::place::is_written;
use super::read::seconds;
use super::{Damage, Ending, LogError, LogWriter, Piece, read_log};
use crate::replace::{part_of, put_in_place};

/// What was copied of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Copied {
    /// How the log ended.
    pub ending: Ending,
    /// Its channels, in the order in which they were met.
    pub channels: Vec<CopiedChannel>,
    /// Parts that could not be read, in the order of the file: the first thousand.
    pub damages: Vec<Damage>,
    /// Bytes of all parts that could not be read.
    pub lost_bytes: u64,
    /// Attachments and metadata records.
    pub others: u64,
}

/// What was copied of a channel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CopiedChannel {
    /// Its topic.
    pub topic: String,
    /// Messages that were copied.
    pub messages: u64,
    /// Messages that are missing between those that were copied, by their numbers.
    pub missing: u64,
    /// Greatest simulated time of a message (ns).
    last: Option<u64>,
    /// Number that the next message should have.
    next: Option<u32>,
    /// Channel in the copy.
    id: u16,
}

impl CopiedChannel {
    /// Greatest simulated time (s) of a message.
    #[must_use]
    pub fn last_time(&self) -> Option<f64> {
        self.last.map(seconds)
    }
}

impl Copied {
    /// All messages that were copied.
    #[must_use]
    pub fn messages(&self) -> u64 {
        self.channels.iter().map(|channel| channel.messages).sum()
    }

    /// Greatest simulated time (s) of a message that was copied.
    #[must_use]
    pub fn last_time(&self) -> Option<f64> {
        self.channels.iter().filter_map(|channel| channel.last).max().map(seconds)
    }
}

/// Most damages that are kept.
const MOST_DAMAGES: usize = 1000;

/// Name of the metadata record that says how a run ended.
pub(super) const END: &str = "end";

/// Copies what can be read of the log at `from`, whole or torn, into `to`, which stays open: series and clouds that are added to it
/// afterwards with the same topic and schema continue the copied ones, their numbering too.
///
/// With `first`, only so many messages are copied, in the order of the file, and the record of how the run ended is left out: a
/// run can go on from there.
///
/// # Errors
/// `from` is no log or cannot be read, or `to` cannot be written.
pub fn copy_log(from: &Path, to: &mut LogWriter, first: Option<u64>) -> Result<Copied, LogError> {
    let most = first.unwrap_or(u64::MAX);
    let ending = Ending { bytes: 0, whole: false };
    let mut copied = Copied { ending, channels: Vec::new(), damages: Vec::new(), lost_bytes: 0, others: 0 };
    copied.ending = read_log(from, |piece| {
        match piece {
            Piece::Channel(channel) => drop(copied.channel(channel, to)?),
            Piece::Message(channel, header, data) if copied.messages() < most => {
                copied.message(channel, header, data, to)?
            }
            Piece::Attachment(file) => {
                to.attach_raw(file)?;
                copied.others += 1;
            }
            Piece::Metadata(record) if first.is_none() || record.name != END => {
                to.metadata_raw(record)?;
                copied.others += 1;
            }
            Piece::Damage(damage) => copied.damage(damage),
            Piece::Library(_) | Piece::Message(..) | Piece::Metadata(_) | Piece::Chunk(_) => {}
        }
        Ok(())
    })?;
    Ok(copied)
}

impl Copied {
    fn channel(&mut self, channel: &Channel, to: &mut LogWriter) -> Result<usize, LogError> {
        let id = to.copy_channel(channel)?;
        let known = self.channels.iter().position(|one| one.id == id);
        Ok(known.unwrap_or_else(|| {
            let topic = channel.topic.clone();
            self.channels.push(CopiedChannel { topic, messages: 0, missing: 0, last: None, next: None, id });
            self.channels.len() - 1
        }))
    }

    fn message(
        &mut self,
        channel: &Channel,
        header: MessageHeader,
        data: &[u8],
        to: &mut LogWriter,
    ) -> Result<(), LogError> {
        let index = self.channel(channel, to)?;
        let copied = &mut self.channels[index];
        to.copy_message(&MessageHeader { channel_id: copied.id, ..header }, data)?;
        copied.messages += 1;
        copied.missing += u64::from(copied.next.map_or(0, |next| header.sequence.saturating_sub(next)));
        copied.next = Some(header.sequence.wrapping_add(1));
        copied.last = copied.last.max(Some(header.log_time));
        Ok(())
    }

    fn damage(&mut self, damage: Damage) {
        self.lost_bytes += damage.bytes;
        if self.damages.len() < MOST_DAMAGES {
            self.damages.push(damage);
        }
    }
}

/// Makes a whole log at `to` of the torn or damaged one at `from`, which is only read. It is written beside `to` and then put in its
/// place, so that nothing half done is ever there. A metadata record `recovered` in it says what was lost.
///
/// # Errors
/// `from` is no log, holds nothing that can be read, or is `to` itself; `to` cannot be written, is no plain file, or is a log that a
/// run is writing.
pub fn recover_log(from: &Path, to: &Path) -> Result<Copied, LogError> {
    if from.is_file() && fs::canonicalize(from).is_ok_and(|from| fs::canonicalize(to).is_ok_and(|to| from == to)) {
        return Err(LogError::new(to, "write", "it is the log that is to be recovered"));
    }
    // Held until the new one has its place.
    let _old = old(to)?;
    let part = part_of(to);
    let writer = LogWriter::create(&part)?;
    let copied = write_part(from, writer).and_then(|copied| {
        put_in_place(&part, to).map_err(|error| LogError::new(to, "write", error))?;
        Ok(copied)
    });
    copied.inspect_err(|_| drop(fs::remove_file(&part)))
}

/// The file at `path`, if there is one: it must be one that can be replaced, and no run writes it while it is open.
fn old(path: &Path) -> Result<Option<File>, LogError> {
    let refused = |why: &str| LogError::new(path, "write", why);
    let fail = |error| LogError::new(path, "write", error);
    match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(fail(error)),
        Ok(data) if data.is_dir() => return Err(refused("it is a folder")),
        Ok(data) if !data.is_file() => return Err(refused("it is no plain file, and would be replaced by one")),
        Ok(_) => {}
    }
    let file = File::open(path).map_err(fail)?;
    if is_written(&file) { Err(refused("a run is writing it")) } else { Ok(Some(file)) }
}

fn write_part(from: &Path, mut writer: LogWriter) -> Result<Copied, LogError> {
    let copied = copy_log(from, &mut writer, None)?;
    if copied.messages() == 0 && copied.others == 0 {
        return Err(LogError::new(from, "recover", "nothing in it can be read"));
    }
    let source = from.file_name().unwrap_or(from.as_os_str()).to_string_lossy().into_owned();
    let mut said = vec![
        ("from".to_owned(), source),
        ("messages".to_owned(), copied.messages().to_string()),
        ("lost_bytes".to_owned(), copied.lost_bytes.to_string()),
    ];
    said.extend(copied.last_time().map(|time| ("last_time [s]".to_owned(), time.to_string())));
    for (index, damage) in copied.damages.iter().enumerate() {
        let what = format!("at byte {}, {} bytes: {}", damage.offset, damage.bytes, damage.what);
        said.push((format!("damage.{index:03}"), what));
    }
    writer.metadata("recovered", &said)?;
    writer.finish()?;
    Ok(copied)
}
