//! Runs that are stopped at random moments and resumed, against the same runs that are not.
//!
//! The last checkpoint of a run holds every bit of its state: two runs went the same way if theirs are the same file. Their logs
//! are compared message by message, as the `mcap` library reads them.

mod checkpoints;
mod later;
#[path = "../support/program.rs"]
mod program;
mod refusals;
#[path = "../support/shipped.rs"]
mod shipped;
mod states;
#[path = "../support/steps.rs"]
mod steps;
mod stopped;
mod stream;

use std::fs;
use std::path::PathBuf;
use std::process::Child;
use std::thread::sleep;
use std::time::{Duration, Instant};

use mcap::Summary;
use program::{Folder, Ran, Told, messages};
use serde_json::Value;
use stream::{slosh, stream};

const RUN: [&str; 7] = ["run", "stream.ron", "--checkpoint-every", "0.002", "--threads", "1", "--json"];
const RESUME: [&str; 3] = ["resume", "runs/stream.checkpoint", "--json"];

/// The same run, and its resume, with another number of threads.
fn with_threads<'a>(arguments: &[&'a str], threads: &'a str) -> Vec<&'a str> {
    let own = ["--threads", threads];
    let rest = arguments.iter().position(|argument| *argument == "--threads").unwrap_or(arguments.len());
    let after = arguments.get(rest + 2..).unwrap_or_default();
    [&arguments[..rest], after, &own[..]].concat()
}

/// The scenes that have between them whatever is shipped.
fn scenes() -> [(&'static str, String); 3] {
    [("2D", stream(2)), ("3D", stream(3)), ("slosh", slosh())]
}

impl Folder {
    /// A folder with the stream in two or three dimensions.
    fn stream(name: &str, dimension: usize) -> Self {
        Self::with_scene(name, &stream(dimension))
    }

    /// A folder with a scene as `stream.ron`, and the files that it reads.
    fn with_scene(name: &str, scene: &str) -> Self {
        let folder = Self::new(name);
        folder.write("stream.ron", scene);
        folder.write("measured.csv", "t,v\n0.01,0.0\n0.1,0.0\n");
        folder.write("quake.csv", "t,a\n0.0,0.0\n0.03,2.0\n0.2,-2.0\n");
        folder
    }

    /// A folder with a run that was killed behind its second checkpoint.
    fn killed(name: &str) -> Self {
        let folder = Self::stream(name, 2);
        folder.start_and_kill(&RUN);
        folder
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
        kill(self.start_and_wait(arguments));
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

fn kill(mut child: Child) {
    let _ = child.kill();
    child.wait().unwrap();
}

/// What a run leaves: its last checkpoint, what is in its log, its expectations.
#[derive(PartialEq)]
struct Left {
    checkpoint: Vec<u8>,
    messages: Vec<Told>,
    others: Vec<String>,
    checks: Value,
}

impl Left {
    fn of(folder: &Folder, ran: &Ran) -> Self {
        ran.ended_with(0);
        let log = fs::read(folder.path("runs/stream.mcap")).unwrap();
        let summary = Summary::read(&log).unwrap().unwrap();
        let metadata = summary.metadata_indexes.iter().map(|index| {
            let mut record = mcap::read::metadata(&log, index).unwrap();
            record.metadata.remove("threads");
            format!("{record:?}")
        });
        let attachments = summary.attachment_indexes.iter();
        let attachments = attachments.map(|index| format!("{:?}", mcap::read::attachment(&log, index)));
        let others = metadata.chain(attachments).collect();
        let checks = ran.json()["checks"].clone();
        let checkpoint = fs::read(folder.checkpoint()).unwrap();
        Self { checkpoint, messages: messages(&log), others, checks }
    }

    #[track_caller]
    fn is(&self, reference: &Self, what: &str) {
        assert!(self.messages == reference.messages, "{what}: the log has other messages");
        assert!(self.others == reference.others, "{what}: the log has other records: {:?}", self.others);
        assert_eq!(self.checks, reference.checks, "{what}");
        assert!(self.checkpoint == reference.checkpoint, "{what}: the run went another way");
    }
}
