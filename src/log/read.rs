//! Reading a log that may be torn or damaged, from its start to its end, in memory for one chunk at a time.
//!
//! Records follow each other, each behind its opcode and its length. Where one is damaged, reading goes on with the next
//! record, if there are some where the length says; otherwise with the next compressed chunk that can be found and whose checksum
//! is right. A chunk whose checksum is wrong is left out whole: no message in it can be trusted.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read};
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::records::{ChunkHeader, MessageHeader, Metadata, op};
use mcap::{Attachment, Channel, MAGIC, Schema};

use super::LogError;
use super::chunk::unpack_checked;
use super::record::{HEAD, LONGEST_CHUNK_HEADER, Record, chunk_header, footer, is_opcode, parse, split, split_head};

/// What is found in a log, in the order of the file.
#[derive(Debug)]
pub enum Piece<'a> {
    /// The library that wrote the log.
    Library(&'a str),
    /// A channel, with its schema; again if the log changes it.
    Channel(&'a Channel<'static>),
    /// A message: its channel, its numbers and times (ns), its bytes.
    Message(&'a Channel<'static>, MessageHeader, &'a [u8]),
    /// An attached file.
    Attachment(&'a Attachment<'a>),
    /// A metadata record.
    Metadata(&'a Metadata),
    /// The end of a whole chunk, whose messages came before.
    Chunk(&'a ChunkHeader),
    /// Something that cannot be read.
    Damage(Damage),
}

/// A part of a log that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damage {
    /// Where it starts (bytes from the start of the file).
    pub offset: u64,
    /// Bytes that are left out; 0 where a log ends too early between two records.
    pub bytes: u64,
    /// What is wrong there.
    pub what: String,
}

/// How a log was read to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ending {
    /// Length of the file (bytes).
    pub bytes: u64,
    /// Whether nothing in it is damaged and it ends as it should, with an index.
    pub whole: bool,
}

/// Reads the log at `path` and shows `visit` every piece of it. Whatever the bytes are, that ends and does not panic; the memory
/// is that of the largest chunk. A log that is still written ends where it ended at the start.
///
/// # Errors
/// The file cannot be read or is no log, and what `visit` says.
pub fn read_log(path: &Path, visit: impl FnMut(Piece<'_>) -> Result<(), LogError>) -> Result<Ending, LogError> {
    Reader::open(path, visit)?.read()
}

/// Compressed and uncompressed bytes of the largest record that is believed: a frame of some eighty million particles.
const LARGEST: u64 = 1 << 32;

/// Why a record is not taken.
pub(super) enum Fault {
    /// It is damaged; the log goes on.
    Damage(Cow<'static, str>),
    /// The file cannot be read any further, or nobody wants to.
    Stop(LogError),
}

impl<T: Into<Cow<'static, str>>> From<T> for Fault {
    fn from(what: T) -> Self {
        Self::Damage(what.into())
    }
}

pub(super) struct Reader<V> {
    path: PathBuf,
    file: BufReader<File>,
    pub(super) size: u64,
    /// Offset of the next byte.
    pub(super) at: u64,
    /// Where the file is; it is ahead while a record is only looked at.
    file_at: u64,
    /// CRC-32 of everything so far, unless a part was left out.
    pub(super) checksum: Option<crc32fast::Hasher>,
    /// Where the index starts, if it is whole.
    summary_start: Option<u64>,
    schemas: BTreeMap<u16, Arc<Schema<'static>>>,
    channels: BTreeMap<u16, Channel<'static>>,
    /// A record, and the records of a chunk; kept so that their memory is used again.
    pub(super) body: Vec<u8>,
    records: Vec<u8>,
    is_damaged: bool,
    visit: V,
}

impl<V: FnMut(Piece<'_>) -> Result<(), LogError>> Reader<V> {
    fn open(path: &Path, visit: V) -> Result<Self, LogError> {
        let fail = |error: std::io::Error| LogError::new(path, "read", error);
        let file = File::open(path).map_err(fail)?;
        let data = file.metadata().map_err(fail)?;
        let mut file = BufReader::new(file);
        let mut magic = [0; MAGIC.len()];
        let why = match file.read_exact(&mut magic) {
            _ if data.is_dir() => "it is a folder",
            _ if !data.is_file() => "it is no plain file",
            _ if data.len() == 0 => "it is empty",
            Ok(()) if magic == MAGIC => "",
            Err(error) if error.kind() != ErrorKind::UnexpectedEof => return Err(fail(error)),
            _ => "it is not a log: it does not begin like an MCAP file",
        };
        if !why.is_empty() {
            return Err(LogError::new(path, "read", why));
        }
        let mut checksum = crc32fast::Hasher::new();
        checksum.update(MAGIC);
        Ok(Self {
            path: path.to_owned(),
            file,
            size: data.len(),
            at: MAGIC.len() as u64,
            file_at: MAGIC.len() as u64,
            checksum: Some(checksum),
            summary_start: None,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            body: Vec::new(),
            records: Vec::new(),
            is_damaged: false,
            visit,
        })
    }

    fn read(mut self) -> Result<Ending, LogError> {
        self.read_summary()?;
        while let Some((opcode, length)) = self.head()? {
            let start = self.at;
            match self.record(opcode, length) {
                Ok(true) => return Ok(Ending { bytes: self.size, whole: !self.is_damaged }),
                Ok(false) => {}
                Err(Fault::Stop(error)) => return Err(error),
                Err(Fault::Damage(what)) => {
                    let next = start.checked_add(HEAD).and_then(|body| body.checked_add(length));
                    self.go_on(start, next, &what)?;
                }
            }
        }
        Ok(Ending { bytes: self.size, whole: false })
    }

    /// The opcode and length of the next record, without reading them for good; `None` at the end of the file.
    fn head(&mut self) -> Result<Option<(u8, u64)>, LogError> {
        if self.at >= self.size {
            self.damage(self.size, 0, "the log ends without its index: it was not closed")?;
            return Ok(None);
        }
        self.fill(self.at, HEAD)?;
        match split_head(&self.body) {
            Some((opcode, length, _)) => Ok(Some((opcode, length))),
            None => {
                self.damage(self.at, self.size - self.at, "the last record is cut off")?;
                Ok(None)
            }
        }
    }

    /// Reads one record; whether the log ends there as it should.
    fn record(&mut self, opcode: u8, length: u64) -> Result<bool, Fault> {
        if !is_opcode(opcode) {
            return Err("here is no record".into());
        }
        if length > self.size - self.at - HEAD.min(self.size - self.at) {
            return Err("a record is cut off, or its length is wrong".into());
        }
        if length > LARGEST {
            return Err("a record of more than four gigabytes".into());
        }
        if opcode == op::CHUNK {
            let header = self.load_chunk(length)?;
            self.chunk_records(&header)?;
            return Ok(false);
        }
        let checksum = self.checksum.clone();
        self.load(HEAD + length)?;
        let body = mem::take(&mut self.body);
        let parsed = parse(opcode, &body[HEAD as usize..]).ok_or(Fault::from("a damaged record"));
        let ends = parsed.and_then(|record| match record {
            Record::DataEnd(crc) => self.data_end(crc, checksum).map(|()| true),
            record => self.take(record).map(|()| false),
        });
        self.body = body;
        ends
    }

    /// The end of the messages: the index must follow.
    fn data_end(&mut self, crc: u32, checksum: Option<crc32fast::Hasher>) -> Result<(), Fault> {
        if self.summary_start.is_none() {
            let (at, rest) = (self.at, self.size - self.at);
            self.damage(at, rest, "the index at the end is cut off or damaged").map_err(Fault::Stop)?;
        }
        let is_right = crc == 0 || checksum.is_none_or(|checksum| checksum.finalize() == crc);
        if !is_right && !self.is_damaged {
            let what =
                "the checksum of the whole log is wrong: something outside of the chunks is not what was written";
            self.damage(0, 0, what).map_err(Fault::Stop)?;
        }
        Ok(())
    }

    /// Takes a record that is no chunk.
    fn take(&mut self, record: Record) -> Result<(), Fault> {
        match record {
            Record::Header { library } => (self.visit)(Piece::Library(library)),
            Record::Schema { id, name, encoding, data } => {
                let (name, encoding, data) = (name.to_owned(), encoding.to_owned(), Cow::Owned(data.to_owned()));
                self.schemas.insert(id, Arc::new(Schema { id, name, encoding, data }));
                Ok(())
            }
            Record::Channel { id, schema, topic, encoding, metadata } => {
                let (topic, message_encoding) = (topic.to_owned(), encoding.to_owned());
                let channel =
                    Channel { id, topic, schema: self.schemas.get(&schema).cloned(), message_encoding, metadata };
                if self.channels.get(&id) == Some(&channel) {
                    return Ok(());
                }
                let shown = (self.visit)(Piece::Channel(&channel));
                self.channels.insert(id, channel);
                shown
            }
            Record::Message(header, data) => match self.channels.get(&header.channel_id) {
                Some(channel) => (self.visit)(Piece::Message(channel, header, data)),
                None => return Err("a message of a channel that is not defined".into()),
            },
            Record::Attachment(attachment) => (self.visit)(Piece::Attachment(&attachment)),
            Record::Metadata(metadata) => (self.visit)(Piece::Metadata(&metadata)),
            Record::DataEnd(_) | Record::Other => Ok(()),
        }
        .map_err(Fault::Stop)
    }

    /// Reads a chunk whose record has `length` bytes and unpacks its records.
    pub(super) fn load_chunk(&mut self, length: u64) -> Result<ChunkHeader, Fault> {
        // Its sizes are compared before memory is asked for: a length that is wrong is wrong in one place only.
        self.fill(self.at, HEAD + LONGEST_CHUNK_HEADER as u64).map_err(Fault::Stop)?;
        let read = self.body.get(HEAD as usize..).and_then(chunk_header);
        let (header, header_length) = read.ok_or(Fault::from("the header of a chunk is damaged"))?;
        if header_length.checked_add(header.compressed_size) != Some(length) || header.uncompressed_size > LARGEST {
            return Err("the sizes of a chunk do not fit".into());
        }
        let start = self.at;
        self.load(HEAD + length)?;
        let stored = &self.body[(HEAD + header_length) as usize..];
        let is_right = unpack_checked(stored, &header, &mut self.records)?;
        if is_right {
            return Ok(header);
        }
        self.at = start;
        let (from, to) = (seconds(header.message_start_time), seconds(header.message_end_time));
        Err(Fault::Damage(format!("a chunk with messages from {from} s to {to} s is damaged").into()))
    }

    /// Takes the records of the chunk that was unpacked.
    fn chunk_records(&mut self, header: &ChunkHeader) -> Result<(), Fault> {
        let records = mem::take(&mut self.records);
        let (mut rest, mut lost) = (records.as_slice(), 0_u64);
        while !rest.is_empty() {
            let Some((opcode, body, next)) = split(rest) else {
                lost += 1;
                break;
            };
            match parse(opcode, body).ok_or(Fault::from("a damaged record")).and_then(|record| self.take(record)) {
                Ok(()) => {}
                Err(Fault::Damage(_)) => lost += 1,
                stop @ Err(Fault::Stop(_)) => return stop,
            }
            rest = next;
        }
        self.records = records;
        if lost > 0 {
            let what = format!("{lost} records of a chunk are damaged, or messages of channels that are not defined");
            self.damage(self.at, 0, &what).map_err(Fault::Stop)?;
        }
        (self.visit)(Piece::Chunk(header)).map_err(Fault::Stop)
    }

    /// Looks for the index at the end. It repeats schemas and channels, so that messages are understood even where the chunk
    /// that defined them is damaged.
    fn read_summary(&mut self) -> Result<(), LogError> {
        const FOOTER: u64 = HEAD + 20;
        let end = FOOTER + MAGIC.len() as u64;
        let Some(footer_start) = self.size.checked_sub(end).filter(|start| *start >= self.at) else { return Ok(()) };
        self.fill(footer_start, end)?;
        let Some(found) = self.body.strip_suffix(MAGIC).and_then(split).filter(|found| found.0 == op::FOOTER) else {
            return Ok(());
        };
        let Some((start, crc)) = footer(found.1) else { return Ok(()) };
        let start = if start == 0 { footer_start } else { start };
        if start < self.at || start > footer_start || footer_start - start > LARGEST {
            return Ok(());
        }
        // Everything up to the checksum itself, which is the last of the footer.
        self.fill(start, footer_start + FOOTER - start)?;
        let checked = self.body.len().saturating_sub(size_of::<u32>());
        if crc != 0 && crc32fast::hash(&self.body[..checked]) != crc {
            return Ok(());
        }
        self.summary_start = Some(start);
        let summary = mem::take(&mut self.body);
        let mut rest = summary.as_slice();
        while let Some((opcode, body, next)) = split(rest) {
            if let Some(record @ (Record::Schema { .. } | Record::Channel { .. })) = parse(opcode, body)
                && let Err(Fault::Stop(error)) = self.take(record)
            {
                return Err(error);
            }
            rest = next;
        }
        Ok(())
    }

    pub(super) fn damage(&mut self, offset: u64, bytes: u64, what: &str) -> Result<(), LogError> {
        self.is_damaged = true;
        (self.visit)(Piece::Damage(Damage { offset, bytes, what: what.to_owned() }))
    }

    /// Reads the next `length` bytes into the body.
    fn load(&mut self, length: u64) -> Result<(), Fault> {
        self.fill(self.at, length).map_err(Fault::Stop)?;
        if self.body.len() as u64 != length {
            return Err("the file became shorter while it was read".into());
        }
        self.at += length;
        if let Some(checksum) = &mut self.checksum {
            checksum.update(&self.body);
        }
        Ok(())
    }

    /// Reads up to `length` bytes at `offset` into the body.
    pub(super) fn fill(&mut self, offset: u64, length: u64) -> Result<(), LogError> {
        let fail = |error| LogError::new(&self.path, "read", error);
        // Relative, for what is near is in the buffer already.
        self.file.seek_relative(offset.wrapping_sub(self.file_at).cast_signed()).map_err(fail)?;
        self.body.clear();
        let read = self.file.by_ref().take(length).read_to_end(&mut self.body).map_err(fail)?;
        self.file_at = offset + read as u64;
        Ok(())
    }
}

/// Nanoseconds in seconds.
pub(super) fn seconds(nanos: u64) -> f64 {
    nanos as f64 / 1e9
}
