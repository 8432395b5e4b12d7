//! The reference page of scenes in Markdown, from their schema.

use std::collections::BTreeSet;
use std::fmt::Write;

use bevy_ecs::prelude::*;
use serde_json::Value;

use super::scene_schema;
use super::words::{default_of, in_words, is_variant, range_of, ron, type_of};
use crate::scene::SectionRegistry;

/// What stands before and after the tables.
const INTRODUCTION: &str = include_str!("introduction.md");
const OUTPUT: &str = include_str!("output.md");

/// The page of every field that the plugins of `world` read from a scene: meaning, unit, default, range.
#[must_use]
pub fn reference_page(world: &World) -> String {
    let schema = scene_schema(world);
    let sections: Vec<&str> = world.resource::<SectionRegistry>().names().collect();
    // First what there is, then how it is computed.
    let (there, how): (Vec<&str>, Vec<&str>) =
        sections.iter().partition(|name| holds_entries(&schema, &schema["properties"][**name]));
    let mut page = Page {
        schema: &schema,
        sections: &sections,
        text: INTRODUCTION.to_owned(),
        told: BTreeSet::new(),
        waiting: Vec::new(),
    };
    page.head();
    for name in there.into_iter().chain(how) {
        page.section(name, &schema["properties"][name]);
    }
    page.heading(2, "Variants");
    page.body(page.definition("VariantFile"), 3);
    page.tell_waiting();
    page.text.push('\n');
    page.text.push_str(OUTPUT);
    // Headings follow on tables and on headings.
    page.text.replace("\n\n\n", "\n\n")
}

/// Whether a section is a list or a table of entries.
fn holds_entries(schema: &Value, section: &Value) -> bool {
    let body = resolve(schema, section);
    body["items"].is_object() || body["additionalProperties"].is_object()
}

/// What a schema refers to in `whole`, or itself.
fn resolve<'a>(whole: &'a Value, schema: &'a Value) -> &'a Value {
    let target = schema["$ref"].as_str().and_then(|path| path.rsplit('/').next());
    target.map_or(schema, |name| &whole["$defs"][name])
}

struct Page<'a> {
    schema: &'a Value,
    sections: &'a [&'a str],
    text: String,
    /// Types that have their heading, and those that still need one.
    told: BTreeSet<String>,
    waiting: Vec<String>,
}

impl<'a> Page<'a> {
    fn heading(&mut self, level: usize, title: &str) {
        let _ = write!(self.text, "\n{} {title}\n\n", "#".repeat(level));
    }

    fn definition(&self, name: &str) -> &'a Value {
        &self.schema["$defs"][name]
    }

    /// What a schema refers to, or itself.
    fn resolve(&self, schema: &'a Value) -> &'a Value {
        resolve(self.schema, schema)
    }

    /// The fields at the top of a scene that are no sections.
    fn head(&mut self) {
        self.heading(2, "Head");
        let mut head = self.schema.clone();
        if let Some(fields) = head["properties"].as_object_mut() {
            fields.retain(|name, _| !self.sections.contains(&name.as_str()));
        }
        let table = self.field_table(&head);
        self.text.push_str(&table);
        self.tell_waiting();
    }

    fn section(&mut self, name: &str, schema: &'a Value) {
        self.heading(2, &format!("`{name}`"));
        let body = self.resolve(schema);
        if let Some(default) = schema.get("default").filter(|default| default.is_string() || is_variant(default)) {
            let _ = write!(self.text, "Default: `{}`. ", ron(default));
        }
        self.body(body, 3);
        self.tell_waiting();
    }

    /// Gives every type that was mentioned its own heading.
    fn tell_waiting(&mut self) {
        while !self.waiting.is_empty() {
            let name = self.waiting.remove(0);
            self.heading(3, &name);
            self.body(self.definition(&name), 4);
        }
    }

    /// Description and contents of a type; what needs headings of its own gets them at `level`.
    fn body(&mut self, schema: &'a Value, level: usize) {
        if let Some(text) = schema["description"].as_str() {
            let _ = write!(self.text, "{text}\n\n");
        }
        if let Some(items) = schema.get("items").filter(|_| schema["type"] == "array") {
            return self.entries("A list; each entry:", items, level);
        }
        if let Some(values) = schema.get("additionalProperties").filter(|values| values.is_object()) {
            return self.entries("A table `{\"name\": …}`; each entry:", values, level);
        }
        if let Some(variants) = schema["oneOf"].as_array().or(schema["enum"].as_array()) {
            return self.variants(variants, schema["open"] == true, level);
        }
        if schema["properties"].as_object().is_some_and(|fields| !fields.is_empty()) {
            let table = self.field_table(schema);
            self.text.push_str(&table);
        }
    }

    fn entries(&mut self, how: &str, entry: &'a Value, level: usize) {
        let _ = write!(self.text, "{how}\n\n");
        self.body(self.resolve(entry), level);
    }

    /// A table of fields.
    fn field_table(&mut self, schema: &Value) -> String {
        let mut table = "| field | type | unit | default | range | meaning |\n|---|---|---|---|---|---|\n".to_owned();
        for (name, field) in schema["properties"].as_object().into_iter().flatten() {
            let cells = self.cells(field, is_required(schema, name));
            let _ = writeln!(table, "| `{name}` | {cells} |");
        }
        table
    }

    /// Type, unit, default, range and meaning of a field.
    fn cells(&mut self, field: &Value, is_required: bool) -> String {
        let kind = self.mention(field);
        let unit = field["unit"].as_str().unwrap_or_default();
        let default = if is_required { "required".to_owned() } else { default_of(field) };
        let description = field["description"].as_str().or_else(|| self.text_of_type(field)).unwrap_or_default();
        let meaning = in_words(description, unit);
        [kind, unit.to_owned(), default, range_of(field), meaning].map(|cell| escaped(&cell)).join(" | ")
    }

    /// The type of a field in words; types with contents of their own get a heading later.
    fn mention(&mut self, field: &Value) -> String {
        let (mut kind, mentioned) = type_of(field);
        for name in mentioned {
            // A section has its heading already.
            if let Some(section) = self.section_of(&name) {
                kind =
                    kind.replace(&format!("[{name}](#{})", name.to_lowercase()), &format!("[`{section}`](#{section})"));
            } else if self.told.insert(name.clone()) {
                self.waiting.push(name);
            }
        }
        kind
    }

    /// The section that the definition called `name` is that of.
    fn section_of(&self, name: &str) -> Option<&'a str> {
        let path = format!("#/$defs/{name}");
        self.sections.iter().find(|section| self.schema["properties"][**section]["$ref"] == path.as_str()).copied()
    }

    /// The description of the type of a field that has none itself.
    fn text_of_type(&self, field: &Value) -> Option<&'a str> {
        let name = field["$ref"].as_str()?.rsplit('/').next()?;
        self.definition(name)["description"].as_str()
    }

    /// The variants of an enum: each under its heading if its names are registered, else all in a table.
    fn variants(&mut self, variants: &'a [Value], is_open: bool, level: usize) {
        if variants.iter().all(|variant| variant["properties"].is_null()) {
            self.text.push_str("| name | meaning |\n|---|---|\n");
            for variant in variants {
                let name = variant["const"].as_str().or(variant.as_str()).unwrap_or_default();
                let meaning = in_words(variant["description"].as_str().unwrap_or_default(), "");
                let _ = writeln!(self.text, "| `{name}` | {} |", escaped(&meaning));
            }
        } else if is_open {
            for (name, body) in variants.iter().filter_map(named_body) {
                self.heading(level, &format!("`{name}`"));
                self.body(self.resolve(body), level + 1);
            }
        } else {
            let table = self.variant_table(variants);
            self.text.push_str(&table);
        }
    }

    /// A row for each variant, followed by a row for each of its fields.
    fn variant_table(&mut self, variants: &'a [Value]) -> String {
        let mut table =
            "| name | field | type | unit | default | range | meaning |\n|---|---|---|---|---|---|---|\n".to_owned();
        for variant in variants {
            let text = variant["description"].as_str().unwrap_or_default();
            let Some((name, body)) = named_body(variant) else {
                let name = variant["const"].as_str().or(variant.as_str()).unwrap_or_default();
                let _ = writeln!(table, "| `{name}` | | | | | | {} |", escaped(&in_words(text, "")));
                continue;
            };
            let Some(fields) = body["properties"].as_object() else {
                let (kind, unit) = (self.mention(body), variant["unit"].as_str().unwrap_or_default());
                let (range, meaning) = (range_of(variant), escaped(&in_words(text, unit)));
                let _ = writeln!(table, "| `{name}(…)` | | {kind} | {unit} | | {range} | {meaning} |");
                continue;
            };
            let _ = writeln!(table, "| `{name}(…)` | | | | | | {} |", escaped(&in_words(text, "")));
            for (field, schema) in fields {
                let cells = self.cells(schema, is_required(body, field));
                let _ = writeln!(table, "| | `{field}` | {cells} |");
            }
        }
        table
    }
}

/// Name and contents of a variant that has any.
fn named_body(variant: &Value) -> Option<(&String, &Value)> {
    variant["properties"].as_object().and_then(|one| one.iter().next())
}

fn is_required(schema: &Value, field: &str) -> bool {
    schema["required"].as_array().is_some_and(|required| required.iter().any(|one| one == field))
}

/// Text for a cell of a table.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}
