//! The text of a scene and the place of every value in it.
//!
//! A [`Document`] is read before anything is known about what a scene contains: it checks the syntax, finds values by
//! their path and turns every later complaint, whether of the reader of a type or of a physical check, into a
//! [`UserError`] that shows the place.

mod depth;
mod edit;
mod explain;
mod leaves;
mod names;
#[cfg(test)]
mod tests;
mod tree;

use std::ops::Range;
use std::sync::Arc;

use ron::Options;
use ron::extensions::Extensions;
use serde::de::{DeserializeOwned, IgnoredAny};

use crate::error::UserError;
use crate::scene::invalid::Invalid;

pub use leaves::flatten;
pub use names::nearest;
pub use tree::{Field, Kind, Name, Node, Scalar};

use explain::{Complaint, byte_offset, explain, mismatch, unknown};

/// A scene as written: its text and the tree of its values.
#[derive(Debug, Clone)]
pub struct Document {
    file: String,
    text: Arc<str>,
    root: Node,
    overrides: Vec<(String, String)>,
    /// For each override what it brought.
    brought: Vec<Brought>,
    /// The variant file that changed the scene, if it came from one.
    variant: Option<Arc<Self>>,
}

/// What an override brought into a scene.
#[derive(Debug, Clone)]
struct Brought {
    /// Path of the outermost value.
    path: String,
    /// The file in which the override stands, and its place there; none for the command line.
    by: Option<(Arc<Document>, Range<usize>)>,
}

/// A value `Name(…)` or `Name` whose name chooses what its body means.
#[derive(Debug, Clone)]
pub struct Named<'a> {
    /// The name.
    pub name: &'a str,
    /// Bytes of the name.
    pub span: Range<usize>,
    node: &'a Node,
}

impl Document {
    /// Reads the text of the scene called `file`: `Scene(…)` or `(…)`, with finite numbers, no name given twice, and
    /// names in tables that can be part of a path.
    pub fn parse(file: &str, text: &str) -> Result<Self, UserError> {
        let document = Self::parse_value(file, text)?;
        let root = &document.root;
        let is_struct = match &root.kind {
            Kind::Struct { .. } => true,
            Kind::Tuple { items, .. } => items.is_empty(),
            _ => false,
        };
        if !is_struct || root.name().is_some_and(|name| name != "Scene") {
            return Err(document.complain(mismatch(text, root, "a scene `Scene(…)`")));
        }
        document.check_names(root)?;
        Ok(document)
    }

    /// Reads a text that is one value of any kind.
    pub(crate) fn parse_value(file: &str, text: &str) -> Result<Self, UserError> {
        let text: Arc<str> = text.into();
        if let Some(span) = depth::too_deep(&text) {
            let message = format!("more than {} brackets stand in one another here", depth::MOST_LEVELS);
            return Err(UserError::plain(message).at(file, text, span, "one level too many"));
        }
        let root = tree::parse(&text).map_err(|error| {
            UserError::plain(error.message).at(file, Arc::clone(&text), error.span, "the text cannot be read from here")
        })?;
        let document =
            Self { file: file.to_owned(), text, root, overrides: Vec::new(), brought: Vec::new(), variant: None };
        document.check(&document.root)?;
        // The tree comes from another reader of the same notation; both must agree that the text is sound.
        document.read_node::<IgnoredAny>(&document.root)?;
        Ok(document)
    }

    /// Refuses infinite numbers, texts with control characters and repeated names anywhere inside `node`.
    fn check(&self, node: &Node) -> Result<(), UserError> {
        if node.kind == Kind::Scalar(Scalar::Number { finite: false }) {
            return Err(self.error(node.span.clone(), "must be a finite number", "expected a finite number"));
        }
        if let Kind::Scalar(Scalar::Text(text)) = &node.kind {
            self.refuse_control(text, node.span.clone())?;
        }
        for (index, field) in node.fields().iter().enumerate() {
            self.refuse_control(&field.key, field.key_span.clone())?;
            if node.fields().iter().take(index).any(|earlier| earlier.key == field.key) {
                let message = format!("`{}` is given twice", field.key);
                return Err(self.error(field.key_span.clone(), message, "the second time"));
            }
        }
        node.children().try_for_each(|child| self.check(child))
    }

    /// Refuses line breaks, escapes and the like, which would break lines of the log and of the terminal.
    fn refuse_control(&self, text: &str, span: Range<usize>) -> Result<(), UserError> {
        match text.chars().find(|letter| letter.is_control()) {
            Some(letter) => {
                let message = format!("a text may not contain the control character {}", letter.escape_debug());
                Err(self.error(span, message, "expected a text in one line"))
            }
            None => Ok(()),
        }
    }

    /// Refuses names in quotes, anywhere inside `node`, that could not be part of a path.
    fn check_names(&self, node: &Node) -> Result<(), UserError> {
        if let Kind::Map { entries } = &node.kind {
            for entry in entries.iter().filter(|entry| entry.is_quoted()) {
                let problem = match entry.key.trim() {
                    "" => "a name may not be empty",
                    key if key.contains('.') => "a name may not contain a dot",
                    _ => continue,
                };
                return Err(self.error(entry.key_span.clone(), problem, "expected another name"));
            }
        }
        node.children().try_for_each(|child| self.check_names(child))
    }

    /// The name of the file, as the user wrote it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The text, with all overrides in it.
    pub fn text(&self) -> &Arc<str> {
        &self.text
    }

    /// The whole scene.
    pub fn root(&self) -> &Node {
        &self.root
    }

    /// The overrides applied so far, as path and value.
    pub fn overrides(&self) -> &[(String, String)] {
        &self.overrides
    }

    /// The variant file that changed the scene, if it came from one.
    pub fn variant(&self) -> Option<&Self> {
        self.variant.as_deref()
    }

    /// The value at a path such as `phases.slide.rheology.yield_stress` or `fluids.0.velocity.1`; the empty path is
    /// the whole scene. Names before parentheses and `Some` are passed over.
    pub fn node(&self, path: &str) -> Option<&Node> {
        let (node, rest) = self.deepest(path);
        rest.is_empty().then_some(node)
    }

    /// The value the longest existing beginning of `path` leads to, and the rest of the path.
    fn deepest<'p>(&self, path: &'p str) -> (&Node, &'p str) {
        let (mut node, mut rest) = (&self.root, path);
        while !rest.is_empty() {
            let (component, after) = rest.split_once('.').unwrap_or((rest, ""));
            match node.step(component) {
                Some(next) => (node, rest) = (next, after),
                None => break,
            }
        }
        (node, rest)
    }

    /// Reads the value at `path` as a `T`.
    pub fn read<T: DeserializeOwned>(&self, path: &str) -> Result<T, UserError> {
        let (node, rest) = self.deepest(path);
        if rest.is_empty() {
            return self.read_node(node);
        }
        Err(self.error(node.opening(), format!("`{path}` is missing"), format!("needs `{rest}`")))
    }

    /// Reads the value `node` of this document as a `T`.
    pub fn read_node<T: DeserializeOwned>(&self, node: &Node) -> Result<T, UserError> {
        self.read_span(node, node.span.clone())
    }

    /// Takes a value `Name(…)` or `Name` apart, for kinds whose names are registered and not known here.
    pub fn named<'a>(&self, node: &'a Node) -> Result<Named<'a>, UserError> {
        match node.name() {
            Some("Some") if let Some(inner) = node.inner() => self.named(inner),
            Some(name) => Ok(Named { name, span: node.opening(), node }),
            None => Err(self.complain(mismatch(&self.text, node, "a name such as `Name(…)`"))),
        }
    }

    /// Reads what stands behind a name as a `T`: `(…)`, or `()` if the name stands alone.
    pub fn read_body<T: DeserializeOwned>(&self, named: &Named<'_>) -> Result<T, UserError> {
        let body = named.span.end..named.node.span.end;
        if !body.is_empty() {
            return self.read_span(named.node, body);
        }
        options()
            .from_str("()")
            .map_err(|error| self.complain(explain(&self.text, named.node, named.span.start, &error)))
    }

    fn read_span<T: DeserializeOwned>(&self, node: &Node, span: Range<usize>) -> Result<T, UserError> {
        let text = self.text.get(span.clone()).unwrap_or_default();
        options().from_str(text).map_err(|error| {
            let offset = span.start + byte_offset(text, error.span.end);
            self.complain(explain(&self.text, node, offset, &error))
        })
    }

    /// The place of a physically wrong value. The path counts from the top of the scene.
    pub fn invalid(&self, invalid: &Invalid) -> UserError {
        let (node, rest) = self.deepest(&invalid.path);
        let message = match invalid.path.as_str() {
            "" => invalid.message.clone(),
            path => format!("`{path}`: {}", invalid.message),
        };
        if !rest.is_empty() {
            let label = format!("`{rest}` is not given here");
            let error = self.error(node.opening(), message, label);
            return error.help(format!("`{rest}` has its default value; give another one"));
        }
        let multiline = self.text.get(node.span.clone()).is_some_and(|shown| shown.contains('\n'));
        self.error(if multiline { node.opening() } else { node.span.clone() }, message, "this value")
    }

    /// `found`, at `span`, is none of the `known` names of a `what` (such as a rheology).
    pub fn unknown_name_error(&self, span: Range<usize>, what: &str, found: &str, known: &[&str]) -> UserError {
        self.complain(unknown(what, found, span, known))
    }

    /// Refuses fields of the value at `path` that are not `known`.
    pub fn require_known_fields(&self, path: &str, known: &[&str]) -> Result<(), UserError> {
        let fields = self.node(path).map(Node::unwrapped).map_or(&[][..], Node::fields);
        match fields.iter().find(|field| !known.contains(&field.key.as_str())) {
            Some(field) => Err(self.unknown_name_error(field.key_span.clone(), "field", &field.key, known)),
            None => Ok(()),
        }
    }

    /// An error at `span` of the text; says so if that text was set on the command line.
    pub fn error(&self, span: Range<usize>, message: impl Into<String>, label: impl Into<String>) -> UserError {
        let (message, label) = (message.into(), label.into());
        self.complain(Complaint { message, span, label, help: None })
    }

    fn complain(&self, complaint: Complaint) -> UserError {
        let Complaint { message, span, label, help } = complaint;
        if let Some((file, span)) = self.brought_from(&span) {
            return file.complain(Complaint { message, span, label, help });
        }
        let origin = self.override_at(&span).and_then(|index| self.overrides.get(index));
        let mut error = UserError::plain(message).at(self.file.as_str(), Arc::clone(&self.text), span, label);
        if let Some(help) = help {
            error = error.help(help);
        }
        match origin {
            Some((path, value)) => error.help(format!("(set by --set {path}={value})")),
            None => error,
        }
    }
}

/// How scenes are read: a value may stand for `Some(value)`, and a variant's fields need no second parentheses.
fn options() -> Options {
    Options::default().with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES | Extensions::IMPLICIT_SOME)
}
