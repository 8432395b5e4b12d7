//! What `storegga doctor` finds.

use mcap::{MessageStream, Summary};
use serde_json::Value;
use storegga::log::{Field, LogWriter};

use crate::chunks;
use crate::program::{Folder, assert_parts};

fn channel<'a>(json: &'a Value, topic: &str) -> &'a Value {
    json["channels"].as_array().unwrap().iter().find(|channel| channel["topic"] == topic).unwrap()
}

#[test]
fn a_whole_log_is_healthy_and_told_in_full() {
    let folder = Folder::tank("healthy");
    let log = folder.log();
    let ran = folder.run(&["doctor", "runs/tank.mcap", "--json"]);
    ran.ended_with(0);
    let json = ran.json();
    assert_eq!((&json["state"], &json["end"]), (&Value::from("whole"), &Value::from("done")));
    assert_eq!(json["bytes"], log.len());
    assert!(json["library"].as_str().unwrap().starts_with("storegga "));

    // Counts, sizes and times as the library reads them.
    let summary = Summary::read(&log).unwrap().unwrap();
    assert_eq!(json["chunks"]["count"], summary.chunk_indexes.len());
    let sizes = summary.chunk_indexes.iter().map(|chunk| [chunk.compressed_size, chunk.uncompressed_size]);
    let sizes = sizes.fold([0, 0], |sum, size| [sum[0] + size[0], sum[1] + size[1]]);
    assert_eq!([&json["chunks"]["stored_bytes"], &json["chunks"]["unpacked_bytes"]], sizes.map(Value::from).each_ref());
    for (id, known) in &summary.channels {
        let told = channel(&json, &known.topic);
        assert_eq!(
            told["messages"],
            summary.stats.as_ref().unwrap().channel_message_counts.get(id).copied().unwrap_or(0)
        );
        let stream = MessageStream::new(&log).unwrap().map(Result::unwrap).filter(|m| m.channel.topic == known.topic);
        assert_eq!(told["bytes"], stream.map(|message| message.data.len()).sum::<usize>());
        assert_eq!((&told["missing"], &told["gaps"]), (&Value::from(0), &Value::from(0)), "{}", known.topic);
    }
    assert_eq!(json["span_s"], serde_json::json!([0.0, 0.05]));
    assert_eq!(channel(&json, "/particles")["expected_interval_s"], 0.01);
    assert_eq!(channel(&json, "/steps")["expected_interval_s"], 0.005);
    assert_eq!(channel(&json, "/walls")["expected_interval_s"], Value::Null);
    let unit = |topic: &str, name: &str| {
        let fields = channel(&json, topic)["fields"].as_array().unwrap();
        fields.iter().find(|field| field["name"] == name).unwrap()["unit"].clone()
    };
    assert_eq!((unit("/particles", "pressure"), unit("/steps", "time_step")), ("Pa".into(), "s".into()));
    assert_eq!(json["attachments"][0]["name"], "tank.ron");
    assert_eq!(json["metadata"]["parameters"]["phases.water.rheology.viscosity"], "0.001");
    assert_eq!(json["metadata"]["end"]["time [s]"], "0.05");

    let text = folder.run(&["doctor", "runs/tank.mcap"]).out();
    let parts =
        ["tank.mcap: whole", "A small tank", "done at t = 0.05 s after ", "pressure [Pa]", "tank.ron (text/plain"];
    assert_parts(&text, &parts);
}

#[test]
fn a_torn_or_damaged_log_is_told_as_such() {
    let folder = Folder::tank("ill");
    let log = folder.log();
    let chunks = chunks(&log);
    let doctor = |bytes: &[u8]| {
        folder.write("ill.mcap", bytes);
        let ran = folder.run(&["doctor", "ill.mcap", "--json"]);
        ran.ended_with(1);
        ran.json()
    };
    for cut in [chunks[4].end, chunks[4].end - 3, log.len() - 1] {
        let json = doctor(&log[..cut]);
        assert_eq!(json["state"], "torn");
        assert_eq!(json["end"].is_null(), cut < log.len() - 1, "the record of the end comes before the index");
    }
    let mut damaged = log.clone();
    damaged[chunks[3].start + 60] ^= 4;
    let json = doctor(&damaged);
    assert_eq!((&json["state"], &json["end"]), (&Value::from("damaged"), &Value::from("done")));
    assert!(channel(&json, "/steps")["missing"].as_u64() > Some(0));
    // Outside of chunks only the checksum of the whole tells.
    let mut damaged = log.clone();
    let viscosity = log.windows(5).position(|bytes| bytes == b"0.001").unwrap();
    damaged[viscosity] = b'9';
    assert_eq!(doctor(&damaged)["state"], "damaged");

    // What was recovered has the same gap, and says so.
    let mut damaged = log.clone();
    damaged[chunks[3].start + 60] ^= 4;
    folder.write("ill.mcap", &damaged);
    folder.run(&["recover", "ill.mcap"]);
    let ran = folder.run(&["doctor", "ill.recovered.mcap", "--json"]);
    assert_eq!((ran.code(), &ran.json()["state"]), (Some(1), &Value::from("whole")));
    assert!(ran.json()["metadata"]["recovered"]["damage.000"].as_str().unwrap().contains("is damaged"));
    folder.run(&["doctor", "none.mcap"]).is_refused_with(&["cannot read the log none.mcap: No such file"]);
    folder.run(&["doctor", "tank.ron"]).is_refused_with(&["it is not a log"]);
}

/// What a run leaves that is killed before the first of its log is on the disk.
#[test]
fn a_log_of_which_there_is_only_the_beginning_is_told_as_such() {
    let folder = Folder::tank("beginning");
    let log = folder.log();
    for length in [8, 12, 30] {
        folder.write("head.mcap", &log[..length]);
        let ran = folder.run(&["doctor", "head.mcap"]);
        ran.ended_with(1);
        let told = format!("head.mcap: torn, and nothing in its {length} B can be read or recovered");
        assert_parts(&ran.out(), &[&told]);
        // Nothing made up, and no advice that does not help.
        for part in ["written by", "?", "storegga recover"] {
            assert!(!ran.out().contains(part), "{part} is in\n{}", ran.out());
        }
        let json = folder.run(&["doctor", "head.mcap", "--json"]).json();
        assert_eq!((&json["state"], &json["healthy"]), (&Value::from("torn"), &Value::from(false)));
        folder.run(&["recover", "head.mcap"]).is_refused_with(&["head.mcap: nothing in it can be read"]);
    }
}

#[test]
fn outputs_that_were_never_written_are_gaps() {
    let folder = Folder::tank("gaps");
    let out = folder.path("gaps.mcap");
    let mut log = LogWriter::create(&out).unwrap();
    log.metadata("derived", &[("series_interval [s]".to_owned(), "0.1".to_owned())]).unwrap();
    let field = [Field::number("a", "Pa", "a pressure")];
    let [beat, events, late] = ["/beat", "/events", "/late"].map(|topic| log.add_series(topic, "", &field).unwrap());
    // The 4th and the 7th to 9th are missing; events come when they come; the last one ends too early by two.
    let times =
        |except: &[u32]| (0..21).filter(|k| !except.contains(k)).map(|k| f64::from(k) * 0.1).collect::<Vec<_>>();
    for time in times(&[4, 7, 8, 9]) {
        log.write_series(beat, time, &[0.0]).unwrap();
    }
    for time in [0.0, 0.13, 1.7] {
        log.write_series(events, time, &[0.0]).unwrap();
    }
    for time in times(&[19, 20]) {
        log.write_series(late, time, &[0.0]).unwrap();
    }
    log.metadata("end", &[("time [s]".to_owned(), "2".to_owned())]).unwrap();
    log.finish().unwrap();

    let ran = folder.run(&["doctor", "gaps.mcap", "--json"]);
    ran.ended_with(1);
    let json = ran.json();
    let gaps = |topic: &str| (channel(&json, topic)["gaps"].as_u64(), channel(&json, topic)["missing"].as_u64());
    assert_eq!([gaps("/beat"), gaps("/events"), gaps("/late")], [4, 0, 2].map(|count| (Some(count), Some(0))));
}
