//! How deeply the brackets of a text are nested, found without reading its values: a reader needs memory and stack for
//! every level.

use std::ops::Range;

/// Levels of brackets that a text may have; shipped scenes have less than ten.
pub(super) const MOST_LEVELS: usize = 32;

/// The first opening bracket with more than [`MOST_LEVELS`] brackets open, itself included.
pub(super) fn too_deep(text: &str) -> Option<Range<usize>> {
    let mut open = 0_usize;
    let mut place = 0;
    while let Some(rest) = text.get(place..).filter(|rest| !rest.is_empty()) {
        if let Some(length) = skipped(rest) {
            place += length;
            continue;
        }
        match rest.as_bytes()[0] {
            b'(' | b'[' | b'{' if open == MOST_LEVELS => return Some(place..place + 1),
            b'(' | b'[' | b'{' => open += 1,
            b')' | b']' | b'}' => open = open.saturating_sub(1),
            _ => {}
        }
        place += rest.chars().next().map_or(1, char::len_utf8);
    }
    None
}

/// Bytes of the comment or text in quotes at the start of `rest`, in which brackets do not count; one that is never
/// closed takes all.
fn skipped(rest: &str) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    if rest.starts_with("/*") {
        return Some(comment(rest));
    }
    if let Some(raw) = rest.strip_prefix('r') {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        let closing = format!("\"{}", "#".repeat(hashes));
        let content = raw.get(hashes..)?.strip_prefix('"')?;
        let start = rest.len() - content.len();
        return Some(content.find(&closing).map_or(rest.len(), |end| start + end + closing.len()));
    }
    // Of single characters only these matter.
    let characters = ["'('", "'['", "'{'", "')'", "']'", "'}'", "'\"'", "'\\\"'"];
    if let Some(character) = characters.iter().find(|character| rest.starts_with(**character)) {
        return Some(character.len());
    }
    rest.starts_with('"').then(|| quoted(rest))
}

/// Bytes of the text in quotes at the start of `rest`.
fn quoted(rest: &str) -> usize {
    let mut escaped = false;
    let closing = rest.bytes().skip(1).position(|byte| {
        let closes = byte == b'"' && !escaped;
        escaped = byte == b'\\' && !escaped;
        closes
    });
    closing.map_or(rest.len(), |place| place + 2)
}

/// Bytes of the comment at the start of `rest`; such comments may be nested.
fn comment(rest: &str) -> usize {
    let (mut open, mut place) = (0_usize, 0);
    while let Some(pair) = rest.as_bytes().get(place..place + 2) {
        match pair {
            b"/*" => (open, place) = (open + 1, place + 2),
            b"*/" if open == 1 => return place + 2,
            b"*/" => (open, place) = (open - 1, place + 2),
            _ => place += 1,
        }
    }
    rest.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bracket_too_many_is_found() {
        let levels = |count: usize| "[(".repeat(count / 2) + &")]".repeat(count / 2);
        assert_eq!(too_deep(&levels(MOST_LEVELS)), None);
        assert_eq!(too_deep(&levels(MOST_LEVELS).repeat(3)), None);
        assert_eq!(too_deep(&format!("ø{}", levels(MOST_LEVELS + 2))), Some(MOST_LEVELS + 2..MOST_LEVELS + 3));
        assert_eq!(too_deep(&"{".repeat(100_000)), Some(MOST_LEVELS..MOST_LEVELS + 1));
    }

    #[test]
    fn brackets_in_texts_and_comments_do_not_count() {
        let many = "(".repeat(2 * MOST_LEVELS);
        for text in [
            format!("\"{many}\""),
            format!("\"\\\"{many}\\\\\""),
            format!("r\"{many}\\\""),
            format!("r##\"{many}\"#{many}\"##"),
            format!("// {many}"),
            format!("/* /* */ {many} */"),
            "'('".repeat(2 * MOST_LEVELS),
            "'\"' '\\\"' r#type".to_owned(),
        ] {
            assert_eq!(too_deep(&text), None, "{text}");
            assert!(too_deep(&format!("{text}\n{many}")).is_some(), "{text} goes on behind its end");
        }
        for open in ["\"", "\"\\\"", "r#\"\"", "/*", "/* /* */"] {
            assert_eq!(too_deep(&format!("{open}{many}")), None, "{open}");
        }
    }
}
