//! `storegga scenes`, and where scenes are found.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::args::ScenesArgs;
use super::exit::say;
use super::number::short;
use super::table::Table;
use crate::error::UserError;
use crate::scene::open_document;

/// Lists the scenes of a folder, a line each.
pub(super) fn list(args: &ScenesArgs) -> Result<ExitCode, UserError> {
    let mut table = Table::new(["scene", "title", "dimension", "spacing"]);
    for file in scene_files(&args.folder)? {
        let scene = open_document(&file, &[])?;
        table.push([
            file.display().to_string(),
            scene.read("title").unwrap_or_default(),
            format!("{}D", scene.read::<usize>("dimension")?),
            format!("{} m", short(scene.read("spacing")?)),
        ]);
    }
    say(&table.render());
    Ok(ExitCode::SUCCESS)
}

/// The scene files in a folder, by name.
pub(super) fn scene_files(folder: &Path) -> Result<Vec<PathBuf>, UserError> {
    let entries = fs::read_dir(folder).map_err(|error| {
        UserError::plain(format!("cannot read the folder of scenes {}: {error}", folder.display()))
            .help("run storegga where `scenes` is, or say --scenes DIR")
    })?;
    let paths = entries.filter_map(Result::ok).map(|entry| entry.path());
    let mut scenes: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|end| end == "ron")).collect();
    scenes.sort();
    if scenes.is_empty() {
        return Err(UserError::plain(format!("there are no scenes (*.ron) in {}", folder.display())));
    }
    Ok(scenes)
}
