//! `storegga test`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use bevy_app::PluginGroup;

use super::args::TestArgs;
use super::exit::{self, complain, say};
use super::progress::Progress;
use super::scenes::scene_files;
use super::simulate::{Outcome, Settings, simulate};
use super::summary::{check_cells, verdict};
use super::table::Table;
use crate::app::{End, StopFlag, open};
use crate::error::UserError;
use crate::expect::has_expectations;
use crate::scene::open_document;

/// Runs scenes and compares them with their expectations. A scene that is wrong is complained about, and the others run.
pub(super) fn test<P: PluginGroup>(args: &TestArgs, plugins: fn() -> P) -> Result<ExitCode, UserError> {
    let stop = exit::stop_on_interrupt();
    let scenes = if args.scenes.is_empty() { scene_files(&args.folder.folder)? } else { args.scenes.clone() };
    let mut table = Table::new(["scene", "check", "value", "expected", "tolerance", ""]);
    let (mut all_pass, mut all_right) = (true, true);
    for scene in &scenes {
        match run_one(args, scene, plugins, &stop) {
            Ok(None) => {}
            Ok(Some(outcome)) if outcome.end == End::Interrupted => break,
            Ok(Some(outcome)) => {
                all_pass &= outcome.end == End::Done && outcome.passes();
                add_rows(&mut table, scene, &outcome);
            }
            Err(error) => {
                all_right = false;
                exit::report(&error);
            }
        }
    }
    let code = match (stop.is_set(), all_right, all_pass) {
        (true, ..) => exit::INTERRUPTED,
        (_, false, _) => exit::WRONG_INPUT,
        (_, _, false) => exit::FAILED,
        _ if table.is_empty() => {
            return Err(UserError::plain("no scene has expectations").help("they stand in its section `expect`"));
        }
        _ => 0,
    };
    if !table.is_empty() {
        say(&table.render());
    }
    Ok(ExitCode::from(code))
}

/// Runs a scene; `None` if nothing is expected of it.
fn run_one<P: PluginGroup>(
    args: &TestArgs,
    scene: &PathBuf,
    plugins: fn() -> P,
    stop: &StopFlag,
) -> Result<Option<Outcome>, UserError> {
    let mut app = open(plugins(), open_document(scene, &args.overrides.set)?)?;
    if !has_expectations(app.world()) {
        if args.scenes.contains(scene) {
            complain(&format!("Warning: {} has no expectations\n", scene.display()));
        }
        return Ok(None);
    }
    if !args.quiet {
        complain(&format!("{}\n", scene.display()));
    }
    let threads = args.threads.count();
    let settings = Settings { until: None, log: None, warnings: Vec::new(), checkpoints: None, resume: None, threads };
    simulate(&mut app, &settings, stop, &mut Progress::new(args.quiet)).map(Some)
}

fn add_rows(table: &mut Table, scene: &Path, outcome: &Outcome) {
    let scene = scene.display().to_string();
    if let End::Diverged(report) = &outcome.end {
        let what = format!("diverged at t = {} s: particle {}: {}", report.time, report.particle, report.broken);
        table.push([scene.clone(), what, String::new(), String::new(), String::new(), verdict(false).to_owned()]);
    }
    for check in outcome.checks.iter().flatten() {
        let [name, value, expected, tolerance, verdict] = check_cells(check);
        table.push([scene.clone(), name, value, expected, tolerance, verdict]);
    }
}
