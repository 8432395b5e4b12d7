//! Units of values of scenes, by their paths.

use std::collections::BTreeSet;

use serde_json::Value;

/// Levels of references and alternatives that are followed.
const MOST_LEVELS: usize = 64;

/// SI unit of the number at `path` of a scene, as `schema`, that of scenes, states it. None for numbers without dimension, for what
/// is no number, and where alternatives, such as rheologies, differ in the unit.
#[must_use]
pub fn unit_at(schema: &Value, path: &str) -> Option<String> {
    let parts: Vec<&str> = path.split('.').collect();
    let mut search = Search { whole: schema, found: BTreeSet::new() };
    search.follow(schema, &parts, None, MOST_LEVELS);
    let mut found = search.found.into_iter();
    found.next().filter(|unit| found.next().is_none() && *unit != "1").map(str::to_owned)
}

struct Search<'s> {
    whole: &'s Value,
    found: BTreeSet<&'s str>,
}

impl<'s> Search<'s> {
    /// Looks for the unit of what `path` leads to from `schema`, all of which has the unit `outer` if it is made of numbers.
    fn follow(&mut self, schema: &'s Value, path: &[&str], outer: Option<&'s str>, levels: usize) {
        let Some(levels) = levels.checked_sub(1) else { return };
        let unit = schema["unit"].as_str().or(outer);
        if path.is_empty() {
            self.found.extend(unit);
        }
        let referred = schema["$ref"].as_str().and_then(|path| self.whole.pointer(path.strip_prefix('#')?));
        let alternatives = ["oneOf", "anyOf", "allOf"].into_iter().filter_map(|key| schema[key].as_array()).flatten();
        for part in referred.into_iter().chain(alternatives) {
            self.follow(part, path, unit, levels);
        }
        let Some((first, rest)) = path.split_first() else { return };
        let fields = &schema["properties"];
        if let Some(field) = fields.get(first) {
            self.follow(field, rest, None, levels);
        } else if let Some(variant) = fields.as_object().and_then(only_variant) {
            self.follow(variant, path, unit, levels);
        } else if schema["additionalProperties"].is_object() {
            self.follow(&schema["additionalProperties"], rest, None, levels);
        }
        if let Ok(index) = first.parse::<usize>() {
            let item = schema["prefixItems"].get(index).unwrap_or(&schema["items"]);
            self.follow(item, rest, unit, levels);
        }
    }
}

/// What stands behind the name of a variant `Name(…)`, which paths pass over.
fn only_variant(fields: &serde_json::Map<String, Value>) -> Option<&Value> {
    let (name, value) = fields.iter().next().filter(|_| fields.len() == 1)?;
    name.starts_with(char::is_uppercase).then_some(value)
}

#[cfg(test)]
mod tests {
    use bevy_app::App;

    use super::*;
    use crate::app::PaperPlugins;
    use crate::scene::schema::scene_schema;

    #[test]
    fn units_are_those_that_the_fields_state() {
        let mut app = App::new();
        app.add_plugins(PaperPlugins).finish();
        let schema = scene_schema(app.world());
        for (path, unit) in [
            ("spacing", Some("m")),
            ("smoothing_ratio", None),
            ("title", None),
            ("gravity", Some("m/s²")),
            ("gravity.1", Some("m/s²")),
            ("phases.slide.rheology.yield_stress", Some("Pa")),
            ("phases.slide.reference_density", Some("kg/m³")),
            ("fluids.0.velocity.1", Some("m/s")),
            ("structures.pipe.shape.radius", Some("m")),
            ("equation_of_state.max_speed", Some("m/s")),
            ("log.series", Some("s")),
            ("nothing.of.the.kind", None),
        ] {
            assert_eq!(unit_at(&schema, path).as_deref(), unit, "{path}");
        }
    }
}
