//! Series: numbers over time.

use serde_json::Value;

use crate::log::described_fields;

/// One quantity of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesField {
    /// Name, as in the log.
    pub name: String,
    /// SI unit; empty for pure numbers.
    pub unit: String,
    /// A value for each time; NaN where there was none.
    pub values: Vec<f64>,
}

/// What a topic logged over time. Words are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeSeries {
    /// Topic, such as `/probes/front`.
    pub topic: String,
    /// Simulated times (s).
    pub times: Vec<f64>,
    /// Quantities besides the time, in the order of the log.
    pub fields: Vec<SeriesField>,
}

impl TimeSeries {
    /// An empty series with the numbers that its JSON schema describes.
    pub(super) fn new(topic: &str, schema: &[u8]) -> Self {
        let numbers = described_fields(schema).into_iter().filter_map(|(name, unit)| Some((name, unit?)));
        let fields = numbers.filter(|(name, _)| name != "time");
        let fields = fields.map(|(name, unit)| SeriesField {
            name,
            unit: if unit == "1" { String::new() } else { unit },
            values: Vec::new(),
        });
        Self { topic: topic.to_owned(), times: Vec::new(), fields: fields.collect() }
    }

    /// Adds a message. One that cannot be read, or has no time, is left out.
    pub(super) fn push(&mut self, message: &[u8]) {
        let message: Value = serde_json::from_slice(message).unwrap_or_default();
        let Some(time) = message["time"].as_f64() else { return };
        self.times.push(time);
        for field in &mut self.fields {
            field.values.push(message[&field.name].as_f64().unwrap_or(f64::NAN));
        }
    }

    /// The last part of the topic: the name of the probe.
    #[must_use]
    pub fn name(&self) -> &str {
        self.topic.rsplit('/').next().unwrap_or(&self.topic)
    }

    /// The field called `name`.
    #[must_use]
    pub fn field(&self, name: &str) -> Option<&SeriesField> {
        self.fields.iter().find(|field| field.name == name)
    }
}
