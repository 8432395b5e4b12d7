//! What scenes may hold, as a JSON Schema made from the types that they are read into, plugins' included.
//!
//! A doc comment is a description; `#[schemars(…)]` adds to a field what a type does not say:
//!
//! ```
//! # use schemars::JsonSchema;
//! #[derive(JsonSchema)]
//! struct Earthquake {
//!     /// Greatest acceleration of the ground.
//!     #[schemars(range(min = 0.0), extend("unit" = "m/s²"))]
//!     peak: f64,
//!     /// Duration.
//!     #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0.0, "derived" = "that of the run"))]
//!     duration: Option<f64>,
//! }
//! ```
//!
//! `unit` stands on every number ("1" for one without dimension) and on what is made of numbers; `derived` says in words
//! what a field left out follows from. A range is not only told: a number outside it is refused. RON maps to JSON as `serde` does it: `(a: 1)` is `{"a": 1}`, `(1, 2)` is `[1, 2]`,
//! `Name` is `"Name"`, `Name(a: 1)` is `{"Name": {"a": 1}}`, and `None` is `null`.

mod page;
mod ranges;
mod units;
mod words;

use std::borrow::Cow;
use std::marker::PhantomData;

use bevy_ecs::prelude::*;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Map, Value, json};

use super::header::DEFAULT_KERNEL;
use super::variant::VariantFile;
use super::{Header, SectionRegistry};
use crate::kernels::KernelRegistry;
use crate::probes::ProbeRegistry;
use crate::rheology::RheologyRegistry;

pub use page::reference_page;
pub(crate) use ranges::check_ranges;
pub use units::unit_at;

/// Makes the schema of a type.
pub(crate) type Describe = fn(&mut SchemaGenerator) -> Schema;

/// The schema of `T`, by reference where it has a name.
pub(crate) fn describe<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    generator.subschema_for::<T>()
}

/// A registry whose entries are the variants of an enum that stays open: rheologies, probes, kernels.
pub(crate) trait OpenEnum: Resource {
    /// Its name in the schema.
    const NAME: &'static str;

    /// Name and schema of each variant.
    fn variants(&self) -> impl Iterator<Item = (&str, Describe)>;
}

/// Stands in a derived schema for a value whose name is looked up in the registry `R`.
pub(crate) struct Open<R>(PhantomData<R>);

impl<R: OpenEnum> JsonSchema for Open<R> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        R::NAME.into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        Schema::new_ref(format!("#/$defs/{}", R::NAME))
    }
}

/// The JSON Schema (draft 2020-12) of every scene that the plugins of `world` can read; that of a variant of a scene is
/// `#/$defs/VariantFile`.
#[must_use]
pub fn scene_schema(world: &World) -> Value {
    let mut generator = SchemaSettings::draft2020_12().into_generator();
    let mut scene = Header::json_schema(&mut generator).to_value();
    scene["title"] = json!("Storegga scene");
    scene["properties"]["kernel"] = json!({
        "$ref": "#/$defs/kernel",
        "description": "Smoothing kernel, by name.",
        "default": DEFAULT_KERNEL,
    });
    for section in &world.resource::<SectionRegistry>().entries {
        let mut schema = (section.describe)(&mut generator).to_value();
        match (section.when_absent)() {
            Some(value) => schema["default"] = value,
            None => push(&mut scene["required"], json!(section.name)),
        }
        scene["properties"][section.name] = schema;
    }
    describe::<VariantFile>(&mut generator);
    let open = [
        open_enum(world.resource::<RheologyRegistry>(), &mut generator),
        open_enum(world.resource::<ProbeRegistry>(), &mut generator),
        kernels(world.resource::<KernelRegistry>(), &mut generator),
    ];
    let mut definitions = generator.take_definitions(true);
    definitions.extend(open.map(|(name, schema)| (name.to_owned(), schema)));
    scene["additionalProperties"] = json!(false);
    scene["$defs"] = Value::Object(definitions);
    let mut whole = json!({"$schema": "https://json-schema.org/draft/2020-12/schema"});
    if let (Value::Object(whole), Value::Object(scene)) = (&mut whole, scene) {
        whole.extend(scene);
    }
    for_each_object(&mut whole, &mut |object| {
        if let Some(Value::String(text)) = object.get_mut("description") {
            *text = without_links(text);
        }
    });
    whole
}

/// The schema for editors, which show descriptions and know nothing of units: these and derived defaults stand in them.
#[must_use]
pub fn editor_schema(world: &World) -> Value {
    let mut schema = scene_schema(world);
    for_each_object(&mut schema, &mut |object| {
        let word = |key: &str| object.get(key).and_then(Value::as_str);
        let unit = word("unit").map(|unit| format!("Unit: {unit}."));
        let derived = word("derived").map(|derived| format!("Left out: {derived}."));
        let parts: Vec<String> =
            word("description").map(str::to_owned).into_iter().chain(unit).chain(derived).collect();
        if !parts.is_empty() {
            object.insert("description".to_owned(), json!(parts.join("\n")));
        }
    });
    schema
}

fn push(list: &mut Value, item: Value) {
    if let Value::Array(list) = list {
        list.push(item);
    }
}

/// One variant a registered name: `Name(…)`, and `Name` alone where nothing has to be given.
fn open_enum<R: OpenEnum>(registry: &R, generator: &mut SchemaGenerator) -> (&'static str, Value) {
    let mut variants = Vec::new();
    for (name, describe) in registry.variants() {
        let body = describe(generator);
        let definition = body.get("$ref").and_then(Value::as_str).and_then(|path| path.rsplit('/').next());
        let definition = definition.and_then(|name| generator.definitions().get(name));
        let needs_nothing = definition.is_none_or(|definition| definition.get("required").is_none());
        variants.push(json!({
            "type": "object",
            "properties": {name: body},
            "required": [name],
            "additionalProperties": false,
        }));
        if needs_nothing {
            variants.push(json!({"const": name}));
        }
    }
    (R::NAME, json!({"oneOf": variants, "open": true}))
}

/// Kernels have no parameters: each is a name.
fn kernels(registry: &KernelRegistry, generator: &mut SchemaGenerator) -> (&'static str, Value) {
    let mut alone = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true).into_generator();
    let variants: Vec<Value> = registry
        .variants()
        .map(|(name, describe)| {
            describe(generator);
            json!({"const": name, "description": describe(&mut alone).get("description")})
        })
        .collect();
    (KernelRegistry::NAME, json!({"oneOf": variants}))
}

/// Calls `change` for every object inside `value`.
fn for_each_object(value: &mut Value, change: &mut impl FnMut(&mut Map<String, Value>)) {
    match value {
        Value::Object(object) => {
            change(object);
            object.values_mut().for_each(|inner| for_each_object(inner, change));
        }
        Value::Array(items) => items.iter_mut().for_each(|inner| for_each_object(inner, change)),
        _ => {}
    }
}

/// A doc comment without its links to items of the program: `` [`a`](crate::a) `` and `` [`a`] `` become `` `a` ``.
fn without_links(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("[`") {
        plain.push_str(before);
        let Some((name, end)) = after.split_once("`]") else { return plain + "[`" + after };
        plain.push_str(&format!("`{name}`"));
        let target = end.strip_prefix('(').and_then(|target| target.split_once(')'));
        rest = target.map_or(end, |(_, end)| end);
    }
    plain + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_to_items_lose_their_targets() {
        assert_eq!(without_links("as [`a`](crate::a) and [`b`], [c](d)"), "as `a` and `b`, [c](d)");
        assert_eq!(without_links("[`a"), "[`a");
    }
}
