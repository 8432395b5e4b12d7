//! The reference page and the JSON Schema of scenes, as the shipped plugins make them.

use std::path::{Path, PathBuf};

use bevy_app::App;
use serde_json::Value;
use storegga::scene::schema::{reference_page, scene_schema};
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

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn the_page_in_the_repository_is_that_of_the_types() {
    let committed = std::fs::read_to_string(root().join("docs/scene.md")).expect("the page is there");
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
