//! Lists of names in messages, and the name the user may have meant.

/// The known name that `name` is most likely a misspelling of; none if all are too different.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = name.to_lowercase();
    known
        .into_iter()
        .filter_map(|candidate| {
            let distance = strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
            let longest = candidate.chars().count().max(lower.chars().count());
            // A third of the letters may be wrong: more is another word, and short words differ by one letter only.
            (distance <= (longest / 3).max(1)).then_some((distance, candidate))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// `` did you mean `x`? `` if some known name is near.
pub(super) fn suggestion<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(name, known).map(|candidate| format!("did you mean `{candidate}`?"))
}

/// `` expected one of `a`, `b` ``.
pub(super) fn expected_one_of(known: &[&str]) -> String {
    match known {
        [] => "nothing is expected here".to_owned(),
        [only] => format!("expected `{only}`"),
        many => format!("expected one of {}", quoted(many)),
    }
}

/// `` `a`, `b` ``.
pub(super) fn quoted(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspellings_find_their_name_and_strangers_do_not() {
        let known = ["yield_stress", "density", "dx", "viscosity"];
        assert_eq!(nearest("yeild_stress", known), Some("yield_stress"));
        assert_eq!(nearest("Viscosity", known), Some("viscosity"));
        assert_eq!(nearest("denisty", known), Some("density"));
        assert_eq!(nearest("dy", known), Some("dx"));
        assert_eq!(nearest("colour", known), None);
        assert_eq!(nearest("anything", []), None);
    }

    #[test]
    fn lists_of_names_read_well() {
        assert_eq!(expected_one_of(&["a", "b"]), "expected one of `a`, `b`");
        assert_eq!(expected_one_of(&["a"]), "expected `a`");
        assert_eq!(expected_one_of(&[]), "nothing is expected here");
    }
}
