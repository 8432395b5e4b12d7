//! Going on behind a damaged part of a log: where the next record is.

use mcap::MAGIC;
use mcap::records::op;

use super::read::{Fault, Reader};
use super::record::{HEAD, is_opcode, split_head};
use super::{LogError, Piece};

/// How the name of its compression stands in a chunk, and where in its record: what a search for a chunk goes by.
const MARK: &[u8; 8] = b"\x04\0\0\0zstd";
const MARK_OFFSET: u64 = HEAD + 28;

impl<V: FnMut(Piece<'_>) -> Result<(), LogError>> Reader<V> {
    /// Tells of the damage at `start` and goes on behind it: at `next` if a record is there, else at the next chunk.
    pub(super) fn go_on(&mut self, start: u64, next: Option<u64>, what: &str) -> Result<(), LogError> {
        let next = match next {
            Some(next) if self.are_records(next)? => next,
            _ => self.find_chunk(start + 1)?,
        };
        self.damage(start, next - start, what)?;
        self.checksum = None;
        self.at = next;
        Ok(())
    }

    /// Whether records can follow each other from `offset` on. One head alone can be chance: so are some bytes of every chunk.
    fn are_records(&mut self, mut offset: u64) -> Result<bool, LogError> {
        const HEADS: usize = 8;
        for _ in 0..HEADS {
            let Some((opcode, length)) = self.plausible_head(offset)? else { return Ok(offset == self.size) };
            offset += HEAD + length;
            if opcode == op::FOOTER {
                return Ok(offset + MAGIC.len() as u64 == self.size);
            }
        }
        Ok(true)
    }

    /// Opcode and length of the record at `offset`, if there can be one.
    fn plausible_head(&mut self, offset: u64) -> Result<Option<(u8, u64)>, LogError> {
        let Some(rest) = self.size.checked_sub(offset).and_then(|rest| rest.checked_sub(HEAD)) else { return Ok(None) };
        self.fill(offset, HEAD)?;
        let head = split_head(&self.body).map(|(opcode, length, _)| (opcode, length));
        Ok(head.filter(|(opcode, length)| is_opcode(*opcode) && *length <= rest))
    }

    /// Offset of the first chunk from `from` on that is whole; the end of the file if there is none.
    fn find_chunk(&mut self, from: u64) -> Result<u64, LogError> {
        let mut from = from + MARK_OFFSET;
        while let Some(mark) = self.find_mark(from)? {
            let start = mark - MARK_OFFSET;
            self.at = start;
            if let Some((op::CHUNK, length)) = self.plausible_head(start)? {
                match self.load_chunk(length) {
                    Ok(_) => return Ok(start),
                    Err(Fault::Stop(error)) => return Err(error),
                    Err(Fault::Damage(_)) => {}
                }
            }
            from = mark + 1;
        }
        Ok(self.size)
    }

    /// Offset of the first [`MARK`] from `from` on.
    fn find_mark(&mut self, mut from: u64) -> Result<Option<u64>, LogError> {
        const BLOCK: u64 = 1 << 20;
        while from < self.size {
            self.fill(from, BLOCK)?;
            if self.body.is_empty() {
                break;
            }
            if let Some(found) = self.body.windows(MARK.len()).position(|bytes| bytes == MARK) {
                return Ok(Some(from + found as u64));
            }
            // Blocks overlap by what a mark across their border needs.
            from += (self.body.len().saturating_sub(MARK.len() - 1) as u64).max(1);
        }
        Ok(None)
    }
}
