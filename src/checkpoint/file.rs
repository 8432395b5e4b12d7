//! The file of a checkpoint.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | how every checkpoint begins |
//! | 4 | version of the format |
//! | 8 | length of the body |
//! | 4 | CRC-32 of version, length and body |
//! | … | the body: version of the program, [`About`], the state, in [postcard](https://postcard.jamesmunns.com) |
//!
//! Numbers are little endian. These four fields stay in every version of the format; a program reads its own version only,
//! because another one would not compute the same bits.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::state::{encode, take};
use crate::error::UserError;
use crate::log::LogMark;

/// How every checkpoint begins.
pub(super) const MAGIC: [u8; 8] = *b"\x89STOCKP\n";

/// Version of the format. It changes with [`About`] and with how state is written.
const FORMAT: u32 = 3;

/// Bytes before the body.
const HEAD: usize = MAGIC.len() + 4 + 8 + 4;

/// How a run was started.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// Folder in which the run was started.
    pub folder: PathBuf,
    /// Scene file, as seen from there.
    pub scene: PathBuf,
    /// Overrides of the command line.
    pub overrides: Vec<String>,
    /// End (s) of the run, if it is not that of the scene.
    pub until: Option<f64>,
    /// Interval (s) of checkpoints in simulated time.
    pub every: Option<f64>,
    /// Interval (s) of checkpoints in time of the clock on the wall.
    pub every_wall: Option<f64>,
    /// The log, as seen from the folder.
    pub log: PathBuf,
}

/// What a checkpoint says besides the state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// How the run was started.
    pub origin: Origin,
    /// CRC-32 of the executable, if it could be read.
    pub program: Option<u32>,
    /// The text of the scene with all overrides in it.
    pub text: String,
    /// Files that the scene reads, with the length and the CRC-32 of each.
    pub files: Vec<(PathBuf, u64, u32)>,
    /// How much of the log was written.
    pub mark: LogMark,
    /// Simulated time (s).
    pub time: f64,
    /// Simulated time (s) at which the run is to end.
    pub end_time: f64,
    /// Whether it has ended there. The state may be one of a step or two before: that from which it can go on to a later end.
    pub is_done: bool,
    /// Steps done.
    pub step: u64,
}

/// A checkpoint as read.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// What it is of.
    pub about: About,
    /// The state, for [`restore_state`](super::restore_state).
    pub state: Vec<u8>,
}

impl Checkpoint {
    /// Reads the checkpoint at `path`.
    ///
    /// # Errors
    /// A file that cannot be read, is no checkpoint, is damaged, cut off, or of another version of the program.
    pub fn read(path: &Path) -> Result<Self, UserError> {
        let bytes = fs::read(path)
            .map_err(|error| UserError::plain(format!("cannot read the checkpoint {}: {error}", path.display())))?;
        Self::parse(&bytes).map_err(|why| {
            let error = UserError::plain(format!("cannot resume from {}: {}", path.display(), why.what));
            why.help.into_iter().fold(error, UserError::help)
        })
    }

    /// Whether it was written by another build of the program: then the bits may differ.
    #[must_use]
    pub fn is_of_another_build(&self) -> bool {
        self.about.program.zip(program_checksum()).is_some_and(|(then, now)| then != now)
    }

    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Refusal> {
        let Some((head, body)) = bytes.split_first_chunk::<HEAD>().filter(|(head, _)| head.starts_with(&MAGIC)) else {
            let is_cut = MAGIC.starts_with(&bytes[..bytes.len().min(MAGIC.len())]) && !bytes.is_empty();
            let what = if is_cut { "it is cut off" } else { "it is not a checkpoint" };
            return Err(what.into());
        };
        let (format, length, crc) = split_head(head);
        if length > body.len() as u64 {
            return Err(format!("it is cut off: {} of {length} bytes are there", body.len()).as_str().into());
        }
        if length < body.len() as u64 || crc != checksum(format, body) {
            return Err("it is damaged: its checksum is wrong".into());
        }
        let own = env!("CARGO_PKG_VERSION");
        let other = |version: &str| Refusal {
            what: format!("it is of storegga {version}, and this is storegga {own}: it would not compute the same"),
            help: Some("resume it with the program that wrote it"),
        };
        if format != FORMAT {
            return Err(other(&format!("with format {format} of checkpoints (this one has format {FORMAT})")));
        }
        let (version, rest): (&str, _) = take(body).map_err(|_| "it is damaged: its version cannot be read")?;
        if version != own {
            return Err(other(version));
        }
        let (about, state) = take(rest).map_err(|_| "it is damaged: its head cannot be read")?;
        Ok(Self { about, state: state.to_vec() })
    }
}

/// CRC-32 of the executable.
pub(crate) fn program_checksum() -> Option<u32> {
    let bytes = std::env::current_exe().and_then(fs::read).ok()?;
    Some(crc32fast::hash(&bytes))
}

/// Why a file is not resumed from.
#[derive(Debug)]
pub(super) struct Refusal {
    what: String,
    help: Option<&'static str>,
}

impl Refusal {
    /// Whether it is whole, as far as can be told, and of another version of the program.
    pub(super) fn is_of_another_version(&self) -> bool {
        self.help.is_some()
    }
}

impl From<&str> for Refusal {
    fn from(what: &str) -> Self {
        Self { what: what.to_owned(), help: None }
    }
}

/// Version of the format, length of the body, checksum.
fn split_head(head: &[u8; HEAD]) -> (u32, u64, u32) {
    let number = |from: usize, to: usize| head[from..to].iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte));
    (number(8, 12) as u32, number(12, 20), number(20, 24) as u32)
}

fn checksum(format: u32, body: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&format.to_le_bytes());
    hasher.update(&(body.len() as u64).to_le_bytes());
    hasher.update(body);
    hasher.finalize()
}

/// The bytes of a checkpoint.
///
/// # Errors
/// `about` cannot be written: a path of it is not a text.
pub(super) fn to_bytes(about: &About, state: &[u8]) -> Result<Vec<u8>, String> {
    let mut bytes = vec![0; HEAD];
    encode(env!("CARGO_PKG_VERSION"), &mut bytes)?;
    encode(about, &mut bytes)?;
    bytes.extend_from_slice(state);
    let (head, body) = bytes.split_at_mut(HEAD);
    head[..8].copy_from_slice(&MAGIC);
    head[8..12].copy_from_slice(&FORMAT.to_le_bytes());
    head[12..20].copy_from_slice(&(body.len() as u64).to_le_bytes());
    head[20..24].copy_from_slice(&checksum(FORMAT, body).to_le_bytes());
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn about() -> About {
        About {
            origin: Origin {
                folder: "/home/ann".into(),
                scene: "tank.ron".into(),
                overrides: vec!["spacing=0.1".to_owned()],
                until: None,
                every: Some(0.1),
                every_wall: None,
                log: "runs/tank.mcap".into(),
            },
            program: None,
            text: "Scene()".to_owned(),
            files: Vec::new(),
            mark: LogMark::default(),
            time: 0.25,
            end_time: 1.0,
            is_done: false,
            step: 1000,
        }
    }

    fn bytes() -> Vec<u8> {
        to_bytes(&about(), &[7; 100]).expect("it can be written")
    }

    fn refusal(bytes: &[u8]) -> String {
        Checkpoint::parse(bytes).expect_err("it is refused").what
    }

    #[test]
    fn what_was_written_is_read() {
        let read = Checkpoint::parse(&bytes()).expect("it is whole");
        assert_eq!(read, Checkpoint { about: about(), state: vec![7; 100] });
    }

    #[test]
    fn a_checkpoint_that_is_cut_off_is_refused_wherever_it_ends() {
        let whole = bytes();
        for end in 1..whole.len() {
            assert!(refusal(&whole[..end]).contains("cut off"), "{end} bytes");
        }
        assert!(refusal(&[]).contains("not a checkpoint"));
        assert!(refusal(b"Scene(dimension: 2, spacing: 0.01)").contains("not a checkpoint"));
    }

    #[test]
    fn every_bit_that_is_wrong_is_found() {
        let whole = bytes();
        for bit in 0..8 * whole.len() {
            let mut damaged = whole.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(!refusal(&damaged).is_empty(), "bit {bit}");
        }
        assert!(refusal(&[&whole[..], b"x"].concat()).contains("damaged"));
        assert!(Checkpoint::parse(&whole[1..]).is_err_and(|refused| !refused.is_of_another_version()));
    }

    #[test]
    fn other_versions_are_refused_by_name() {
        let resealed = |change: fn(&mut Vec<u8>) -> u32| {
            let mut bytes = bytes();
            let format = change(&mut bytes);
            let crc = checksum(format, &bytes[HEAD..]);
            bytes[8..12].copy_from_slice(&format.to_le_bytes());
            bytes[20..24].copy_from_slice(&crc.to_le_bytes());
            let refused = Checkpoint::parse(&bytes).expect_err("it is refused");
            assert!(refused.is_of_another_version());
            refused.what
        };
        let later = resealed(|_| FORMAT + 1);
        assert!(later.contains(&format!("format {}", FORMAT + 1)), "{later}");
        let program = resealed(|bytes| {
            bytes[HEAD + 1] = b'9';
            FORMAT
        });
        assert!(program.contains("it is of storegga 9"), "{program}");
    }
}
