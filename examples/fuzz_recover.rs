//! Damages a small log in every way and recovers it: `cargo run --example fuzz_recover -- --seconds 60`.
//!
//! Whatever the bytes are, `recover` and `doctor` must end, not panic and not ask for much memory; and whatever was recovered
//! must be read by the strict reader of the `mcap` library, message for message, and be whole to `doctor`.

mod fuzz;

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{self, ExitCode};

use mcap::records::op;
use mcap::{MessageStream, Summary};
use storegga::app::{PaperPlugins, StopFlag, open, run};
use storegga::log::{LogWriter, close_log, copy_log, examine_log, open_log, recover_log};
use storegga::scene::Document;

use fuzz::{Random, fuzz};

const TANK: &str = r#"Scene(
    dimension: 2, spacing: 0.02, gravity: (0.0, -9.81), end_time: 0.03,
    phases: {"water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001))},
    walls: {"tank": (shape: Box(min: (0.0, 0.0), max: (0.1, 0.2)))},
    fluids: [(phase: "water", shape: Box(min: (0.0, 0.0), max: (0.1, 0.1)))],
    log: (particles: 0.005, series: 0.0025),
)"#;

/// Memory (bytes) that one log may take.
const MOST_MEMORY: usize = 64 << 20;

fn main() -> ExitCode {
    let folder = std::env::temp_dir().join(format!("storegga-fuzz-{}", process::id()));
    fs::create_dir_all(&folder).expect("the folder for temporary files can be written");
    let log = whole_log(&folder.join("seed.mcap"));
    let files = [folder.join("torn.mcap"), folder.join("out.mcap"), folder.join("copy.mcap")];
    let code = fuzz("recover", MOST_MEMORY, |random| {
        let mut bytes = log.clone();
        for _ in 0..=random.below(3) {
            damage(&mut bytes, random);
        }
        check(&bytes, &files, random);
    });
    if code == ExitCode::SUCCESS {
        let _ = fs::remove_dir_all(&folder);
    }
    code
}

/// The log of a short run.
fn whole_log(path: &Path) -> Vec<u8> {
    let scene = Document::parse("tank.ron", TANK).expect("the scene is right");
    let mut app = open(PaperPlugins, scene).expect("the scene is right");
    open_log(app.world_mut(), path, 0.03).expect("the log can be written");
    let end = run(app.world_mut(), 0.03, &StopFlag::default(), |_| {});
    close_log(app.world_mut(), &end).expect("the log can be written");
    fs::read(path).expect("the log was written")
}

/// Recovers and examines a log and holds the result against the library.
fn check(bytes: &[u8], [torn, out, copy]: &[PathBuf; 3], random: &mut Random) {
    fs::write(torn, bytes).expect("the log can be written");
    let examined = examine_log(torn);
    let recovered = recover_log(torn, out);
    assert_eq!(examined.is_ok(), bytes.starts_with(mcap::MAGIC), "what is a log begins like one");
    let Ok(copied) = recovered else { return };
    let whole = fs::read(out).expect("the log was written");
    let summary = Summary::read(&whole).expect("the index is right").expect("there is an index");
    let read: Result<Vec<_>, _> = MessageStream::new(&whole).expect("it is a log").collect();
    let count = read.expect("every message is right").len() as u64;
    assert_eq!(
        (count, summary.stats.expect("there are statistics").message_count),
        (copied.messages(), copied.messages())
    );
    assert!(examine_log(out).expect("it is a log").ending.whole, "what was recovered is whole");

    // A part of it, as a run that goes on copies it.
    let first = random.below(copied.messages() as usize + 2) as u64;
    let mut writer = LogWriter::create(copy).expect("the log can be written");
    let part = copy_log(torn, &mut writer, Some(first)).expect("it was copied before");
    writer.finish().expect("the log can be written");
    assert_eq!(part.messages(), first.min(copied.messages()));
}

/// Changes the bytes of a log in one way.
fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    match random.below(12) {
        0 => bytes.truncate(random.below(bytes.len() + 1)),
        1 => flip(bytes, random),
        2 => huge_number(bytes, random),
        3..6 => damage_record(bytes, random),
        6..10 => damage_inside_chunk(bytes, random),
        10 => {
            let at = random.below(bytes.len() + 1);
            let noise: Vec<u8> = (0..random.below(200)).map(|_| random.next() as u8).collect();
            bytes.splice(at..at, noise);
        }
        _ => {
            let start = random.below(bytes.len() + 1);
            let end = (start + random.below(3000)).min(bytes.len());
            bytes[start..end].fill(random.next() as u8);
        }
    }
}

/// Flips up to eight bits.
fn flip(bytes: &mut [u8], random: &mut Random) {
    for _ in 0..=random.below(8) {
        let at = random.below(bytes.len());
        if let Some(byte) = bytes.get_mut(at) {
            *byte ^= 1 << random.below(8);
        }
    }
}

/// Puts a number that is mostly too large somewhere, in four or eight bytes.
fn huge_number(bytes: &mut [u8], random: &mut Random) {
    put_number(bytes, random.below(bytes.len()), random);
}

fn put_number(bytes: &mut [u8], at: usize, random: &mut Random) {
    let length = bytes.len() as u64;
    let numbers = [u64::MAX, 1 << 63, 1 << 32, (1 << 32) - 1, 1 << 31, 1 << 24, length, length + 1, 0, random.next()];
    let number = numbers[random.below(numbers.len())].to_le_bytes();
    let size = if random.below(2) == 0 { 4 } else { 8 };
    for (byte, new) in bytes.iter_mut().skip(at).zip(&number[..size]) {
        *byte = *new;
    }
}

/// Where the records of a whole part of a log lie.
fn records(bytes: &[u8], mut at: usize) -> Vec<std::ops::Range<usize>> {
    let mut found = Vec::new();
    while let Some(length) = bytes.get(at + 1..at + 9) {
        let length = u64::from_le_bytes(length.try_into().expect("there are eight bytes"));
        let Some(end) = usize::try_from(length).ok().and_then(|length| (at + 9).checked_add(length)) else { break };
        if end > bytes.len() {
            break;
        }
        found.push(at..end);
        at = end;
    }
    found
}

/// Removes, doubles, moves or misnames a record, or changes a number in its head or near its start.
fn damage_record(bytes: &mut Vec<u8>, random: &mut Random) {
    let start = if bytes.starts_with(mcap::MAGIC) { mcap::MAGIC.len() } else { 0 };
    damage_one_of(bytes, start, random);
}

fn damage_one_of(bytes: &mut Vec<u8>, start: usize, random: &mut Random) {
    let records = records(bytes, start);
    let Some(record) = records.get(random.below(records.len())).cloned() else { return };
    match random.below(6) {
        0 => drop(bytes.drain(record)),
        1 => drop(bytes.splice(record.start..record.start, bytes[record].to_vec())),
        2 => {
            let moved: Vec<u8> = bytes.drain(record).collect();
            let to = records[random.below(records.len())].start.min(bytes.len());
            bytes.splice(to..to, moved);
        }
        3 => bytes[record.start] = random.below(18) as u8,
        4 => put_number(bytes, record.start + 1, random),
        _ => put_number(bytes, record.start + 9 + random.below((record.len() - 9).min(60)), random),
    }
}

/// Damages what a chunk holds and packs it again with the right checksum: what only a mistake of a writer does.
fn damage_inside_chunk(bytes: &mut Vec<u8>, random: &mut Random) {
    let chunks: Vec<_> =
        records(bytes, mcap::MAGIC.len()).into_iter().filter(|record| bytes[record.start] == op::CHUNK).collect();
    let Some(record) = chunks.get(random.below(chunks.len())).cloned() else { return };
    // Times, sizes and checksum, and the name of the compression between its length and that of the data. (The library's parser
    // asks for as much memory as a damaged length says.)
    let body = bytes[record.start + 9..record.end].to_vec();
    let Some((times, data)) = body.split_at_checked(44).filter(|(head, _)| head[28..36] == *b"\x04\0\0\0zstd") else {
        return;
    };
    // It may have been damaged before, and unpack to gigabytes.
    let mut inner = Vec::new();
    let unpacked = zstd::Decoder::new(data).and_then(|decoder| decoder.take(1 << 20).read_to_end(&mut inner));
    if unpacked.is_err() {
        return;
    }
    for _ in 0..=random.below(2) {
        match random.below(4) {
            0 => flip(&mut inner, random),
            1 => huge_number(&mut inner, random),
            _ => damage_one_of(&mut inner, 0, random),
        }
    }
    let (name, packed) = match random.below(3) {
        0 => ("", inner.clone()),
        _ => ("zstd", zstd::encode_all(inner.as_slice(), 1).expect("it can be packed")),
    };
    let crc = if random.below(4) == 0 { 0 } else { crc32fast::hash(&inner) };
    let mut chunk = Vec::new();
    chunk.extend_from_slice(&times[..16]);
    chunk.extend_from_slice(&(inner.len() as u64).to_le_bytes());
    chunk.extend_from_slice(&crc.to_le_bytes());
    chunk.extend_from_slice(&(name.len() as u32).to_le_bytes());
    chunk.extend_from_slice(name.as_bytes());
    chunk.extend_from_slice(&(packed.len() as u64).to_le_bytes());
    chunk.extend_from_slice(&packed);
    let mut whole = vec![op::CHUNK];
    whole.extend_from_slice(&(chunk.len() as u64).to_le_bytes());
    whole.extend_from_slice(&chunk);
    bytes.splice(record, whole);
}
