//! Logs and standard output that cannot be written: a message, an exit code, and what was written stays readable.

#![cfg(unix)]

use std::fs::{self, File};
use std::io::Read;
use std::process::Command;

use crate::program::{Folder, LONG_RUN, Ran, STOREGGA};

/// Messages that `storegga recover` keeps of a log.
fn kept(folder: &Folder, log: &str) -> u64 {
    let ran = folder.run(&["recover", log, "--json"]);
    ran.ended_with(0);
    ran.json()["messages"].as_u64().unwrap()
}

/// The shell limits the size of files as a quota or a full disk does.
#[test]
fn a_disk_that_fills_up_ends_the_run_and_keeps_what_was_written() {
    let folder = Folder::tank("full");
    let limited = format!("ulimit -f 80 && exec {STOREGGA} {}", LONG_RUN.join(" "));
    let ran = Ran(folder.command_of("sh", &["-c", &limited]).output().unwrap());
    ran.is_refused_with(&[
        "cannot write the log runs/tank.mcap: File too large",
        "the run ended at t = ",
        "storegga recover",
    ]);
    let ran = folder.run(&["doctor", "runs/tank.mcap", "--json"]);
    assert_eq!((ran.code(), &ran.json()["state"]), (Some(1), &"torn".into()));
    assert!(kept(&folder, "runs/tank.mcap") > 20);
    // Recovering needs room, too, and leaves nothing half done behind.
    let limited = format!("ulimit -f 20 && exec {STOREGGA} recover runs/tank.mcap --out small.mcap");
    let ran = Ran(folder.command_of("sh", &["-c", &limited]).output().unwrap());
    ran.is_refused_with(&["cannot", "the log small.mcap", "File too large", "--out"]);
    assert!(!folder.path("small.mcap").exists() && !folder.path("small.mcap.part").exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_told_before_the_run() {
    let folder = Folder::tank("unwritable");
    let closed = folder.path("closed");
    fs::create_dir(&closed).unwrap();
    fs::set_permissions(&closed, std::os::unix::fs::PermissionsExt::from_mode(0o555)).unwrap();
    let is_root = File::create(closed.join("probe")).is_ok();
    let run = |out: &str| folder.run(&["run", "tank.ron", "--quiet", "--out", out]);
    if !is_root {
        run("closed/a.mcap").is_refused_with(&["cannot create the log closed/a.mcap: Permission denied", "--out"]);
        run("closed/b/a.mcap").is_refused_with(&["cannot make the folder closed/b", "Permission denied", "--out"]);
    }
    // Nobody makes files or folders here, not even root.
    run("/proc/a.mcap").is_refused_with(&["cannot create the log /proc/a.mcap", "--out"]);
    run("/proc/storegga/a.mcap").is_refused_with(&["cannot make the folder /proc/storegga", "--out"]);
}

#[test]
fn a_log_into_a_pipe_ends_with_its_reader() {
    let folder = Folder::tank("pipe");
    assert!(Command::new("mkfifo").arg(folder.path("pipe")).status().unwrap().success());
    let out = [&LONG_RUN[..], &["--out", "pipe"]].concat();
    let child = folder.start(&out);
    let mut taken = vec![0; 50_000];
    File::open(folder.path("pipe")).unwrap().read_exact(&mut taken).unwrap();
    Ran::of(child).is_refused_with(&["cannot write the log pipe: Broken pipe", "the run ended at t = "]);
    folder.write("taken.mcap", &taken);
    assert!(kept(&folder, "taken.mcap") > 20);
}

#[test]
fn standard_output_that_is_closed_or_full_is_told() {
    let folder = Folder::tank("unheard");
    for arguments in [&["run", "tank.ron", "--json"][..], &["check", "tank.ron"], &["scenes", "--scenes", "."]] {
        let (reader, closed) = std::io::pipe().unwrap();
        drop(reader);
        let ran = Ran(folder.command(arguments).stdout(closed).output().unwrap());
        ran.is_refused_with(&["cannot write to standard output: Broken pipe"]);
        let full = File::options().write(true).open("/dev/full").unwrap();
        let ran = Ran(folder.command(arguments).stdout(full).output().unwrap());
        ran.is_refused_with(&["cannot write to standard output: No space left on device"]);
    }
    assert_eq!(folder.run(&["doctor", "runs/tank.mcap"]).code(), Some(0), "the log is whole all the same");
}

#[test]
fn a_log_that_is_taken_away_ends_the_run() {
    let removed: [(&str, fn(&Folder)); 3] = [
        ("removed", |folder| fs::remove_file(folder.path("runs/tank.mcap")).unwrap()),
        ("folder-removed", |folder| fs::remove_dir_all(folder.path("runs")).unwrap()),
        ("moved", |folder| fs::rename(folder.path("runs/tank.mcap"), folder.path("moved.mcap")).unwrap()),
    ];
    for (name, remove) in removed {
        let folder = Folder::tank(name);
        let child = folder.start_long_run();
        remove(&folder);
        let parts = ["cannot write the log runs/tank.mcap: it was removed, moved or replaced", "the run ended at t = "];
        Ran::of(child).is_refused_with(&parts);
        if name == "moved" {
            assert!(kept(&folder, "moved.mcap") > 20);
        }
    }
}

#[test]
fn two_runs_do_not_write_one_log() {
    let folder = Folder::tank("twice");
    let mut child = folder.start_long_run();
    let ran = folder.run(&["run", "tank.ron", "--quiet"]);
    let told = ran.err();
    // Read while it is written: up to now it is a log that is torn.
    let so_far = kept(&folder, "runs/tank.mcap");
    child.kill().unwrap();
    child.wait().unwrap();
    ran.is_refused_with(&["cannot create the log runs/tank.mcap: another run is writing it", "--out"]);
    assert!(so_far > 20 && kept(&folder, "runs/tank.mcap") >= so_far, "{told}");
}
