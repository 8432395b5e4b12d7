//! Errors that are the user's to mend: a wrong scene, a wrong option, a missing file.

use std::borrow::Cow;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use ariadne::{Color, Config, IndexType, Label, Report, ReportKind, Source};

/// What a user got wrong, where, and what would mend it. Every other kind of error is a bug of the program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UserError {
    message: String,
    place: Option<Box<Place>>,
    help: Option<String>,
}

/// The piece of text an error is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Name of the file as the user wrote it.
    pub file: String,
    /// The whole text of the file.
    pub text: Arc<str>,
    /// Bytes of the text that are wrong.
    pub span: Range<usize>,
    /// What was expected there; may be empty.
    pub label: String,
}

impl Place {
    /// Line and column of the first wrong character, both counted from one, columns in characters.
    pub fn line_column(&self) -> (usize, usize) {
        let before = &self.text[..self.text.floor_char_boundary(self.span.start)];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

impl UserError {
    /// An error described by one line, so far without a place.
    pub fn plain(message: impl Into<String>) -> Self {
        Self { message: message.into(), place: None, help: None }
    }

    /// The error lies at `span` (bytes) of `text`, the content of `file`; `label` says what was expected there.
    #[must_use]
    pub fn at(mut self, file: impl Into<String>, text: Arc<str>, span: Range<usize>, label: impl Into<String>) -> Self {
        let start = text.floor_char_boundary(span.start);
        let end = text.ceil_char_boundary(span.end).max(start);
        self.place = Some(Box::new(Place { file: file.into(), text, span: start..end, label: label.into() }));
        self
    }

    /// Adds a line that says how to mend the error; several are joined.
    #[must_use]
    pub fn help(mut self, line: impl Into<String>) -> Self {
        let line = line.into();
        self.help = Some(match self.help {
            Some(before) => format!("{before} {line}"),
            None => line,
        });
        self
    }

    /// The one-line description, without the place.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Where the error lies, if it lies in a text.
    pub fn place(&self) -> Option<&Place> {
        self.place.as_deref()
    }

    /// The line that says how to mend the error.
    pub fn help_line(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The error for a terminal: the line it lies in with the wrong part underlined, and the help.
    pub fn render(&self, colour: bool) -> String {
        self.render_as(ReportKind::Error, colour)
    }

    /// The same for what may be wrong but does not stop a run.
    pub fn render_warning(&self, colour: bool) -> String {
        self.render_as(ReportKind::Warning, colour)
    }

    fn render_as(&self, kind: ReportKind<'_>, colour: bool) -> String {
        let placed = self.place().and_then(|place| self.render_place(place, kind, colour));
        placed.unwrap_or_else(|| self.render_plain(kind, colour))
    }

    fn render_place(&self, place: &Place, kind: ReportKind<'_>, colour: bool) -> Option<String> {
        let id = place.file.as_str();
        let Shown { text, span } = shown(&place.text, &place.span);
        let config = Config::default().with_color(colour).with_index_type(IndexType::Byte);
        let hue = if kind == ReportKind::Error { Color::Red } else { Color::Yellow };
        let mut label = Label::new((id, span.clone())).with_color(hue);
        if !place.label.is_empty() {
            label = label.with_message(&place.label);
        }
        let mut report =
            Report::build(kind, (id, span.clone())).with_config(config).with_message(&self.message).with_label(label);
        if let Some(help) = &self.help {
            report.set_help(help);
        }
        let mut bytes = Vec::new();
        report.finish().write((id, Source::from(&*text)), &mut bytes).ok()?;
        // The place is that in the file, not in what is shown of it.
        let named = |place: &Place| {
            let (line, column) = place.line_column();
            format!("{id}:{line}:{column}")
        };
        let of_shown = named(&Place { text: text.as_ref().into(), span, ..place.clone() });
        String::from_utf8(bytes).ok().map(|report| report.replacen(&of_shown, &named(place), 1))
    }

    fn render_plain(&self, kind: ReportKind<'_>, colour: bool) -> String {
        let (red, off) = if colour { ("\u{1b}[31m", "\u{1b}[0m") } else { ("", "") };
        let help = self.help.as_ref().map(|help| format!("  Help: {help}\n")).unwrap_or_default();
        format!("{red}{kind}:{off} {self}\n{help}")
    }
}

/// Letters of a line that are shown on each side of where the error begins; a longer line is cut.
const MOST_SHOWN: usize = 200;

/// What is shown of a text.
struct Shown<'a> {
    text: Cow<'a, str>,
    span: Range<usize>,
}

/// The text without control characters, which the terminal would obey, and with what is far off in the line of `span` left out.
fn shown<'a>(text: &'a str, span: &Range<usize>) -> Shown<'a> {
    let start = text.floor_char_boundary(span.start);
    let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
    let line_end = text[start..].find('\n').map_or(text.len(), |length| start + length);
    // A span over several lines is shown by its first one, whatever the others are like.
    let span = &(span.start..span.end.min(line_end.max(start)));
    let (from, to) = (start.saturating_sub(MOST_SHOWN).max(line_start), (start + MOST_SHOWN).min(line_end));
    let (from, to) = (text.floor_char_boundary(from), text.floor_char_boundary(to));
    let is_long = line_end - line_start > 2 * MOST_SHOWN;
    let (text, span) = if is_long {
        let before = if from > line_start { "…" } else { "" };
        let after = if to < line_end { "…" } else { "" };
        let shown = format!("{}{before}{}{after}{}", &text[..line_start], &text[from..to], &text[line_end..]);
        let shift = |byte: usize| byte.min(to) - from + line_start + before.len();
        (Cow::Owned(shown), shift(start)..shift(span.end.max(start)))
    } else {
        (Cow::Borrowed(text), span.clone())
    };
    let obeyed = |letter: char| letter.is_control() && !matches!(letter, '\n' | '\r' | '\t');
    if !text.contains(obeyed) {
        return Shown { text, span };
    }
    // As many bytes as before, so that the span stays right.
    let harmless = |letter: char| match letter.len_utf8() {
        1 if obeyed(letter) => '?',
        _ if obeyed(letter) => '¿',
        _ => letter,
    };
    Shown { text: Cow::Owned(text.chars().map(harmless).collect()), span }
}

impl fmt::Display for UserError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            let (line, column) = place.line_column();
            write!(f, "{}:{line}:{column}: ", place.file)?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for UserError {}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str, span: Range<usize>) -> UserError {
        UserError::plain("wrong").at("a.ron", text.into(), span, "a number")
    }

    #[test]
    fn display_counts_lines_and_characters_from_one() {
        // "é" and "ø" take two bytes each: byte 11 is the eighth character of the second line.
        assert_eq!(at("(\né: \"ø\" x)", 11..12).to_string(), "a.ron:2:8: wrong");
        assert_eq!(at("abc", 0..1).to_string(), "a.ron:1:1: wrong");
        assert_eq!(UserError::plain("no such file").to_string(), "no such file");
    }

    #[test]
    fn a_span_over_several_lines_is_shown_by_its_first() {
        let text = format!("(\n  a: (\n  b: \"{}\"),\n)", "x".repeat(1_000_000));
        let shown = at(&text, 7..text.len() - 2).render(false);
        assert!(shown.contains("a.ron:2:6") && shown.len() < 2000, "{} bytes", shown.len());
    }

    #[test]
    fn render_shows_line_label_and_help_under_the_right_column() {
        let error = at("(\n  // fjørd é\n  naïve: \"sjø\", x: y,\n)", 38..39).help("try 1").help("or 2");
        let shown = error.render(false);
        for part in ["a.ron:3:20", "naïve: \"sjø\", x: y,", "a number", "Help: try 1 or 2", "Error: wrong"] {
            assert!(shown.contains(part), "{part} not in\n{shown}");
        }
        let column_of = |line: &str, what| line.find(what).map(|byte| line[..byte].chars().count());
        let source = shown.lines().find(|line| line.contains("naïve")).unwrap_or_default();
        let under = shown.lines().find(|line| line.contains('┬')).unwrap_or_default();
        assert_eq!(column_of(source, "y,"), column_of(under, "┬"), "{shown}");
        assert!(!shown.contains('\u{1b}') && error.render(true).contains('\u{1b}'));
    }

    #[test]
    fn spans_at_and_beyond_the_end_do_not_panic() {
        for text in ["", "x", "x\n", "ø", "a\r\nø\u{2028}"] {
            for start in 0..text.len() + 3 {
                for length in 0..4 {
                    let shown = at(text, start..start + length).render(false);
                    assert!(shown.contains("wrong"), "{shown}");
                }
            }
        }
    }

    #[test]
    fn of_a_long_line_the_part_around_the_error_is_shown_and_its_place_is_that_in_the_file() {
        let line = format!("title: \"{}\", wrong: x, then: \"{}\"", "ø".repeat(500_000), "y".repeat(1_000_000));
        let text = format!("(\n{line}\n)");
        let start = text.find("wrong").unwrap_or_default();
        let shown = at(&text, start..start + 5).render(false);
        assert!(shown.len() < 3000, "{} bytes", shown.len());
        for part in ["a.ron:2:500012", "øø\", wrong: x, then: \"yy", "a number", "…"] {
            assert!(shown.contains(part), "{part} not in\n{shown}");
        }
        let endless = at(&text, start..text.len()).render(false);
        assert!(endless.len() < 4000 && endless.contains("a.ron:2:500012"), "{endless}");
    }

    #[test]
    fn the_terminal_does_not_obey_what_stands_in_a_scene() {
        let shown = at("(title: \"\u{1b}[31m\u{9b}2J\u{7}\", x: y)", 23..24).render(false);
        assert!(!shown.chars().any(|letter| letter.is_control() && letter != '\n'), "{shown:?}");
    }

    #[test]
    fn plain_errors_render_message_and_help() {
        let shown = UserError::plain("no file").help("look elsewhere").render(false);
        assert_eq!(shown, "Error: no file\n  Help: look elsewhere\n");
    }
}
