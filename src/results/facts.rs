//! What a log says of its run.

use std::collections::BTreeMap;

/// What figures and files need to know of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunFacts {
    /// Title of the scene.
    pub title: String,
    /// 2 or 3.
    pub dimension: usize,
    /// Spacing (m) of the particles; 0 if the log does not say.
    pub spacing: f64,
    /// Names of the phases, by their number.
    pub phases: Vec<String>,
    /// Unit of each field of particles.
    pub units: BTreeMap<String, String>,
    /// Every parameter of the scene with its value, by its path.
    pub parameters: BTreeMap<String, String>,
}

impl RunFacts {
    pub(super) fn of(metadata: &BTreeMap<String, BTreeMap<String, String>>) -> Self {
        let entry =
            |record: &str, key: &str| metadata.get(record).and_then(|record| record.get(key)).map(String::as_str);
        let number = |key: &str| entry("parameters", key).and_then(|text| text.parse().ok());
        let phases = metadata.get("phases").cloned().unwrap_or_default();
        let mut phases: Vec<(usize, String)> =
            phases.into_iter().filter_map(|(index, name)| Some((index.parse().ok()?, name))).collect();
        phases.sort_unstable();
        Self {
            title: entry("parameters", "title").unwrap_or_default().trim_matches('"').to_owned(),
            dimension: number("dimension").map_or(2, |dimension| dimension as usize),
            spacing: number("spacing").unwrap_or(0.0),
            phases: phases.into_iter().map(|(_, name)| name).collect(),
            units: metadata.get("units").cloned().unwrap_or_default(),
            parameters: metadata.get("parameters").cloned().unwrap_or_default(),
        }
    }
}
