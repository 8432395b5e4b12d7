//! The runs of a study: every combination of values, or a list.

use super::document::expected;
use crate::error::UserError;
use crate::scene::document::{Field, Kind, Node};
use crate::scene::{Document, Setting, settings};

/// What a run of a list may be called, beside the values that it has.
const NAME: &str = "name";

/// The name of a run, empty if it has none, and its overrides.
type NamedRun = (String, Vec<Setting>);

/// Most runs of a study: more are a mistake rather than a plan.
const MOST_RUNS: usize = 10_000;

/// Paths that are varied, names and overrides of the runs, and whether they are a grid.
pub(super) struct Runs {
    pub varied: Vec<String>,
    pub names: Vec<String>,
    pub settings: Vec<Vec<Setting>>,
    pub is_grid: bool,
}

/// The runs that stand in `field`, `vary` or `coarse`.
pub(super) fn read_runs(document: &Document, field: &str) -> Result<Runs, UserError> {
    let Some(node) = document.node(field) else {
        let label = "needs `vary: Grid({…})` or `vary: List([…])`";
        return Err(document.error(document.root().opening(), "`vary` is missing", label));
    };
    let named = document.named(node)?;
    let runs = match named.name {
        "Grid" => grid(document, node.inner().unwrap_or(node)),
        "List" => list(document, node.inner().unwrap_or(node)),
        other => return Err(document.unknown_name_error(named.span, "way to vary", other, &["Grid", "List"])),
    }?;
    let (names, runs): (Vec<String>, Vec<Vec<Setting>>) = runs.into_iter().unzip();
    let fixed = settings(document, "set")?;
    let mut varied: Vec<String> = Vec::new();
    for setting in runs.iter().flatten() {
        if fixed.iter().any(|fixed| fixed.path == setting.path) {
            let message = format!("`{}` is varied, and stands in `set`, too", setting.path);
            return Err(document.error(setting.span.clone(), message, "varied here"));
        }
        if !varied.contains(&setting.path) {
            varied.push(setting.path.clone());
        }
    }
    Ok(Runs { varied, names, settings: runs, is_grid: named.name == "Grid" })
}

/// `{"path": [values]}`: every combination; the last path varies fastest.
fn grid(document: &Document, node: &Node) -> Result<Vec<NamedRun>, UserError> {
    const TABLE: &str = "a table of lists `{\"path\": [value, …]}`";
    let Kind::Map { entries } = &node.kind else { return Err(expected(document, node, TABLE)) };
    if entries.is_empty() {
        return Err(document.error(node.span.clone(), "nothing is varied", format!("expected {TABLE}")));
    }
    let mut runs = vec![Vec::new()];
    for entry in entries {
        let values = values(document, entry)?;
        if runs.len() * values.len() > MOST_RUNS {
            let message = format!("more than {MOST_RUNS} runs come of all combinations");
            return Err(document.error(entry.key_span.clone(), message, "with these values"));
        }
        let with = |run: &Vec<Setting>, value: &Setting| run.iter().chain([value]).cloned().collect();
        runs = runs.iter().flat_map(|run| values.iter().map(move |value| with(run, value))).collect();
    }
    Ok(runs.into_iter().map(|run| (String::new(), run)).collect())
}

/// The values that a path takes in a grid.
fn values(document: &Document, entry: &Field) -> Result<Vec<Setting>, UserError> {
    let Kind::List(items) = &entry.value.kind else {
        return Err(expected(document, &entry.value, "a list of values `[…]`"));
    };
    if items.is_empty() {
        let message = format!("the list of values of `{}` is empty", entry.key);
        return Err(document.error(entry.value.span.clone(), message, "expected at least one value"));
    }
    let values: Vec<Setting> = items.iter().map(|item| Setting::new(document, &entry.key, item)).collect();
    for (k, value) in values.iter().enumerate() {
        if values[..k].iter().any(|other| other.shown() == value.shown()) {
            let message = format!("`{}` is given twice", value.shown());
            return Err(document.error(value.span.clone(), message, "the second time"));
        }
    }
    Ok(values)
}

/// `[{"path": value}]`: these.
fn list(document: &Document, node: &Node) -> Result<Vec<NamedRun>, UserError> {
    const LIST: &str = "a list of tables `[{\"path\": value}, …]`";
    let Kind::List(items) = &node.kind else { return Err(expected(document, node, LIST)) };
    if items.is_empty() || items.len() > MOST_RUNS {
        let message = if items.is_empty() { "the list of runs is empty" } else { "these are too many runs" };
        return Err(document.error(node.opening(), message, format!("expected 1 to {MOST_RUNS} tables")));
    }
    let mut runs: Vec<NamedRun> = Vec::new();
    for item in items {
        let Kind::Map { entries } = &item.kind else {
            return Err(expected(document, item, "a table `{\"path\": value}`"));
        };
        let run: Vec<Setting> = entries.iter().map(|entry| Setting::new(document, &entry.key, &entry.value)).collect();
        let (names, run): (Vec<Setting>, Vec<Setting>) = run.into_iter().partition(|setting| setting.path == NAME);
        let name = names.into_iter().next().map(|setting| setting.text).unwrap_or_default();
        if runs.iter().any(|(_, other)| are_same(other, &run)) {
            return Err(document.error(item.span.clone(), "this run is given twice", "the second time"));
        }
        runs.push((name, run));
    }
    Ok(runs)
}

/// Whether two runs have the same overrides, in whatever order.
fn are_same(one: &[Setting], other: &[Setting]) -> bool {
    let has = |setting: &Setting| other.iter().any(|b| b.path == setting.path && b.shown() == setting.shown());
    one.len() == other.len() && one.iter().all(has)
}
