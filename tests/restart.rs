//! Runs that are stopped at random moments and resumed, against the same runs that are not.
//!
//! The last checkpoint of a run holds every bit of its state: two runs went the same way if theirs are the same file. Their logs
//! are compared message by message, as the `mcap` library reads them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use bevy_ecs::prelude::*;
use mcap::{MessageStream, Summary};
use serde_json::Value;
use storegga::app::{End, StopFlag, open, run};
use storegga::checkpoint::{check_state, restore_state, save_state};
use storegga::clock::Clock;
use storegga::scene::open_document;
use storegga_standard::StandardPlugins;

/// Whatever is shipped, at once: three liquids, two of them soils, that a force drives over a floor that moves, past a body that
/// goes up and down, round through the sides and through a relaxation zone, while the ground shakes; lists are rebuilt and
/// particles re-sorted often, and probes measure.
fn stream(dimension: usize) -> String {
    let (spacing, z) = if dimension == 2 { (0.05, "") } else { (0.1, ", z: (0.0, 0.8)") };
    let at = |x: f64, y: f64, z: f64| {
        if dimension == 2 { format!("({x:?}, {y:?})") } else { format!("({x:?}, {y:?}, {z:?})") }
    };
    let block = |(x0, y0, z0), (x1, y1, z1)| format!("Box(min: {}, max: {})", at(x0, y0, z0), at(x1, y1, z1));
    let (round, axis) = if dimension == 2 { ("Circle", "") } else { ("Sphere", "axis: (0.0, 0.0, 1.0),") };
    let (mud, sand) = (block((0.0, 0.0, 0.0), (0.4, 0.3, 0.8)), block((0.4, 0.0, 0.0), (0.8, 0.3, 0.8)));
    let water = block((0.0, 0.3, 0.0), (0.8, 0.6, 0.8));
    let (floor, open) = (block((-1.0, 0.0, -1.0), (2.0, 2.0, 2.0)), block((-3.0, 0.0, -3.0), (3.0, 3.0, 3.0)));
    let row = |time: f64, up: f64| format!("(time: {time:?}, displacement: {})", at(0.0, up, 0.0));
    format!(
        r#"Scene(
    dimension: {dimension}, spacing: {spacing:?}, gravity: {gravity}, end_time: 0.1,
    periodic: (x: (0.0, 0.8){z}), neighbours: (skin: 0.02, sort_every: 2), equation_of_state: (max_speed: 3.0),
    phases: {{
        "mud": (reference_density: 1500.0, rheology: StrainSoftening(
            consistency: 3.0, exponent: 0.7, peak_yield_stress: 50.0, sensitivity: 4.0, strain_95: 0.2, max_viscosity: 50.0)),
        "sand": (reference_density: 1800.0, rheology: MuI(
            static_friction: 0.4, limiting_friction: 0.7, inertial_number: 0.3, grain_diameter: 0.001,
            grain_density: 2600.0, pore_pressure: Dry, pressure_floor: 1.0, max_viscosity: 50.0)),
        "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)),
    }},
    fluids: [
        (phase: "mud", shape: {mud}, pressure: Uniform(0.0)),
        (phase: "sand", shape: {sand}, pressure: Uniform(0.0)),
        (phase: "water", shape: {water}, velocity: {velocity}, pressure: Uniform(0.0)),
    ],
    walls: {{ "floor": (shape: {floor}, cut: {open}, motion: Translation(velocity: {backwards})) }},
    structures: {{ "body": (
        shape: {round}(center: {center}, radius: 0.15),
        motion: Table(center: {center}, {axis} rows: [{up}, {down}]),
    ) }},
    probes: {{
        "front": Front(phase: "mud", direction: {upward}), "mud": CenterOfMass(phase: "mud"),
        "gauge": SurfaceHeight(at: {center}), "pressure": PressurePoint(at: {center}),
        "drag": ForceCoefficients(structure: "body", velocity: {velocity}, density: 1000.0, frontal: 0.3),
        "flow": MeanVelocity(shape: {water}),
    }},
    relaxation_zones: {{ "inlet": (shape: {mud}, target: Uniform(velocity: {velocity}), rate: 5.0, ramp: 0.1) }},
    shaking: Accelerogram(file: "quake.csv", time: "t", columns: [(name: "a", direction: {velocity})]),
    log: (particles: 0.02, series: 0.005),
    expect: [
        (name: "over the whole run", of: "body.force_y", take: Mean(from: 0.0, to: 0.1), is: Between(-1e9, 1e9)),
        (name: "measured", of: "mud.vx", is: Csv(file: "measured.csv", time: "t", value: "v"), within: Absolute(1e9)),
    ],
)
"#,
        gravity = at(4.0, -9.81, 0.0),
        velocity = at(1.0, 0.0, 0.0),
        backwards = at(-0.5, 0.0, 0.0),
        upward = at(0.0, 1.0, 0.0),
        center = at(0.4, 0.3, 0.4),
        up = row(0.0, 0.0),
        down = row(0.3, 0.1),
    )
}

const RUN: [&str; 7] = ["run", "stream.ron", "--checkpoint-every", "0.002", "--threads", "1", "--json"];
const RESUME: [&str; 3] = ["resume", "runs/stream.checkpoint", "--json"];

/// A folder with the scene `stream.ron`, in which the program runs; removed at the end of the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, scene: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("storegga-restart-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("stream.ron"), scene).unwrap();
        fs::write(folder.join("measured.csv"), "t,v\n0.01,0.0\n0.1,0.0\n").unwrap();
        fs::write(folder.join("quake.csv"), "t,a\n0.0,0.0\n0.03,2.0\n0.2,-2.0\n").unwrap();
        Self(folder)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_storegga"));
        command.args(arguments).current_dir(&self.0);
        command
    }

    fn run(&self, arguments: &[&str]) -> Ran {
        Ran(self.command(arguments).output().unwrap())
    }

    fn start(&self, arguments: &[&str]) -> Child {
        self.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn checkpoint(&self) -> PathBuf {
        self.path("runs/stream.checkpoint")
    }

    /// Starts a run and waits for a checkpoint that is later than the first.
    fn start_and_wait(&self, arguments: &[&str]) -> Child {
        let child = self.start(arguments);
        let start = Instant::now();
        while !self.checkpoint().exists() {
            assert!(start.elapsed() < Duration::from_secs(60), "no checkpoint appears");
            sleep(Duration::from_millis(1));
        }
        self.wait_for_another_checkpoint();
        child
    }

    /// Starts a run and kills it behind its second checkpoint.
    fn start_and_kill(&self, arguments: &[&str]) {
        let _ = fs::remove_file(self.checkpoint());
        let mut child = self.start_and_wait(arguments);
        let _ = child.kill();
        child.wait().unwrap();
    }

    /// Waits until there is another checkpoint than now.
    fn wait_for_another_checkpoint(&self) {
        let (start, first) = (Instant::now(), fs::read(self.checkpoint()).unwrap());
        while fs::read(self.checkpoint()).unwrap() == first {
            assert!(start.elapsed() < Duration::from_secs(60), "no other checkpoint appears");
            sleep(Duration::from_millis(1));
        }
    }

    /// The folder to start from again: without what runs left.
    fn clear(&self) {
        let _ = fs::remove_dir_all(self.path("runs"));
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

struct Ran(Output);

impl Ran {
    fn code(&self) -> Option<i32> {
        self.0.status.code()
    }

    fn err(&self) -> String {
        String::from_utf8_lossy(&self.0.stderr).into_owned()
    }

    fn json(&self) -> Value {
        serde_json::from_slice(&self.0.stdout).unwrap_or_else(|error| panic!("{error}: {}", self.err()))
    }

    #[track_caller]
    fn is_done(&self) {
        assert_eq!(self.code(), Some(0), "{}", self.err());
    }

    #[track_caller]
    fn is_refused_with(&self, parts: &[&str]) {
        assert_eq!(self.code(), Some(2), "{}", self.err());
        parts.iter().for_each(|part| assert!(self.err().contains(part), "{part} is not in\n{}", self.err()));
    }
}

/// What a run leaves: its last checkpoint, what is in its log, its expectations.
#[derive(PartialEq)]
struct Left {
    checkpoint: Vec<u8>,
    messages: Vec<(String, u32, u64, Vec<u8>)>,
    others: Vec<String>,
    checks: Value,
}

impl Left {
    fn of(folder: &Folder, ran: &Ran) -> Self {
        ran.is_done();
        let log = fs::read(folder.path("runs/stream.mcap")).unwrap();
        let message = |message: mcap::Message| {
            (message.channel.topic.clone(), message.sequence, message.log_time, message.data.into_owned())
        };
        let messages = MessageStream::new(&log).unwrap().map(|each| message(each.unwrap())).collect();
        let summary = Summary::read(&log).unwrap().unwrap();
        let metadata = summary.metadata_indexes.iter().map(|index| format!("{:?}", mcap::read::metadata(&log, index)));
        let attachments = summary.attachment_indexes.iter();
        let attachments = attachments.map(|index| format!("{:?}", mcap::read::attachment(&log, index)));
        let others = metadata.chain(attachments).collect();
        let checks = ran.json()["checks"].clone();
        Self { checkpoint: fs::read(folder.checkpoint()).unwrap(), messages, others, checks }
    }

    #[track_caller]
    fn is(&self, reference: &Self, what: &str) {
        assert!(self.messages == reference.messages, "{what}: the log has other messages");
        assert!(self.others == reference.others, "{what}: the log has other records: {:?}", self.others);
        assert_eq!(self.checks, reference.checks, "{what}");
        assert!(self.checkpoint == reference.checkpoint, "{what}: the run went another way");
    }
}

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
fn kill(folder: &Folder, child: &mut Child, random: &mut Random, most: Duration, kills: &mut Kills) -> bool {
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
    for dimension in [2, 3] {
        let folder = Folder::new(&format!("killed-{dimension}"), &stream(dimension));
        let started = Instant::now();
        let reference = Left::of(&folder, &folder.run(&RUN));
        let whole = started.elapsed();
        assert_eq!(reference.checks.as_array().map(Vec::len), Some(2));

        let mut kills = Kills::default();
        let mut runs = 0;
        while kills.all < 30 || kills.checkpoint < 3 || kills.log < 1 {
            assert!(runs < 100, "{kills:?}");
            runs += 1;
            folder.clear();
            // Killed up to eight times, a run is then left alone: it may have been so early that it never got anywhere.
            for _ in 0..8 {
                let arguments = if folder.checkpoint().exists() { &RESUME[..] } else { &RUN[..] };
                if !kill(&folder, &mut folder.start(arguments), &mut random, whole.mul_f64(0.5), &mut kills) {
                    break;
                }
            }
            let arguments = if folder.checkpoint().exists() { &RESUME[..] } else { &RUN[..] };
            Left::of(&folder, &folder.run(arguments)).is(&reference, &format!("{dimension}D, run {runs}"));
        }
        println!("{dimension}D, {runs} runs: {kills:?}");
    }
}

#[test]
fn checkpoints_change_nothing_and_threads_neither() {
    let folder = Folder::new("nothing", &stream(2));
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
    let mut child = folder.start_and_wait(&RUN);
    let _ = child.kill();
    child.wait().unwrap();
    let threads = [&RESUME[..], &["--threads", "2"]].concat();
    Left::of(&folder, &folder.run(&threads)).is(&with, "resumed with two threads");
    // Nothing is left to do: the same again.
    Left::of(&folder, &folder.run(&RESUME)).is(&with, "resumed at its end");
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_a_checkpoint_of_its_last_step() {
    let folder = Folder::new("interrupted", &stream(2));
    // The interval says how often checkpoints are written, which the last one repeats.
    let arguments = ["run", "stream.ron", "--checkpoint-every", "0.06", "--threads", "1", "--json"];
    let reference = Left::of(&folder, &folder.run(&arguments));
    let mut interrupted = false;
    for _ in 0..20 {
        folder.clear();
        let child = folder.start_and_wait(&arguments);
        let sent = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        let ran = Ran(child.wait_with_output().unwrap());
        interrupted = ran.code() == Some(130);
        if interrupted {
            assert!(ran.err().contains("storegga resume runs/stream.checkpoint"), "{}", ran.err());
            break;
        }
    }
    assert!(interrupted, "every run was faster than its signal");
    let ran = folder.run(&RESUME);
    assert!(ran.err().contains("going on with stream.ron from t = 0.0"), "{}", ran.err());
    Left::of(&folder, &ran).is(&reference, "interrupted");
}

/// A folder with a run that was killed behind its second checkpoint.
fn killed(name: &str) -> Folder {
    let folder = Folder::new(name, &stream(2));
    folder.start_and_kill(&RUN);
    folder
}

#[test]
fn a_run_that_goes_on_is_not_resumed() {
    let folder = Folder::new("goes-on", &stream(2));
    let mut child = folder.start_and_wait(&[&RUN[..], &["--set", "end_time=1000.0"]].concat());
    folder.run(&RESUME).is_refused_with(&["cannot go on with the log runs/stream.mcap: another run is writing it"]);
    assert_eq!(child.try_wait().unwrap(), None, "the run was disturbed");
    let _ = child.kill();
    child.wait().unwrap();
}

/// Calls `change` with the bytes of a file and writes what it returns.
fn rewrite(path: &Path, change: impl Fn(Vec<u8>) -> Vec<u8>) {
    fs::write(path, change(fs::read(path).unwrap())).unwrap();
}

#[test]
fn what_cannot_go_on_as_before_is_refused_with_the_reason() {
    let folder = killed("refused");
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
    folder.run(&["run", "stream.ron", "--set", "phases.water.rheology.viscosity=0.5", "--quiet"]).is_done();
    fs::write(folder.checkpoint(), &whole).unwrap();
    refused(&["it is the log of another run"]);

    fs::write(folder.path("runs/stream.mcap"), &log).unwrap();
    folder.run(&RESUME).is_done();
}

/// What a run has read is a part of it; what becomes of the file while it runs is not.
#[test]
fn a_file_of_the_scene_may_change_while_a_run_goes_on_but_not_for_its_resume() {
    let folder = Folder::new("edited", &stream(2));
    let quake = folder.path("quake.csv");
    let shaking = fs::read_to_string(&quake).unwrap();
    let edited = shaking.replace("2.0", "3.0");
    for change in [Some(edited.as_str()), None] {
        folder.clear();
        let mut child = folder.start_and_wait(&[&RUN[..], &["--set", "end_time=1000.0"]].concat());
        match change {
            Some(edited) => fs::write(&quake, edited).unwrap(),
            None => fs::remove_file(&quake).unwrap(),
        }
        // The one that is being written now may be older than the change.
        folder.wait_for_another_checkpoint();
        folder.wait_for_another_checkpoint();
        let _ = child.kill();
        child.wait().unwrap();
        let parts = [if change.is_some() { "quake.csv of the scene has changed" } else { "quake.csv cannot be read" }];
        folder.run(&RESUME).is_refused_with(&parts);
        fs::write(&quake, &shaking).unwrap();
        let mut resumed = folder.start(&RESUME);
        folder.wait_for_another_checkpoint();
        let _ = resumed.kill();
        resumed.wait().unwrap();
    }
}

#[test]
fn a_checkpoint_that_cannot_be_written_does_not_end_the_run() {
    let folder = Folder::new("unwritable", &stream(2));
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
    let ran = Ran(child.wait_with_output().unwrap());
    ran.is_done();
    assert!(ran.err().contains("Warning: cannot write the checkpoint"), "{}", ran.err());
    fs::remove_dir(&part).unwrap();
    assert!(fs::read(folder.checkpoint()).unwrap() == before, "the old checkpoint is not there any more");
    let resumed = Left::of(&folder, &folder.run(&RESUME));
    folder.clear();
    resumed.is(&Left::of(&folder, &folder.run(&RUN)), "resumed from an old checkpoint");
}

/// Who types `run` again and not `resume` loses nothing of the run before.
#[test]
fn a_run_that_has_not_ended_is_kept_when_a_new_one_takes_its_name() {
    let folder = killed("kept");
    let again = folder.run(&RUN);
    again.is_done();
    let resume = "storegga resume runs/stream.unfinished.checkpoint";
    for part in ["Warning: runs/stream.checkpoint was of a run that has not ended", "of 0.1 s", resume] {
        assert!(again.err().contains(part), "{part} is not in\n{}", again.err());
    }
    let reference = Left::of(&folder, &again);
    let kept = folder.run(&["resume", "runs/stream.unfinished.checkpoint", "--json"]);
    kept.is_done();
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
        assert!(without.err().contains(&format!("storegga resume {kept}")), "{}", without.err());
        assert!(folder.path(kept).is_file() && !folder.checkpoint().exists());
    }
}

#[test]
fn a_log_and_a_checkpoint_are_two_files() {
    let folder = Folder::new("two-files", &stream(2));
    let run = |out: &str| {
        let short = ["--checkpoint-every", "0.002", "--until", "0.004", "--quiet", "--out", out];
        folder.run(&[&["run", "stream.ron"], &short[..]].concat())
    };
    for (out, checkpoint) in
        [("small.checkpoint", "small.checkpoint.checkpoint"), ("z.mcap", "z.checkpoint"), ("z.log", "z.log.checkpoint")]
    {
        run(out).is_done();
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

/// A run that has ended goes on to a later end as one run to that end does, wherever the first end lay between its steps.
#[test]
fn a_run_that_ended_goes_on_to_a_later_end_with_the_same_bits() {
    let folder = Folder::new("later", &stream(2));
    let until = |seconds: &'static str| folder.run(&[&RUN[..], &["--until", seconds]].concat());
    let resume = |seconds: &'static str| folder.run(&[&RESUME[..], &["--until", seconds]].concat());
    let reference = Left::of(&folder, &until("0.06"));
    let beyond = Left::of(&folder, &until("0.12"));
    // An output, a moment before one, and in the midst of steps.
    for first in ["0.02", "0.0199999999", "0.0213", "0.04371"] {
        until(first).is_done();
        let mut extended = Left::of(&folder, &resume("0.06"));
        // The log says that it was asked to run to the first end, and then that it was asked to run to the second.
        let asked = |record: &String| record.contains("until [s]");
        let ends = extended.others.iter().filter(|record| asked(record)).cloned().collect::<Vec<_>>();
        assert!(ends.len() == 2 && ends[0].contains(first) && ends[1].contains("0.06"), "{ends:?}");
        extended.others = reference.others.clone();
        extended.is(&reference, first);
        assert_eq!(folder.run(&["doctor", "runs/stream.mcap"]).code(), Some(0));
    }
    // On from there, beyond the end of the scene, killed on its way.
    let mut child = folder.start(&[&RESUME[..], &["--until", "0.12"]].concat());
    folder.wait_for_another_checkpoint();
    folder.wait_for_another_checkpoint();
    let _ = child.kill();
    child.wait().unwrap();
    let mut extended = Left::of(&folder, &folder.run(&RESUME));
    extended.others = beyond.others.clone();
    extended.is(&beyond, "extended twice and killed");

    for (seconds, part) in [("0.01", "too late for a run to 0.01 s"), ("-1", "greater than 0"), ("soon", "--until")] {
        resume(seconds).is_refused_with(&[part]);
    }
}

#[test]
fn intervals_that_make_no_sense_are_refused() {
    let folder = Folder::new("intervals", &stream(2));
    for option in ["--checkpoint-every", "--checkpoint-every-wall"] {
        folder.run(&["run", "stream.ron", option, "0"]).is_refused_with(&[option, "greater than 0"]);
    }
    let longest = ["run", "stream.ron", "--checkpoint-every-wall", "1e300"];
    folder.run(&longest).is_refused_with(&["--checkpoint-every-wall", "no clock runs that long"]);
    // The longest and the shortest that make sense, or nearly so.
    for (option, seconds) in [("--checkpoint-every", "1e300"), ("--checkpoint-every-wall", "1e19")] {
        folder.run(&["run", "stream.ron", "--until", "0.002", "--quiet", option, seconds]).is_done();
    }
    let tiny = ["run", "stream.ron", "--checkpoint-every", "1e-320", "--quiet"];
    let mut child = folder.start_and_wait(&tiny);
    folder.wait_for_another_checkpoint();
    let _ = child.kill();
    child.wait().unwrap();
}

#[test]
fn checkpoints_follow_the_clock_on_the_wall_too() {
    let folder = Folder::new("wall", &stream(2));
    let child = folder.start_and_wait(&["run", "stream.ron", "--checkpoint-every-wall", "0.002", "--quiet"]);
    Ran(child.wait_with_output().unwrap()).is_done();
    let ran = folder.run(&RESUME);
    ran.is_done();
    assert!(ran.err().contains("from t = 0.1 s"), "{}", ran.err());
}

/// Runs so many steps.
fn advance(world: &mut World, steps: u64) {
    let last = world.resource::<Clock>().step + steps;
    let stop = StopFlag::default();
    let watched = stop.clone();
    let end = run(world, f64::INFINITY, &stop, |clock| {
        if clock.step >= last {
            watched.stop();
        }
    });
    assert_eq!(end, End::Interrupted);
}

/// Whatever a plugin that is shipped brings, some scene has it.
#[test]
fn every_shipped_scene_can_be_resumed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/ci");
    let mut scenes: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    scenes.retain(|path| path.extension().is_some_and(|extension| extension == "ron"));
    assert!(scenes.len() > 5);
    for path in scenes {
        let opened = || open_document(&path, &[]).and_then(|document| open(StandardPlugins, document));
        let [mut straight, mut resumed] = [opened(), opened()].map(|app| app.unwrap_or_else(|error| panic!("{error}")));
        advance(straight.world_mut(), 8);
        let forgotten = check_state(straight.world());
        assert_eq!(forgotten, Ok(()), "{}: neither saved nor rebuilt", path.display());
        let saved = save_state(straight.world_mut()).unwrap();
        restore_state(resumed.world_mut(), &saved).unwrap();
        advance(straight.world_mut(), 8);
        advance(resumed.world_mut(), 8);
        let [straight, resumed] = [straight, resumed].map(|mut app| save_state(app.world_mut()).unwrap());
        assert!(straight == resumed, "{}: the resumed run went another way", path.display());
    }
}
