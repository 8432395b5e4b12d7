//! `storegga validate`.

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use bevy_app::PluginGroup;

use super::exit::{self, complain, say};
use super::study::{Done, done};
use super::study_args::ValidateArgs;
use super::validation_page::{figure_folder, refuse_unreadable, write_page};
use crate::error::UserError;
use crate::study::{Study, Table};

/// Runs studies and writes one page of what came out of all of them.
pub(super) fn validate<P: PluginGroup>(args: &ValidateArgs, plugins: fn() -> P) -> Result<ExitCode, UserError> {
    let stop = exit::stop_on_interrupt();
    let page = args.page.clone().unwrap_or_else(|| args.out.join("validation.md"));
    if page.extension().is_none_or(|extension| extension != "md") || figure_folder(&page) == args.out {
        let message = format!("{} cannot be the page", page.display());
        return Err(UserError::plain(message)
            .help("its name ends in .md, and the folder of that name beside it is for its figures"));
    }
    let files = studies(&args.studies, args.how.coarse)?;
    refuse_unreadable(&page)?;
    let (mut all, mut code) = (Vec::new(), 0);
    for (name, file) in files {
        if !args.how.quiet {
            complain(&format!("{}\n", file.display()));
        }
        let Some(done) = done(&file, args.out.join(&name), &args.how, plugins, &stop)? else { break };
        code = worse(code, done.code);
        all.push((name, done));
        if stop.is_set() {
            break;
        }
    }
    if stop.is_set() {
        complain("The page is written when everything is done, or with --no-run.\n");
        return Ok(ExitCode::from(exit::INTERRUPTED));
    }
    let kept = write_page(&page, &args.out, &all)?;
    if !kept.is_empty() && !args.how.quiet {
        complain(&format!("The page keeps what it had of {}.\n", kept.join(", ")));
    }
    say(&format!("{}\n", page.display()));
    let is_missed = all.iter().any(|(_, done)| is_missed(done));
    Ok(ExitCode::from(if code == 0 && is_missed { exit::FAILED } else { code }))
}

/// The study files that are meant, each with its name: those that are named, and those in folders, by name. All of them are read, so that
/// a mistake in the last is told before the first runs.
fn studies(named: &[PathBuf], is_coarse: bool) -> Result<Vec<(String, PathBuf)>, UserError> {
    let mut files = Vec::new();
    for path in named {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let entries = fs::read_dir(path)
            .map_err(|error| UserError::plain(format!("cannot read the folder {}: {error}", path.display())))?;
        let mut found: Vec<PathBuf> = entries
            .flatten()
            .map(|entry| entry.path())
            .filter(|path| path.extension().is_some_and(|e| e == "ron"))
            .collect();
        if found.is_empty() {
            return Err(UserError::plain(format!("there is no study (*.ron) in {}", path.display())));
        }
        found.sort();
        files.append(&mut found);
    }
    let mut studies: Vec<(String, PathBuf)> = Vec::new();
    for file in files {
        Study::read(&file, is_coarse)?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if let Some((_, other)) = studies.iter().find(|(known, _)| *known == name) {
            let message = format!(
                "{} and {} have one name: their runs would go into one folder",
                other.display(),
                file.display()
            );
            return Err(UserError::plain(message));
        }
        studies.push((name, file));
    }
    Ok(studies)
}

/// The worse of two exit codes: a mistake before an interruption, a failure, a divergence.
fn worse(one: u8, other: u8) -> u8 {
    let order = [0, exit::DIVERGED, exit::FAILED, exit::INTERRUPTED, exit::WRONG_INPUT];
    let place = |code: u8| order.iter().position(|known| *known == code).unwrap_or(order.len());
    if place(one) >= place(other) { one } else { other }
}

/// Whether a number that was asked for is missed.
fn is_missed(done: &Done) -> bool {
    Table { plan: &done.plan, rows: &done.rows }.asked().iter().any(|asked| asked.is_missed())
}
