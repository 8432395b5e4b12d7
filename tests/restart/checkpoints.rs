//! What writing checkpoints changes, when and where they are written, and what is kept of a run that has not ended.

use std::fs;

use crate::program::{Folder, Ran, assert_parts};
use crate::{Left, RESUME, RUN, kill, scenes, with_threads};

/// With soils, shaking and relaxation zones; with a yield stress, damping, a wave at the start and the books.
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for (name, scene) in scenes() {
        let folder = Folder::with_scene(&format!("threads-{name}"), &scene);
        let reference = Left::of(&folder, &folder.run(&RUN));
        for threads in ["2", "3", "8"] {
            folder.clear();
            let left = Left::of(&folder, &folder.run(&with_threads(&RUN, threads)));
            left.is(&reference, &format!("{name}, {threads} threads"));
        }
    }
}

#[test]
fn checkpoints_change_nothing_and_threads_neither() {
    let folder = Folder::stream("nothing", 2);
    let with = Left::of(&folder, &folder.run(&RUN));
    let seldom = ["run", "stream.ron", "--checkpoint-every-wall", "1000", "--threads", "1", "--json"];
    let ran = folder.run(&seldom);
    // Only how often checkpoints are written differs, which the last one says.
    let seldom = Left { checkpoint: with.checkpoint.clone(), ..Left::of(&folder, &ran) };
    seldom.is(&with, "with checkpoints that are seldom");
    let ran = folder.run(&["run", "stream.ron", "--threads", "1", "--json"]);
    let without = Left { checkpoint: with.checkpoint.clone(), ..Left::of(&folder, &ran) };
    without.is(&with, "without checkpoints");

    folder.clear();
    kill(folder.start_and_wait(&RUN));
    let threads = [&RESUME[..], &["--threads", "2"]].concat();
    Left::of(&folder, &folder.run(&threads)).is(&with, "resumed with two threads");
    // Nothing is left to do: the same again.
    Left::of(&folder, &folder.run(&RESUME)).is(&with, "resumed at its end");
}

#[test]
fn checkpoints_follow_the_clock_on_the_wall_too() {
    let folder = Folder::stream("wall", 2);
    let child = folder.start_and_wait(&["run", "stream.ron", "--checkpoint-every-wall", "0.002", "--quiet"]);
    Ran::of(child).ended_with(0);
    let ran = folder.run(&RESUME);
    ran.ended_with(0);
    assert_parts(&ran.err(), &["from t = 0.1 s"]);
}

#[test]
fn a_checkpoint_that_cannot_be_written_does_not_end_the_run() {
    let folder = Folder::stream("unwritable", 2);
    let part = folder.path("runs/stream.checkpoint.part");
    // A folder in the place of the part: as on a full disk, nothing can be written there.
    fs::create_dir_all(&part).unwrap();
    folder.run(&RUN).is_refused_with(&["cannot write the checkpoint runs/stream.checkpoint", "--out"]);
    fs::write(folder.checkpoint(), "not mine").unwrap();
    folder.run(&RUN).is_refused_with(&["runs/stream.checkpoint exists and is not a checkpoint"]);
    folder.clear();

    let child = folder.start_and_wait(&RUN);
    while fs::create_dir(&part).is_err() {
        std::hint::spin_loop();
    }
    let before = fs::read(folder.checkpoint()).unwrap();
    let ran = Ran::of(child);
    ran.ended_with(0);
    assert_parts(&ran.err(), &["Warning: cannot write the checkpoint"]);
    fs::remove_dir(&part).unwrap();
    assert!(fs::read(folder.checkpoint()).unwrap() == before, "the old checkpoint is not there any more");
    let resumed = Left::of(&folder, &folder.run(&RESUME));
    folder.clear();
    resumed.is(&Left::of(&folder, &folder.run(&RUN)), "resumed from an old checkpoint");
}

#[test]
fn a_log_and_a_checkpoint_are_two_files() {
    let folder = Folder::stream("two-files", 2);
    let run = |out: &str| {
        let short = ["--checkpoint-every", "0.002", "--until", "0.004", "--quiet", "--out", out];
        folder.run(&[&["run", "stream.ron"], &short[..]].concat())
    };
    for (out, checkpoint) in
        [("small.checkpoint", "small.checkpoint.checkpoint"), ("z.mcap", "z.checkpoint"), ("z.log", "z.log.checkpoint")]
    {
        run(out).ended_with(0);
        let magic = |name: &str| fs::read(folder.path(name)).unwrap()[1..5].to_vec();
        assert_eq!((magic(out), magic(checkpoint)), (b"MCAP".to_vec(), b"STOC".to_vec()));
    }
    let before = fs::read(folder.path("z.checkpoint")).unwrap();
    run("z").is_refused_with(&["z.checkpoint is the checkpoint of a run that writes z.mcap", "--out"]);
    assert!(!folder.path("z").exists() && fs::read(folder.path("z.checkpoint")).unwrap() == before);
    // The old log stays if the new run cannot have its checkpoint.
    fs::write(folder.path("z.checkpoint"), "not mine").unwrap();
    let log = fs::read(folder.path("z.mcap")).unwrap();
    run("z.mcap").is_refused_with(&["z.checkpoint exists and is not a checkpoint"]);
    assert!(fs::read(folder.path("z.mcap")).unwrap() == log, "the log was destroyed");
}

/// Who types `run` again and not `resume` loses nothing of the run before.
#[test]
fn a_run_that_has_not_ended_is_kept_when_a_new_one_takes_its_name() {
    let folder = Folder::killed("kept");
    let again = folder.run(&RUN);
    again.ended_with(0);
    let resume = "storegga resume runs/stream.unfinished.checkpoint";
    assert_parts(
        &again.err(),
        &["Warning: runs/stream.checkpoint was of a run that has not ended", "of 0.1 s", resume],
    );
    let reference = Left::of(&folder, &again);
    let kept = folder.run(&["resume", "runs/stream.unfinished.checkpoint", "--json"]);
    kept.ended_with(0);
    // It ends like the one that was not killed.
    for (kept, name) in [("unfinished.mcap", "mcap"), ("unfinished.checkpoint", "checkpoint")] {
        fs::rename(folder.path(&format!("runs/stream.{kept}")), folder.path(&format!("runs/stream.{name}"))).unwrap();
    }
    let resumed = Left { checkpoint: reference.checkpoint.clone(), ..Left::of(&folder, &kept) };
    resumed.is(&reference, "kept and resumed");
    // A run that has ended is replaced without a word; two that have not are both kept.
    let quiet = folder.run(&RUN);
    assert!(!quiet.err().contains("Warning"), "{}", quiet.err());
    for kept in ["runs/stream.unfinished.checkpoint", "runs/stream.unfinished-2.checkpoint"] {
        folder.start_and_kill(&RUN);
        let without = folder.run(&["run", "stream.ron", "--threads", "1", "--quiet", "--until", "0.001"]);
        assert_parts(&without.err(), &[&format!("storegga resume {kept}")]);
        assert!(folder.path(kept).is_file() && !folder.checkpoint().exists());
    }
}
