//! Runs that are killed or interrupted go on to the same bits.

use std::process::{Child, ExitStatus};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use crate::program::{self, Folder};
use crate::{Left, RESUME, RUN, scenes, with_threads};

/// Random numbers (SplitMix64); the seed is printed, and STOREGGA_SEED gives another one.
struct Random(u64);

impl Random {
    fn new() -> Self {
        let given = std::env::var("STOREGGA_SEED").ok().and_then(|seed| seed.parse().ok());
        let clock = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64);
        let seed = given.unwrap_or(clock);
        println!("STOREGGA_SEED={seed}");
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A duration up to `most`.
    fn duration(&mut self, most: Duration) -> Duration {
        most.mul_f64((self.next() >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

/// Whether a process was ended by SIGKILL, and not by itself before.
fn was_killed(status: ExitStatus) -> bool {
    #[cfg(unix)]
    return std::os::unix::process::ExitStatusExt::signal(&status) == Some(9);
    #[cfg(not(unix))]
    return !status.success();
}

/// How many kills there were, and how many of them in the middle of writing a checkpoint or of copying the log.
#[derive(Debug, Default)]
struct Kills {
    all: usize,
    checkpoint: usize,
    log: usize,
}

/// Ends `child` at a random moment, or as soon as a file is half written: a checkpoint, or the copy of the log at the start.
fn kill_at_random(folder: &Folder, child: &mut Child, random: &mut Random, most: Duration, kills: &mut Kills) -> bool {
    let parts = ["runs/stream.checkpoint.part", "runs/stream.mcap.part"].map(|part| folder.path(part));
    let awaited = parts.get((random.next() % 4) as usize);
    if awaited != Some(&parts[1]) {
        sleep(random.duration(most));
    }
    if let Some(part) = awaited {
        let seen = Instant::now();
        while !part.exists() && seen.elapsed() < most && child.try_wait().unwrap().is_none() {
            std::hint::spin_loop();
        }
    }
    let _ = child.kill();
    let is_killed = was_killed(child.wait().unwrap());
    if is_killed {
        kills.all += 1;
        kills.checkpoint += usize::from(parts[0].exists());
        kills.log += usize::from(parts[1].exists());
    }
    is_killed
}

#[test]
fn a_run_that_is_killed_again_and_again_ends_with_the_same_bits() {
    let mut random = Random::new();
    for (name, scene) in scenes() {
        let folder = Folder::with_scene(&format!("killed-{name}"), &scene);
        let started = Instant::now();
        let reference = Left::of(&folder, &folder.run(&RUN));
        let whole = started.elapsed();
        assert_eq!(reference.checks.as_array().map(Vec::len), Some(2));

        let mut kills = Kills::default();
        let mut runs = 0;
        while kills.all < 20 || kills.checkpoint < 3 || kills.log < 1 {
            assert!(runs < 100, "{kills:?}");
            runs += 1;
            folder.clear();
            // Killed up to eight times, a run is then left alone: it may have been so early that it never got anywhere.
            for _ in 0..8 {
                let threads = ["1", "2", "3"][(random.next() % 3) as usize];
                let arguments = if folder.checkpoint().exists() { &RESUME[..] } else { &RUN[..] };
                let mut child = folder.start(&with_threads(arguments, threads));
                if !kill_at_random(&folder, &mut child, &mut random, whole.mul_f64(0.5), &mut kills) {
                    break;
                }
            }
            let arguments = if folder.checkpoint().exists() { &RESUME[..] } else { &RUN[..] };
            Left::of(&folder, &folder.run(arguments)).is(&reference, &format!("{name}, run {runs}"));
        }
        println!("{name}, {runs} runs: {kills:?}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_a_checkpoint_of_its_last_step() {
    let folder = Folder::stream("interrupted", 2);
    // The interval says how often checkpoints are written, which the last one repeats.
    let arguments = ["run", "stream.ron", "--checkpoint-every", "0.06", "--threads", "1", "--json"];
    let reference = Left::of(&folder, &folder.run(&arguments));
    let mut interrupted = false;
    for _ in 0..20 {
        folder.clear();
        let child = folder.start_and_wait(&arguments);
        program::interrupt(&child, "TERM");
        let ran = program::Ran::of(child);
        interrupted = ran.code() == Some(130);
        if interrupted {
            program::assert_parts(&ran.err(), &["storegga resume runs/stream.checkpoint"]);
            break;
        }
    }
    assert!(interrupted, "every run was faster than its signal");
    let ran = folder.run(&RESUME);
    program::assert_parts(&ran.err(), &["going on with stream.ron from t = 0.0"]);
    Left::of(&folder, &ran).is(&reference, "interrupted");
}
