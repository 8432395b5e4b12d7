//! What is run again, and what goes on.

use std::fs;
use std::process::Child;
use std::thread::sleep;
use std::time::{Duration, Instant};

use storegga::log::LogWriter;

use crate::program::{Folder, Ran, TANK, assert_parts};
use crate::{GRID, NAMES};

#[test]
fn a_second_start_runs_nothing() {
    let folder = Folder::with_study("second", GRID);
    folder.study(&[]).ended_with(0);
    let (logs, table) = (folder.logs(), folder.table());
    let ran = folder.study(&[]);
    ran.ended_with(0);
    assert_parts(&ran.err(), &["4 done before, 0 to do"]);
    assert_eq!((folder.logs(), folder.table()), (logs, table));
    fs::remove_file(folder.path("runs/study/table.csv")).unwrap();
    // The record tells how long it took; the log alone says that it is done.
    fs::remove_file(folder.path(&format!("runs/study/{}.json", NAMES[1]))).unwrap();
    assert_parts(&folder.study(&[]).err(), &["4 done before, 0 to do"]);
    assert_eq!(folder.table()[NAMES[1]]["wall time [s]"], "");
    let ran = folder.study(&["--again"]);
    ran.ended_with(0);
    assert_parts(&ran.err(), &["0 done before, 4 to do"]);
}

/// Runs of the study that its second start did, after `change`.
fn run_again(name: &str, change: impl FnOnce(&Folder)) -> (Vec<String>, String) {
    let folder = Folder::with_study(name, GRID);
    folder.study(&["--quiet"]).ended_with(0);
    let before = folder.logs();
    change(&folder);
    let ran = folder.study(&[]);
    ran.ended_with(0);
    let after = folder.logs().into_iter();
    (after.filter(|(name, time)| before.get(name) != Some(time)).map(|(name, _)| name).collect(), ran.err())
}

#[test]
fn a_changed_value_runs_only_that() {
    let (runs, _) = run_again("changed", |folder| drop(folder.write("study.ron", GRID.replace("1.0]", "2.0]"))));
    assert_eq!(runs, ["viscosity=2,spacing=0.02", "viscosity=2,spacing=0.025"]);
}

#[test]
fn a_changed_scene_or_end_runs_everything_and_says_why() {
    let scene = TANK.replace("end_time: 0.05", "end_time: 0.051");
    let (runs, told) = run_again("scene", |folder| drop(folder.write("tank.ron", scene)));
    assert_eq!(runs, NAMES);
    assert_parts(
        &told,
        &["is run again: the scene has changed: its line 6 was `end_time: 0.05,` and is `end_time: 0.051,`"],
    );
    let until = GRID.replace("    vary", "    until: 0.04,\n    vary");
    let (runs, told) = run_again("until", |folder| drop(folder.write("study.ron", until)));
    assert_eq!(runs, NAMES);
    assert_parts(&told, &["is run again: it went to 0.05 s, and shall go to 0.04 s"]);
}

#[test]
fn what_is_not_in_the_scene_runs_nothing() {
    let fewer = GRID.replace("        Series(of: \"energy.kinetic\"),\n", "").replace("family", "number");
    let (runs, _) = run_again("figures", |folder| drop(folder.write("study.ron", fewer)));
    assert!(runs.is_empty(), "{runs:?}");
}

#[test]
fn a_torn_log_is_run_again_to_the_same_bytes() {
    let folder = Folder::with_study("torn", GRID);
    folder.study(&["--quiet"]).ended_with(0);
    let logs: Vec<Vec<u8>> = NAMES.iter().map(|name| folder.log(name)).collect();
    let log = |k: usize| format!("runs/study/{}.mcap", NAMES[k]);
    folder.write(&log(1), &logs[1][..logs[1].len() / 2]);
    folder.write(&log(2), b"");
    let mut damaged = logs[3].clone();
    damaged[logs[3].len() / 2] ^= 1;
    folder.write(&log(3), damaged);
    let ran = folder.study(&[]);
    ran.ended_with(0);
    assert_parts(&ran.err(), &["1 done before, 3 to do", &format!("{}: is run again: its log is torn", NAMES[1])]);
    for (name, log) in NAMES.iter().zip(&logs) {
        assert!(folder.log(name) == *log, "{name}");
    }
}

#[test]
fn a_log_of_another_version_is_run_again() {
    let folder = Folder::with_study("version", GRID);
    folder.study(&["--quiet"]).ended_with(0);
    let path = folder.path(&format!("runs/study/{}.mcap", NAMES[0]));
    let scene = TANK.replace("spacing: 0.01", "spacing: 0.02");
    let write = |version: &str| {
        let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        let mut log = LogWriter::create(&path).unwrap();
        log.attach("tank.ron", "text/plain", scene.as_bytes()).unwrap();
        log.metadata("program", &[pair("storegga", version), pair("until [s]", "0.05")]).unwrap();
        log.metadata("end", &[pair("how", "done"), pair("time [s]", "0.05"), pair("step", "7")]).unwrap();
        log.finish().unwrap();
    };
    write(env!("CARGO_PKG_VERSION"));
    assert_parts(&folder.study(&["--quiet", "--dry-run"]).out(), &["done"]);
    assert!(!folder.study(&["--dry-run"]).out().contains("to run"));
    write("0.0.9");
    let ran = folder.study(&[]);
    ran.ended_with(0);
    assert_parts(
        &ran.err(),
        &["3 done before, 1 to do", &format!("{}: is run again: it was made by storegga 0.0.9", NAMES[0])],
    );
}

#[test]
fn a_file_that_the_scene_reads_counts_too() {
    let shaking =
        "shaking: Accelerogram(file: \"quake.csv\", time: \"t\", columns: [(name: \"ew\", direction: (1.0, 0.0))]),\n)";
    let folder = Folder::with_study("file", GRID);
    folder.write("tank.ron", TANK.trim_end().trim_end_matches(')').to_owned() + shaking);
    folder.write("quake.csv", "t,ew\n0,0.1\n0.1,0.1\n");
    folder.study(&["--quiet"]).ended_with(0);
    assert_parts(&folder.study(&[]).err(), &["4 done before, 0 to do"]);
    folder.write("quake.csv", "t,ew\n0,0.1\n0.1,0.2\n");
    let ran = folder.study(&[]);
    ran.ended_with(0);
    assert_parts(&ran.err(), &["0 done before, 4 to do", "quake.csv that its scene reads is another one"]);
}

/// A study of two runs that take seconds, and its first ones.
fn long(name: &str) -> Folder {
    let study = GRID.replace("[0.001, 1.0]", "[0.001]").replace("[0.02, 0.025]", "[0.01, 0.02]");
    Folder::with_study(name, &study.replace("    vary", "    set: {\"end_time\": 2.0},\n    vary"))
}

const LONG: [&str; 2] = ["viscosity=0.001,spacing=0.01", "viscosity=0.001,spacing=0.02"];

/// Starts the study, and waits until both of its runs are at work.
fn start(folder: &Folder) -> Child {
    let child = folder.start(&["study", "study.ron", "--threads", "1", "--jobs", "2", "--checkpoint-every-wall", "1"]);
    let started = Instant::now();
    let length =
        |name: &str| fs::metadata(folder.path(&format!("runs/study/{name}.mcap"))).map_or(0, |data| data.len());
    while LONG.iter().any(|name| length(name) < 20_000) {
        assert!(started.elapsed() < Duration::from_secs(60), "no log appears");
        sleep(Duration::from_millis(5));
    }
    child
}

/// The table without what the clock on the wall says.
fn values(folder: &Folder) -> Vec<Vec<String>> {
    let rows = folder.table().into_values().map(|mut row| {
        row.remove("wall time [s]");
        row.into_values().collect()
    });
    rows.collect()
}

#[cfg(unix)]
#[test]
fn an_interrupted_study_goes_on_to_the_same_values() {
    let reference = long("reference");
    reference.study(&["--quiet", "--jobs", "2"]).ended_with(0);
    for signal in ["INT", "TERM"] {
        let folder = long(&format!("interrupted-{signal}"));
        let child = start(&folder);
        crate::program::interrupt(&child, signal);
        Ran::of(child).ended_with(130);
        let table = folder.table();
        assert!(table.values().any(|row| row["end"] == "interrupted" && row["mass [kg]"].is_empty()), "{table:?}");
        let ran = folder.study(&["--jobs", "2"]);
        ran.ended_with(0);
        assert_parts(&ran.err(), &["goes on from t = "]);
        assert_eq!(values(&folder), values(&reference), "{signal}");
        assert!(folder.table().values().all(|row| row["wall time [s]"].parse::<f64>().is_ok_and(|wall| wall > 0.0)));
    }
}

#[test]
fn the_runs_of_a_killed_study_stop_and_go_on_later() {
    let folder = long("killed");
    let mut child = start(&folder);
    child.kill().unwrap();
    child.wait().unwrap();
    // They hear of it: nothing is written any more after a while.
    let started = Instant::now();
    let is_written =
        |name: &str| fs::File::open(folder.path(&format!("runs/study/{name}.mcap"))).unwrap().try_lock().is_err();
    while LONG.iter().any(|name| is_written(name)) {
        assert!(started.elapsed() < Duration::from_secs(60), "a run goes on without its study");
        sleep(Duration::from_millis(20));
    }
    let logs = folder.logs();
    sleep(Duration::from_millis(300));
    assert_eq!(folder.logs(), logs);
    let ran = folder.study(&["--jobs", "2"]);
    ran.ended_with(0);
    assert_parts(&ran.err(), &["goes on from t = "]);
    let reference = long("killed-reference");
    reference.study(&["--quiet", "--jobs", "2"]).ended_with(0);
    assert_eq!(values(&folder), values(&reference));
}

/// A run that was interrupted in its study and went on with `storegga resume` took longer than its first part.
#[test]
fn a_part_of_a_run_is_not_taken_for_the_whole() {
    let folder = Folder::with_study("part", GRID);
    folder.study(&[]).ended_with(0);
    let took = |name: &str| folder.table()[name]["wall time [s]"].clone();
    assert!(NAMES.iter().all(|name| took(name).parse::<f64>().is_ok()));
    let record = folder.path(&format!("runs/study/{}.json", NAMES[1]));
    let text = fs::read_to_string(&record).unwrap();
    fs::write(&record, text.replace("\"done\"", "\"interrupted\"")).unwrap();
    folder.study(&[]).ended_with(0);
    assert_eq!((took(NAMES[1]), took(NAMES[0]).is_empty()), (String::new(), false));
}
