//! What cannot go on as before is refused.

use std::fs;
use std::path::Path;

use crate::program::Folder;
use crate::{RESUME, RUN, kill};

#[test]
fn a_run_that_goes_on_is_not_resumed() {
    let folder = Folder::stream("goes-on", 2);
    let mut child = folder.start_and_wait(&[&RUN[..], &["--set", "end_time=1000.0"]].concat());
    folder.run(&RESUME).is_refused_with(&["cannot go on with the log runs/stream.mcap: another run is writing it"]);
    assert_eq!(child.try_wait().unwrap(), None, "the run was disturbed");
    kill(child);
}

/// Calls `change` with the bytes of a file and writes what it returns.
fn rewrite(path: &Path, change: impl Fn(Vec<u8>) -> Vec<u8>) {
    fs::write(path, change(fs::read(path).unwrap())).unwrap();
}

#[test]
fn what_cannot_go_on_as_before_is_refused_with_the_reason() {
    let folder = Folder::killed("refused");
    let whole = fs::read(folder.checkpoint()).unwrap();
    let log = fs::read(folder.path("runs/stream.mcap")).unwrap();
    let refused = |parts: &[&str]| {
        folder.run(&RESUME).is_refused_with(parts);
        assert!(!folder.path("runs/stream.mcap.part").exists());
    };
    folder
        .run(&["resume", "runs/strem.checkpoint"])
        .is_refused_with(&["cannot read the checkpoint runs/strem.checkpoint"]);
    folder.run(&["resume", "stream.ron"]).is_refused_with(&["stream.ron", "it is not a checkpoint"]);

    let damage = |change: &dyn Fn(Vec<u8>) -> Vec<u8>, parts: &[&str]| {
        rewrite(&folder.checkpoint(), change);
        refused(parts);
        fs::write(folder.checkpoint(), &whole).unwrap();
    };
    damage(&|bytes| bytes[..bytes.len() / 2].to_vec(), &["it is cut off"]);
    let flipped = |mut bytes: Vec<u8>| {
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        bytes
    };
    damage(&flipped, &["it is damaged: its checksum is wrong"]);

    let scene = fs::read_to_string(folder.path("stream.ron")).unwrap();
    fs::write(folder.path("stream.ron"), scene.replace("viscosity: 0.001", "viscosity: 0.002")).unwrap();
    refused(&["its line 10 was", "viscosity: 0.001", "viscosity: 0.002"]);
    fs::write(folder.path("stream.ron"), &scene).unwrap();

    let measured = folder.path("measured.csv");
    fs::write(&measured, "t,v\n0.01,0.5\n0.1,0.0\n").unwrap();
    refused(&["measured.csv of the scene has changed"]);
    fs::write(&measured, "t,v\n0.01,0.0\n0.1,0.0\n").unwrap();

    let quake = folder.path("quake.csv");
    let shaking = fs::read_to_string(&quake).unwrap();
    fs::write(&quake, shaking.replace("2.0", "3.0")).unwrap();
    refused(&["quake.csv of the scene has changed"]);
    fs::write(&quake, shaking).unwrap();

    fs::remove_file(folder.path("runs/stream.mcap")).unwrap();
    refused(&["cannot resume: cannot read the log", "stream.mcap"]);
    fs::write(folder.path("runs/stream.mcap"), &log[..log.len().min(2000)]).unwrap();
    refused(&["cannot go on with the log", "messages at the checkpoint"]);
    // A run of a scene that differs in nothing but a number that is not in the text of the checkpoint's log.
    folder.run(&["run", "stream.ron", "--set", "phases.water.rheology.viscosity=0.5", "--quiet"]).ended_with(0);
    fs::write(folder.checkpoint(), &whole).unwrap();
    refused(&["it is the log of another run"]);

    fs::write(folder.path("runs/stream.mcap"), &log).unwrap();
    folder.run(&RESUME).ended_with(0);
}

/// What a run has read is a part of it; what becomes of the file while it runs is not.
#[test]
fn a_file_of_the_scene_may_change_while_a_run_goes_on_but_not_for_its_resume() {
    let folder = Folder::stream("edited", 2);
    let quake = folder.path("quake.csv");
    let shaking = fs::read_to_string(&quake).unwrap();
    let edited = shaking.replace("2.0", "3.0");
    for change in [Some(edited.as_str()), None] {
        folder.clear();
        // Long enough for what follows, and short enough to end if the resume below is not refused.
        let child = folder.start_and_wait(&[&RUN[..], &["--set", "end_time=5.0"]].concat());
        match change {
            Some(edited) => fs::write(&quake, edited).unwrap(),
            None => fs::remove_file(&quake).unwrap(),
        }
        // The one that is being written now may be older than the change.
        folder.wait_for_another_checkpoint();
        folder.wait_for_another_checkpoint();
        kill(child);
        let parts = [if change.is_some() { "quake.csv of the scene has changed" } else { "quake.csv cannot be read" }];
        folder.run(&RESUME).is_refused_with(&parts);
        fs::write(&quake, &shaking).unwrap();
        let resumed = folder.start(&RESUME);
        folder.wait_for_another_checkpoint();
        kill(resumed);
    }
}

#[test]
fn intervals_that_make_no_sense_are_refused() {
    let folder = Folder::stream("intervals", 2);
    for option in ["--checkpoint-every", "--checkpoint-every-wall"] {
        folder.run(&["run", "stream.ron", option, "0"]).is_refused_with(&[option, "greater than 0"]);
    }
    let longest = ["run", "stream.ron", "--checkpoint-every-wall", "1e300"];
    folder.run(&longest).is_refused_with(&["--checkpoint-every-wall", "no clock runs that long"]);
    // The longest and the shortest that make sense, or nearly so.
    for (option, seconds) in [("--checkpoint-every", "1e300"), ("--checkpoint-every-wall", "1e19")] {
        folder.run(&["run", "stream.ron", "--until", "0.002", "--quiet", option, seconds]).ended_with(0);
    }
    let tiny = ["run", "stream.ron", "--checkpoint-every", "1e-320", "--quiet"];
    let child = folder.start_and_wait(&tiny);
    folder.wait_for_another_checkpoint();
    kill(child);
}
