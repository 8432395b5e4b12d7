//! `storegga reference` and `storegga schema`.

use std::process::ExitCode;

use bevy_app::{App, PluginGroup};

use super::exit::say;
use crate::error::UserError;
use crate::scene::schema::{editor_schema, reference_page};

/// Prints the page of all fields of a scene.
pub(super) fn reference<P: PluginGroup>(plugins: fn() -> P) -> Result<ExitCode, UserError> {
    say(&reference_page(with(plugins()).world()));
    Ok(ExitCode::SUCCESS)
}

/// Prints the JSON Schema of scenes.
pub(super) fn schema<P: PluginGroup>(plugins: fn() -> P) -> Result<ExitCode, UserError> {
    say(&format!("{:#}\n", editor_schema(with(plugins()).world())));
    Ok(ExitCode::SUCCESS)
}

fn with(plugins: impl PluginGroup) -> App {
    let mut app = App::new();
    app.add_plugins(plugins);
    app.finish();
    app
}
