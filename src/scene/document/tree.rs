//! The tree of values of a scene, each with its place in the text.

use std::ops::Range;

use ron2::ast::{Expr, Ident, NumberKind, StructBody, StructField, TupleElement, parse_document};
use ron2::error::{ErrorKind, Span};

/// One value and the bytes of the text it covers.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Bytes from the first to behind the last character of the value, its name included.
    pub span: Range<usize>,
    /// What the value is.
    pub kind: Kind,
}

/// What a value is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// `Name(a: 1)` or `(a: 1)`.
    Struct {
        /// The name before the parenthesis.
        name: Option<Name>,
        /// The fields in the order of the text.
        fields: Vec<Field>,
    },
    /// `Name(1, 2)`, `(1, 2)`, `Some(1)`, `Name()`, `()`.
    Tuple {
        /// The name before the parenthesis.
        name: Option<Name>,
        /// The values in the order of the text.
        items: Vec<Node>,
    },
    /// `{"key": 1}`.
    Map {
        /// The entries in the order of the text; a key in quotes is given without them.
        entries: Vec<Field>,
    },
    /// `[1, 2]`.
    List(Vec<Node>),
    /// A value without parts.
    Scalar(Scalar),
}

/// The kinds of values without parts.
#[derive(Debug, Clone, PartialEq)]
pub enum Scalar {
    /// A number; false if it is not finite.
    Number {
        /// Whether the number is neither infinite nor NaN.
        finite: bool,
    },
    /// A text in quotes, with its content.
    Text(String),
    /// `true` or `false`.
    Bool,
    /// A single character or bytes, which no scene needs.
    Character,
    /// `None`.
    Nothing,
    /// A bare name such as `NoSlip`.
    Name(String),
}

/// A name and its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Name {
    /// The name.
    pub text: String,
    /// Bytes of the name.
    pub span: Range<usize>,
}

/// A named value in a struct or a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// The name, without quotes.
    pub key: String,
    /// Bytes of the name, with quotes.
    pub key_span: Range<usize>,
    /// The value.
    pub value: Node,
}

impl Field {
    /// Whether the name stands in quotes, as it may in a map.
    pub fn is_quoted(&self) -> bool {
        self.key_span.len() > self.key.len()
    }
}

impl Node {
    /// The name of a struct, tuple or bare name.
    pub fn name(&self) -> Option<&str> {
        match &self.kind {
            Kind::Struct { name, .. } | Kind::Tuple { name, .. } => name.as_ref().map(|name| name.text.as_str()),
            Kind::Scalar(Scalar::Name(name)) => Some(name),
            _ => None,
        }
    }

    /// What to underline when something is missing inside: the name if there is one, else the opening bracket, else
    /// the whole value.
    pub fn opening(&self) -> Range<usize> {
        match &self.kind {
            Kind::Struct { name: Some(name), .. } | Kind::Tuple { name: Some(name), .. } => name.span.clone(),
            Kind::Scalar(_) => self.span.clone(),
            _ => self.span.start..self.span.start + 1,
        }
    }

    /// The fields of a struct or map; none for anything else.
    pub fn fields(&self) -> &[Field] {
        match &self.kind {
            Kind::Struct { fields, .. } => fields,
            Kind::Map { entries } => entries,
            _ => &[],
        }
    }

    /// The items of a list or tuple; none for anything else.
    pub fn items(&self) -> &[Node] {
        match &self.kind {
            Kind::Tuple { items, .. } | Kind::List(items) => items,
            _ => &[],
        }
    }

    /// All values directly inside this one.
    pub fn children(&self) -> impl Iterator<Item = &Node> {
        self.fields().iter().map(|field| &field.value).chain(self.items())
    }

    /// The only value inside `Some(x)`, `Name(x)` or `(x)`.
    pub fn inner(&self) -> Option<&Node> {
        match &self.kind {
            Kind::Tuple { items, .. } if items.len() == 1 => items.first(),
            _ => None,
        }
    }

    /// The value itself without any wrappers around it, as in `Some(Shape(Box(min: 1)))`.
    pub fn unwrapped(&self) -> &Node {
        self.inner().map_or(self, Node::unwrapped)
    }

    /// The field or entry `key` of this value, looking through wrappers.
    pub fn field(&self, key: &str) -> Option<&Field> {
        self.fields().iter().find(|field| field.key == key).or_else(|| self.inner()?.field(key))
    }

    /// The value `component` (a field, key or index) one level further in, looking through wrappers.
    ///
    /// An index counts the values of a wrapper before it counts those inside, except for `Some(…)`, which is never
    /// counted.
    pub fn step(&self, component: &str) -> Option<&Node> {
        if self.name() == Some("Some") {
            return self.inner()?.step(component);
        }
        let item = || component.parse::<usize>().ok().and_then(|index| self.items().get(index));
        let within = || self.inner()?.step(component);
        self.field(component).map(|field| &field.value).or_else(item).or_else(within)
    }

    /// What the value is, in the words of an error message.
    pub fn describe(&self, text: &str) -> String {
        let shown = || text.get(self.span.clone()).unwrap_or_default();
        match (&self.kind, self.name()) {
            (Kind::Scalar(Scalar::Number { .. }), _) => format!("the number {}", shown()),
            (Kind::Scalar(Scalar::Text(_)), _) if self.span.len() <= 40 => format!("the text {}", shown()),
            (Kind::Scalar(Scalar::Text(_)), _) => "a text".to_owned(),
            (Kind::Scalar(Scalar::Character), _) => "a character".to_owned(),
            (Kind::Scalar(_), _) => format!("`{}`", shown()),
            (_, Some(name)) => format!("`{name}(…)`"),
            (Kind::Struct { .. }, None) => "named values `(name: …)`".to_owned(),
            (Kind::Tuple { items, .. }, None) if items.is_empty() => "`()`".to_owned(),
            (Kind::Tuple { .. }, None) => "values in parentheses `(…)`".to_owned(),
            (Kind::Map { .. }, None) => "a table `{…}`".to_owned(),
            (Kind::List(_), None) => "a list `[…]`".to_owned(),
        }
    }
}

/// A mistake in the syntax: what and where.
pub(super) struct SyntaxError {
    pub message: String,
    pub span: Range<usize>,
}

/// Reads the tree of a text; `Err` if its brackets, commas or values are malformed.
pub(super) fn parse(text: &str) -> Result<Node, SyntaxError> {
    let document = parse_document(text).map_err(|error| {
        let span = bytes(error.span());
        let rest = text.get(span.start..).unwrap_or_default();
        let message = if rest.starts_with('.') {
            "a decimal point must stand between digits, as in 0.5 or 5.0".to_owned()
        } else if rest.starts_with("/*") {
            "this comment is never closed".to_owned()
        } else {
            words(error.kind())
        };
        SyntaxError { message, span }
    })?;
    match document.value {
        Some(value) => Ok(node(&value)),
        None => Err(SyntaxError { message: "there is no value".to_owned(), span: text.len()..text.len() }),
    }
}

/// The parser's message in plain words.
fn words(kind: &ErrorKind) -> String {
    let fixed = match kind {
        ErrorKind::Eof => "the text ends where a value is expected",
        ErrorKind::ExpectedStringEnd => "this text in quotes is never closed",
        ErrorKind::TrailingCharacters => "something follows the end of the value",
        ErrorKind::UnexpectedChar('-' | '+') => "a sign must be followed by a digit, as in -0.5",
        ErrorKind::UnexpectedChar(found) => return format!("unexpected character `{found}`"),
        ErrorKind::Expected { expected, .. } => match &**expected {
            "closing `)` or `}`" | "closing `)`" => "expected `,` or the closing `)`",
            "closing `]`" => "expected `,` or the closing `]`",
            "closing `}`" => "expected `,` or the closing `}`",
            "`:` after map key" => "expected `:` after the name",
            "comma" => "expected `,` or a closing bracket",
            "identifier" => "expected a name",
            "value" => "expected a value",
            other => return format!("expected {other}"),
        },
        other => return lower_first(&other.to_string()),
    };
    fixed.to_owned()
}

/// The sentence with a lower-case first letter, so that it can follow a place.
pub(super) fn lower_first(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}

fn bytes(span: &Span) -> Range<usize> {
    span.start_offset..span.end_offset
}

fn node(expr: &Expr<'_>) -> Node {
    let kind = match expr {
        Expr::Unit(_) => Kind::Tuple { name: None, items: Vec::new() },
        Expr::Bool(_) => Kind::Scalar(Scalar::Bool),
        Expr::Char(_) | Expr::Byte(_) | Expr::Bytes(_) | Expr::Error(_) => Kind::Scalar(Scalar::Character),
        Expr::Number(number) => Kind::Scalar(Scalar::Number { finite: is_finite(&number.raw, &number.kind) }),
        Expr::String(string) => Kind::Scalar(Scalar::Text(string.value.clone())),
        Expr::Option(option) => match &option.value {
            None => Kind::Scalar(Scalar::Nothing),
            Some(value) => {
                let start = option.span.start_offset;
                let name = Name { text: "Some".to_owned(), span: start..start + "Some".len() };
                Kind::Tuple { name: Some(name), items: vec![node(&value.expr)] }
            }
        },
        Expr::Seq(list) => Kind::List(list.items.iter().map(|item| node(&item.expr)).collect()),
        Expr::Map(map) => {
            Kind::Map { entries: map.entries.iter().map(|entry| field(map_key(&entry.key), &entry.value)).collect() }
        }
        Expr::Tuple(tuple) => Kind::Tuple { name: None, items: items(&tuple.elements) },
        Expr::AnonStruct(body) => Kind::Struct { name: None, fields: fields(&body.fields) },
        Expr::Struct(named) => match &named.body {
            None => named_scalar(&named.name.name),
            Some(StructBody::Tuple(body)) => {
                Kind::Tuple { name: Some(name(&named.name)), items: items(&body.elements) }
            }
            Some(StructBody::Fields(body)) => {
                Kind::Struct { name: Some(name(&named.name)), fields: fields(&body.fields) }
            }
        },
    };
    Node { span: bytes(expr.span()), kind }
}

/// A bare name; the spellings of infinity with a type suffix are numbers to `ron`.
fn named_scalar(name: &str) -> Kind {
    Kind::Scalar(match name {
        "inff32" | "inff64" | "NaNf32" | "NaNf64" => Scalar::Number { finite: false },
        _ => Scalar::Name(name.to_owned()),
    })
}

fn is_finite(raw: &str, kind: &NumberKind) -> bool {
    let digits = raw.replace('_', "");
    let digits = digits.strip_suffix("f64").or_else(|| digits.strip_suffix("f32")).unwrap_or(&digits);
    *kind != NumberKind::SpecialFloat && digits.parse::<f64>().is_ok_and(f64::is_finite) || is_radix_integer(digits)
}

/// Whether a number is written like `0x1F`, which Rust's own number parser does not read.
fn is_radix_integer(digits: &str) -> bool {
    let unsigned = digits.trim_start_matches(['+', '-']);
    ["0x", "0b", "0o"].iter().any(|prefix| unsigned.starts_with(prefix))
}

fn name(ident: &Ident<'_>) -> Name {
    Name { text: ident.name.trim_start_matches("r#").to_owned(), span: bytes(&ident.span) }
}

fn map_key(key: &Expr<'_>) -> Name {
    let text = match key {
        Expr::String(string) => string.value.clone(),
        Expr::Struct(bare) => bare.name.name.clone().into_owned(),
        Expr::Number(number) => number.raw.clone().into_owned(),
        _ => String::new(),
    };
    Name { text, span: bytes(key.span()) }
}

fn field(key: Name, value: &Expr<'_>) -> Field {
    Field { key: key.text, key_span: key.span, value: node(value) }
}

fn fields(fields: &[StructField<'_>]) -> Vec<Field> {
    fields.iter().map(|entry| field(name(&entry.name), &entry.value)).collect()
}

fn items(elements: &[TupleElement<'_>]) -> Vec<Node> {
    elements.iter().map(|element| node(&element.expr)).collect()
}
