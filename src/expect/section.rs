//! Section `expect` of a scene.

use bevy_ecs::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check::{Expectations, Resolved, Tolerance};
use super::reference::{Reference, Target};
use super::take::Take;
use crate::probes::Series;
use crate::scene::{Invalid, SceneFacts, SceneInfo, SceneSection, SectionError, unknown};

/// Section `expect`: what should come out. All times, those of a file too, lie between 0 and `end_time`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct ExpectSection(Vec<Expectation>);

/// One expectation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// What is checked, in words.
    pub name: String,
    /// The measured number: `<series>.<field>`, such as `floor.force_y`.
    pub of: String,
    /// Which of its values counts; `None` for the last one.
    #[serde(default)]
    #[schemars(extend("derived" = "`Last`"))]
    pub take: Option<Take>,
    /// What it should be.
    pub is: Reference,
    /// How near it should be; not with `Between`.
    #[serde(default)]
    #[schemars(extend("derived" = "required, but not with `Between`"))]
    pub within: Option<Within>,
}

/// How near a value should be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Within {
    /// A fraction of what it should be.
    #[schemars(extend("unit" = "1", "minimum" = 0.0))]
    Relative(f64),
    /// A difference in the unit of the value.
    #[schemars(extend("unit" = "that of the value", "minimum" = 0.0))]
    Absolute(f64),
}

impl SceneSection for ExpectSection {
    const NAME: &'static str = "expect";

    fn when_absent() -> Option<Self> {
        Some(Self::default())
    }

    fn check(&self, _: &World) -> Result<(), Invalid> {
        self.0
            .iter()
            .enumerate()
            .try_for_each(|(k, expectation)| expectation.check().map_err(|invalid| invalid.under(&k.to_string())))
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let mut resolved = Vec::with_capacity(self.0.len());
        for (k, expectation) in self.0.into_iter().enumerate() {
            if expectation.take.is_none() && !matches!(expectation.is, Reference::Csv { .. }) {
                world.get_resource_or_init::<SceneFacts>().resolve(&format!("expect.{k}.take"), "Last");
            }
            resolved.push(expectation.resolve(world).map_err(|invalid| invalid.under(&k.to_string()))?);
        }
        world.insert_resource(Expectations(resolved));
        Ok(())
    }
}

impl Expectation {
    fn check(&self) -> Result<(), Invalid> {
        if let Some(take) = &self.take {
            take.check().map_err(|invalid| invalid.under("take"))?;
            if matches!(self.is, Reference::Csv { .. }) {
                return Err(Invalid::new("take", "a series from a file is compared at every time: leave `take` out"));
            }
        }
        match (&self.is, self.within) {
            (Reference::Between(..), Some(_)) => {
                Err(Invalid::new("within", "`Between` says by itself how near: leave `within` out"))
            }
            (Reference::Between(..), None) => Ok(()),
            (_, None) => Err(Invalid::new("", "give `within`: how near is near enough?")),
            (_, Some(Within::Relative(r) | Within::Absolute(r))) if r < 0.0 => {
                Err(Invalid::new("within", format!("must not be negative, got {r}")))
            }
            (Reference::Number(0.0), Some(Within::Relative(_))) => {
                Err(Invalid::new("within", "a fraction of 0 is 0: use `Absolute`"))
            }
            _ => Ok(()),
        }
    }

    /// Finds the series and works out what it should be.
    fn resolve(self, world: &mut World) -> Result<Resolved, Invalid> {
        let (series, field) = find(world, &self.of)?;
        let take = self.take.unwrap_or_default();
        let end_time = world.resource::<SceneInfo>().end_time;
        take.check_times(end_time).map_err(|invalid| invalid.under("take"))?;
        let target = self.is.resolve(world).map_err(|invalid| invalid.under("is"))?;
        if let (Target::Table(table, _), Some(Within::Relative(_))) = (&target, self.within)
            && table.is_zero()
        {
            return Err(Invalid::new(
                "within",
                "every value of the file is 0, and a fraction of 0 is 0: use `Absolute`",
            ));
        }
        if let Target::Series(other, other_field, _) = target {
            let unit = |(series, field): (Entity, usize)| {
                world.get::<Series>(series).map(|series| series.fields[field].unit.clone()).unwrap_or_default()
            };
            let (own, its) = (unit((series, field)), unit((other, other_field)));
            if own != its {
                return Err(Invalid::new("is", format!("the two numbers differ in unit: `{own}` and `{its}`")));
            }
        }
        let tolerance = match (&target, self.within) {
            (Target::Number(number), Some(Within::Relative(r))) => Tolerance::Relative(r, r * number.abs()),
            (_, Some(Within::Relative(r))) => Tolerance::Relative(r, r),
            (_, Some(Within::Absolute(a))) => Tolerance::Absolute(a),
            (_, None) => Tolerance::Range,
        };
        Ok(Resolved { name: self.name, series, field, take, target, tolerance })
    }
}

/// The series and the index of the field called `of`.
pub(crate) fn find(world: &mut World, of: &str) -> Result<(Entity, usize), Invalid> {
    let mut query = world.query::<(Entity, &Series)>();
    // Names may have dots in them: the last one parts series and field.
    let (name, field) = of.rsplit_once('.').unwrap_or((of, ""));
    if let Some((entity, series)) = query.iter(world).find(|(_, series)| series.name == name) {
        let fields = series.fields.iter().map(|field| field.name.as_str());
        let found = series.field(field).ok_or_else(|| unknown("of", &format!("field of `{name}`"), field, fields))?;
        return Ok((entity, found));
    }
    let mut known: Vec<&str> = query.iter(world).map(|(_, series)| series.name.as_str()).collect();
    known.sort_unstable();
    Err(unknown("of", "series", name, known))
}

#[cfg(test)]
mod tests {
    use crate::probes::test_support::{TANK, complaint, scene};

    fn refusal(expectation: &str) -> String {
        complaint(&scene(TANK, &format!("expect: [(name: \"n\", {expectation})],")))
    }

    #[test]
    fn unknown_numbers_are_refused_with_the_nearest_name() {
        let rest = "is: Number(1), within: Absolute(1)";
        assert!(refusal(&format!("of: \"flor.force_y\", {rest}")).contains("did you mean `floor`?"));
        assert!(refusal(&format!("of: \"floor.forc_y\", {rest}")).contains("did you mean `force_y`?"));
        assert!(refusal(&format!("of: \"energy\", {rest}")).contains("no field of `energy`"));
    }

    #[test]
    fn tolerances_that_make_no_sense_are_refused() {
        for (rest, word) in [
            ("is: Number(1)", "near enough"),
            ("is: Number(0), within: Relative(0.1)", "use `Absolute`"),
            ("is: Number(1), within: Absolute(-1)", "negative"),
            ("is: Between(1, 2), within: Absolute(1)", "leave `within` out"),
            ("is: Number(1), within: Absolute(1), take: Mean(from: 2, to: 1)", "after `from`"),
            ("is: Csv(file: \"a\", time: \"t\", value: \"v\"), within: Relative(1), take: Max", "leave `take` out"),
            ("is: Csv(file: \"a\", time: \"t\", value: \"v\"), within: Relative(1)", "cannot be read"),
            ("is: SameAs(\"floor.forc_y\"), within: Relative(0.1)", "did you mean `force_y`?"),
            ("is: SameAs(\"floor.volume\"), within: Relative(0.1)", "differ in unit: `N` and `m³`"),
            ("is: Number(1), within: Absolute(1), take: At(1.1)", "1.1 s lies outside the run"),
        ] {
            let refusal = refusal(&format!("of: \"floor.force_y\", {rest}"));
            assert!(refusal.contains(word), "{rest}: {refusal}");
        }
    }

    #[test]
    fn files_that_a_run_cannot_be_compared_with_are_refused() {
        let path = std::env::temp_dir().join(format!("storegga-zeros-{}.csv", std::process::id()));
        assert!(std::fs::write(&path, "t,zero,y\n0,0,1\n0.5,0,1\n1.5,0,1\n").is_ok());
        let is =
            |value: &str| format!("of: \"floor.volume\", is: Csv(file: {path:?}, time: \"t\", value: \"{value}\")");
        let late = refusal(&format!("{}, within: Absolute(1)", is("y")));
        assert!(late.contains("1.5 s lies outside the run"), "{late}");
        assert!(std::fs::write(&path, "t,zero\n0,0\n0.5,0\n").is_ok());
        let zeros = refusal(&format!("{}, within: Relative(1)", is("zero")));
        assert!(zeros.contains("use `Absolute`"), "{zeros}");
        assert_eq!(refusal(&format!("{}, within: Absolute(1)", is("zero"))), "");
    }
}
