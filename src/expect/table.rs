//! Series to compare with, from CSV files.

use std::path::Path;

use csv::StringRecord;

use super::take::{Sample, at, in_run};
use crate::scene::{Invalid, SceneFile};

/// Columns of a CSV file with a line of names; lines that begin with `#` are skipped.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CsvTable {
    /// Time (s) and value of each row.
    rows: Vec<Sample>,
}

impl CsvTable {
    /// Reads the columns `time` and `value` of a file.
    ///
    /// # Errors
    /// A column that is missing, or the first row that is not one of finite numbers at a later time.
    pub fn read(file: &SceneFile, time: &str, value: &str) -> Result<Self, Invalid> {
        let path = file.path.as_path();
        let refused = |error: csv::Error| unreadable(path, &error);
        let mut reader =
            csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(file.bytes.as_slice());
        let names: Vec<String> = reader.headers().map_err(refused)?.iter().map(str::to_owned).collect();
        if names.iter().all(String::is_empty) {
            let what = if names.len() > 1 { "has no names in its first line" } else { "is empty" };
            return Err(Invalid::new("file", format!("{} {what}: expected a line of names", path.display())));
        }
        if let [only] = names.as_slice()
            && only.contains(';')
        {
            return Err(Invalid::new("file", format!("{}: put `,` between the columns, not `;`", path.display())));
        }
        let columns = (column(&names, "time", time)?, column(&names, "value", value)?);
        let mut rows: Vec<Sample> = Vec::new();
        for record in reader.records() {
            let record = record.map_err(refused)?;
            let (t, y) = (number(path, &names, &record, columns.0)?, number(path, &names, &record, columns.1)?);
            if let Some((before, _)) = rows.last().filter(|(before, _)| *before >= t) {
                return Err(wrong_row(
                    path,
                    &record,
                    &format!("the time {t} s must lie after {before} s, that before it"),
                ));
            }
            rows.push((t, y));
        }
        if rows.is_empty() {
            return Err(Invalid::new("file", format!("{} has no rows", path.display())));
        }
        Ok(Self { rows })
    }

    /// Time (s) and value of each row, in the order of time.
    #[must_use]
    pub fn rows(&self) -> &[(f64, f64)] {
        &self.rows
    }

    /// Refuses rows at times at which a run from 0 to `end_time` (s) measures nothing.
    pub(super) fn check_times(&self, end_time: f64) -> Result<(), Invalid> {
        self.rows.iter().try_for_each(|(t, _)| in_run("file", *t, end_time))
    }

    /// Whether all values are 0.
    pub(super) fn is_zero(&self) -> bool {
        self.rows.iter().all(|(_, value)| *value == 0.0)
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Root mean square `√(Σ (y_k − ŷ(t_k))²/n)` of the difference between the rows y_k and a series ŷ, linear between
    /// its samples, and that of the rows themselves; or why there is none.
    pub(super) fn compare(&self, samples: &[Sample]) -> Result<(f64, f64), String> {
        let (mut error, mut norm) = (0.0, 0.0);
        for &(t, y) in &self.rows {
            error += (y - at(samples, t)?).powi(2);
            norm += y * y;
        }
        let n = self.rows.len() as f64;
        Ok(((error / n).sqrt(), (norm / n).sqrt()))
    }
}

/// The complaint about a file that the reader of CSV does not understand.
fn unreadable(path: &Path, error: &csv::Error) -> Invalid {
    let shown = path.display();
    let message = match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            format!("{shown}, line {line}: found {len} columns, expected the {expected_len} of the line of names")
        }
        _ => format!("{shown} cannot be read: {error}"),
    };
    Invalid::new("file", message)
}

/// The complaint about one row.
fn wrong_row(path: &Path, record: &StringRecord, message: &str) -> Invalid {
    let line = record.position().map_or(0, csv::Position::line);
    Invalid::new("file", format!("{}, line {line}: {message}", path.display()))
}

/// The finite number of a row in a column.
fn number(path: &Path, names: &[String], record: &StringRecord, column: usize) -> Result<f64, Invalid> {
    let text = record.get(column).unwrap_or_default();
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| wrong_row(path, record, &format!("`{text}` in `{}` is no number", names[column])))
}

/// Index of the column that the field `field` calls `name`.
fn column(names: &[String], field: &str, name: &str) -> Result<usize, Invalid> {
    let known = names.iter().map(String::as_str);
    names.iter().position(|known| known == name).ok_or_else(|| crate::scene::unknown(field, "column", name, known))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with this text.
    fn file(name: &str, text: &str) -> SceneFile {
        SceneFile { path: name.into(), bytes: text.as_bytes().to_vec() }
    }

    #[test]
    fn columns_are_found_by_name_and_comments_skipped() {
        let file = file("good.csv", "# digitised from Fig. 3\nt, x, y\n0.0, 1, 5\n# a gap\n1.0, 2, 7\n");
        let table = CsvTable::read(&file, "t", "y");
        assert_eq!(table, Ok(CsvTable { rows: vec![(0.0, 5.0), (1.0, 7.0)] }));
        // A series of 6 and 7 differs by −1 and 0.
        let compared = table.unwrap_or_default().compare(&[(0.0, 6.0), (2.0, 8.0)]);
        assert_eq!(compared, Ok((0.5_f64.sqrt(), 37.0_f64.sqrt())));
    }

    #[test]
    fn what_is_wrong_with_a_file_is_said_with_its_line() {
        let complaint = |name: &str, text: &str, value: &str| {
            CsvTable::read(&file(name, text), "t", value).err().map(|invalid| invalid.message).unwrap_or_default()
        };
        assert!(complaint("word.csv", "t,y\n# note\n0,1\n1,two\n", "y").contains("line 4: `two` in `y`"));
        assert!(complaint("short.csv", "t,y\n0,1\n1\n", "y").contains("line 3: found 1 columns, expected the 2"));
        assert!(complaint("german.csv", "t;y\n0;1\n", "y").contains("put `,` between the columns"));
        assert!(complaint("back.csv", "t,y\n0,1\n2,1\n1,1\n", "y").contains("line 4: the time 1 s must lie after 2 s"));
        assert!(complaint("twice.csv", "t,y\n0,1\n0,1\n", "y").contains("line 3"));
        assert!(complaint("empty.csv", "t,y\n", "y").contains("no rows"));
        assert!(complaint("nothing.csv", "", "y").contains("nothing.csv is empty"));
        assert!(complaint("comment.csv", "# to come\n", "y").contains("comment.csv is empty"));
        assert!(complaint("names.csv", "t,height\n0,1\n", "heigth").contains("did you mean `height`?"));
    }

    #[test]
    fn a_run_that_ended_too_early_cannot_be_compared() {
        let table = CsvTable { rows: vec![(0.5, 1.0), (2.0, 1.0)] };
        assert!(table.compare(&[(0.0, 1.0), (1.0, 1.0)]).is_err_and(|why| why.contains("leaves out 2 s")));
    }
}
