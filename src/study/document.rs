//! The study file.
//!
//! ```ron
//! Study(
//!     title: "Yield stress and spacing",
//!     scene: "../scenes/submarine_slide.ron",      // seen from this file
//!     vary: Grid({"phases.slide.rheology.yield_stress": [100.0, 750.0], "spacing": [0.05, 0.025]}),
//!     measures: [(name: "greatest front velocity", of: "front.velocity", take: Max)],
//!     figures: [Measure(of: "greatest front velocity", over: "phases.slide.rheology.yield_stress")],
//! )
//! ```

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;

use crate::error::UserError;
use crate::expect::Take;
use crate::number::plain;
use crate::scene::document::{Field, Kind, Node};
use crate::scene::{Document, Invalid, Setting, clean, open_document, read_text, settings, unknown};

/// Fields of a study.
const FIELDS: [&str; 7] = ["title", "scene", "until", "set", "vary", "measures", "figures"];

/// Most runs of a study: more are a mistake rather than a plan.
const MOST_RUNS: usize = 10_000;

/// A study, as read.
#[derive(Debug, Clone)]
pub struct Study {
    /// What it shows, in a line; may be empty.
    pub title: String,
    /// The scene, from the folder of the program.
    pub scene: PathBuf,
    /// End (s) of every run, if it is not that of the scene.
    pub until: Option<f64>,
    /// Paths of the values that are varied, in the order of the file.
    pub varied: Vec<String>,
    /// Whether every combination is run, and not some that are listed.
    pub is_grid: bool,
    /// Numbers that are taken of every run.
    pub measures: Vec<Measure>,
    /// Figures.
    pub figures: Vec<FigureSpec>,
    /// Overrides of all runs, and those of each.
    set: Vec<Setting>,
    pub(super) runs: Vec<Vec<Setting>>,
    document: Arc<Document>,
}

/// A number that is taken of every run: the words are those of an expectation of a scene.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measure {
    /// Its name, in words.
    pub name: String,
    /// The measured number: `<series>.<field>`, such as `front.velocity`.
    pub of: String,
    /// Which of its values counts; by default the last.
    #[serde(default)]
    pub take: Take,
}

/// A figure of a study.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum FigureSpec {
    /// A measure over a varied value.
    Measure {
        /// Name of the measure.
        of: String,
        /// Path of the varied value on the horizontal axis; its values are numbers.
        over: String,
        /// Paths of the varied values of which each combination has a curve of its own. By default all others in a grid, none
        /// in a list.
        #[serde(default)]
        by: Option<Vec<String>>,
    },
    /// A number over time, a curve for each run.
    Series {
        /// The measured number: `<series>.<field>`.
        of: String,
    },
    /// The upper surface of a phase, a curve for each run.
    Surface {
        /// Name of the phase.
        of: String,
        /// Time (s); the nearest frame of each run is drawn.
        at: f64,
    },
}

impl Study {
    /// Reads the study at `path`, as strictly as a scene.
    ///
    /// # Errors
    /// What is wrong with it, with its place.
    pub fn read(path: &Path) -> Result<Self, UserError> {
        let document = Arc::new(Document::parse_value(&path.display().to_string(), &read_text(path)?)?);
        let root = document.root();
        if !matches!(root.kind, Kind::Struct { .. }) || root.name().is_some_and(|name| name != "Study") {
            return Err(expected(&document, root, "a study `Study(…)`"));
        }
        document.require_known_fields("", &FIELDS)?;
        let scene: String = document.read("scene")?;
        let (varied, runs, is_grid) = read_runs(&document)?;
        let study = Self {
            title: optional(&document, "title")?,
            scene: clean(&path.parent().unwrap_or(Path::new("")).join(scene)),
            until: optional(&document, "until")?,
            varied,
            is_grid,
            measures: optional(&document, "measures")?,
            figures: optional(&document, "figures")?,
            set: settings(&document, "set")?,
            runs,
            document,
        };
        study.check().map_err(|invalid| study.document.invalid(&invalid))?;
        Ok(study)
    }

    /// The text of the file.
    #[must_use]
    pub fn text(&self) -> &str {
        self.document.text()
    }

    /// An error about a value of the file.
    pub(super) fn invalid(&self, invalid: &Invalid) -> UserError {
        self.document.invalid(invalid)
    }

    /// All overrides of run number `k`, in their order.
    pub(super) fn overrides(&self, k: usize) -> impl Iterator<Item = &Setting> {
        self.set.iter().chain(&self.runs[k])
    }

    /// The scene as it is without the study.
    pub(super) fn base(&self) -> Result<Document, UserError> {
        open_document(&self.scene, &[]).map_err(|error| {
            if error.place().is_some() {
                return error;
            }
            let placed = self.invalid(&Invalid::new("scene", error.message()));
            error.help_line().into_iter().fold(placed, |placed, help| placed.help(help))
        })
    }

    /// The scene of run number `k`: complaints about what the study changed point to its file.
    pub(super) fn scene_of(&self, base: &Document, k: usize) -> Result<Document, UserError> {
        self.overrides(k).try_fold(base.clone(), |scene, Setting { path, text, span }| {
            scene.set_from(path, text, (&self.document, span.clone()))
        })
    }

    fn check(&self) -> Result<(), Invalid> {
        if let Some(until) = self.until.filter(|until| *until <= 0.0) {
            return Err(Invalid::new("until", format!("must be greater than 0, got {until} s")));
        }
        for (k, measure) in self.measures.iter().enumerate() {
            self.check_measure(k, measure).map_err(|invalid| invalid.under(&format!("measures.{k}")))?;
        }
        self.figures.iter().enumerate().try_for_each(|(k, figure)| {
            self.check_figure(figure).map_err(|invalid| invalid.under(&format!("figures.{k}")))
        })
    }

    fn check_measure(&self, k: usize, measure: &Measure) -> Result<(), Invalid> {
        if measure.name.trim().is_empty() {
            return Err(Invalid::new("name", "a name may not be empty"));
        }
        if self.measures[..k].iter().any(|other| other.name == measure.name) {
            return Err(Invalid::new("name", "another measure has this name, too"));
        }
        measure.take.check().map_err(|invalid| invalid.under("take"))
    }

    fn check_figure(&self, figure: &FigureSpec) -> Result<(), Invalid> {
        let FigureSpec::Measure { of, over, by } = figure else { return Ok(()) };
        let measures = self.measures.iter().map(|measure| measure.name.as_str());
        if !measures.clone().any(|name| name == of) {
            return Err(unknown("of", "measure", of, measures));
        }
        self.check_varied("over", over)?;
        for (k, path) in by.iter().flatten().enumerate() {
            self.check_varied(&format!("by.{k}"), path)?;
            if path == over {
                return Err(Invalid::new(format!("by.{k}"), "this value is on the horizontal axis"));
            }
        }
        let mut values = self.runs.iter().flatten().filter(|setting| setting.path == *over);
        match values.find(|setting| setting.number().is_none()) {
            Some(word) => {
                Err(Invalid::new("over", format!("`{}` is no number: it has no place on an axis", word.text)))
            }
            None => Ok(()),
        }
    }

    fn check_varied(&self, field: &str, path: &str) -> Result<(), Invalid> {
        let varied = self.varied.iter().map(String::as_str);
        if varied.clone().any(|known| known == path) {
            return Ok(());
        }
        Err(unknown(field, "varied value", path, varied))
    }
}

impl Setting {
    /// The number that it is, if it is one.
    pub(super) fn number(&self) -> Option<f64> {
        number(&self.text)
    }

    /// The value as it is shown: one number looks the same however it is written.
    pub(super) fn shown(&self) -> String {
        shown(&self.text)
    }
}

/// The number that a value of a scene is, if it is one.
pub(super) fn number(text: &str) -> Option<f64> {
    text.trim().replace('_', "").parse().ok().filter(|number: &f64| number.is_finite())
}

/// A value of a scene as it is shown.
pub(super) fn shown(text: &str) -> String {
    number(text).map_or_else(|| text.split_whitespace().collect::<Vec<_>>().join(" "), plain)
}

fn optional<T: serde::de::DeserializeOwned + Default>(document: &Document, field: &str) -> Result<T, UserError> {
    if document.node(field).is_none() { Ok(T::default()) } else { document.read(field) }
}

fn expected(document: &Document, node: &Node, what: &str) -> UserError {
    let message = format!("expected {what}, found {}", node.describe(document.text()));
    let is_long = document.text().get(node.span.clone()).is_some_and(|shown| shown.contains('\n'));
    let span = if is_long { node.opening() } else { node.span.clone() };
    document.error(span, message, format!("expected {what}"))
}

/// Paths that are varied, the overrides of each run, and whether they are a grid.
type Runs = (Vec<String>, Vec<Vec<Setting>>, bool);

fn read_runs(document: &Document) -> Result<Runs, UserError> {
    let Some(node) = document.node("vary") else {
        let label = "needs `vary: Grid({…})` or `vary: List([…])`";
        return Err(document.error(document.root().opening(), "`vary` is missing", label));
    };
    let named = document.named(node)?;
    let runs = match named.name {
        "Grid" => grid(document, node.inner().unwrap_or(node)),
        "List" => list(document, node.inner().unwrap_or(node)),
        other => return Err(document.unknown_name_error(named.span, "way to vary", other, &["Grid", "List"])),
    }?;
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
    Ok((varied, runs, named.name == "Grid"))
}

/// `{"path": [values]}`: every combination; the last path varies fastest.
fn grid(document: &Document, node: &Node) -> Result<Vec<Vec<Setting>>, UserError> {
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
    Ok(runs)
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
fn list(document: &Document, node: &Node) -> Result<Vec<Vec<Setting>>, UserError> {
    const LIST: &str = "a list of tables `[{\"path\": value}, …]`";
    let Kind::List(items) = &node.kind else { return Err(expected(document, node, LIST)) };
    if items.is_empty() || items.len() > MOST_RUNS {
        let message = if items.is_empty() { "the list of runs is empty" } else { "these are too many runs" };
        return Err(document.error(node.opening(), message, format!("expected 1 to {MOST_RUNS} tables")));
    }
    let mut runs: Vec<Vec<Setting>> = Vec::new();
    for item in items {
        let Kind::Map { entries } = &item.kind else {
            return Err(expected(document, item, "a table `{\"path\": value}`"));
        };
        let run: Vec<Setting> = entries.iter().map(|entry| Setting::new(document, &entry.key, &entry.value)).collect();
        if runs.iter().any(|other| are_same(other, &run)) {
            return Err(document.error(item.span.clone(), "this run is given twice", "the second time"));
        }
        runs.push(run);
    }
    Ok(runs)
}

/// Whether two runs have the same overrides, in whatever order.
fn are_same(one: &[Setting], other: &[Setting]) -> bool {
    let has = |setting: &Setting| other.iter().any(|b| b.path == setting.path && b.shown() == setting.shown());
    one.len() == other.len() && one.iter().all(has)
}
