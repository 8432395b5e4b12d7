//! The table of a study: what was varied, how each run ended, what was measured.

use std::fmt::Write;
use std::io;
use std::path::Path;

use super::figures::{FigureFile, figure_lines};
use super::{Drawn, Finished, Plan, Source};
use crate::error::UserError;
use crate::figures::labelled;
use crate::log::LogError;
use crate::number::{count, duration, plain, short};
use crate::replace::replace;
use crate::results::{Fit, PARTICLES, Record, Results, upper_surface};

/// What came of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Row {
    /// It was not run yet.
    Waiting,
    /// It was interrupted, and can go on.
    Interrupted,
    /// It failed; why.
    Failed(String),
    /// It left the range of the model.
    Diverged(Finished),
    /// It is done: its measures, and the points of the curve of each figure, or why there is none.
    Done(Finished, Vec<Result<f64, String>>, Vec<Result<Vec<[f64; 2]>, String>>),
}

impl Row {
    /// The row of a run that has ended, from its log.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn of(plan: &Plan, finished: Finished, log: &Path) -> Result<Self, UserError> {
        if finished.has_diverged {
            return Ok(Self::Diverged(finished));
        }
        let results = Results::open(log).map_err(unreadable)?;
        let measures = plan.study.measures.iter().zip(&plan.measures).map(|(measure, source)| {
            let taken = samples(&results, source).and_then(|samples| match &measure.against {
                Some(against) => {
                    let points: Vec<[f64; 2]> =
                        samples.iter().map(|(t, y)| [*t, *y]).filter(|[_, y]| y.is_finite()).collect();
                    Fit::of(&against.points, &points, None).map(|fit| fit.r_squared)
                }
                None => measure.take.of(&samples),
            });
            match taken {
                Ok(value) if value.is_nan() => Err("what was measured is not a number".to_owned()),
                taken => taken,
            }
        });
        let curves = plan.drawn.iter().map(|drawn| curve(&results, drawn)).collect::<Result<_, _>>();
        Ok(Self::Done(finished, measures.collect(), curves.map_err(unreadable)?))
    }

    /// How it ended, in a word.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Waiting => "not run",
            Self::Interrupted => "interrupted",
            Self::Failed(_) => "failed",
            Self::Diverged(_) => "diverged",
            Self::Done(..) => "done",
        }
    }

    /// What is left of it, if it has ended.
    #[must_use]
    pub const fn finished(&self) -> Option<&Finished> {
        match self {
            Self::Diverged(finished) | Self::Done(finished, ..) => Some(finished),
            _ => None,
        }
    }

    /// Duration (s), if it is known.
    #[must_use]
    pub fn wall(&self) -> Option<f64> {
        self.finished().and_then(|finished| finished.record.as_ref()?.wall_s)
    }

    /// The value of measure `k`.
    #[must_use]
    pub fn measure(&self, k: usize) -> Option<f64> {
        let Self::Done(_, measures, _) = self else { return None };
        measures.get(k).and_then(|value| value.as_ref().ok().copied())
    }

    /// What is to be said besides.
    fn note(&self, plan: &Plan) -> String {
        match self {
            Self::Failed(why) => why.clone(),
            Self::Diverged(finished) => {
                finished.record.as_ref().map(|record| record.reason.clone()).unwrap_or_default()
            }
            Self::Done(_, measures, curves) => {
                let names = plan.study.measures.iter().map(|measure| measure.name.clone());
                let of_measures = names.zip(measures.iter().map(|value| value.as_ref().err()));
                let names = (1..=curves.len()).map(|number| format!("figure {number}"));
                let of_figures = names.zip(curves.iter().map(|curve| curve.as_ref().err()));
                let reasons = of_measures.chain(of_figures).filter_map(|(name, why)| Some(format!("{name}: {}", why?)));
                reasons.collect::<Vec<_>>().join("; ")
            }
            Self::Waiting | Self::Interrupted => String::new(),
        }
    }
}

fn unreadable(error: LogError) -> UserError {
    UserError::plain(error.to_string())
}

/// Times (s) and values of a number of a log, filtered if that is asked for. What is no number before the first and after the last one stays
/// none; what lies between has no frequencies, and is not filtered.
fn samples(results: &Results, source: &Source) -> Result<Vec<(f64, f64)>, String> {
    let series = results.series.iter().find(|series| series.topic == source.topic);
    let found = series.and_then(|series| Some((series, series.field(&source.field)?)));
    let samples: Vec<(f64, f64)> = found.map_or_else(Vec::new, |(series, field)| {
        series.times.iter().copied().zip(field.values.iter().map(|value| source.factor * value)).collect()
    });
    let Some(cutoff) = source.cutoff else { return Ok(samples) };
    let is_number = |(_, value): &(f64, f64)| value.is_finite();
    let (Some(first), Some(last)) = (samples.iter().position(is_number), samples.iter().rposition(is_number)) else {
        return Err("it is never a number".to_owned());
    };
    if let Some((time, _)) = samples[first..=last].iter().find(|sample| !is_number(sample)) {
        return Err(format!("it is no number at {time} s, in the midst of the record, which cannot be filtered so"));
    }
    let filtered = Record::of(&samples[first..=last])?.filtered(cutoff)?;
    let filtered = filtered.values.iter().enumerate().map(|(k, value)| (filtered.time(k), *value));
    Ok(samples[..first].iter().copied().chain(filtered).chain(samples[last + 1..].iter().copied()).collect())
}

/// The points that a figure shows of a run.
fn curve(results: &Results, drawn: &Drawn) -> Result<Result<Vec<[f64; 2]>, String>, LogError> {
    let points = match drawn {
        Drawn::Measures | Drawn::Frames => Vec::new(),
        Drawn::Series(source) => {
            let samples = samples(results, source);
            return Ok(samples.map(|samples| samples.into_iter().map(|(time, value)| [time, value]).collect()));
        }
        Drawn::Surface(phase, at) => {
            let Some(number) = results.nearest_frame(PARTICLES, *at) else { return Ok(Ok(Vec::new())) };
            let (frame, facts) = (results.frame(PARTICLES, number)?, &results.facts);
            let surface = |frame| upper_surface(&frame, *phase, facts.up, facts.spacing);
            frame.map_or_else(Vec::new, surface)
        }
    };
    Ok(Ok(points))
}

/// What was asked for of a measure, and what came out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked<'a> {
    /// Name of the measure.
    pub name: &'a str,
    /// Its unit.
    pub unit: &'a str,
    /// Least and greatest value.
    pub range: (f64, f64),
    /// What the last run that is done has.
    pub value: Option<f64>,
    /// The run that it has the value of, if that is not the last one of the study.
    pub coarser: Option<&'a str>,
    /// Whether the range counts: coarse runs are judged by what is asked of them alone.
    pub is_judged: bool,
    /// Whether the runs are coarse ones.
    pub is_coarse: bool,
}

impl Asked<'_> {
    /// Whether there is no value, or one that counts and is not in the range.
    #[must_use]
    pub fn is_missed(&self) -> bool {
        !self.value.is_some_and(|value| !self.is_judged || (self.range.0..=self.range.1).contains(&value))
    }

    /// Name, least and greatest value, value and verdict, for a table in Markdown.
    #[must_use]
    pub fn cells(&self) -> [String; 5] {
        let verdict = match (self.is_missed(), self.is_judged) {
            (true, _) => "**missed**",
            (_, false) => "not judged",
            _ => "met",
        };
        let verdict = format!("{verdict}{}", if self.is_coarse { ": coarse" } else { "" });
        let by = self.coarser.map(|run| format!(", by {run}: the last run is not done")).unwrap_or_default();
        let seen = self.value.map_or_else(|| "–".to_owned(), short);
        let name = escaped(&labelled(self.name, self.unit));
        [name, short(self.range.0), short(self.range.1), seen, escaped(&(verdict + &by))]
    }
}

/// A text in a cell of a table in Markdown.
pub fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}

/// The rows of a study, in the order of its plan.
#[derive(Debug, Clone)]
pub struct Table<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// A row a run.
    pub rows: &'a [Row],
}

impl Table<'_> {
    /// Writes the table to `path` as CSV, for programs: numbers with all their digits, units in the line of names.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_csv(&self, path: &Path) -> Result<(), UserError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let written = std::iter::once(self.names()).chain(self.cells()).try_for_each(|row| writer.write_record(row));
        let bytes = written
            .map_err(io::Error::from)
            .and_then(|()| writer.into_inner().map_err(|error| io::Error::other(error.to_string())));
        bytes.and_then(|bytes| replace(path, &bytes)).map_err(|error| unwritable(path, &error))
    }

    fn names(&self) -> Vec<String> {
        let with_unit =
            |name: &str, unit: &str| if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") };
        let varied = self.plan.varied.iter().map(|varied| with_unit(&varied.path, &varied.unit));
        let measures = self.plan.study.measures.iter().zip(&self.plan.measures);
        let measures = measures.map(|(measure, source)| with_unit(&measure.name, &source.unit));
        let fixed = ["fluid particles", "end", "time [s]", "steps", "wall time [s]"].map(str::to_owned);
        let names = std::iter::once("run".to_owned()).chain(varied).chain(fixed).chain(measures);
        names.chain(["note".to_owned()]).collect()
    }

    fn cells(&self) -> impl Iterator<Item = Vec<String>> {
        self.plan.runs.iter().zip(self.rows).map(|(run, row)| {
            let number = |value: Option<f64>| value.map_or_else(String::new, plain);
            let finished = row.finished();
            let fixed = [
                run.particles.fluid.to_string(),
                row.word().to_owned(),
                number(finished.map(|finished| finished.time)),
                finished.map_or_else(String::new, |finished| finished.steps.to_string()),
                number(row.wall()),
            ];
            let measures = (0..self.plan.measures.len()).map(|k| number(row.measure(k)));
            let cells = std::iter::once(run.name.clone()).chain(run.values.iter().cloned()).chain(fixed);
            cells.chain(measures).chain([row.note(self.plan)]).collect()
        })
    }

    /// The table for people: a line of names, then a line a run; numbers have four digits.
    #[must_use]
    pub fn lines(&self) -> Vec<Vec<String>> {
        let shown = || (0..self.plan.varied.len()).filter(|k| !self.plan.varied[*k].shown.is_empty());
        let varied = shown().map(|k| &self.plan.varied[k]).map(|varied| labelled(&varied.shown, &varied.unit));
        let measures = self.plan.study.measures.iter().zip(&self.plan.measures);
        let measures = measures.map(|(measure, source)| labelled(&measure.name, &source.unit));
        let has_labels = self.plan.runs.iter().any(|run| !run.label.is_empty());
        let run = has_labels.then(|| "run".to_owned()).into_iter();
        let names = run
            .chain(varied)
            .chain(["fluid particles", "end", "steps", "took"].map(str::to_owned))
            .chain(measures)
            .collect();
        let row = |(run, row): (&super::PlannedRun, &Row)| {
            let label = has_labels.then(|| run.label.clone());
            let values = label.into_iter().chain(shown().map(|k| run.shown(k)));
            let end = match row {
                Row::Diverged(finished) => format!("diverged at {} s", short(finished.time)),
                other => other.word().to_owned(),
            };
            let fixed = [
                count(run.particles.fluid as u64),
                end,
                row.finished().map_or_else(String::new, |finished| count(finished.steps)),
                row.wall().map_or_else(String::new, duration),
            ];
            let measures = (0..self.plan.measures.len()).map(|k| row.measure(k).map_or_else(String::new, short));
            values
                .chain(fixed)
                .chain(measures)
                .map(|cell| if cell.is_empty() { "–".to_owned() } else { cell })
                .collect()
        };
        std::iter::once(names).chain(self.plan.runs.iter().zip(self.rows).map(row)).collect()
    }

    /// Writes the table to `path` as Markdown, with `figures`, files in the same folder, below it.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_markdown(&self, path: &Path, figures: &[FigureFile]) -> Result<(), UserError> {
        let text = self.markdown("#") + &figure_lines("", figures);
        replace(path, text.as_bytes()).map_err(|error| unwritable(path, &error))
    }

    /// The page of the study: its title behind `level`, text, table, and what was asked for.
    #[must_use]
    pub fn markdown(&self, level: &str) -> String {
        let study = &self.plan.study;
        let title = if study.title.is_empty() { "A study" } else { &study.title };
        let mut text = format!("{level} {title}\n\n");
        if !study.text.is_empty() {
            let _ = write!(text, "{}\n\n", study.text.trim());
        }
        let _ = write!(text, "Scene: `{}`", study.scene.display());
        if let Some(until) = study.until {
            let _ = write!(text, ", to t = {until} s");
        }
        let coarse = if study.is_coarse { " Coarse runs." } else { "" };
        let _ = writeln!(text, ". Made by storegga {}{}.{coarse}\n", env!("CARGO_PKG_VERSION"), self.builds());
        for (k, line) in self.lines().iter().enumerate() {
            let cells: Vec<String> = line.iter().map(|cell| escaped(cell)).collect();
            let _ = writeln!(text, "| {} |", cells.join(" | "));
            if k == 0 {
                let _ = writeln!(text, "|{}", "---|".repeat(line.len()));
            }
        }
        text += &self.verdicts();
        let notes = self.plan.runs.iter().zip(self.rows).map(|(run, row)| (&run.name, row.note(self.plan)));
        let notes: Vec<_> = notes.filter(|(_, note)| !note.is_empty()).collect();
        if !notes.is_empty() {
            text += "\n";
        }
        for (name, note) in notes {
            let _ = writeln!(text, "- `{name}`: {note}");
        }
        text
    }

    /// The builds of the program that made the runs, by their checksums.
    fn builds(&self) -> String {
        let of_row = |row: &Row| row.finished()?.record.as_ref()?.program;
        let mut builds: Vec<String> = self.rows.iter().filter_map(of_row).map(|build| format!("{build:08x}")).collect();
        builds.sort_unstable();
        builds.dedup();
        match builds.len() {
            0 => String::new(),
            1 => format!(", build {}", builds[0]),
            _ => format!(", builds {}", builds.join(", ")),
        }
    }

    /// What is asked of the last run, with the values of the last one that is done.
    #[must_use]
    pub fn asked(&self) -> Vec<Asked<'_>> {
        let study = &self.plan.study;
        let done = self.rows.iter().rposition(|row| matches!(row, Row::Done(..)));
        let asked = study.measures.iter().enumerate().filter_map(|(m, measure)| {
            Some(Asked {
                name: &measure.name,
                unit: self.plan.measures[m].unit.as_str(),
                range: if study.is_coarse { measure.asked_coarse.or(measure.asked)? } else { measure.asked? },
                value: done.and_then(|k| self.rows[k].measure(m)),
                coarser: done.filter(|k| k + 1 < self.rows.len()).map(|k| self.plan.runs[k].name.as_str()),
                is_judged: !study.is_coarse || measure.asked_coarse.is_some(),
                is_coarse: study.is_coarse,
            })
        });
        asked.collect()
    }

    /// [`asked`](Self::asked) in Markdown.
    fn verdicts(&self) -> String {
        let lines = self.asked().into_iter().map(|asked| format!("| {} |\n", asked.cells().join(" | ")));
        let lines: String = lines.collect();
        if lines.is_empty() {
            return lines;
        }
        format!(
            "\n| asked of the last run that is done | at least | at most | seen | |\n|---|---|---|---|---|\n{lines}"
        )
    }
}

fn unwritable(path: &Path, error: &io::Error) -> UserError {
    UserError::plain(format!("cannot write {}: {error}", path.display()))
}
