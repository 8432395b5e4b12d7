//! Logs: what is in them, what is kept of those that were torn or damaged, and what the program says when one cannot be written.

mod doctor;
mod failures;
mod recover;

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use mcap::Summary;
use serde_json::Value;

const TANK: &str = r#"Scene(
    title: "A small tank",
    dimension: 2,
    spacing: 0.02,
    gravity: (0.0, -9.81),
    end_time: 0.05,
    phases: {"water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001))},
    walls: {"tank": (shape: Box(min: (0.0, 0.0), max: (0.2, 0.2)), slip: NoSlip)},
    fluids: [(phase: "water", shape: Box(min: (0.0, 0.0), max: (0.2, 0.1)))],
    log: (particles: 0.01, series: 0.005),
)
"#;

const STOREGGA: &str = env!("CARGO_BIN_EXE_storegga");

/// A folder with the scene `tank.ron`, in which the program runs; removed at the end of the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("storegga-logs-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("tank.ron"), TANK).unwrap();
        Self(folder)
    }

    fn command(&self, program: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(arguments).current_dir(&self.0);
        command
    }

    fn run(&self, arguments: &[&str]) -> Ran {
        Ran(self.command(STOREGGA, arguments).output().unwrap())
    }

    /// The whole log of the tank.
    fn log(&self) -> Vec<u8> {
        let ran = self.run(&["run", "tank.ron", "--quiet"]);
        assert_eq!(ran.code(), Some(0), "{}", ran.err());
        fs::read(self.path("runs/tank.mcap")).unwrap()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        fs::write(self.path(name), bytes).unwrap();
        self.path(name)
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

    fn out(&self) -> String {
        String::from_utf8_lossy(&self.0.stdout).into_owned()
    }

    fn err(&self) -> String {
        String::from_utf8_lossy(&self.0.stderr).into_owned()
    }

    fn json(&self) -> Value {
        serde_json::from_slice(&self.0.stdout).unwrap_or_else(|error| panic!("{error}: {}{}", self.out(), self.err()))
    }

    #[track_caller]
    fn is_refused_with(&self, parts: &[&str]) {
        assert_eq!(self.code(), Some(2), "{}{}", self.out(), self.err());
        parts.iter().for_each(|part| assert!(self.err().contains(part), "{part} is not in\n{}", self.err()));
    }
}

/// Where each chunk of a whole log lies.
fn chunks(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let summary = Summary::read(bytes).unwrap().unwrap();
    let range = |start: u64, length: u64| start as usize..(start + length) as usize;
    let mut found: Vec<_> =
        summary.chunk_indexes.iter().map(|chunk| range(chunk.chunk_start_offset, chunk.chunk_length)).collect();
    found.sort_by_key(|chunk| chunk.start);
    found
}
