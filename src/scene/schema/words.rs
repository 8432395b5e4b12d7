//! The parts of a schema in words.

use serde_json::Value;

/// The type of a field, with links to types that have contents of their own, and the names of these.
pub(super) fn type_of(schema: &Value) -> (String, Vec<String>) {
    if let Some(name) = schema["$ref"].as_str().and_then(|path| path.rsplit('/').next()) {
        return (format!("[{name}](#{})", name.to_lowercase()), vec![name.to_owned()]);
    }
    if let Some(title) = schema["title"].as_str() {
        return (title.to_owned(), Vec::new());
    }
    // `Option<T>`: T or null.
    if let Some(inner) = schema["anyOf"].as_array().and_then(|any| any.iter().find(|one| one["type"] != "null")) {
        return type_of(inner);
    }
    let kind = match &schema["type"] {
        Value::Array(kinds) => kinds.iter().find(|kind| *kind != "null").and_then(Value::as_str),
        kind => kind.as_str(),
    };
    let plain = |words: &str| (words.to_owned(), Vec::new());
    match kind {
        Some("number") => plain("number"),
        Some("integer") => plain("whole number"),
        Some("string") => plain("text"),
        Some("boolean") => plain("true or false"),
        Some("array") => match schema["prefixItems"].as_array() {
            Some(items) => {
                let (names, mentioned): (Vec<String>, Vec<Vec<String>>) = items.iter().map(type_of).unzip();
                (format!("({})", names.join(", ")), mentioned.concat())
            }
            None => prefixed("list of ", type_of(&schema["items"])),
        },
        Some("object") => prefixed("table of ", type_of(&schema["additionalProperties"])),
        _ => plain("any value"),
    }
}

/// `list of vectors`, `list of [Shape](#shape)`.
fn prefixed(prefix: &str, (name, mentioned): (String, Vec<String>)) -> (String, Vec<String>) {
    let plural = if name.ends_with(char::is_alphabetic) && name != "any value" { "s" } else { "" };
    (format!("{prefix}{name}{plural}"), mentioned)
}

/// The default of a field that may be left out.
pub(super) fn default_of(schema: &Value) -> String {
    match (schema["derived"].as_str(), schema.get("default")) {
        (Some(words), _) => words.to_owned(),
        (None, Some(Value::Null) | None) => "none".to_owned(),
        (None, Some(value)) => format!("`{}`", ron(value)),
    }
}

/// The numbers that a field may have.
pub(super) fn range_of(schema: &Value) -> String {
    let bound = |key: &str, sign: &str| schema[key].as_f64().map(|bound| format!("{sign} {bound}"));
    let bounds = [
        bound("minimum", "≥"),
        bound("exclusiveMinimum", ">"),
        bound("maximum", "≤").filter(|_| schema["format"] != "uint32"),
        bound("exclusiveMaximum", "<"),
    ];
    bounds.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// A description as one line: without the unit in brackets, which has its own column, and what `None` stands for, which
/// is the default.
pub(super) fn in_words(description: &str, unit: &str) -> String {
    let line = description.split("\n\n").map(|part| part.replace('\n', " ")).collect::<Vec<_>>().join("<br>");
    let line = if unit.is_empty() { line } else { line.replacen(&format!(" ({unit})"), "", 1) };
    match line.split_once("; `None` for ").or(line.split_once(" `None` for ")) {
        Some((before, after)) => match after.split_once(". ") {
            Some((_, rest)) => format!("{}. {rest}", before.trim_end_matches('.')),
            None => format!("{}.", before.trim_end_matches('.')),
        },
        None => line,
    }
}

/// Whether `value` is `{"Name": …}`: a variant with contents.
pub(super) fn is_variant(value: &Value) -> bool {
    let is_name = |key: &String| key.starts_with(char::is_uppercase);
    value.as_object().is_some_and(|object| object.len() == 1 && object.keys().all(is_name))
}

/// A JSON value as a scene writes it; a text can only be the name of a variant or empty.
pub(super) fn ron(value: &Value) -> String {
    let joined = |parts: Vec<String>| parts.join(", ");
    match value {
        Value::String(text) if text.is_empty() => "\"\"".to_owned(),
        Value::String(name) => name.clone(),
        Value::Array(items) => format!("[{}]", joined(items.iter().map(ron).collect())),
        Value::Object(object) if is_variant(value) => object
            .iter()
            .map(|(name, body)| match body {
                Value::Object(_) => format!("{name}{}", ron(body)),
                _ => format!("{name}({})", ron(body)),
            })
            .collect(),
        Value::Object(object) => {
            let given = object.iter().filter(|(_, value)| !value.is_null());
            format!("({})", joined(given.map(|(name, value)| format!("{name}: {}", ron(value))).collect()))
        }
        other => other.to_string(),
    }
}
