//! Series: what a run measures again and again, a row of numbers at a time.

use bevy_ecs::prelude::*;
use serde::{Deserialize, Serialize};

/// One number of a series.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SeriesField {
    /// Name: the property in the log, and what `expect` calls it.
    pub name: String,
    /// SI unit, empty for pure numbers.
    pub unit: String,
    /// What it means.
    pub description: String,
}

impl SeriesField {
    /// A field `name` in `unit`.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: &str, description: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.to_owned(), description: description.into() }
    }
}

/// Rows of numbers over time. Every entity that has one gets a channel of its own in the log, and expectations can ask
/// for it by its name: spawn one and [`push`](Series::push) rows in
/// [`OutputStage::Measure`](crate::schedule::OutputStage::Measure), after [`ProbeSystems`](super::ProbeSystems), to log
/// whatever a plugin measures.
#[derive(Component, Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Name, unique in the run.
    pub name: String,
    /// Topic of the channel.
    pub topic: String,
    /// What the series is.
    pub description: String,
    /// What each number of a row is.
    pub fields: Vec<SeriesField>,
    times: Vec<f64>,
    values: Vec<f64>,
}

impl Series {
    /// An empty series.
    #[must_use]
    pub fn new(name: &str, topic: impl Into<String>, description: impl Into<String>, fields: Vec<SeriesField>) -> Self {
        let (times, values) = (Vec::new(), Vec::new());
        Self { name: name.to_owned(), topic: topic.into(), description: description.into(), fields, times, values }
    }

    /// Makes room for `rows` more rows, so that recording them allocates nothing.
    pub fn reserve(&mut self, rows: usize) {
        self.times.reserve(rows);
        self.values.reserve(rows * self.fields.len());
    }

    /// Appends a row at `time` (s); `row` has a number for each field.
    pub fn push(&mut self, time: f64, row: &[f64]) {
        debug_assert_eq!(row.len(), self.fields.len());
        self.times.push(time);
        self.values.extend_from_slice(row);
    }

    /// Times (s) of the rows.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The row at index `k`.
    #[must_use]
    pub fn row(&self, k: usize) -> &[f64] {
        &self.values[k * self.fields.len()..(k + 1) * self.fields.len()]
    }

    /// Index of the field called `name`.
    #[must_use]
    pub fn field(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|field| field.name == name)
    }

    /// (time, value) of the field with this index.
    pub fn column(&self, field: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.times.iter().copied().zip(self.values.iter().skip(field).step_by(self.fields.len()).copied())
    }
}
