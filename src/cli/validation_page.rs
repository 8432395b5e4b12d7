//! The page of `storegga validate`. Each study leaves its part of the page in a file beside its figures, so that studies can be run one by
//! one, on several machines, and the page has all of them.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::export::unwritable;
use super::study::Done;
use crate::error::UserError;
use crate::replace::replace;
use crate::study::{FigureFile, Row, Table, escaped, figure_lines};

/// Name of the file with the part of a study.
const SECTION: &str = "section.json";

/// The part of the page that a study has.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Section {
    title: String,
    /// Its place on the page, before its name.
    order: u32,
    /// What was asked for and what came out, as cells.
    asked: Vec<Vec<String>>,
    /// Numbers of runs: all, those that are done, that diverged or failed, that are not done.
    runs: [usize; 4],
    /// Its Markdown, by lines.
    lines: Vec<String>,
    /// Its figures, whose files lie beside this one.
    figures: Vec<FigureFile>,
}

/// Writes the parts of the studies that were `done`, copies their figures from their folders in `runs`, and writes the page of all studies
/// that have a part. Names of the studies whose parts are kept as they were.
pub(super) fn write_page(page: &Path, runs: &Path, done: &[(String, Done)]) -> Result<Vec<String>, UserError> {
    let folder = figure_folder(page);
    for (name, done) in done {
        copy_figures(&runs.join(name), &folder.join(name), &done.figures)?;
        let path = folder.join(name).join(SECTION);
        let section = serde_json::to_string_pretty(&Section::of(name, done));
        let written = section.map_err(Into::into).and_then(|text| replace(&path, (text + "\n").as_bytes()));
        written.map_err(|error| unwritable(&path, &error))?;
    }
    let sections = sections(&folder)?;
    let text = written(&sections, &folder.file_name().unwrap_or_default().to_string_lossy());
    replace(page, text.as_bytes()).map_err(|error| unwritable(page, &error))?;
    let kept = sections.into_iter().map(|(name, _)| name).filter(|name| done.iter().all(|(new, _)| new != name));
    Ok(kept.collect())
}

/// The folder of the figures of a page: `validation` for `validation.md`.
pub(super) fn figure_folder(page: &Path) -> PathBuf {
    page.with_extension("")
}

/// Puts the figures of a study beside the page, in the place of what was there.
fn copy_figures(from: &Path, to: &Path, figures: &[FigureFile]) -> Result<(), UserError> {
    let fail = |error: std::io::Error| unwritable(to, &error);
    fs::create_dir_all(to).map_err(fail)?;
    for entry in fs::read_dir(to).map_err(fail)?.flatten() {
        if entry.path().extension().is_some_and(|extension| extension == "png") {
            fs::remove_file(entry.path()).map_err(fail)?;
        }
    }
    for FigureFile { file, .. } in figures {
        fs::copy(from.join(file), to.join(file)).map_err(fail)?;
    }
    Ok(())
}

/// Refuses a page whose parts cannot be read, before anything is run for it.
pub(super) fn refuse_unreadable(page: &Path) -> Result<(), UserError> {
    let folder = figure_folder(page);
    if folder.exists() { sections(&folder).map(drop) } else { Ok(()) }
}

/// The parts in the folder beside the page, in the order of the page.
fn sections(folder: &Path) -> Result<Vec<(String, Section)>, UserError> {
    let unreadable = |path: &Path, why: &dyn std::fmt::Display| {
        UserError::plain(format!("cannot read {}: {why}", path.display()))
            .help("delete what is there: a study without a part in the page has one when it is run again")
    };
    let mut sections = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| unreadable(folder, &error))?.flatten() {
        let path = entry.path().join(SECTION);
        if path.is_file() {
            let text = fs::read_to_string(&path).map_err(|error| unreadable(&path, &error))?;
            let section = serde_json::from_str(&text).map_err(|error| unreadable(&path, &error))?;
            sections.push((entry.file_name().to_string_lossy().into_owned(), section));
        }
    }
    sections.sort_by(|a: &(String, Section), b| (a.1.order, &a.0).cmp(&(b.1.order, &b.0)));
    Ok(sections)
}

impl Section {
    /// The part of the study `name`.
    fn of(name: &str, done: &Done) -> Self {
        let table = Table { plan: &done.plan, rows: &done.rows };
        let title = &done.plan.study.title;
        let count = |is: fn(&Row) -> bool| done.rows.iter().filter(|row| is(row)).count();
        Self {
            order: done.plan.study.order,
            title: escaped(if title.is_empty() { name } else { title }),
            asked: table.asked().iter().map(|asked| asked.cells().to_vec()).collect(),
            runs: [
                done.rows.len(),
                count(|row| matches!(row, Row::Done(..))),
                count(|row| matches!(row, Row::Diverged(_) | Row::Failed(_))),
                count(|row| matches!(row, Row::Waiting | Row::Interrupted)),
            ],
            lines: table.markdown("##").lines().map(str::to_owned).collect(),
            figures: done.figures.clone(),
        }
    }
}

/// The page, the figures of whose parts, by name, are below `folder`.
fn written(sections: &[(String, Section)], folder: &str) -> String {
    let mut text = "# Validation\n\nWritten by `storegga validate`: tables and figures are what the runs gave, and the words above them are those of the \
         study files. Each section is a study, and can be run alone (`storegga validate FILE --page …`). `took` is real time, on the threads that a run had and beside whatever else \
         went on; `build` is the checksum of the program that made the runs.\n\n\
         | case | asked of the last run that is done | at least | at most | seen | |\n|---|---|---|---|---|---|\n"
        .to_owned();
    for (_, section) in sections {
        for cells in &section.asked {
            let _ = writeln!(text, "| {} | {} |", section.title, cells.join(" | "));
        }
    }
    text += "\n| study | runs | done | diverged or failed | not done |\n|---|---|---|---|---|\n";
    for (_, section) in sections {
        let runs = section.runs.map(|number| number.to_string());
        let _ = writeln!(text, "| {} | {} |", section.title, runs.join(" | "));
    }
    for (name, section) in sections {
        let figures = figure_lines(&format!("{folder}/{name}/"), &section.figures);
        let _ = write!(text, "\n{}\n{figures}", section.lines.join("\n"));
    }
    text
}
