//! Files that a scene reads besides its own text, such as tables to compare with.

use std::fs;
use std::path::{Path, PathBuf};

use bevy_ecs::prelude::*;

use super::SceneInfo;

/// The files that the scene of this run reads.
#[derive(Resource, Debug, Clone, Default)]
pub struct SceneFiles(Vec<PathBuf>);

impl SceneFiles {
    /// Path, length and CRC-32 of each file.
    ///
    /// # Errors
    /// One of them cannot be read any more.
    pub(crate) fn fingerprints(&self) -> Result<Vec<(PathBuf, u64, u32)>, String> {
        let fingerprint = |path: &PathBuf| match fs::read(path) {
            Ok(bytes) => Ok((path.clone(), bytes.len() as u64, crc32fast::hash(&bytes))),
            Err(error) => Err(format!("the file {} of the scene cannot be read: {error}", path.display())),
        };
        self.0.iter().map(fingerprint).collect()
    }
}

/// The path of a `file` that the scene names: it is seen from the folder of the scene. The file becomes a part of what the run
/// depends on: a checkpoint is not resumed when it has changed.
pub fn scene_file(world: &mut World, file: &str) -> PathBuf {
    let scene = Path::new(&world.resource::<SceneInfo>().file).to_owned();
    let path = scene.parent().unwrap_or(Path::new("")).join(file);
    let mut files = world.get_resource_or_init::<SceneFiles>();
    if !files.0.contains(&path) {
        files.0.push(path.clone());
    }
    path
}
