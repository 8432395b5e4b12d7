//! Values that were read, listed leaf by leaf: what the scene left open, and everything for a log.
//!
//! A value is written as `ron` writes it and read back as a tree, so that the paths are those of a scene.

use serde::Serialize;

use super::Document;
use super::tree::{self, Kind, Node, Scalar};

impl Document {
    /// Path and value of every leaf of `value` that is not written in the scene at `path`: the defaults it relies on.
    pub fn defaults<T: Serialize>(&self, path: &str, value: &T) -> Vec<(String, String)> {
        let mut found = Vec::new();
        with_tree(path, value, &mut found, |listing, node| listing.absent(path, node, self.node(path)));
        found
    }
}

/// Path and value of every leaf of `value`, whose own path is `path`. Lists of plain values are one leaf.
pub fn flatten<T: Serialize>(path: &str, value: &T) -> Vec<(String, String)> {
    let mut found = Vec::new();
    with_tree(path, value, &mut found, |listing, node| listing.all(path, node));
    found
}

/// Writes `value` as text and hands its tree to `list`.
fn with_tree<T: Serialize>(
    path: &str,
    value: &T,
    found: &mut Vec<(String, String)>,
    list: impl FnOnce(&mut Listing<'_>, &Node),
) {
    // The plain options: with the reader's extensions `Some` would vanish and the variants lose their parentheses.
    let written = ron::Options::default().to_string(value).map_err(|error| error.to_string());
    match written.and_then(|text| tree::parse(&text).map(|node| (text, node)).map_err(|error| error.message)) {
        Ok((text, node)) => list(&mut Listing { text: &text, found }, &node),
        Err(message) => found.push((path.to_owned(), format!("(cannot be written: {message})"))),
    }
}
struct Listing<'a> {
    text: &'a str,
    found: &'a mut Vec<(String, String)>,
}

impl Listing<'_> {
    /// Lists the leaves of `node` that `there`, the same value in the scene, does not have.
    fn absent(&mut self, path: &str, node: &Node, there: Option<&Node>) {
        let Some(there) = there else { return self.all(path, node) };
        let (node, there) = (node.unwrapped(), there.unwrapped());
        match (&node.kind, &there.kind) {
            // A bare name or empty parentheses leave everything inside open.
            (Kind::Struct { .. } | Kind::Map { .. }, Kind::Struct { .. } | Kind::Map { .. })
            | (Kind::Struct { .. }, Kind::Scalar(Scalar::Name(_))) => self.absent_fields(path, node, there),
            (Kind::Struct { .. }, Kind::Tuple { items, .. }) if items.is_empty() => {
                self.absent_fields(path, node, there);
            }
            _ => {
                for (index, (item, there)) in node.items().iter().zip(there.items()).enumerate() {
                    self.absent(&join(path, &index.to_string()), item, Some(there));
                }
            }
        }
    }

    fn absent_fields(&mut self, path: &str, node: &Node, there: &Node) {
        for field in node.fields() {
            let there = there.field(&field.key).map(|field| &field.value);
            self.absent(&join(path, &field.key), &field.value, there);
        }
    }

    /// Lists all leaves of `node`. A name before fields is a leaf of its own, at the path of the whole.
    fn all(&mut self, path: &str, node: &Node) {
        let mut names = Vec::new();
        let mut inner = node;
        while let Some(next) = inner.inner() {
            names.extend(inner.name().filter(|name| *name != "Some"));
            inner = next;
        }
        let is_leaf = !is_compound(inner) || inner.children().next().is_none();
        if is_leaf {
            let shown = self.text.get(inner.span.clone()).unwrap_or_default();
            names.push(shown);
        } else {
            names.extend(inner.name());
        }
        if !names.is_empty() {
            let closing = ")".repeat(names.len() - 1);
            self.found.push((path.to_owned(), names.join("(") + &closing));
        }
        if !is_leaf {
            for field in inner.fields() {
                self.all(&join(path, &field.key), &field.value);
            }
            for (index, item) in inner.items().iter().enumerate() {
                self.all(&join(path, &index.to_string()), item);
            }
        }
    }
}

/// Whether a value has named parts anywhere inside, so that one line would not show it well.
fn is_compound(node: &Node) -> bool {
    matches!(node.kind, Kind::Struct { .. } | Kind::Map { .. }) || node.children().any(is_compound)
}

fn join(path: &str, component: &str) -> String {
    if path.is_empty() { component.to_owned() } else { format!("{path}.{component}") }
}
