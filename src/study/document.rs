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

use std::collections::BTreeMap;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;

use super::Beside;
use super::runs::{Runs, read_runs};
use crate::error::UserError;
use crate::expect::Take;
use crate::number::plain;
use crate::scene::document::{Kind, Node};
use crate::scene::{Document, Invalid, Setting, clean, open_document, read_text, settings, unknown};

/// Fields of a study.
const FIELDS: [&str; 11] =
    ["title", "text", "order", "scene", "until", "set", "vary", "coarse", "names", "measures", "figures"];

/// A study, as read.
#[derive(Debug, Clone)]
pub struct Study {
    /// What it shows, in a line; may be empty.
    pub title: String,
    /// What there is to say of it, in Markdown; may be empty.
    pub text: String,
    /// Its place on the page of all studies: small numbers first, and equal ones by name.
    pub order: u32,
    /// Whether the coarse values are meant.
    pub is_coarse: bool,
    /// The scene, from the folder of the program.
    pub scene: PathBuf,
    /// End (s) of every run, if it is not that of the scene.
    pub until: Option<f64>,
    /// Paths of the values that are varied, in the order of the file.
    pub varied: Vec<String>,
    /// What people are shown in the place of the paths of some of them.
    pub shown: BTreeMap<String, String>,
    /// Whether every combination is run, and not some that are listed.
    pub is_grid: bool,
    /// Numbers that are taken of every run.
    pub measures: Vec<Measure>,
    /// Figures.
    pub figures: Vec<FigureSpec>,
    /// Overrides of all runs, and those of each.
    set: Vec<Setting>,
    pub(super) runs: Vec<Vec<Setting>>,
    /// What each run is called, empty if it has no name.
    pub(super) names: Vec<String>,
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
    /// A curve that all its values are compared with, in the place of `take`: the measure is R² (Eq. 22).
    #[serde(default)]
    pub against: Option<Beside>,
    /// Cutoff (Hz) of the filter through which the number goes first, as in `storegga forces`; `None` for the number as it was logged.
    #[serde(default)]
    pub cutoff: Option<f64>,
    /// What it is multiplied by first: a moment by 1/arm becomes a force.
    #[serde(default)]
    pub scale: Option<Scale>,
    /// Least and greatest value that is asked for, of the last run of the study that is done.
    #[serde(default)]
    pub asked: Option<(f64, f64)>,
    /// The same of the last of its coarse runs; `None` if they are not judged.
    #[serde(default)]
    pub asked_coarse: Option<(f64, f64)>,
}

/// A number in the place of another, that times a factor.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scale {
    /// The factor.
    pub by: f64,
    /// Unit of the product.
    pub unit: String,
}

/// A figure of a study.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum FigureSpec {
    /// A measure over a varied value.
    Measure {
        /// Name of the measure.
        of: String,
        /// Path of the varied value on the horizontal axis, whose values are numbers, or the name of another measure.
        over: String,
        /// Paths of the varied values of which each combination has a curve of its own. By default all others in a grid, none
        /// in a list.
        #[serde(default)]
        by: Option<Vec<String>>,
        /// Whether both axes are logarithmic: that of a convergence is a line there.
        #[serde(default)]
        logarithmic: bool,
        /// Curves beside them, dashed.
        #[serde(default)]
        beside: Vec<Beside>,
    },
    /// A number over time, a curve for each run.
    Series {
        /// The measured number: `<series>.<field>`.
        of: String,
        /// What stands beside its axis; by default the series and the field.
        #[serde(default)]
        name: Option<String>,
        /// Cutoff (Hz) of the filter, as in a measure.
        #[serde(default)]
        cutoff: Option<f64>,
        /// What it is multiplied by, as in a measure.
        #[serde(default)]
        scale: Option<Scale>,
        /// First and last time (s) that are drawn; by default all.
        #[serde(default)]
        window: Option<(f64, f64)>,
        /// Measurements beside them.
        #[serde(default)]
        beside: Vec<Beside>,
    },
    /// The upper surface of a phase, a curve for each run.
    Surface {
        /// Name of the phase.
        of: String,
        /// Time (s); the nearest frame of each run is drawn.
        at: f64,
    },
    /// The particles of the last runs that are done, coloured by a quantity.
    Field {
        /// The quantity, such as `pressure`, `speed`, `phase`.
        of: String,
        /// Times (s); the nearest frames are drawn.
        at: Vec<f64>,
        /// Whether arrows show the velocity.
        #[serde(default)]
        arrows: bool,
        /// How many runs are drawn, with the same colours.
        #[serde(default = "one")]
        runs: NonZero<usize>,
    },
    /// A profile of the last run that is done.
    Profile {
        /// `surface:<phase>`, or `<field>:<axis>=<coordinate in m>`.
        of: String,
        /// Times (s); the nearest frames are drawn.
        at: Vec<f64>,
        /// Measurements or exact values beside it.
        #[serde(default)]
        beside: Vec<Beside>,
    },
}

impl Study {
    /// Reads the study at `path`, as strictly as a scene; with its `coarse` values in the place of `vary` if asked for and if it has any.
    ///
    /// # Errors
    /// What is wrong with it, with its place.
    pub fn read(path: &Path, is_coarse: bool) -> Result<Self, UserError> {
        let document = Arc::new(Document::parse_value(&path.display().to_string(), &read_text(path)?)?);
        let root = document.root();
        if !matches!(root.kind, Kind::Struct { .. }) || root.name().is_some_and(|name| name != "Study") {
            return Err(expected(&document, root, "a study `Study(…)`"));
        }
        document.require_known_fields("", &FIELDS)?;
        let scene: String = document.read("scene")?;
        let is_coarse = is_coarse && document.node("coarse").is_some();
        let Runs { varied, names, settings: runs, is_grid } =
            read_runs(&document, if is_coarse { "coarse" } else { "vary" })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut study = Self {
            title: optional(&document, "title")?,
            text: optional::<Vec<String>>(&document, "text")?.join(" "),
            order: optional(&document, "order")?,
            is_coarse,
            scene: clean(&folder.join(scene)),
            until: optional(&document, "until")?,
            varied,
            shown: optional(&document, "names")?,
            is_grid,
            measures: optional(&document, "measures")?,
            figures: optional(&document, "figures")?,
            set: settings(&document, "set")?,
            runs,
            names,
            document,
        };
        // Coarse runs may vary less than what is named.
        let named = if is_coarse { read_runs(&study.document, "vary")?.varied } else { study.varied.clone() };
        let strange = study.shown.keys().find(|path| !named.contains(path));
        let checked = strange
            .map_or(Ok(()), |path| Err(unknown("names", "varied value", path, named.iter().map(String::as_str))));
        let checked = checked.and_then(|()| study.check()).and_then(|()| study.read_curves(folder));
        checked.map_err(|invalid| study.document.invalid(&invalid))?;
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

    /// Reads the files of curves to compare with, seen from `folder`.
    fn read_curves(&mut self, folder: &Path) -> Result<(), Invalid> {
        for (k, measure) in self.measures.iter_mut().enumerate() {
            let read = measure.against.as_mut().map_or(Ok(()), |against| against.read(folder));
            read.map_err(|invalid| invalid.under(&format!("measures.{k}.against")))?;
        }
        for (k, figure) in self.figures.iter_mut().enumerate() {
            for (n, beside) in figure.beside_mut().iter_mut().enumerate() {
                beside.read(folder).map_err(|invalid| invalid.under(&format!("figures.{k}.beside.{n}")))?;
            }
        }
        Ok(())
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
        if measure.against.is_some() && measure.take != Take::Last {
            return Err(Invalid::new("take", "all values are compared with the file: leave `take` out"));
        }
        for (field, asked) in [("asked", measure.asked), ("asked_coarse", measure.asked_coarse)] {
            if asked.is_some_and(|(least, greatest)| least > greatest) {
                return Err(Invalid::new(field, "the least value comes first"));
            }
        }
        measure.take.check().map_err(|invalid| invalid.under("take"))
    }

    fn check_figure(&self, figure: &FigureSpec) -> Result<(), Invalid> {
        if let FigureSpec::Series { window: Some((from, to)), .. } = figure
            && from >= to
        {
            return Err(Invalid::new("window", "the first time comes first"));
        }
        let FigureSpec::Measure { of, over, by, .. } = figure else { return Ok(()) };
        let mut measures = self.measures.iter().map(|measure| measure.name.as_str());
        if !measures.clone().any(|name| name == of) {
            return Err(unknown("of", "measure", of, measures));
        }
        if !measures.any(|name| name == over) {
            self.check_varied("over", over)?;
        }
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
        if self.shown.get(path).is_some_and(String::is_empty) {
            return Err(Invalid::new(
                field,
                format!("`{path}` has an empty name in `names`: nothing would tell what it is"),
            ));
        }
        if varied.clone().any(|known| known == path) {
            return Ok(());
        }
        Err(unknown(field, "varied value", path, varied))
    }
}

impl FigureSpec {
    /// Curves that stand beside those of the runs.
    #[must_use]
    pub fn beside(&self) -> &[Beside] {
        match self {
            Self::Measure { beside, .. } | Self::Series { beside, .. } | Self::Profile { beside, .. } => beside,
            Self::Surface { .. } | Self::Field { .. } => &[],
        }
    }

    fn beside_mut(&mut self) -> &mut [Beside] {
        match self {
            Self::Measure { beside, .. } | Self::Series { beside, .. } | Self::Profile { beside, .. } => beside,
            Self::Surface { .. } | Self::Field { .. } => &mut [],
        }
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

/// What a field draws unless the study says otherwise: the last run.
const fn one() -> NonZero<usize> {
    NonZero::<usize>::MIN
}

fn optional<T: serde::de::DeserializeOwned + Default>(document: &Document, field: &str) -> Result<T, UserError> {
    if document.node(field).is_none() { Ok(T::default()) } else { document.read(field) }
}

pub(super) fn expected(document: &Document, node: &Node, what: &str) -> UserError {
    let message = format!("expected {what}, found {}", node.describe(document.text()));
    let is_long = document.text().get(node.span.clone()).is_some_and(|shown| shown.contains('\n'));
    let span = if is_long { node.opening() } else { node.span.clone() };
    document.error(span, message, format!("expected {what}"))
}
