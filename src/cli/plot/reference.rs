//! What results are compared with: two columns of a CSV file.

use std::path::Path;

use crate::error::UserError;
use crate::expect::CsvTable;
use crate::figures::{Curve, LineFigure, Marks};
use crate::number::short;
use crate::results::Fit;
use crate::scene::SceneFile;

/// A curve to compare with.
pub(super) struct Reference {
    name: String,
    points: Vec<[f64; 2]>,
}

impl Reference {
    /// Reads `FILE.csv`, whose first two columns count, or `FILE.csv:X,Y`, which names them.
    pub fn read(text: &str) -> Result<Self, UserError> {
        let named = text.rsplit_once(':').and_then(|(file, names)| Some((file, names.split_once(',')?)));
        let file = named.map_or(text, |(file, _)| file);
        let path = Path::new(file);
        let bytes = std::fs::read(path).map_err(|error| UserError::plain(format!("cannot read {file}: {error}")))?;
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let head = text.lines().find(|line| !line.starts_with('#')).unwrap_or_default();
        let first_two =
            head.split_once(',').map(|(x, rest)| (x.trim(), rest.split(',').next().unwrap_or_default().trim()));
        let (x, y) = named.map(|(_, names)| names).or(first_two).unwrap_or_default();
        let table = CsvTable::read(&SceneFile { path: path.to_owned(), bytes }, x, y);
        let table = table.map_err(|invalid| UserError::plain(invalid.message))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, points: table.rows().iter().map(|(x, y)| [*x, *y]).collect() })
    }

    /// Adds the reference to a figure, and R² and L₂ of its first curve.
    pub fn add_to(&self, figure: &mut LineFigure, points: Option<usize>) -> Result<(), UserError> {
        let found = figure.curves.first().map_or(&[][..], |curve| &curve.points);
        let found: Vec<[f64; 2]> = found.iter().copied().filter(|point| point[1].is_finite()).collect();
        let fit =
            Fit::of(&self.points, &found, points).map_err(|why| UserError::plain(format!("{}: {why}", self.name)))?;
        figure.notes.push(format!("R² = {:.4}", fit.r_squared));
        figure.notes.push(format!("L₂ = {}", short(fit.l2)));
        figure.notes.push(format!("{} points", fit.points));
        figure.curves.push(Curve { name: self.name.clone(), points: self.points.clone(), marks: Marks::Rings });
        super::say(&format!(
            "R² = {:.6}, L2 = {} over {} points of {}\n",
            fit.r_squared,
            short(fit.l2),
            fit.points,
            self.name
        ));
        Ok(())
    }
}
