//! The program as its tests run it, each in a folder of its own.

#![allow(dead_code, reason = "no test uses all of it")]

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use mcap::MessageStream;
use serde_json::Value;

pub const STOREGGA: &str = env!("CARGO_BIN_EXE_storegga");

pub const TANK: &str = r#"Scene(
    title: "A small tank",
    dimension: 2,
    spacing: 0.01,
    gravity: (0.0, -9.81),
    end_time: 0.05,
    phases: {"water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001))},
    walls: {"tank": (shape: Box(min: (0.0, 0.0), max: (0.2, 0.2)), slip: NoSlip)},
    fluids: [(phase: "water", shape: Box(min: (0.0, 0.0), max: (0.2, 0.1)))],
    log: (particles: 0.01, series: 0.005),
)
"#;

/// Arguments of a run of `tank.ron` that would last for hours.
pub const LONG_RUN: [&str; 7] = ["run", "tank.ron", "--set", "end_time=10000.0", "--quiet", "--threads", "1"];

/// A folder in which the program runs; removed at the end of the test.
pub struct Folder(PathBuf);

impl Folder {
    /// An empty one; no other test of the file has this name.
    pub fn new(name: &str) -> Self {
        let own = concat!("storegga-", env!("CARGO_CRATE_NAME"));
        let folder = std::env::temp_dir().join(format!("{own}-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        fs::write(self.path(name), content).unwrap();
        self.path(name)
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        self.command_of(STOREGGA, arguments)
    }

    pub fn command_of(&self, program: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(arguments).current_dir(&self.0);
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Ran {
        Ran(self.command(arguments).output().unwrap())
    }

    pub fn start(&self, arguments: &[&str]) -> Child {
        self.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    /// Starts a [`LONG_RUN`], and waits until its log has some frames.
    pub fn start_long_run(&self) -> Child {
        let child = self.start(&LONG_RUN);
        let start = Instant::now();
        while fs::metadata(self.path("runs/tank.mcap")).map_or(0, |data| data.len()) < 60_000 {
            assert!(start.elapsed() < Duration::from_secs(60), "no log appears");
            sleep(Duration::from_millis(20));
        }
        child
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A run that has ended: its exit code and what it said.
pub struct Ran(pub Output);

impl Ran {
    /// Waits for the end of a run.
    pub fn of(child: Child) -> Self {
        Self(child.wait_with_output().unwrap())
    }

    pub fn code(&self) -> Option<i32> {
        self.0.status.code()
    }

    pub fn out(&self) -> String {
        String::from_utf8_lossy(&self.0.stdout).into_owned()
    }

    pub fn err(&self) -> String {
        String::from_utf8_lossy(&self.0.stderr).into_owned()
    }

    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.0.stdout).unwrap_or_else(|error| panic!("{error}: {}{}", self.out(), self.err()))
    }

    #[track_caller]
    pub fn ended_with(&self, code: i32) {
        assert_eq!(self.code(), Some(code), "{}{}", self.out(), self.err());
    }

    #[track_caller]
    pub fn is_refused_with(&self, parts: &[&str]) {
        self.ended_with(2);
        assert_eq!(self.out(), "");
        assert_parts(&self.err(), parts);
    }
}

#[track_caller]
pub fn assert_parts(text: &str, parts: &[&str]) {
    parts.iter().for_each(|part| assert!(text.contains(part), "{part} is not in\n{text}"));
}

/// Sends a signal to a running program.
#[cfg(unix)]
pub fn interrupt(child: &Child, signal: &str) {
    let sent = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// A message of a log: its topic, number, time and bytes.
pub type Told = (String, u32, u64, Vec<u8>);

pub fn told(message: mcap::Message<'_>) -> Told {
    (message.channel.topic.clone(), message.sequence, message.log_time, message.data.into_owned())
}

/// All messages of a whole log, read strictly.
pub fn messages(log: &[u8]) -> Vec<Told> {
    MessageStream::new(log).unwrap().map(|message| told(message.unwrap())).collect()
}
