//! What `storegga recover` keeps.
//!
//! What should be kept is worked out from the index of the undamaged log by the `mcap` library, which shares no code with ours.

use std::fs;

use mcap::Summary;
use storegga::log::{LogWriter, copy_log, recover_log};
use storegga::particles::Workspace;

use crate::chunks;
use crate::program::{Folder, Told, assert_parts, messages, told};

/// Messages of each chunk of a whole log.
fn messages_by_chunk(bytes: &[u8]) -> Vec<Vec<Told>> {
    let summary = Summary::read(bytes).unwrap().unwrap();
    let mut indexes = summary.chunk_indexes.clone();
    indexes.sort_by_key(|chunk| chunk.chunk_start_offset);
    let of = |chunk| summary.stream_chunk(bytes, chunk).unwrap().map(|message| told(message.unwrap()));
    indexes.iter().map(|chunk| of(chunk).collect()).collect()
}

/// Recovers the log that `bytes` are left of and returns it; it must be whole to a strict reader and by its own statistics.
fn recovered(folder: &Folder, bytes: &[u8]) -> Result<Vec<u8>, String> {
    let (torn, out) = (folder.write("torn.mcap", bytes), folder.path("out.mcap"));
    let copied = recover_log(&torn, &out).map_err(|error| error.to_string())?;
    let whole = fs::read(out).unwrap();
    let summary = Summary::read(&whole).unwrap().expect("it has a summary");
    assert_eq!(summary.stats.unwrap().message_count, copied.messages());
    assert_eq!(messages(&whole).len() as u64, copied.messages());
    assert_eq!(fs::read(torn).unwrap(), bytes, "the torn log was changed");
    assert!(!folder.path("out.mcap.part").exists());
    Ok(whole)
}

#[test]
fn a_log_cut_at_any_byte_keeps_every_whole_chunk() {
    let folder = Folder::tank("cut");
    let log = folder.log();
    let (chunks, by_chunk) = (chunks(&log), messages_by_chunk(&log));
    assert!(chunks.len() > 5, "{chunks:?}");
    // Every border and its neighbours, and bytes all over the file.
    let borders = chunks.iter().flat_map(|chunk| [chunk.start, chunk.end]).flat_map(|at| [at - 1, at, at + 1]);
    let cuts = borders.chain((0..log.len()).step_by(log.len() / 150)).chain([log.len() - 1, log.len()]);
    for cut in cuts {
        let expected: Vec<Told> = chunks
            .iter()
            .zip(&by_chunk)
            .filter(|(chunk, _)| chunk.end <= cut)
            .flat_map(|(_, told)| told.clone())
            .collect();
        match recovered(&folder, &log[..cut]) {
            Ok(whole) => assert!(messages(&whole) == expected, "cut at byte {cut} of {}", log.len()),
            Err(why) => assert!(expected.is_empty() && cut < chunks[1].start, "cut at byte {cut}: {why}"),
        }
    }
    let attached = |bytes: &[u8]| Summary::read(bytes).unwrap().unwrap().attachment_indexes[0].name.clone();
    assert_eq!(attached(&recovered(&folder, &log[..chunks[1].end]).unwrap()), "tank.ron");
}

#[test]
fn a_damaged_chunk_is_left_out_and_the_others_are_kept() {
    let folder = Folder::tank("damaged");
    let log = folder.log();
    let (chunks, by_chunk) = (chunks(&log), messages_by_chunk(&log));
    for k in [0, 1, chunks.len() / 2, chunks.len() - 1] {
        let start = chunks[k].start;
        let expected: Vec<Told> =
            by_chunk.iter().enumerate().filter(|(other, _)| *other != k).flat_map(|(_, told)| told.clone()).collect();
        // A bit of its data; its opcode, its checksum, its sizes; every byte of its length, so that the next record must be
        // searched for.
        let middle = (start + chunks[k].end) / 2;
        let lengths = (1..9).flat_map(|byte| [(start + byte, 1), (start + byte, 64), (start + byte, 128)]);
        let others = [(middle, 1), (start, 0x50), (start + 33, 255), (start + 25, 3), (start + 45, 2)];
        for (at, mask) in others.into_iter().chain(lengths) {
            let mut damaged = log.clone();
            damaged[at] ^= mask;
            let whole = recovered(&folder, &damaged).unwrap();
            assert!(messages(&whole) == expected, "chunk {k}, byte {} of it: {}", at - start, messages(&whole).len());
        }
    }
    let mut damaged = log.clone();
    damaged[(chunks[2].start + chunks[2].end) / 2] ^= 1;
    folder.write("torn.mcap", &damaged);
    let ran = folder.run(&["recover", "torn.mcap", "--json"]);
    ran.ended_with(0);
    let json = ran.json();
    let steps = json["channels"].as_array().unwrap().iter().find(|channel| channel["topic"] == "/steps").unwrap();
    let lost = by_chunk[2].iter().filter(|told| told.0 == "/steps").count();
    assert!(lost > 0);
    assert_eq!(steps["missing"], lost);
    assert_eq!(json["damages"][0]["offset"], chunks[2].start);
    assert!(json["damages"][0]["what"].as_str().unwrap().contains("a chunk with messages from 0.0"), "{json}");
}

/// A few damaged bytes can unpack to gigabytes; no memory is taken for them.
#[cfg(target_os = "linux")]
#[test]
fn a_chunk_that_unpacks_to_far_more_than_it_should_takes_no_memory() {
    use std::io::Read;

    let folder = Folder::tank("bomb");
    let log = folder.log();
    let (first, size) = (chunks(&log)[2].start, 1_u64 << 29);
    let packed = zstd::encode_all(std::io::repeat(0).take(size), 1).unwrap();
    let mut bomb = vec![0; 16];
    bomb.extend([size.to_le_bytes(), packed.len().to_le_bytes()].as_flattened());
    // Between the two sizes: a checksum that is wrong, and the name of the compression behind its length.
    bomb.splice(24..24, *b"\x01\0\0\0\x04\0\0\0zstd");
    bomb.extend(packed);
    let head = [&[6][..], &bomb.len().to_le_bytes()].concat();
    let mut damaged = log.clone();
    damaged.splice(first..first, [head, bomb].concat());

    let most_memory = || {
        let status = fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap().to_owned();
        line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() << 10
    };
    let before = most_memory();
    assert_eq!(messages(&recovered(&folder, &damaged).unwrap()), messages(&log));
    let taken = most_memory() - before;
    assert!(taken < size / 4, "{taken} bytes");
}

#[test]
fn a_log_goes_on_after_its_copy() {
    let folder = Folder::tank("goes-on");
    let log = folder.log();
    let from = folder.write("torn.mcap", &log[..log.len() - 100]);
    let out = folder.path("out.mcap");
    let mut writer = LogWriter::create(&out).unwrap();
    let early = messages(&log).into_iter().filter(|told| told.2 <= 20_000_000).count();
    let copied = copy_log(&from, &mut writer, Some(early as u64)).unwrap();
    assert_eq!(copied.last_time(), Some(0.02));
    let ticks = writer.add_series("/ticks", "a new series", &[]).unwrap();
    let frames = writer.add_points("/particles", &storegga::log::FLUID_FIELDS).unwrap();
    let empty = [glam::DVec3::ZERO; 0];
    let (vector, scalar) = (storegga::log::Column::Vector(&empty), storegga::log::Column::Scalar(&[]));
    let (u8s, u32s) = (storegga::log::Column::U8(&[]), storegga::log::Column::U32(&[]));
    let columns = [vector, vector, scalar, scalar, scalar, scalar, u8s, u32s];
    writer.write_points(frames, 0.03, &columns, &mut Workspace::default()).unwrap();
    writer.write_series(ticks, 0.03, &[]).unwrap();
    writer.finish().unwrap();

    let told = messages(&fs::read(&out).unwrap());
    let old: Vec<Told> = messages(&log).into_iter().filter(|told| told.2 <= 20_000_000).collect();
    assert!(told[..old.len()] == old);
    let numbers = |topic: &str| -> Vec<u32> { told.iter().filter(|told| told.0 == topic).map(|told| told.1).collect() };
    assert_eq!(numbers("/particles"), [0, 1, 2, 3]);
    assert_eq!(numbers("/ticks"), [0]);
    let summary = Summary::read(&fs::read(out).unwrap()).unwrap().unwrap();
    assert_eq!(summary.channels.values().filter(|channel| channel.topic == "/particles").count(), 1);
    assert!(!summary.metadata_indexes.iter().any(|index| index.name == "end"));
}

#[test]
fn recover_tells_what_is_kept_and_what_is_lost() {
    let folder = Folder::tank("tells");
    let log = folder.log();
    let chunks = chunks(&log);
    folder.write("torn.mcap", &log[..chunks[3].end - 7]);
    let ran = folder.run(&["recover", "torn.mcap"]);
    ran.ended_with(0);
    let parts =
        ["torn.mcap: ", "up to t = 0.0", "kept in torn.recovered.mcap", "/particles", "/steps", "lost: ", "cut off"];
    assert_parts(&ran.out(), &parts);
    // Its own output may be replaced; a log that is whole is only copied.
    let ran = folder.run(&["recover", "runs/tank.mcap", "--out", "torn.recovered.mcap"]);
    assert!(ran.code() == Some(0) && ran.out().contains("was whole"), "{}{}", ran.out(), ran.err());
    assert_eq!(messages(&fs::read(folder.path("torn.recovered.mcap")).unwrap()), messages(&log));
}

#[test]
fn what_is_no_log_is_not_recovered() {
    let folder = Folder::tank("no-log");
    let log = folder.log();
    let recover = |name: &str| folder.run(&["recover", name]);
    folder.write("empty.mcap", b"");
    recover("empty.mcap").is_refused_with(&["cannot read the log empty.mcap: it is empty"]);
    recover("tank.ron").is_refused_with(&["it is not a log", "MCAP"]);
    recover(".").is_refused_with(&["it is a folder"]);
    recover("none.mcap").is_refused_with(&["cannot read the log none.mcap: No such file or directory"]);
    for length in [3, 8, 12, 30] {
        folder.write("head.mcap", &log[..length]);
        recover("head.mcap").is_refused_with(&["head.mcap: "]);
    }
    assert!(!folder.path("head.recovered.mcap").exists() && !folder.path("head.recovered.mcap.part").exists());
    let out = |out: &str| folder.run(&["recover", "runs/tank.mcap", "--out", out]);
    out("tank.ron").is_refused_with(&["exists and is not a log", "--out"]);
    out("runs/../runs/tank.mcap").is_refused_with(&["it is the log that is to be recovered"]);
    out("tank.ron/a.mcap").is_refused_with(&["tank.ron", "--out"]);
    fs::create_dir(folder.path("folder.mcap")).unwrap();
    out("folder.mcap").is_refused_with(&["cannot write the log folder.mcap: it is a folder", "--out"]);
    assert_eq!(fs::read(folder.path("runs/tank.mcap")).unwrap(), log);
    assert!(folder.path("tank.ron").is_file());
}

/// A pipe stands for a device: what is no plain file is not replaced by one.
#[cfg(unix)]
#[test]
fn what_is_no_plain_file_is_not_replaced() {
    use std::os::unix::fs::FileTypeExt;

    let folder = Folder::tank("no-file");
    folder.log();
    let pipe = folder.path("pipe.mcap");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let ran = folder.run(&["recover", "runs/tank.mcap", "--out", "pipe.mcap"]);
    ran.is_refused_with(&["cannot write the log pipe.mcap: it is no plain file", "--out"]);
    assert!(fs::metadata(pipe).unwrap().file_type().is_fifo() && !folder.path("pipe.mcap.part").exists());
}

#[test]
fn a_log_that_is_being_written_is_not_replaced() {
    let folder = Folder::tank("busy");
    folder.log();
    let written = folder.path("written.mcap");
    let mut writer = LogWriter::create(&written).unwrap();
    writer.message(0.0, storegga::log::Level::Info, "still here").unwrap();
    writer.flush().unwrap();
    let recover = || folder.run(&["recover", "runs/tank.mcap", "--out", "written.mcap"]);
    recover().is_refused_with(&["cannot write the log written.mcap: a run is writing it", "--out"]);
    // What another program is putting together there is left alone, too.
    let mut part = LogWriter::create(&folder.path("other.mcap.part")).unwrap();
    let ran = folder.run(&["recover", "runs/tank.mcap", "--out", "other.mcap"]);
    ran.is_refused_with(&["cannot create the log other.mcap.part: another run is writing it"]);
    part.finish().unwrap();
    writer.finish().unwrap();
    assert_eq!(messages(&fs::read(&written).unwrap()).len(), 1);
    drop(writer);
    assert_eq!(recover().code(), Some(0));
}
