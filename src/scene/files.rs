//! Files that a scene reads besides its own text, such as tables to compare with.

use std::fs;
use std::path::{Path, PathBuf};

use bevy_ecs::prelude::*;

use super::{Invalid, SceneInfo};

/// The files that the scene of this run has read.
#[derive(Resource, Debug, Clone, Default)]
pub struct SceneFiles(Vec<Fingerprint>);

/// Path, length and CRC-32 of a file as it was read: what becomes of it afterwards is nothing to the run.
pub(crate) type Fingerprint = (PathBuf, u64, u32);

impl SceneFiles {
    /// Each file, in the order in which they were first read.
    pub(crate) fn fingerprints(&self) -> &[Fingerprint] {
        &self.0
    }

    /// Keeps a file that was read; `false` if it was another one when it was read before.
    fn keep(&mut self, new: Fingerprint) -> bool {
        match self.0.iter().find(|known| known.0 == new.0) {
            Some(known) => *known == new,
            None => {
                self.0.push(new);
                true
            }
        }
    }
}

/// A file that a scene names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneFile {
    /// Where it lies.
    pub path: PathBuf,
    /// What it held when it was read.
    pub bytes: Vec<u8>,
}

/// Reads a `file` that the scene names, seen from the folder of the scene. What was read becomes a part of what the run depends
/// on: a checkpoint is not resumed when the file is another one.
///
/// # Errors
/// It cannot be read, or has changed since another part of the scene read it.
pub fn scene_file(world: &mut World, file: &str) -> Result<SceneFile, Invalid> {
    let scene = Path::new(&world.resource::<SceneInfo>().file).to_owned();
    let path = scene.parent().unwrap_or(Path::new("")).join(file);
    let wrong = |what: String| Invalid::new("file", format!("{} {what}", path.display()));
    let bytes = fs::read(&path).map_err(|error| wrong(format!("cannot be read: {error}")))?;
    let fingerprint = (path.clone(), bytes.len() as u64, crc32fast::hash(&bytes));
    if !world.get_resource_or_init::<SceneFiles>().keep(fingerprint) {
        return Err(wrong("changed while the scene was read".to_owned()));
    }
    Ok(SceneFile { path, bytes })
}
