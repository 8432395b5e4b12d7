//! Puts an error of `ron` into the words of the person who wrote the scene, and finds the value it is about.
//!
//! The text has been parsed before, so every error here is a value or a name other than the one asked for.

use std::ops::Range;

use ron::error::{Error, Position, SpannedError};

use super::names::{expected_one_of, suggestion};
use super::tree::{Kind, Node, Scalar, lower_first};

/// An error whose place in the text is known but which does not know the text's name.
pub(super) struct Complaint {
    pub message: String,
    pub span: Range<usize>,
    pub label: String,
    pub help: Option<String>,
}

/// Byte offset of a position, which counts lines and characters from one.
pub(super) fn byte_offset(text: &str, position: Position) -> usize {
    let line_start: usize = text.split_inclusive('\n').take(position.line.saturating_sub(1)).map(str::len).sum();
    let line = text.get(line_start..).unwrap_or_default();
    let column = position.col.saturating_sub(1);
    line_start + line.char_indices().nth(column).map_or(line.len(), |(byte, _)| byte)
}

/// Explains `error`, which occurred at byte `offset` of `text` while `node` was read.
pub(super) fn explain(text: &str, node: &Node, offset: usize, error: &SpannedError) -> Complaint {
    let value = value_at(node, offset);
    match &error.code {
        Error::NoSuchStructField { expected, found, .. } => {
            unknown("field", found, key_span(node, offset, found), expected)
        }
        Error::NoSuchEnumVariant { expected, found, .. } => {
            unknown("name", found, variant_span(node, offset), expected)
        }
        Error::MissingStructField { field, .. } => Complaint {
            message: format!("`{field}` is missing"),
            span: holder(node, offset).opening(),
            label: format!("needs `{field}: …`"),
            help: None,
        },
        Error::ExpectedDifferentLength { expected, found } => {
            wrong_count(last_number(expected), *found, holder(node, offset).span.clone())
        }
        Error::ExpectedComma
        | Error::ExpectedStructLikeEnd
        | Error::ExpectedOptionEnd
        | Error::ExpectedArrayEnd
        | Error::ExpectedMapEnd
        | Error::TrailingCharacters => surplus(text, node, offset),
        Error::IntegerOutOfBounds => mismatch(text, value, out_of_bounds(text, value)),
        Error::Message(message) => {
            Complaint { message: lower_first(message), span: value.span.clone(), label: String::new(), help: None }
        }
        code => match wanted(code) {
            Some(wanted) => mismatch(text, value, &wanted),
            None => Complaint {
                message: lower_first(&code.to_string()),
                span: value.span.clone(),
                label: String::new(),
                help: None,
            },
        },
    }
}

/// `` unknown field `x` `` with what was expected and what may have been meant.
pub(super) fn unknown(what: &str, found: &str, span: Range<usize>, known: &[&str]) -> Complaint {
    Complaint {
        message: format!("unknown {what} `{found}`"),
        span,
        label: expected_one_of(known),
        help: suggestion(found, known.iter().copied()),
    }
}

/// `value` is not what was `wanted`.
pub(super) fn mismatch(text: &str, value: &Node, wanted: &str) -> Complaint {
    let help = match (&value.kind, wanted) {
        (Kind::Scalar(Scalar::Name(name)), TEXT) => Some(format!("put it in quotes: \"{name}\"")),
        (Kind::Scalar(Scalar::Text(content)), NAME) => Some(format!("write it without quotes: {content}")),
        (Kind::List(_), PARENTHESES) => Some("use round brackets instead of square ones".to_owned()),
        (Kind::Tuple { .. } | Kind::Struct { .. }, LIST) => {
            Some("use square brackets instead of round ones".to_owned())
        }
        (Kind::Struct { .. } | Kind::Tuple { .. }, TABLE) => {
            Some("use curly brackets and put the names in quotes".to_owned())
        }
        (Kind::Scalar(Scalar::Name(name)), PARENTHESES) => Some(format!("write `{name}(…)`")),
        _ => None,
    };
    Complaint {
        message: format!("expected {wanted}, found {}", value.describe(text)),
        span: value.span.clone(),
        label: format!("expected {wanted}"),
        help,
    }
}

const NUMBER: &str = "a number";
const WHOLE: &str = "a whole number";
const BOOLEAN: &str = "true or false";
const TEXT: &str = "a text in quotes";
const NAME: &str = "a name";
const LIST: &str = "a list `[…]`";
const TABLE: &str = "a table `{\"name\": …}`";
const PARENTHESES: &str = "values in parentheses `(…)`";

/// What an error of type wanted, in plain words.
fn wanted(code: &Error) -> Option<String> {
    let words = match code {
        Error::ExpectedArray => LIST,
        Error::ExpectedBoolean => BOOLEAN,
        Error::ExpectedFloat => NUMBER,
        Error::ExpectedInteger | Error::InvalidIntegerDigit { .. } => WHOLE,
        Error::ExpectedMap => TABLE,
        Error::ExpectedString | Error::ExpectedStringEnd => TEXT,
        Error::ExpectedChar => "a single character 'x'",
        Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) => NAME,
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) | Error::Eof => PARENTHESES,
        Error::ExpectedUnit => "`()`",
        Error::ExpectedDifferentStructName { expected, .. } => return Some(format!("`{expected}(…)` or `(…)`")),
        Error::InvalidValueForType { expected, .. } => return Some(plain_type(expected)),
        _ => return None,
    };
    Some(words.to_owned())
}

/// The name of a Rust type, as `serde` gives it, in plain words; anything else is left as the author wrote it.
fn plain_type(expected: &str) -> String {
    let first = expected.split(' ').next().unwrap_or_default();
    let words = match expected {
        "f32" | "f64" | "a floating point number" => NUMBER,
        "u8" | "u16" | "u32" | "u64" | "usize" | "i8" | "i16" | "i32" | "i64" | "isize" => WHOLE,
        "bool" | "a boolean" => BOOLEAN,
        "str" | "string" | "a string" | "a borrowed string" => TEXT,
        "a sequence" => LIST,
        "a map" => TABLE,
        "unit" => "`()`",
        _ if expected.starts_with("a nonzero ") => "a whole number other than zero",
        _ if expected.ends_with("signed integer") => WHOLE,
        _ if matches!(first, "struct" | "tuple") => PARENTHESES,
        _ if matches!(first, "enum" | "variant") => NAME,
        other => other,
    };
    words.to_owned()
}

fn out_of_bounds(text: &str, value: &Node) -> &'static str {
    match text.get(value.span.clone()) {
        Some(number) if number.starts_with('-') => "a whole number that is not negative",
        _ => "a smaller whole number",
    }
}

/// The value of a kind ended at `offset` but the text goes on.
fn surplus(text: &str, node: &Node, offset: usize) -> Complaint {
    let holder = interrupted(node, offset);
    if matches!(holder.kind, Kind::Scalar(_)) {
        return mismatch(text, holder, WHOLE);
    }
    let items: Vec<&Node> = holder.children().collect();
    let read = items.iter().filter(|item| item.span.end <= offset).count();
    match (holder.name(), items.get(read)) {
        (Some(name), _) if read == 0 => Complaint {
            message: format!("`{name}` stands alone, without `(…)`"),
            span: holder.span.clone(),
            label: format!("expected `{name}`"),
            help: None,
        },
        (_, Some(first)) => wrong_count(Some(read), items.len(), first.span.clone()),
        (_, None) => wrong_count(None, items.len(), holder.span.clone()),
    }
}

fn wrong_count(expected: Option<usize>, found: usize, span: Range<usize>) -> Complaint {
    let expected = match expected {
        None => "another number of values".to_owned(),
        Some(1) => "1 value".to_owned(),
        Some(count) => format!("{count} values"),
    };
    Complaint {
        message: format!("expected {expected}, found {found}"),
        span,
        label: format!("expected {expected}"),
        help: None,
    }
}

/// The last number in a phrase such as "tuple struct Vec2 with 2 elements".
fn last_number(phrase: &str) -> Option<usize> {
    phrase.split_whitespace().rev().find_map(|word| word.parse().ok())
}

/// The innermost value that covers the byte at `offset`.
fn holder(node: &Node, offset: usize) -> &Node {
    let child = node.children().find(|child| child.span.contains(&offset));
    child.map_or(node, |child| holder(child, offset))
}

/// The innermost value that `offset` cuts in two.
fn interrupted(node: &Node, offset: usize) -> &Node {
    let child = node.children().find(|child| child.span.start < offset && offset < child.span.end);
    child.map_or(node, |child| interrupted(child, offset))
}

/// The innermost value that covers the byte at `offset` or ends right before it: the one that was just read.
fn value_at(node: &Node, offset: usize) -> &Node {
    let child = node.children().find(|child| child.span.contains(&offset) || child.span.end == offset);
    child.map_or(node, |child| value_at(child, offset))
}

/// The key `found` of the value around `offset`.
fn key_span(node: &Node, offset: usize, found: &str) -> Range<usize> {
    let holder = holder(node, offset);
    let field = holder.fields().iter().find(|field| field.key == found);
    field.map_or_else(|| value_at(node, offset).opening(), |field| field.key_span.clone())
}

/// The name that ends at `offset`: a key of a map, or a value's own name.
fn variant_span(node: &Node, offset: usize) -> Range<usize> {
    let keys = holder(node, offset).fields().iter().map(|field| &field.key_span);
    let key = keys.into_iter().find(|key| key.end == offset || key.contains(&offset));
    key.cloned().unwrap_or_else(|| value_at(node, offset).opening())
}
