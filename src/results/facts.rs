//! What a log says of its run.

use std::collections::BTreeMap;

/// What figures and files need to know of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunFacts {
    /// Title of the scene.
    pub title: String,
    /// 2 or 3.
    pub dimension: usize,
    /// The axis that points up (0 for x, …): y in the plane; in space that of y and z along which gravity is stronger, z without gravity.
    pub up: usize,
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
        let dimension = number("dimension").map_or(2, |dimension| dimension as usize);
        Self {
            title: entry("parameters", "title").unwrap_or_default().trim_matches('"').to_owned(),
            dimension,
            up: vertical_axis(dimension, entry("parameters", "gravity").unwrap_or_default()),
            spacing: number("spacing").unwrap_or(0.0),
            phases: phases.into_iter().map(|(_, name)| name).collect(),
            units: metadata.get("units").cloned().unwrap_or_default(),
            parameters: metadata.get("parameters").cloned().unwrap_or_default(),
        }
    }
}

/// The axis that points up against `gravity`, a vector as a log has it.
fn vertical_axis(dimension: usize, gravity: &str) -> usize {
    let along = gravity.trim_matches(['(', ')']).split(',').map(|g| g.trim().parse::<f64>().map_or(0.0, f64::abs));
    let along: Vec<f64> = along.collect();
    match along[..] {
        _ if dimension == 2 => 1,
        [_, y, z] if y > z => 1,
        _ => 2,
    }
}

#[cfg(test)]
mod tests {
    use super::vertical_axis;

    #[test]
    fn up_is_against_gravity() {
        assert_eq!(vertical_axis(2, "(0.0,-9.81)"), 1);
        assert_eq!(vertical_axis(3, "(0.0,0.0,-9.81)"), 2);
        assert_eq!(vertical_axis(3, "(0.0,-9.81,0.0)"), 1);
        // A slope of 30° whose bed is the plane z = 0; and nothing that is known.
        assert_eq!(vertical_axis(3, "(4.905,0.0,-8.496)"), 2);
        assert_eq!(vertical_axis(3, ""), 2);
    }
}
