//! Refuses numbers outside the ranges that their schema states: what the reference page says and what is refused are one.

use schemars::generate::SchemaSettings;
use serde::Serialize;
use serde_json::Value;

use super::Describe;
use crate::number::plain;
use crate::scene::Invalid;

/// Refuses the first number of `value`, of the type that `describe` describes, that lies outside its range.
///
/// # Errors
/// The number, with its path in `value`.
pub(crate) fn check_ranges<T: Serialize>(describe: Describe, value: &T) -> Result<(), Invalid> {
    let mut generator = SchemaSettings::draft2020_12().into_generator();
    let schema = describe(&mut generator).to_value();
    let definitions = Value::Object(generator.take_definitions(true));
    let value = serde_json::to_value(value).unwrap_or_default();
    check(&definitions, &schema, &value)
}

fn check(definitions: &Value, schema: &Value, value: &Value) -> Result<(), Invalid> {
    let inner = |path: &str, schema: &Value, value: &Value| {
        check(definitions, schema, value).map_err(|invalid| invalid.under(path))
    };
    if let Some(name) = schema["$ref"].as_str().and_then(|path| path.rsplit('/').next()) {
        check(definitions, &definitions[name], value)?;
    }
    for part in schema["anyOf"].as_array().into_iter().flatten() {
        check(definitions, part, value)?;
    }
    match value {
        Value::Number(number) => in_range(schema, number.as_f64().unwrap_or(f64::NAN)),
        Value::Array(items) => items.iter().enumerate().try_for_each(|(k, item)| {
            let schema = if schema["prefixItems"].is_array() { &schema["prefixItems"][k] } else { &schema["items"] };
            inner(&k.to_string(), schema, item)
        }),
        Value::Object(fields) => {
            // A variant `Name(…)` has the path of its contents; what a newtype variant holds has the variant's range.
            for variant in schema["oneOf"].as_array().into_iter().flatten() {
                if let Some((name, held)) = fields.iter().next()
                    && let Some(body) = variant["properties"].get(name)
                {
                    check(definitions, body, held)?;
                    check(definitions, variant, if held.is_number() { held } else { &Value::Null })?;
                }
            }
            fields.iter().try_for_each(|(name, field)| match schema["properties"].get(name) {
                Some(schema) => inner(name, schema, field),
                None => inner(name, &schema["additionalProperties"], field),
            })
        }
        _ => Ok(()),
    }
}

/// Refuses `number` if it lies outside the range of `schema`.
fn in_range(schema: &Value, number: f64) -> Result<(), Invalid> {
    let bound = |key: &str| schema[key].as_f64();
    let (least, above) = (bound("minimum"), bound("exclusiveMinimum"));
    let (most, below) = (bound("maximum"), bound("exclusiveMaximum"));
    let holds = least.is_none_or(|least| number >= least)
        && above.is_none_or(|above| number > above)
        && most.is_none_or(|most| number <= most)
        && below.is_none_or(|below| number < below);
    if holds {
        return Ok(());
    }
    let rule = match (least.or(above), most.or(below)) {
        (Some(low), Some(high)) => format!("must lie between {low} and {high}"),
        (Some(0.0), None) if least.is_some() => "must not be negative".to_owned(),
        (Some(low), None) if least.is_some() => format!("must be at least {low}"),
        (Some(low), None) => format!("must be greater than {low}"),
        (None, high) => format!("must be at most {}", high.unwrap_or_default()),
    };
    let unit = schema["unit"].as_str().filter(|unit| *unit != "1").unwrap_or_default();
    Err(Invalid::new("", format!("{rule}, got {} {unit}", plain(number)).trim_end()))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use schemars::JsonSchema;

    use super::*;
    use crate::scene::schema::describe;

    #[derive(JsonSchema, Serialize)]
    struct Layer {
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
        thickness: f64,
        #[schemars(range(min = 0.0, max = 1.0), extend("unit" = "1"))]
        porosity: Option<f64>,
        fill: Option<Fill>,
    }

    #[derive(JsonSchema, Serialize, Clone, Copy)]
    enum Fill {
        #[schemars(extend("minimum" = 0.0, "unit" = "Pa"))]
        Uniform(f64),
        Ramp {
            #[schemars(range(min = 1.0), extend("unit" = "1"))]
            ratio: f64,
        },
    }

    fn refusal(layer: Layer) -> Option<(String, String)> {
        let layers: BTreeMap<&str, Vec<Layer>> = [("bed", vec![layer])].into();
        check_ranges(describe::<BTreeMap<&str, Vec<Layer>>>, &layers)
            .err()
            .map(|invalid| (invalid.path, invalid.message))
    }

    #[test]
    fn numbers_are_found_wherever_they_stand() {
        let sound = || Layer { thickness: 1.0, porosity: Some(0.5), fill: Some(Fill::Ramp { ratio: 1.0 }) };
        let wrong = |path: &str, message: &str| Some((path.to_owned(), message.to_owned()));
        assert_eq!(refusal(sound()), None);
        assert_eq!(refusal(Layer { porosity: None, fill: None, ..sound() }), None);
        let thin = Layer { thickness: 0.0, ..sound() };
        assert_eq!(refusal(thin), wrong("bed.0.thickness", "must be greater than 0, got 0 m"));
        let empty = Layer { porosity: Some(1.5), ..sound() };
        assert_eq!(refusal(empty), wrong("bed.0.porosity", "must lie between 0 and 1, got 1.5"));
        let suction = Layer { fill: Some(Fill::Uniform(-1.0)), ..sound() };
        assert_eq!(refusal(suction), wrong("bed.0.fill", "must not be negative, got -1 Pa"));
        let ramp = Layer { fill: Some(Fill::Ramp { ratio: 0.5 }), ..sound() };
        assert_eq!(refusal(ramp), wrong("bed.0.fill.ratio", "must be at least 1, got 0.5"));
    }
}
