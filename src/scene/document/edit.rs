//! Overrides of single values from the command line: `--set path=value`.

use std::ops::Range;
use std::sync::Arc;

use super::names::{quoted, suggestion};
use super::tree::{Kind, Node, Scalar};
use super::{Brought, Document, UserError};
use crate::scene::variant;

impl Document {
    /// The document with the override `path=value`.
    pub fn set_pair(&self, pair: &str) -> Result<Self, UserError> {
        match pair.split_once('=') {
            Some((path, value)) if !path.trim().is_empty() => self.set(path.trim(), value),
            _ => {
                Err(UserError::plain(format!("--set {pair}: expected `path=value`"))
                    .help("for example --set spacing=0.01"))
            }
        }
    }

    /// The document with the value at `path` replaced, or added to what it belongs to: `equation_of_state.max_speed`
    /// also where the scene leaves the whole section open. Tables get no new names and lists no new items on the way.
    ///
    /// The value is written as in a scene; where a text stood, the quotes may be left out.
    pub fn set(&self, path: &str, value: &str) -> Result<Self, UserError> {
        if path.split('.').any(|part| part.trim().is_empty()) {
            return Err(UserError::plain(format!("--set {path}={value}: the path has an empty part"))
                .help("its parts are names and numbers with a dot between two, as in --set fluids.0.phase=mud"));
        }
        let value = self.with_quotes(path, value.trim());
        let parsed = Self::parse_value(&format!("--set {path}"), &value)?;
        parsed.check_names(&parsed.root)?;
        // Only the value itself: a comment behind it would swallow what follows in the scene.
        let value = value.get(parsed.root.span.clone()).unwrap_or_default().to_owned();
        let (span, new) = match self.node(path) {
            Some(old) => (old.span.clone(), value.clone()),
            None => self.insertion(path, &value)?,
        };
        let mut document = self.spliced(span, &new)?;
        document.brought.push(Brought { path: self.outermost_new(path).to_owned(), by: None });
        document.overrides.push((path.to_owned(), value));
        document.variant = self.variant.clone();
        Ok(document)
    }

    /// The same for an override that stands at `span` of another file: complaints about it point there.
    pub(crate) fn set_from(
        &self,
        path: &str,
        value: &str,
        (file, span): (&Arc<Self>, Range<usize>),
    ) -> Result<Self, UserError> {
        let mut document = self.set(path, value).map_err(|error| {
            let placed = file.error(span.clone(), error.message(), "this override");
            error.help_line().into_iter().fold(placed, |placed, help| placed.help(help))
        })?;
        if let Some(brought) = document.brought.last_mut() {
            brought.by = Some((Arc::clone(file), span));
        }
        Ok(document)
    }

    /// The document with the text of the top-level field `name` replaced, or added.
    pub(in crate::scene) fn replace(&self, name: &str, value: &str) -> Result<Self, UserError> {
        let (span, new) = match self.node(name) {
            Some(old) => (old.span.clone(), value.to_owned()),
            None => self.insertion(name, value)?,
        };
        self.spliced(span, &new)
    }

    /// The document with the text `new` at `span`.
    fn spliced(&self, span: Range<usize>, new: &str) -> Result<Self, UserError> {
        let before = self.text.get(..span.start).unwrap_or_default();
        let after = self.text.get(span.end..).unwrap_or_default();
        let document = Self::parse(&self.file, &format!("{before}{new}{after}"))?;
        Ok(Self { overrides: self.overrides.clone(), brought: self.brought.clone(), ..document })
    }

    /// The beginning of `path` that leads to the outermost value which does not exist yet; `path` itself if all do.
    fn outermost_new<'p>(&self, path: &'p str) -> &'p str {
        let (_, rest) = self.deepest(path);
        let below = rest.split_once('.').map_or(0, |(_, below)| below.len() + 1);
        path.get(..path.len() - below).unwrap_or(path)
    }

    /// The override that brought the text at `span`: its index, the latest one first.
    pub(super) fn override_at(&self, span: &Range<usize>) -> Option<usize> {
        let holds = |entry: Range<usize>| entry.start <= span.start && span.end <= entry.end;
        self.brought.iter().rposition(|brought| self.entry_span(&brought.path).is_some_and(holds))
    }

    /// The document, which `variant` changed: complaints about its changes point there.
    pub(in crate::scene) fn with_variant(self, variant: Arc<Self>) -> Self {
        Self { variant: Some(variant), ..self }
    }

    /// Where the text at `span` stands in the file that brought it, if it is not of the scene itself nor of the command line.
    pub(super) fn brought_from(&self, span: &Range<usize>) -> Option<(&Self, Range<usize>)> {
        if let Some(replaced) = self.in_replaced(span) {
            return Some(replaced);
        }
        let (file, span) = self.brought.get(self.override_at(span)?)?.by.as_ref()?;
        Some((file, span.clone()))
    }

    /// Where the text at `span` stands in the section that the variant replaced, if it is of that.
    fn in_replaced(&self, span: &Range<usize>) -> Option<(&Self, Range<usize>)> {
        let variant = self.variant.as_deref()?;
        let (here, there) = (self.node(variant::REPLACED)?, variant.node(variant::REPLACED)?);
        let is_unchanged = self.text.get(here.span.clone()) == variant.text.get(there.span.clone());
        let contains = here.span.start <= span.start && span.end <= here.span.end;
        let shifted = |byte: usize| byte - here.span.start + there.span.start;
        (is_unchanged && contains).then(|| (variant, shifted(span.start)..shifted(span.end)))
    }

    /// Adds the quotes a text needs if the value it replaces is a text.
    fn with_quotes(&self, path: &str, value: &str) -> String {
        let old = self.node(path).map(|old| &old.unwrapped().kind);
        let is_text = matches!(old, Some(Kind::Scalar(Scalar::Text(_))));
        let is_written_out = ["\"", "r\"", "r#", "Some("].iter().any(|start| value.starts_with(start));
        if !is_text || is_written_out || value == "None" {
            return value.to_owned();
        }
        format!("\"{}\"", value.replace('\\', "\\\\").replace('"', "\\\""))
    }

    /// Where and how `path`, which does not exist, is added to what it belongs to.
    fn insertion(&self, path: &str, value: &str) -> Result<(Range<usize>, String), UserError> {
        let (node, rest) = self.deepest(path);
        let parent = node.unwrapped();
        let inserted = match &parent.kind {
            Kind::Struct { fields, .. } => {
                fields.last().zip(nested(rest, value)).map(|(last, entry)| (last.value.span.end, format!(", {entry}")))
            }
            Kind::Tuple { items, .. } if items.is_empty() => {
                nested(rest, value).map(|entry| (parent.span.end - 1, entry))
            }
            Kind::Scalar(Scalar::Name(_)) => nested(rest, value).map(|entry| (parent.span.end, format!("({entry})"))),
            Kind::Map { entries } if !rest.contains('.') => Some(match entries.last() {
                None => (parent.span.end - 1, format!("{rest:?}: {value}")),
                Some(last) if last.is_quoted() => (last.value.span.end, format!(", {rest:?}: {value}")),
                Some(last) => (last.value.span.end, format!(", {rest}: {value}")),
            }),
            _ => None,
        };
        match inserted {
            Some((position, new)) => Ok((position..position, new)),
            None => Err(self.no_such_path(path, value, node, rest)),
        }
    }

    /// The error for a path whose component at the start of `rest` does not exist in `node`.
    fn no_such_path(&self, path: &str, value: &str, node: &Node, rest: &str) -> UserError {
        let missing = rest.split('.').next().unwrap_or_default();
        let above = path.strip_suffix(rest).unwrap_or_default().trim_end_matches('.');
        let place = if above.is_empty() { "the scene".to_owned() } else { format!("`{above}`") };
        let parent = node.unwrapped();
        let names: Vec<&str> = parent.fields().iter().map(|field| field.key.as_str()).collect();
        let contents = match (&parent.kind, parent.items().len()) {
            (Kind::Struct { .. } | Kind::Map { .. }, _) if !names.is_empty() => format!("it has {}", quoted(&names)),
            (Kind::List(_) | Kind::Tuple { .. }, 1) => "it has 1 item, 0".to_owned(),
            (Kind::List(_) | Kind::Tuple { .. }, count @ 2..) => format!("it has {count} items, 0 to {}", count - 1),
            (Kind::Scalar(_), _) => format!("it is {}", parent.describe(&self.text)),
            _ => "it is empty".to_owned(),
        };
        let error = UserError::plain(format!("--set {path}={value}: {place} has no `{missing}`; {contents}"));
        match suggestion(missing, names) {
            Some(help) => error.help(help),
            None if rest.contains('.') && matches!(parent.kind, Kind::Struct { .. }) => {
                error.help(format!("give it whole: --set '{}=…'", self.outermost_new(path)))
            }
            None => error,
        }
    }

    /// Bytes of the value at `path` together with its name.
    fn entry_span(&self, path: &str) -> Option<Range<usize>> {
        let (above, last) = path.rsplit_once('.').unwrap_or(("", path));
        let field = self.node(above)?.field(last);
        let start = |node: &Node| field.map_or(node.span.start, |field| field.key_span.start);
        self.node(path).map(|node| start(node)..node.span.end)
    }
}

/// The value at the relative path `rest` as `a: (b: value)`; none if a component is not a name of a field.
fn nested(rest: &str, value: &str) -> Option<String> {
    let is_name = |name: &str| {
        name.starts_with(|first: char| first.is_alphabetic() || first == '_')
            && name.chars().all(|letter| letter.is_alphanumeric() || letter == '_')
    };
    let mut names = rest.rsplit('.');
    let innermost = names.next().filter(|name| is_name(name)).map(|name| format!("{name}: {value}"))?;
    names.try_fold(innermost, |inner, name| is_name(name).then(|| format!("{name}: ({inner})")))
}
