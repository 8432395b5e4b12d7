//! Logs written and read back with the `mcap` library, whole and torn.

use std::{collections::BTreeMap, env, fs, path::PathBuf, process};

use foxglove::{
    Decode,
    messages::{Log, PointCloud},
};
use glam::DVec3;
use mcap::{McapError, Message, MessageStream, Summary, read::Options};
use serde_json::{Value as Json, json};

use super::*;
use crate::particles::Workspace;

/// A path in the temporary folder, removed at the end of the test.
struct TempLog(PathBuf);

impl TempLog {
    fn new(name: &str) -> Self {
        Self(env::temp_dir().join(format!("storegga-log-{}-{name}.mcap", process::id())))
    }
}

impl Drop for TempLog {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

const STEP_FIELDS: [Field; 3] = [
    Field::number("dt", "s", "length of the step"),
    Field::number("energy", "J", "kinetic energy of the fluid"),
    Field::text("limit", "what limited the step"),
];

/// Writes the frames `range`, one every 0.1 s: three particles and a step record each, then a flush.
fn write_frames(log: &mut LogWriter, ids: (PointsId, SeriesId), range: std::ops::Range<u32>) {
    for frame in range {
        let time = f64::from(frame) * 0.1;
        let place: Vec<_> = (0..3).map(|i| DVec3::new(f64::from(i), f64::from(frame), -0.5)).collect();
        let columns = [
            Column::Vector(&place),
            Column::Vector(&[DVec3::X; 3]),
            Column::Scalar(&[1e4; 3]),
            Column::U8(&[7, 8, 9]),
            Column::U32(&[0, 1, u32::MAX]),
        ];
        log.write_points(ids.0, time, &columns, &mut Workspace::default()).unwrap();
        let values = [Value::Number(0.1), Value::Number(f64::from(frame)), Value::Text("sound")];
        log.write_record(ids.1, time, &values).unwrap();
        log.flush().unwrap();
    }
}

fn open(temp: &TempLog) -> (LogWriter, (PointsId, SeriesId)) {
    let mut log = LogWriter::create(&temp.0).unwrap();
    let points = log.add_points("/walls", &BODY_FIELDS).unwrap();
    let series = log.add_series("/step", "one record per time step", &STEP_FIELDS).unwrap();
    (log, (points, series))
}

/// All messages up to the end or the first error, which comes along.
fn read(bytes: &[u8]) -> (Vec<Message<'static>>, Option<McapError>) {
    let mut messages = Vec::new();
    for message in MessageStream::new_with_options(bytes, Options::IgnoreEndMagic.into()).unwrap() {
        match message {
            Ok(message) => messages.push(message),
            Err(error) => return (messages, Some(error)),
        }
    }
    (messages, None)
}

fn on<'m>(messages: &'m [Message<'static>], topic: &str) -> Vec<&'m Message<'static>> {
    messages.iter().filter(|message| message.channel.topic == topic).collect()
}

fn json_of(message: &Message) -> Json {
    serde_json::from_slice(&message.data).unwrap()
}

#[test]
fn what_is_written_is_read_back() {
    let temp = TempLog::new("round-trip");
    let (mut log, ids) = open(&temp);
    log.attach("scene.ron", "text/plain", b"(bodies: [])").unwrap();
    log.metadata("run", &[("version".to_owned(), "1.2.3".to_owned())]).unwrap();
    write_frames(&mut log, ids, 0..5);
    log.message(0.4, Level::Warning, "slow").unwrap();
    log.finish().unwrap();

    let bytes = fs::read(&temp.0).unwrap();
    let summary = Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.stats.unwrap().message_count, 11);
    let attachment = mcap::read::attachment(&bytes, &summary.attachment_indexes[0]).unwrap();
    assert_eq!((attachment.name.as_str(), attachment.media_type.as_str()), ("scene.ron", "text/plain"));
    assert_eq!(&*attachment.data, b"(bodies: [])");
    let metadata = mcap::read::metadata(&bytes, &summary.metadata_indexes[0]).unwrap();
    assert_eq!(metadata.name, "run");
    assert_eq!(metadata.metadata, BTreeMap::from([("version".to_owned(), "1.2.3".to_owned())]));

    let messages: Vec<_> = MessageStream::new(&bytes).unwrap().map(Result::unwrap).collect();
    let steps = on(&messages, "/step");
    assert_eq!(steps.len(), 5);
    assert_eq!(&*steps[3].data, br#"{"time":0.30000000000000004,"dt":0.1,"energy":3.0,"limit":"sound"}"#);
    let said = on(&messages, "/log");
    let said = Log::decode(&*said[0].data).unwrap();
    assert_eq!((said.level(), said.message.as_str()), (Level::Warning, "slow"));
    assert_eq!(said.timestamp.unwrap().total_nanos(), 400_000_000);
}

#[test]
fn a_point_cloud_holds_packed_rows() {
    let temp = TempLog::new("points");
    let (mut log, ids) = open(&temp);
    write_frames(&mut log, ids, 0..3);
    log.finish().unwrap();

    let (messages, _) = read(&fs::read(&temp.0).unwrap());
    let clouds = on(&messages, "/walls");
    assert_eq!(clouds.len(), 3);
    assert_eq!(clouds[0].channel.schema.as_ref().unwrap().name, "foxglove.PointCloud");
    let cloud = PointCloud::decode(&*clouds[2].data).unwrap();
    assert_eq!((cloud.frame_id.as_str(), cloud.point_stride), ("world", 33));
    assert_eq!(cloud.timestamp.unwrap().total_nanos(), 200_000_000);
    let offsets: Vec<_> = cloud.fields.iter().map(|field| (field.name.as_str(), field.offset)).collect();
    assert_eq!(offsets[5..], [("vz", 20), ("pressure", 24), ("body", 28), ("id", 29)]);
    let row = &cloud.data[66..];
    let floats: Vec<_> = row[..28].chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
    assert_eq!(floats, [2.0, 2.0, -0.5, 1.0, 0.0, 0.0, 1e4]);
    assert_eq!((row[28], &row[29..]), (9, [255; 4].as_slice()));
}

#[test]
fn rows_of_many_blocks_keep_their_order_when_the_count_changes() {
    let temp = TempLog::new("blocks");
    let mut log = LogWriter::create(&temp.0).unwrap();
    let fields = [PointField::new("x", "m", PointKind::F32), PointField::new("id", "", PointKind::U32)];
    let points = log.add_points("/fluid", &fields).unwrap();
    let counts = [1000_u32, 0, 257, 600];
    for (frame, count) in counts.iter().enumerate() {
        let ids: Vec<u32> = (0..*count).collect();
        let x: Vec<f64> = ids.iter().map(|id| f64::from(*id) / 2.0).collect();
        log.write_points(points, frame as f64, &[Column::Scalar(&x), Column::U32(&ids)], &mut Workspace::default())
            .unwrap();
    }
    log.finish().unwrap();

    let (messages, _) = read(&fs::read(&temp.0).unwrap());
    for (message, count) in messages.iter().zip(counts) {
        let cloud = PointCloud::decode(&*message.data).unwrap();
        let expected: Vec<u8> =
            (0..count).flat_map(|id| [(id as f32 / 2.0).to_le_bytes(), id.to_le_bytes()]).flatten().collect();
        assert_eq!(cloud.data, expected);
    }
    assert_eq!(messages.len(), counts.len());
}

#[test]
fn a_schema_names_units_and_starts_with_time() {
    let temp = TempLog::new("schema");
    let (mut log, ids) = open(&temp);
    write_frames(&mut log, ids, 0..1);
    log.finish().unwrap();

    let (messages, _) = read(&fs::read(&temp.0).unwrap());
    let schema = on(&messages, "/step")[0].channel.schema.clone().unwrap();
    assert_eq!((schema.name.as_str(), schema.encoding.as_str()), ("storegga.step", "jsonschema"));
    let text = std::str::from_utf8(&schema.data).unwrap();
    assert!(text.contains(r#""properties":{"time":{"type":"number","description":"simulated time [s]"},"dt":"#));
    let expected = json!({
        "title": "storegga.step",
        "description": "one record per time step",
        "type": "object",
        "properties": {
            "time": {"type": "number", "description": "simulated time [s]"},
            "dt": {"type": "number", "description": "length of the step [s]"},
            "energy": {"type": "number", "description": "kinetic energy of the fluid [J]"},
            "limit": {"type": "string", "description": "what limited the step"},
        },
        "required": ["time", "dt", "energy", "limit"],
    });
    assert_eq!(serde_json::from_str::<Json>(text).unwrap(), expected);
}

#[test]
fn what_json_cannot_say_is_null_or_escaped() {
    let temp = TempLog::new("null");
    let mut log = LogWriter::create(&temp.0).unwrap();
    let fields = [Field::number("a", "1", ""), Field::number("b", "1", "")];
    let numbers = log.add_series("/numbers", "", &fields).unwrap();
    log.write_series(numbers, 1.0, &[f64::NAN, f64::NEG_INFINITY]).unwrap();
    let words = log.add_series("/words", "", &[Field::text("a \"b\"", "")]).unwrap();
    log.write_record(words, 1.0, &[Value::Text("line\n\"two\"")]).unwrap();
    log.finish().unwrap();

    let (messages, _) = read(&fs::read(&temp.0).unwrap());
    assert_eq!(json_of(&messages[0]), json!({"time": 1.0, "a": null, "b": null}));
    assert_eq!(json_of(&messages[1]), json!({"time": 1.0, "a \"b\"": "line\n\"two\""}));
}

#[test]
fn times_are_exact_nanoseconds() {
    let temp = TempLog::new("times");
    let mut log = LogWriter::create(&temp.0).unwrap();
    let series = log.add_series("/tick", "", &[]).unwrap();
    let ticks: Vec<u32> = (0..1000).chain(864_000..864_100).collect();
    for tick in &ticks {
        log.write_series(series, f64::from(*tick) * 0.1, &[]).unwrap();
    }
    log.write_series(series, -1.0, &[]).unwrap();
    log.write_series(series, f64::NAN, &[]).unwrap();
    log.finish().unwrap();

    let (messages, _) = read(&fs::read(&temp.0).unwrap());
    let expected = ticks.iter().map(|tick| u64::from(*tick) * 100_000_000).chain([0, 0]);
    assert!(messages.iter().map(|message| message.log_time).eq(expected));
    assert!(messages.iter().all(|message| message.log_time == message.publish_time));
    assert!(messages.iter().take(1100).map(|message| message.sequence).eq(0..1100));
}

/// What kill -9 leaves is what the file holds while the writer still is open.
#[test]
fn a_killed_run_leaves_all_that_was_flushed() {
    let temp = TempLog::new("killed");
    let (mut log, ids) = open(&temp);
    log.attach("scene.ron", "text/plain", b"()").unwrap();
    write_frames(&mut log, ids, 0..4);
    let flushed = fs::read(&temp.0).unwrap();
    log.write_record(ids.1, 0.4, &[Value::Number(0.1), Value::Number(4.0), Value::Text("lost")]).unwrap();
    assert_eq!(fs::read(&temp.0).unwrap(), flushed, "nothing of an open chunk is in the file");

    let (messages, _) = read(&flushed);
    assert_eq!((on(&messages, "/walls").len(), on(&messages, "/step").len()), (4, 4));

    // The next flush was interrupted at any of its bytes: the frames before it are all there.
    write_frames(&mut log, ids, 5..6);
    let longer = fs::read(&temp.0).unwrap();
    assert!(longer.len() > flushed.len());
    for end in flushed.len()..longer.len() {
        let (messages, _) = read(&longer[..end]);
        let frames = on(&messages, "/walls");
        assert!(frames.len() >= 4, "{} frames in {end} bytes", frames.len());
        assert_eq!(frames[3].log_time, 300_000_000);
    }
}

#[test]
fn a_dropped_writer_finishes_the_log() {
    let temp = TempLog::new("dropped");
    let (mut log, ids) = open(&temp);
    write_frames(&mut log, ids, 0..2);
    drop(log);
    let bytes = fs::read(&temp.0).unwrap();
    assert_eq!(Summary::read(&bytes).unwrap().unwrap().stats.unwrap().message_count, 4);
}

#[test]
fn misuse_is_an_error_and_the_log_goes_on() {
    let temp = TempLog::new("misuse");
    let (mut log, ids) = open(&temp);
    assert!(log.write_series(ids.1, 0.0, &[1.0, 2.0, 3.0]).is_err(), "a number for a text");
    assert!(log.write_record(ids.1, 0.0, &[Value::Number(1.0)]).is_err(), "too few values");
    assert!(log.write_series(SeriesId(9), 0.0, &[]).is_err());
    assert!(log.write_points(ids.0, 0.0, &[Column::U8(&[1])], &mut Workspace::default()).is_err(), "not the fields");
    let x = [DVec3::ZERO; 2];
    let uneven =
        [Column::Vector(&x), Column::Vector(&x), Column::Scalar(&[1.0]), Column::U8(&[1; 2]), Column::U32(&[1; 2])];
    assert!(log.write_points(ids.0, 0.0, &uneven, &mut Workspace::default()).is_err(), "columns of different lengths");
    assert!(log.add_points("/none", &[]).is_err());
    write_frames(&mut log, ids, 0..2);
    log.finish().unwrap();
    log.finish().unwrap();
    let error = log.message(0.0, Level::Info, "late").unwrap_err();
    assert_eq!(error.to_string(), format!("cannot write the log {}: it is finished", temp.0.display()));
    assert!(log.flush().is_err());
    assert_eq!(read(&fs::read(&temp.0).unwrap()).0.len(), 4);
}

#[cfg(unix)]
#[test]
fn an_error_of_the_system_is_one_clear_line() {
    let missing = env::temp_dir().join("storegga-no-such-folder/a.mcap");
    let error = LogWriter::create(&missing).unwrap_err();
    assert_eq!(
        error.to_string(),
        format!("cannot create the log {}: No such file or directory (os error 2)", missing.display())
    );
    assert_eq!(error.path(), missing);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_and_does_not_panic() {
    let mut log = LogWriter::create(std::path::Path::new("/dev/full")).unwrap();
    let error = log.flush().unwrap_err();
    assert_eq!(error.to_string(), "cannot write the log /dev/full: No space left on device (os error 28)");
    assert_eq!(error.io_error().unwrap().kind(), std::io::ErrorKind::StorageFull);
    assert!(log.message(0.0, Level::Info, "again").and_then(|()| log.flush()).is_err());
    assert!(log.finish().is_err());
}

/// Others keep the writer where several threads can reach it.
#[test]
fn a_writer_can_be_shared_between_threads() {
    fn shared<T: Send + Sync + 'static>() {}
    shared::<LogWriter>();
    shared::<LogError>();
}
