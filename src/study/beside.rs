//! What runs are compared with: two columns of a CSV file beside the study.

use std::path::Path;

use serde::Deserialize;

use crate::expect::CsvTable;
use crate::figures::{Curve, Marks};
use crate::scene::{Invalid, SceneFile, clean};

/// A curve to compare with, from a file with a line of names; lines that begin with `#` are skipped.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beside {
    /// The file, seen from that of the study.
    pub file: String,
    /// Name of the column of times, or of whatever lies along the horizontal axis.
    pub x: String,
    /// Name of the column of values.
    pub y: String,
    /// What is added to `x`: the time (s) of a run at which the clock of a measurement shows 0.
    #[serde(default)]
    pub shift: f64,
    /// What it is called in a figure; by default the name of the file.
    #[serde(default)]
    pub name: String,
    /// Whether it is drawn as a dashed line: what was computed. By default measurements are rings, and laws beside measures dashed.
    #[serde(default)]
    pub is_line: Option<bool>,
    /// Its points; none before it has been read.
    #[serde(skip)]
    pub points: Vec<[f64; 2]>,
}

impl Beside {
    /// Reads the file, seen from `folder`.
    pub(super) fn read(&mut self, folder: &Path) -> Result<(), Invalid> {
        let path = clean(&folder.join(&self.file));
        let bytes = std::fs::read(&path)
            .map_err(|error| Invalid::new("file", format!("{} cannot be read: {error}", path.display())))?;
        // The table calls its columns as scenes do.
        let own = |invalid: Invalid| match invalid.path.as_str() {
            "time" => Invalid::new("x", invalid.message),
            "value" => Invalid::new("y", invalid.message),
            _ => invalid,
        };
        let table = CsvTable::read(&SceneFile { path: path.clone(), bytes }, &self.x, &self.y).map_err(own)?;
        self.points = table.rows().iter().map(|(x, y)| [*x + self.shift, *y]).collect();
        if self.name.is_empty() {
            self.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        }
        Ok(())
    }

    /// The curve in a figure; as a dashed line if it does not say otherwise and `usually_line`.
    pub(crate) fn curve(&self, usually_line: bool) -> Curve {
        let marks = if self.is_line.unwrap_or(usually_line) { Marks::Dashes } else { Marks::Rings };
        Curve { name: self.name.clone(), points: self.points.clone(), marks }
    }
}
