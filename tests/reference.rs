//! The reference page and the JSON Schema of scenes, as the shipped plugins make them.

#[path = "support/shipped.rs"]
mod shipped;

use std::collections::BTreeSet;
use std::path::PathBuf;

use bevy_app::App;
use serde_json::{Value, json};
use storegga::app::open;
use storegga::scene::document::{Kind, Node, Scalar};
use storegga::scene::schema::{reference_page, scene_schema};
use storegga::scene::{Document, open_document};
use storegga_standard::StandardPlugins;

fn app() -> App {
    let mut app = App::new();
    app.add_plugins(StandardPlugins);
    app.finish();
    app
}

fn schema() -> Value {
    scene_schema(app().world())
}

#[test]
fn the_page_in_the_repository_is_that_of_the_types() {
    let committed = std::fs::read_to_string(shipped::root().join("docs/scene.md")).expect("the page is there");
    let made = reference_page(app().world());
    if let Some((line, (old, new))) = committed.lines().zip(made.lines()).enumerate().find(|(_, (old, new))| old != new)
    {
        panic!("docs/scene.md is out of date from line {} on:\n  has   {old}\n  needs {new}\n{UPDATE}", line + 1);
    }
    assert!(committed == made, "docs/scene.md is out of date: one page is longer than the other\n{UPDATE}");
}

const UPDATE: &str = "update it: cargo run -- reference > docs/scene.md";

/// Where in a schema something stands, and its unit if one is in force there.
#[derive(Clone)]
struct Spot {
    path: String,
    unit: bool,
}

/// Every number in `schema` that has no unit: neither itself, nor the list, the field or the variant that holds it.
fn without_unit(schema: &Value, spot: &Spot, found: &mut Vec<String>) {
    if !schema.is_object() {
        return;
    }
    let unit = spot.unit || schema["unit"].is_string();
    let is_number = |kind: &Value| kind == "number" || kind == "integer";
    let kinds = &schema["type"];
    if !unit && (is_number(kinds) || kinds.as_array().is_some_and(|kinds| kinds.iter().any(is_number))) {
        found.push(spot.path.clone());
    }
    // Of a variant's one property the variant itself speaks; each field of a struct speaks for itself.
    let inner = |what: &str, unit| Spot { path: format!("{}/{what}", spot.path), unit };
    for (name, field) in schema["properties"].as_object().into_iter().flatten() {
        let is_variant = name.starts_with(char::is_uppercase);
        without_unit(field, &inner(name, unit && is_variant), found);
    }
    for key in ["items", "additionalProperties"] {
        without_unit(&schema[key], &inner(key, unit), found);
    }
    for key in ["oneOf", "anyOf", "prefixItems"] {
        for (k, part) in schema[key].as_array().into_iter().flatten().enumerate() {
            without_unit(part, &inner(&k.to_string(), unit), found);
        }
    }
}

#[test]
fn every_number_has_a_unit() {
    let schema = schema();
    let mut found = Vec::new();
    without_unit(&schema, &Spot { path: "scene".to_owned(), unit: false }, &mut found);
    for (name, definition) in schema["$defs"].as_object().expect("there are definitions") {
        without_unit(definition, &Spot { path: name.clone(), unit: false }, &mut found);
    }
    assert!(found.is_empty(), "numbers without #[schemars(extend(\"unit\" = …))]: {found:#?}");
}

#[test]
fn every_field_and_variant_is_described_and_every_default_is_told() {
    let schema = schema();
    let definitions = schema["$defs"].as_object().expect("there are definitions");
    let mut found = Vec::new();
    let all = definitions.iter().map(|(name, schema)| (name.as_str(), schema)).chain([("scene", &schema)]);
    for (owner, holder) in all {
        let bodies = holder["oneOf"].as_array().into_iter().flatten();
        let bodies = bodies.flat_map(|one| one["properties"].as_object().into_iter().flatten());
        let bodies = bodies.map(|(name, body)| (format!("{owner}/{name}"), body)).chain([(owner.to_owned(), holder)]);
        for (place, body) in bodies {
            for (name, field) in body["properties"].as_object().into_iter().flatten() {
                let by_reference = field["$ref"].as_str().and_then(|path| definitions.get(path.rsplit('/').next()?));
                let described = |schema: &Value| schema["description"].is_string();
                if !described(field) && !by_reference.is_some_and(described) {
                    found.push(format!("{place}/{name} has no doc comment"));
                }
                let is_required = body["required"].as_array().is_some_and(|all| all.iter().any(|one| one == name));
                let has_default = field.get("default").is_some_and(|default| !default.is_null());
                if !is_required && !has_default && !field["derived"].is_string() {
                    found.push(format!("{place}/{name} does not say in words what it is when left out"));
                }
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// A value of a scene as JSON, by the rules that the reference page states.
fn json(node: &Node, text: &str) -> Value {
    let body = match &node.kind {
        Kind::Struct { .. } | Kind::Map { .. } => {
            let fields = node.fields().iter().map(|field| (field.key.clone(), json(&field.value, text)));
            Value::Object(fields.collect())
        }
        Kind::Tuple { items, .. } if node.name().is_some() && items.len() == 1 => json(&items[0], text),
        Kind::Tuple { items, .. } if items.is_empty() => json!({}),
        Kind::Tuple { items, .. } | Kind::List(items) => items.iter().map(|item| json(item, text)).collect(),
        Kind::Scalar(Scalar::Text(content)) => return json!(content),
        Kind::Scalar(Scalar::Nothing) => return Value::Null,
        Kind::Scalar(Scalar::Name(name)) => return json!(name),
        Kind::Scalar(_) => {
            let written = &text[node.span.clone()];
            let whole = written.parse::<i64>().map(|number| json!(number));
            return whole
                .or_else(|_| written.parse::<f64>().map(|number| json!(number)))
                .unwrap_or_else(|_| json!(written == "true"));
        }
    };
    match node.name() {
        None | Some("Scene" | "Some") => body,
        Some(name) => json!({name: body}),
    }
}

fn scenes(folder: &str) -> Vec<(PathBuf, Document)> {
    let open = |file: &PathBuf| open_document(file, &[]).unwrap_or_else(|error| panic!("{}", error.render(false)));
    shipped::scenes(folder).into_iter().map(|file| (file.clone(), open(&file))).collect()
}

#[test]
fn shipped_scenes_are_valid_and_spoiled_ones_are_not() {
    let schema = schema();
    jsonschema::meta::validate(&schema).unwrap_or_else(|error| panic!("the schema is none: {error}"));
    let validator = jsonschema::validator_for(&schema).expect("the schema is one");
    for (file, scene) in scenes("scenes") {
        let mut scene = json(scene.root(), scene.text());
        let errors: Vec<String> =
            validator.iter_errors(&scene).map(|error| format!("{}: {error}", error.instance_path)).collect();
        assert!(errors.is_empty(), "{}: {errors:#?}", file.display());
        let mut spoiled = |pointer: &str, value: Value| {
            let place = scene.pointer_mut(pointer).expect("every scene has it");
            let before = std::mem::replace(place, value);
            assert!(!validator.is_valid(&scene), "{}: {pointer} is not looked at", file.display());
            *scene.pointer_mut(pointer).expect("every scene has it") = before;
        };
        spoiled("/spacing", json!(0.0));
        spoiled("/fluids/0/phase", json!(1));
        spoiled("/fluids/0/shape", json!({"Bix": {}}));
        spoiled("/phases", json!({"water": {"reference_density": 1000.0, "rheology": {"Newtonian": {}}}}));
    }
}

/// A number of a scene with a range: where its field stands in the schema, its path, values outside.
struct Ranged {
    field: String,
    path: String,
    /// The variant that holds the number, as in `Relative(0.1)`: the path leads to the whole.
    variant: Option<String>,
    outside: Vec<f64>,
}

fn ranged(whole: &Value, schema: &Value, value: &Value, field: &str, path: &str, found: &mut Vec<Ranged>) {
    if let Some(name) = schema["$ref"].as_str().and_then(|path| path.rsplit('/').next()) {
        ranged(whole, &whole["$defs"][name], value, name, path, found);
    }
    for part in schema["anyOf"].as_array().into_iter().flatten() {
        ranged(whole, part, value, field, path, found);
    }
    let under = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    match value {
        Value::Number(_) => {
            let beyond = |key: &str, step: f64| schema[key].as_f64().map(|bound| bound + step * bound.abs().max(1.0));
            let outside = [
                beyond("minimum", -0.01),
                beyond("exclusiveMinimum", 0.0),
                beyond("maximum", 0.01),
                beyond("exclusiveMaximum", 0.0),
            ];
            let outside: Vec<f64> = outside.into_iter().flatten().collect();
            if !outside.is_empty() && schema["type"] != "integer" {
                let variant = schema["properties"].as_object().and_then(|one| one.keys().next().cloned());
                found.push(Ranged { field: field.to_owned(), path: path.to_owned(), variant, outside });
            }
        }
        Value::Array(items) => {
            for (k, item) in items.iter().enumerate() {
                ranged(whole, &schema["items"], item, field, &under(&k.to_string()), found);
            }
        }
        Value::Object(fields) => {
            for (name, inner) in fields {
                for variant in schema["oneOf"].as_array().into_iter().flatten() {
                    if let Some(body) = variant["properties"].get(name) {
                        let held = if inner.is_number() { variant } else { body };
                        ranged(whole, held, inner, &format!("{field}/{name}"), path, found);
                    }
                }
                let schema = schema["properties"].get(name).unwrap_or(&schema["additionalProperties"]);
                ranged(whole, schema, inner, &format!("{field}/{name}"), &under(name), found);
            }
        }
        _ => {}
    }
}

#[test]
fn a_number_outside_its_stated_range_is_refused_where_it_stands() {
    let schema = schema();
    let mut seen = BTreeSet::new();
    for (file, scene) in scenes("scenes/ci") {
        let mut found = Vec::new();
        ranged(&schema, &schema, &json(scene.root(), scene.text()), "scene", "", &mut found);
        for Ranged { field, path, variant, outside } in found {
            if !seen.insert(field.clone()) {
                continue;
            }
            for value in outside {
                let written = variant.as_ref().map_or(format!("{value:?}"), |name| format!("{name}({value:?})"));
                let spoiled = scene.set(&path, &written).unwrap_or_else(|error| panic!("{error}"));
                let place = spoiled.node(&path).map(|node| node.span.clone());
                let error = open(StandardPlugins, spoiled).err().unwrap_or_else(|| {
                    panic!("{}: {path} = {value} is taken, which the page says it is not", file.display())
                });
                assert!(error.message().contains(&format!("`{path}`")), "{path} = {value}: {error}");
                assert_eq!(error.place().map(|place| place.span.clone()), place, "{path} = {value}: {error}");
            }
        }
    }
    assert!(seen.len() >= 15, "only {seen:?}");
}
