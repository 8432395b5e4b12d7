//! Unpacking the chunks of a log that may be damaged.

use std::borrow::Cow;
use std::io::{self, Read, Write};

use mcap::records::ChunkHeader;
use zstd::stream::read::Decoder;

/// Largest window that a compressed chunk may ask the memory for, as a power of two: that of zstd's level 19.
const WINDOW_LOG: u32 = 23;

/// Unpacks the records of a chunk into `records`; whether they have the length and the checksum that its header tells.
///
/// It is unpacked once to see that, and once to keep it: damaged bytes can unpack to gigabytes.
///
/// # Errors
/// A compression that is not read.
pub(super) fn unpack_checked(
    stored: &[u8],
    header: &ChunkHeader,
    records: &mut Vec<u8>,
) -> Result<bool, Cow<'static, str>> {
    let mut found = Checksum::default();
    let is_right = unpack(stored, header, &mut found)?.is_ok()
        && found.length == header.uncompressed_size
        && (header.uncompressed_crc == 0 || found.crc.finalize() == header.uncompressed_crc);
    records.clear();
    Ok(is_right && unpack(stored, header, records)?.is_ok())
}

/// Unpacks the records of a chunk into `sink`.
fn unpack(stored: &[u8], header: &ChunkHeader, sink: &mut impl Write) -> Result<io::Result<u64>, Cow<'static, str>> {
    match header.compression.as_str() {
        "" => Ok(sink.write_all(stored).map(|()| stored.len() as u64)),
        "zstd" => Ok(Decoder::with_buffer(stored).and_then(|mut decoder| {
            decoder.window_log_max(WINDOW_LOG)?;
            io::copy(&mut decoder.take(header.uncompressed_size.saturating_add(1)), sink)
        })),
        other => Err(format!("a chunk in a compression that is not read: {other}").into()),
    }
}

/// Counts and checks bytes and forgets them.
#[derive(Default)]
struct Checksum {
    length: u64,
    crc: crc32fast::Hasher,
}

impl Write for Checksum {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.length += bytes.len() as u64;
        self.crc.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
