//! The check of what was expected against what came out.

use bevy_ecs::prelude::*;
use serde::Serialize;

use super::reference::Target;
use super::take::{Sample, Take};
use crate::probes::Series;

/// An expectation, and how it came out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// What was checked, in words.
    pub name: String,
    /// The value that came out; NaN if there is none.
    pub value: f64,
    /// What it should be, in the same unit: the middle of what is accepted.
    pub expected: f64,
    /// Greatest |value − expected| that is accepted, in the same unit.
    pub tolerance: f64,
    /// Unit of the value: that of the series, or of what is taken of it; empty for pure numbers.
    pub unit: String,
    /// What the scene says that it should be, with its unit.
    pub expected_text: String,
    /// What the scene says how near it should be.
    pub tolerance_text: String,
    /// Whether it is.
    pub pass: bool,
    /// Why there is no value; empty if there is one.
    pub note: String,
}

/// The expectations of the scene, ready to be checked.
#[derive(Resource, Debug, Clone, Default)]
pub(super) struct Expectations(pub(super) Vec<Resolved>);

/// An expectation whose series is found and whose reference is known.
#[derive(Debug, Clone)]
pub(super) struct Resolved {
    pub(super) name: String,
    pub(super) series: Entity,
    pub(super) field: usize,
    pub(super) take: Take,
    pub(super) target: Target,
    pub(super) tolerance: Tolerance,
}

/// How near a value should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Tolerance {
    /// A fraction, and the difference that it allows.
    Relative(f64, f64),
    /// A difference in the unit of the series.
    Absolute(f64),
    /// The target is a range.
    Range,
}

/// Whether the scene expects anything of its run.
#[must_use]
pub fn has_expectations(world: &World) -> bool {
    world.get_resource::<Expectations>().is_some_and(|expectations| !expectations.0.is_empty())
}

/// Checks every expectation of the scene, in their order, against the series as they are.
#[must_use]
pub fn evaluate(world: &World) -> Vec<Check> {
    let expectations = world.get_resource::<Expectations>();
    expectations.into_iter().flat_map(|expectations| &expectations.0).map(|one| one.check(world)).collect()
}

impl Resolved {
    fn check(&self, world: &World) -> Check {
        let series = world.get::<Series>(self.series);
        let samples: Vec<Sample> = series.map(|series| series.column(self.field).collect()).unwrap_or_default();
        let unit = series.and_then(|series| series.fields.get(self.field)).map_or("", |field| field.unit.as_str());
        let unit = self.take.unit(unit);
        let (value, note) = match self.value(&samples).and_then(|value| self.other(world).map(|_| value)) {
            Ok(value) if value.is_nan() => (value, "what was measured is not a number".to_owned()),
            Ok(value) => (value, String::new()),
            Err(why) => (f64::NAN, why),
        };
        let (least, greatest) = self.accepted(world);
        Check {
            name: self.name.clone(),
            value,
            expected: 0.5 * (least + greatest),
            tolerance: 0.5 * (greatest - least),
            expected_text: self.expected(world, &unit),
            tolerance_text: self.tolerance(&unit),
            unit: unit.into_owned(),
            // NaN is in no range.
            pass: (least..=greatest).contains(&value),
            note,
        }
    }

    /// The value to compare, or why there is none.
    fn value(&self, samples: &[Sample]) -> Result<f64, String> {
        match (&self.target, self.tolerance) {
            (Target::Table(table, _), Tolerance::Absolute(_)) => table.compare(samples).map(|(rms, _)| rms),
            (Target::Table(table, _), _) => table.compare(samples).map(|(rms, norm)| rms / norm),
            _ => self.take.of(samples),
        }
    }

    /// The value that it should be the same as, if it is another series', or why there is none.
    fn other(&self, world: &World) -> Result<Option<f64>, String> {
        let Target::Series(entity, field, name) = &self.target else { return Ok(None) };
        let samples: Vec<Sample> =
            world.get::<Series>(*entity).map(|series| series.column(*field).collect()).unwrap_or_default();
        self.take.of(&samples).map(Some).map_err(|why| format!("{name}: {why}"))
    }

    /// The least and the greatest value that is accepted.
    fn accepted(&self, world: &World) -> (f64, f64) {
        match (&self.target, self.tolerance) {
            (Target::Series(..), tolerance) => {
                let other = self.other(world).ok().flatten().unwrap_or(f64::NAN);
                let d = match tolerance {
                    Tolerance::Relative(fraction, _) => fraction * other.abs(),
                    Tolerance::Absolute(difference) => difference,
                    Tolerance::Range => 0.0,
                };
                (other - d, other + d)
            }
            (Target::Between(least, greatest), _) => (*least, *greatest),
            (Target::Number(number), Tolerance::Relative(_, d) | Tolerance::Absolute(d)) => (number - d, number + d),
            (Target::Table(..), Tolerance::Relative(_, d) | Tolerance::Absolute(d)) => (-d, d),
            (Target::Number(number), Tolerance::Range) => (*number, *number),
            (Target::Table(..), Tolerance::Range) => (0.0, 0.0),
        }
    }

    fn expected(&self, world: &World, unit: &str) -> String {
        match &self.target {
            Target::Number(number) => format!("{} {unit}", rounded(*number)).trim_end().to_owned(),
            Target::Between(least, greatest) => {
                format!("{} … {} {unit}", rounded(*least), rounded(*greatest)).trim_end().to_owned()
            }
            Target::Series(.., name) => match self.other(world) {
                Ok(Some(other)) => format!("{} {unit} ({name})", rounded(other)),
                _ => name.clone(),
            },
            Target::Table(table, file) => format!("{file} ({} rows)", table.len()),
        }
    }

    fn tolerance(&self, unit: &str) -> String {
        let sign = if matches!(self.target, Target::Table(..)) { "L2 ≤" } else { "±" };
        match self.tolerance {
            Tolerance::Relative(fraction, _) => format!("{sign} {} %", rounded(100.0 * fraction)),
            Tolerance::Absolute(difference) => format!("{sign} {} {unit}", rounded(difference)).trim_end().to_owned(),
            Tolerance::Range => String::new(),
        }
    }
}

/// The number to five significant digits.
fn rounded(number: f64) -> f64 {
    format!("{number:.4e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probes::test_support::{TANK, TestApp, measured, opened, scene};

    fn expecting(expectations: &str) -> String {
        scene(TANK, &format!("expect: [{expectations}],"))
    }

    fn only(app: &TestApp) -> Check {
        let mut checks = evaluate(app.0.world());
        assert_eq!(checks.len(), 1);
        checks.remove(0)
    }

    #[test]
    fn a_scene_without_expectations_has_none() {
        let app = measured(&scene(TANK, ""));
        assert!(!has_expectations(app.0.world()) && evaluate(app.0.world()).is_empty());
    }

    #[test]
    fn the_floor_of_the_tank_carries_the_weight() {
        let app = measured(&expecting(
            "(name: \"floor force\", of: \"floor.force_y\", is: FluidWeight, within: Relative(0.05))",
        ));
        assert!(has_expectations(app.0.world()));
        let check = only(&app);
        assert!(check.pass && check.value < -1700.0, "{check:?}");
        assert_eq!((check.tolerance_text.as_str(), check.note.as_str()), ("± 5 %", ""));
        assert!(check.expected_text.starts_with("-17") && check.expected_text.ends_with(" N"), "{check:?}");
    }

    #[test]
    fn each_tolerance_has_its_edges() {
        // The floor's area is 0.06 m².
        for (rest, pass) in [
            ("is: Number(0.05), within: Relative(0.21)", true),
            ("is: Number(0.05), within: Relative(0.19)", false),
            ("is: Number(0.05), within: Absolute(0.0101)", true),
            ("is: Number(0.07), within: Absolute(0.0099)", false),
            ("is: Between(0.05, 0.07)", true),
            ("is: Between(0.061, 0.07)", false),
        ] {
            let app = measured(&expecting(&format!("(name: \"n\", of: \"floor.volume\", {rest})")));
            assert_eq!(only(&app).pass, pass, "{rest}");
        }
    }

    #[test]
    fn two_numbers_of_a_run_can_be_compared() {
        // The floor fills 0.06 m² and displaces none of the fluid; its weight is carried by nobody else.
        for (of, rest, pass) in [
            ("floor.volume", "is: SameAs(\"floor.displaced\"), within: Absolute(0.061)", true),
            ("floor.volume", "is: SameAs(\"floor.displaced\"), within: Absolute(0.059)", false),
            ("floor.pressure_y", "is: SameAs(\"floor.force_y\"), within: Relative(1e-9)", true),
            ("floor.viscous_y", "is: SameAs(\"floor.force_y\"), within: Relative(0.9)", false),
        ] {
            let app = measured(&expecting(&format!("(name: \"n\", of: \"{of}\", {rest})")));
            let check = only(&app);
            assert_eq!(check.pass, pass, "{rest}: {check:?}");
            assert!(check.expected_text.contains(if of == "floor.volume" {
                "(floor.displaced)"
            } else {
                "(floor.force_y)"
            }));
        }
        let expectation = "(name: \"n\", of: \"floor.volume\", is: SameAs(\"floor.volume\"), within: Relative(0))";
        assert_eq!(only(&opened(&expecting(expectation))).note, "nothing was measured");
    }

    #[test]
    fn a_window_that_was_not_reached_fails_with_a_reason() {
        let app = measured(&expecting(
            "(name: \"n\", of: \"floor.volume\", take: Mean(from: 0.5, to: 1), is: Number(0.06), within: Absolute(1))",
        ));
        let check = only(&app);
        assert!(!check.pass && check.value.is_nan() && check.note.contains("leaves out 0.5 s"), "{check:?}");
    }

    #[test]
    fn nothing_measured_and_no_number_fail() {
        let expectation = "(name: \"n\", of: \"floor.volume\", is: Number(0.06), within: Absolute(1))";
        assert_eq!(only(&opened(&expecting(expectation))).note, "nothing was measured");
        let gauge = "probes: {\"dry\": SurfaceHeight(at: (0.9, 0))}, \
             expect: [(name: \"n\", of: \"dry.height\", is: Between(-1, 1))],";
        let check = only(&measured(&scene(TANK, gauge)));
        assert!(!check.pass && check.note.contains("not a number"), "{check:?}");
    }

    #[test]
    fn a_csv_file_lies_beside_its_scene() {
        let path = std::env::temp_dir().join(format!("storegga-expect-{}.csv", std::process::id()));
        assert!(std::fs::write(&path, "t,area\n0,0.05\n").is_ok());
        // Absolute paths stay as they are; `test.ron` has no folder of its own.
        let is = format!("is: Csv(file: {path:?}, time: \"t\", value: \"area\")");
        for (within, value, pass) in [("Relative(0.21)", 0.2, true), ("Absolute(0.009)", 0.01, false)] {
            let app = measured(&expecting(&format!("(name: \"n\", of: \"floor.volume\", {is}, within: {within})")));
            let check = only(&app);
            assert!((check.value - value).abs() < 1e-9 && check.pass == pass, "{check:?}");
            assert!(check.expected_text.ends_with("(1 rows)"));
        }
    }
}
