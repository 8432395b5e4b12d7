//! Opening scene files, and variants of scenes: the same scene, coarser.
//!
//! A variant is a file of its own:
//!
//! ```ron
//! Variant(
//!     of: "../two_phase_tank.ron",       // the scene, seen from this file
//!     set: {"spacing": "0.008"},         // what --set would be given
//!     expect: [],                        // in the place of the scene's own
//! )
//! ```
//!
//! Complaints about what the variant brought point to its file.

use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use schemars::JsonSchema;

use super::document::{Kind, Node, Scalar};
use super::{Document, nearest};
use crate::error::UserError;
use crate::expect::ExpectSection;

/// The section of a scene that a variant replaces.
pub(super) const REPLACED: &str = "expect";

/// Fields of a variant.
const FIELDS: [&str; 3] = ["of", "set", REPLACED];

/// `Variant(of: "tank.ron", set: {"spacing": "0.008"}, expect: […])` in a file of its own is another scene with some values
/// changed and expectations of its own (`scenes/ci`, `scenes/fine`).
#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "a variant is read value by value, since some of its texts are values of the scene")]
pub(super) struct VariantFile {
    /// File of the scene, seen from the file of the variant.
    of: String,
    /// Path and value of what is changed, as `--set path=value` has them: `{"spacing": "0.008"}`.
    #[schemars(extend("derived" = "nothing"))]
    #[serde(default)]
    set: BTreeMap<String, serde_json::Value>,
    /// In the place of the scene's own `expect`.
    #[schemars(extend("derived" = "that of the scene"))]
    expect: Option<ExpectSection>,
}

/// Reads the scene or variant at `path` and applies overrides `path=value` to it.
///
/// # Errors
/// A file that is missing or malformed, or an override that does not fit.
pub fn open_document(path: &Path, overrides: &[String]) -> Result<Document, UserError> {
    let text = read_text(path)?;
    let file = path.display().to_string();
    let any = Document::parse_value(&file, &text)?;
    let document =
        if any.root().name() == Some("Variant") { compose(any, path)? } else { Document::parse(&file, &text)? };
    overrides.iter().try_fold(document, |document, pair| document.set_pair(pair))
}

/// The scene that a variant describes.
fn compose(variant: Document, path: &Path) -> Result<Document, UserError> {
    variant.require_known_fields("", &FIELDS)?;
    let of: String = variant.read("of")?;
    let base = clean(&path.parent().unwrap_or(Path::new("")).join(&of));
    let at_of = |message: &str| variant.error(span_of(&variant, "of"), message, "the scene that this is a variant of");
    let text = read_text(&base).map_err(|error| {
        let placed = at_of(error.message());
        error.help_line().into_iter().fold(placed, |placed, help| placed.help(help))
    })?;
    let mut document = Document::parse(&base.display().to_string(), &text)?;
    let variant = Arc::new(variant);
    for Setting { path, text, span } in settings(&variant, "set")? {
        document = document.set_from(&path, &text, (&variant, span))?;
    }
    if let Some(node) = variant.node(REPLACED) {
        let text = variant.text().get(node.span.clone()).unwrap_or_default();
        document = document.replace(REPLACED, text)?;
    }
    Ok(document.with_variant(variant))
}

/// An override in a file: `path: value`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Setting {
    /// Path of the value in the scene.
    pub path: String,
    /// The value, as `--set` would be given it.
    pub text: String,
    /// Where the value stands in the file.
    pub span: Range<usize>,
}

impl Setting {
    /// The override `path: node`: a text holds what `--set` would be given, anything else stands for itself.
    pub fn new(document: &Document, path: &str, node: &Node) -> Self {
        let text = match &node.kind {
            Kind::Scalar(Scalar::Text(text)) => text.clone(),
            _ => document.text().get(node.span.clone()).unwrap_or_default().to_owned(),
        };
        Self { path: path.to_owned(), text, span: node.span.clone() }
    }
}

/// The overrides in the table at the path `table` of a file; none if there is no such table.
///
/// # Errors
/// It is no table.
pub(crate) fn settings(document: &Document, table: &str) -> Result<Vec<Setting>, UserError> {
    let Some(node) = document.node(table) else { return Ok(Vec::new()) };
    let Kind::Map { entries } = &node.unwrapped().kind else {
        let message = format!("expected a table `{{\"path\": value}}`, found {}", node.describe(document.text()));
        return Err(document.error(node.span.clone(), message, "expected a table"));
    };
    Ok(entries.iter().map(|entry| Setting::new(document, &entry.key, &entry.value)).collect())
}

fn span_of(document: &Document, path: &str) -> Range<usize> {
    document.node(path).map_or(0..0, |node| node.span.clone())
}

/// The text of a file.
///
/// # Errors
/// It cannot be read, with the file that was perhaps meant; or it is no text.
pub(crate) fn read_text(path: &Path) -> Result<String, UserError> {
    let bytes = fs::read(path).map_err(|error| {
        let shown = UserError::plain(format!("cannot read {}: {error}", path.display()));
        match similar_file(path) {
            Some(near) => shown.help(format!("did you mean `{}`?", near.display())),
            None => shown,
        }
    })?;
    decode(bytes)
        .map_err(|what| UserError::plain(format!("{} is {what}", path.display())).help("save it as a text in UTF-8"))
}

/// The text of a file, without the mark that some editors put before it; or what it is instead of a text in UTF-8.
fn decode(bytes: Vec<u8>) -> Result<String, &'static str> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err("a text in UTF-16");
    }
    let text = String::from_utf8(bytes).map_err(|_| "not a text in UTF-8")?;
    Ok(text.trim_start_matches('\u{feff}').to_owned())
}

/// The file in the same folder whose name is nearest to that of a missing one.
fn similar_file(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_string_lossy();
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    let entries = fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    let files = entries.filter_map(Result::ok).filter(|entry| entry.path().is_file());
    // Names without their ending count too: `tank` is for `tank.ron`.
    let names: BTreeMap<String, String> = files
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .flat_map(|file| [(file.trim_end_matches(".ron").to_owned(), file.clone()), (file.clone(), file)])
        .collect();
    let found = nearest(&name, names.keys().map(String::as_str))?;
    names.get(found).map(|file| folder.map_or(PathBuf::from(file), |folder| folder.join(file)))
}

/// `a/b/../c` as `a/c`, as far as the text goes.
pub(crate) fn clean(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut clean, component| {
        let is_folder = matches!(clean.components().next_back(), Some(Component::Normal(_)));
        if component == Component::ParentDir && is_folder {
            clean.pop();
        } else {
            clean.push(component);
        }
        clean
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with a scene and a variant of it, removed at the end of the test.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str, variant: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("storegga-variant-{}-{name}", std::process::id()));
            fs::create_dir_all(folder.join("ci")).unwrap();
            fs::write(folder.join("tank.ron"), "Scene(\n    title: \"a\",\n    spacing: 0.1,\n    expect: [1],\n)\n")
                .unwrap();
            fs::write(folder.join("ci/tank.ron"), variant).unwrap();
            Self(folder)
        }

        fn open(&self, overrides: &[&str]) -> Result<Document, UserError> {
            let overrides: Vec<String> = overrides.iter().map(|pair| (*pair).to_owned()).collect();
            open_document(&self.0.join("ci/tank.ron"), &overrides)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_variant_sets_values_and_replaces_expectations() {
        let folder = Folder::new(
            "sets",
            "Variant(of: \"../tank.ron\", set: {\"spacing\": \"0.2\", \"title\": \"b\"}, expect: [2])",
        );
        let document = folder.open(&["spacing=0.3"]).unwrap();
        assert_eq!(document.read::<f64>("spacing"), Ok(0.3));
        assert_eq!(document.read::<String>("title").unwrap(), "b");
        assert_eq!(document.read::<Vec<u32>>("expect").unwrap(), [2]);
        assert!(document.file().ends_with("tank.ron") && !document.file().contains(".."), "{}", document.file());
    }

    #[test]
    fn errors_point_to_the_file_that_brought_them() {
        let variant = "Variant(of: \"../tank.ron\",\n  set: {\"spacing\": -1},\n  expect: [wrong])";
        let folder = Folder::new("errors", variant);
        let document = folder.open(&[]).unwrap();
        let expect = document.read::<Vec<u32>>("expect").unwrap_err().to_string();
        assert!(expect.contains("ci/tank.ron:3:12"), "{expect}");
        let spacing = document.invalid(&super::super::Invalid::new("spacing", "negative")).to_string();
        assert!(spacing.contains("ci/tank.ron:2:20"), "{spacing}");
        let misspelt =
            Folder::new("misspelt", "Variant(of: \"../tank.ron\", set: {\"spacng.x\": 1})").open(&[]).unwrap();
        let unknown = misspelt.require_known_fields("", &["title", "spacing", "expect"]).unwrap_err().render(false);
        assert!(unknown.contains("ci/tank.ron:1:46") && unknown.contains("did you mean `spacing`?"), "{unknown}");
        let title = document.invalid(&super::super::Invalid::new("title", "dull")).to_string();
        assert!(!title.contains("ci/") && title.contains("tank.ron:2:12"), "{title}");
        let overridden = folder.open(&["spacing=-2"]).unwrap();
        let spacing = overridden.invalid(&super::super::Invalid::new("spacing", "negative")).to_string();
        assert!(!spacing.contains("ci/"), "{spacing}");
    }

    #[test]
    fn what_is_wrong_with_a_variant_is_said_there() {
        for (name, variant, expected) in [
            ("base", "Variant(of: \"../tnak.ron\")", "did you mean"),
            ("path", "Variant(of: \"../tank.ron\", set: {\"expect.7\": \"1\"})", "ci/tank.ron:1:46"),
            ("list", "Variant(of: \"../tank.ron\", set: [1])", "expected a table `{\"path\": value}`, found a list"),
            ("struct", "Variant(of: \"../tank.ron\", set: (spacing: 1))", "ci/tank.ron:1:33"),
            ("of", "Variant(of: 1)", "expected a text in quotes"),
            ("field", "Variant(of: \"../tank.ron\", sets: {})", "`sets`"),
        ] {
            let error = Folder::new(name, variant).open(&[]).unwrap_err();
            assert!(error.render(false).contains(expected), "{}", error.render(false));
        }
    }

    #[test]
    fn marks_of_editors_are_passed_over_and_other_encodings_named() {
        let with_mark = Folder::new("mark", "\u{feff}Variant(of: \"../tank.ron\")");
        assert_eq!(with_mark.open(&[]).unwrap().read::<f64>("spacing"), Ok(0.1));
        let scene: Vec<u8> = "\u{feff}Scene()".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(decode(scene), Err("a text in UTF-16"));
        assert_eq!(decode(vec![b'S', 0xff]), Err("not a text in UTF-8"));
    }
}
