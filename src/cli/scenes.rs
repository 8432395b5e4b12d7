//! `storegga scenes`, and where scenes are found.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use bevy_app::{App, PluginGroup};

use super::args::ScenesArgs;
use super::exit::{self, say};
use super::number::short;
use super::table::Table;
use crate::error::UserError;
use crate::scene::{open_document, read_header};

/// Lists the scenes of a folder, a line each; one that cannot be read is complained about, and the others are listed.
pub(super) fn list<P: PluginGroup>(args: &ScenesArgs, plugins: fn() -> P) -> Result<ExitCode, UserError> {
    let mut app = App::new();
    app.add_plugins(plugins());
    app.finish();
    let mut table = Table::new(["scene", "title", "dimension", "spacing"]);
    let mut code = ExitCode::SUCCESS;
    for file in scene_files(&args.folder)? {
        match open_document(&file, &[]).and_then(|scene| read_header(app.world(), &scene)) {
            Ok(head) => table.push([
                file.display().to_string(),
                head.title,
                format!("{}D", head.dimension),
                format!("{} m", short(head.spacing)),
            ]),
            Err(error) => code = exit::report(&error),
        }
    }
    if !table.is_empty() {
        say(&table.render());
    }
    Ok(code)
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
