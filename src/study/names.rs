//! Short names of varied values, and names of files made of them.

/// Most letters of the name of a file, without its ending.
const LONGEST: usize = 120;

/// Letters of the checksum that stands behind a name which does not hold everything.
const CHECKSUM: usize = 9;

/// For each path the shortest end that no other path has: `yield_stress`, or `slide.rheology.yield_stress` where `mud` has one, too.
pub(super) fn labels(paths: &[String]) -> Vec<String> {
    paths.iter().map(|path| label(path, paths)).collect()
}

fn label(path: &str, paths: &[String]) -> String {
    let starts = path.rmatch_indices('.').map(|(dot, _)| dot + 1).chain([0]);
    let mut ends = starts.map(|start| &path[start..]);
    let is_own = |end: &&str| {
        let has_it = |other: &&String| *other == end || other.strip_suffix(end).is_some_and(|rest| rest.ends_with('.'));
        !end.starts_with(|first: char| first.is_ascii_digit()) && paths.iter().filter(has_it).count() == 1
    };
    ends.find(is_own).unwrap_or(path).to_owned()
}

/// The name of the files of a run, from labels and values: `yield_stress=100,spacing=0.02`. It holds nothing that a shell or a file
/// system could take for something else; where that left something out, a checksum of the whole stands behind it.
pub(super) fn file_name<'a>(values: impl Iterator<Item = (&'a str, &'a str)>) -> String {
    let parts: Vec<String> = values.map(|(label, value)| format!("{label}={value}")).collect();
    let whole = if parts.is_empty() { "unchanged".to_owned() } else { parts.join(",") };
    safe(&whole)
}

/// `text` as the name of a file.
pub(super) fn safe(text: &str) -> String {
    let is_safe = |letter: char| letter.is_ascii_alphanumeric() || "=.,+-_".contains(letter);
    let mut name = String::new();
    for letter in text.chars() {
        match letter {
            letter if is_safe(letter) => name.push(letter),
            _ if name.ends_with('_') => {}
            _ => name.push('_'),
        }
    }
    if name == text && name.len() <= LONGEST {
        return name;
    }
    name.truncate(LONGEST - CHECKSUM);
    format!("{}-{:08x}", name.trim_end_matches('_'), crc32fast::hash(text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_as_short_as_they_can_be() {
        let labels = |paths: &[&str]| labels(&paths.iter().map(|path| (*path).to_owned()).collect::<Vec<_>>());
        assert_eq!(labels(&["phases.slide.rheology.yield_stress", "spacing"]), ["yield_stress", "spacing"]);
        let two = ["phases.slide.rheology.yield_stress", "phases.mud.rheology.yield_stress"];
        assert_eq!(labels(&two), ["slide.rheology.yield_stress", "mud.rheology.yield_stress"]);
        assert_eq!(labels(&["gravity.1", "fluids.0.velocity.1"]), ["gravity.1", "velocity.1"]);
        // One is the end of the other.
        assert_eq!(labels(&["spacing", "log.spacing"]), ["spacing", "log.spacing"]);
    }

    #[test]
    fn names_of_files_are_safe_and_differ() {
        let name = |value: &str| file_name([("a", value), ("b", "-1.5e-7")].into_iter());
        assert_eq!(name("100"), "a=100,b=-1.5e-7");
        assert_eq!(file_name([].into_iter()), "unchanged");
        let lossy = ["(0.0, 1.0)", "(0.0,1.0)", "../../x y", "Bingham(a: 1)", "ø", "å", &"x".repeat(500)].map(name);
        for (k, name) in lossy.iter().enumerate() {
            assert!(name.len() <= LONGEST && !name.contains(['/', '\\', ' ', ':', '(']), "{name}");
            assert!(!lossy[..k].contains(name), "{name}");
        }
    }
}
