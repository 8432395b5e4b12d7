//! Logs: what is in them, what is kept of those that were torn or damaged, and what the program says when one cannot be written.

mod doctor;
mod failures;
mod figures;
mod forces;
mod recover;
mod runout;

#[path = "../support/program.rs"]
mod program;

use std::fs;

use mcap::Summary;
use program::{Folder, TANK};

impl Folder {
    /// A folder with the scene `tank.ron`.
    fn tank(name: &str) -> Self {
        let folder = Self::new(name);
        folder.write("tank.ron", TANK.replace("spacing: 0.01", "spacing: 0.02"));
        folder
    }

    /// The whole log of the tank.
    fn log(&self) -> Vec<u8> {
        self.run(&["run", "tank.ron", "--quiet"]).ended_with(0);
        fs::read(self.path("runs/tank.mcap")).unwrap()
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
