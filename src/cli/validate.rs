//! `storegga validate`.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use bevy_app::PluginGroup;

use super::exit::{self, complain, say};
use super::export::unwritable;
use super::study::{Done, done};
use super::study_args::ValidateArgs;
use crate::error::UserError;
use crate::replace::replace;
use crate::study::Table;

/// Runs studies and writes one page of what came out of all of them.
pub(super) fn validate<P: PluginGroup>(args: &ValidateArgs, plugins: fn() -> P) -> Result<ExitCode, UserError> {
    let stop = exit::stop_on_interrupt();
    let page = args.page.clone().unwrap_or_else(|| args.out.join("validation.md"));
    let (mut sections, mut code) = (Vec::new(), 0);
    for file in studies(&args.studies)? {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if !args.how.quiet {
            complain(&format!("{}\n", file.display()));
        }
        let Some(done) = done(&file, args.out.join(&name), &args.how, plugins, &stop)? else { break };
        code = worse(code, done.code);
        sections.push((name, done));
        if stop.is_set() {
            break;
        }
    }
    for (name, done) in &sections {
        copy_figures(&args.out.join(name), &figure_folder(&page).join(name), &done.figures)?;
    }
    let text = written(&sections, &page);
    replace(&page, text.as_bytes()).map_err(|error| unwritable(&page, &error))?;
    say(&format!("{}\n", page.display()));
    if stop.is_set() {
        return Ok(ExitCode::from(exit::INTERRUPTED));
    }
    let is_missed = sections.iter().any(|(_, done)| is_missed(done));
    Ok(ExitCode::from(if code == 0 && is_missed { exit::FAILED } else { code }))
}

/// The study files that are meant: those that are named, and those in folders, by name.
fn studies(named: &[PathBuf]) -> Result<Vec<PathBuf>, UserError> {
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
    Ok(files)
}

/// The worse of two exit codes: a mistake before an interruption, a failure, a divergence.
fn worse(one: u8, other: u8) -> u8 {
    let order = [0, exit::DIVERGED, exit::FAILED, exit::INTERRUPTED, exit::WRONG_INPUT];
    let place = |code: u8| order.iter().position(|known| *known == code).unwrap_or(order.len());
    if place(one) >= place(other) { one } else { other }
}

/// The folder of the figures of a page: `validation` for `validation.md`.
fn figure_folder(page: &Path) -> PathBuf {
    page.with_extension("")
}

/// Puts the figures of a study beside the page, in the place of what was there.
fn copy_figures(from: &Path, to: &Path, figures: &[String]) -> Result<(), UserError> {
    let fail = |error: std::io::Error| unwritable(to, &error);
    fs::create_dir_all(to).map_err(fail)?;
    for entry in fs::read_dir(to).map_err(fail)?.flatten() {
        if entry.path().extension().is_some_and(|extension| extension == "png") {
            fs::remove_file(entry.path()).map_err(fail)?;
        }
    }
    for figure in figures {
        fs::copy(from.join(figure), to.join(figure)).map_err(fail)?;
    }
    Ok(())
}

/// Whether a number that was asked for is missed.
fn is_missed(done: &Done) -> bool {
    Table { plan: &done.plan, rows: &done.rows }.asked().iter().any(|asked| asked.is_missed())
}

/// The page.
fn written(sections: &[(String, Done)], page: &Path) -> String {
    let mut text = format!(
        "# Validation\n\nWritten by `storegga validate` of storegga {}: every number below is what its runs gave. Each section is a study \
         of the folder `studies`, and can be run alone (`storegga study FILE`).\n\n\
         | case | asked of the last run that is done | at least | at most | seen | |\n|---|---|---|---|---|---|\n",
        env!("CARGO_PKG_VERSION")
    );
    for (_, done) in sections {
        let table = Table { plan: &done.plan, rows: &done.rows };
        for asked in table.asked() {
            let _ = writeln!(text, "| {} | {} |", done.plan.study.title, asked.cells().join(" | "));
        }
    }
    let folder = figure_folder(page);
    let folder = folder.file_name().unwrap_or_default().to_string_lossy();
    for (name, done) in sections {
        let table = Table { plan: &done.plan, rows: &done.rows };
        let _ = write!(text, "\n{}", table.markdown("##", &format!("{folder}/{name}/"), &done.figures));
    }
    text
}
