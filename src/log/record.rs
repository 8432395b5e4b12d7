//! The records of an MCAP file, parsed from bytes that may be damaged.
//!
//! The library's own parser trusts lengths that it reads: it reserves memory for a string of four gigabytes and panics at an
//! attachment that is too short. Here a length that reaches beyond its record is an error, and nothing is allocated for it.
//! The layout is that of <https://mcap.dev/spec>.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::str;

use mcap::Attachment;
use mcap::records::{ChunkHeader, MessageHeader, Metadata, op};

/// Opcode and length in front of every record.
pub(super) const HEAD: u64 = 9;

/// One record.
#[derive(Debug)]
pub(super) enum Record<'a> {
    Header {
        library: &'a str,
    },
    Schema {
        id: u16,
        name: &'a str,
        encoding: &'a str,
        data: &'a [u8],
    },
    Channel {
        id: u16,
        schema: u16,
        topic: &'a str,
        encoding: &'a str,
        metadata: BTreeMap<String, String>,
    },
    Message(MessageHeader, &'a [u8]),
    Attachment(Attachment<'a>),
    Metadata(Metadata),
    /// With the CRC-32 of everything before it; 0 if there is none.
    DataEnd(u32),
    /// Indices, statistics, and records that nobody knows.
    Other,
}

/// Whether a record can have this opcode.
pub(super) fn is_opcode(opcode: u8) -> bool {
    (op::HEADER..=op::DATA_END).contains(&opcode) || opcode >= 0x80
}

/// Opcode, length of the body, and what follows.
pub(super) fn split_head(bytes: &[u8]) -> Option<(u8, u64, &[u8])> {
    let (opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    Some((*opcode, u64::from_le_bytes(*length), rest))
}

/// The next record in `bytes`: its opcode, its body and what follows it.
pub(super) fn split(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (opcode, length, rest) = split_head(bytes)?;
    let (body, rest) = rest.split_at_checked(usize::try_from(length).ok()?)?;
    Some((opcode, body, rest))
}

/// Parses the body of a record; `None` if it is damaged.
pub(super) fn parse(opcode: u8, body: &[u8]) -> Option<Record<'_>> {
    let mut body = Fields(body);
    Some(match opcode {
        op::HEADER => {
            body.text()?;
            Record::Header { library: body.text()? }
        }
        op::SCHEMA => {
            let (id, name, encoding) = (body.u16()?, body.text()?, body.text()?);
            Record::Schema { id, name, encoding, data: body.bytes()? }
        }
        op::CHANNEL => {
            let (id, schema, topic, encoding) = (body.u16()?, body.u16()?, body.text()?, body.text()?);
            Record::Channel { id, schema, topic, encoding, metadata: body.map()? }
        }
        op::MESSAGE => {
            let (channel_id, sequence) = (body.u16()?, body.u32()?);
            let (log_time, publish_time) = (body.u64()?, body.u64()?);
            Record::Message(MessageHeader { channel_id, sequence, log_time, publish_time }, body.0)
        }
        op::ATTACHMENT => Record::Attachment(attachment(body)?),
        op::METADATA => Record::Metadata(Metadata { name: body.text()?.to_owned(), metadata: body.map()? }),
        op::DATA_END => Record::DataEnd(body.u32()?),
        _ => Record::Other,
    })
}

fn attachment<'a>(mut body: Fields<'a>) -> Option<Attachment<'a>> {
    let whole = body.0;
    let (log_time, create_time) = (body.u64()?, body.u64()?);
    let (name, media_type) = (body.text()?.to_owned(), body.text()?.to_owned());
    let length = usize::try_from(body.u64()?).ok()?;
    let data = body.take(length)?;
    let checked = &whole[..whole.len() - body.0.len()];
    let crc = body.u32()?;
    let is_right = crc == 0 || crc == crc32fast::hash(checked);
    is_right.then_some(Attachment { log_time, create_time, name, media_type, data: Cow::Borrowed(data) })
}

/// The fixed part of a chunk in front of the name of its compression, and that of its compressed size behind it.
const CHUNK_FIXED: usize = 32;

/// Longest header of a chunk whose compression is known.
pub(super) const LONGEST_CHUNK_HEADER: usize = CHUNK_FIXED + "zstd".len() + 8;

/// Parses the start of the body of a chunk; returns the length of its header besides.
pub(super) fn chunk_header(body: &[u8]) -> Option<(ChunkHeader, u64)> {
    let mut fields = Fields(body);
    let (message_start_time, message_end_time) = (fields.u64()?, fields.u64()?);
    let (uncompressed_size, uncompressed_crc) = (fields.u64()?, fields.u32()?);
    let (compression, compressed_size) = (fields.text()?.to_owned(), fields.u64()?);
    let length = CHUNK_FIXED + compression.len() + 8;
    let header = ChunkHeader {
        message_start_time,
        message_end_time,
        uncompressed_size,
        uncompressed_crc,
        compression,
        compressed_size,
    };
    Some((header, length as u64))
}

/// Where the summary starts and its CRC-32, from the body of a footer.
pub(super) fn footer(body: &[u8]) -> Option<(u64, u32)> {
    let mut body = Fields(body);
    let (start, _) = (body.u64()?, body.u64()?);
    Some((start, body.u32()?))
}

/// What is left of a record.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// Bytes behind their length.
    fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = usize::try_from(self.u32()?).ok()?;
        self.take(length)
    }

    fn text(&mut self) -> Option<&'a str> {
        str::from_utf8(self.bytes()?).ok()
    }

    fn map(&mut self) -> Option<BTreeMap<String, String>> {
        let mut entries = Fields(self.bytes()?);
        let mut map = BTreeMap::new();
        while !entries.0.is_empty() {
            map.insert(entries.text()?.to_owned(), entries.text()?.to_owned());
        }
        Some(map)
    }
}
