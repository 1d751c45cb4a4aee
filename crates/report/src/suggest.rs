//! "Did you mean": the nearest of the known names.

/// A remedy for an unknown name: the nearest known one if it is near, else the list of what is known.
/// `None` where nothing is known.
#[must_use]
pub fn did_you_mean<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let known: Vec<&str> = known.into_iter().collect();
    match near_names(name, known.iter().copied()).first() {
        Some(near) => Some(format!("did you mean `{near}`?")),
        None if known.is_empty() => None,
        None => Some(format!("known here: {}", list_names(known))),
    }
}

/// The known names that `name` may be a slip of, the nearest first, each once: as many letters changed, swapped, added
/// or left out as a third of its length, at least one, and never all of them.
#[must_use]
pub fn near_names<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let length = name.chars().count();
    let mut near: Vec<(usize, &str)> = known
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), candidate))
        .filter(|(distance, _)| (1..=1.max(length / 3)).contains(distance) && *distance < length)
        .collect();
    near.sort_unstable();
    near.dedup();
    near.into_iter().map(|(_, candidate)| candidate).collect()
}

/// Names as a list for a message: `a`, `b`, `c`.
#[must_use]
pub fn list_names<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    names
        .into_iter()
        .map(|name| format!("`{name}`"))
        .collect::<Vec<_>>()
        .join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_suggested_and_far_ones_listed() {
        assert_eq!(
            did_you_mean("volme", ["volume", "rays"]).unwrap(),
            "did you mean `volume`?"
        );
        assert_eq!(
            did_you_mean("xyz", ["volume", "rays"]).unwrap(),
            "known here: `volume`, `rays`"
        );
        assert_eq!(did_you_mean("xyz", []), None);
    }

    #[test]
    fn the_nearest_come_first_and_a_single_letter_is_like_nothing() {
        assert_eq!(
            near_names("positoin", ["positions", "position", "poison", "position"]),
            ["position", "positions"]
        );
        assert_eq!(near_names("x", ["y", "xy"]), [""; 0]);
        assert_eq!(near_names("ab", ["ac", "b"]), ["ac", "b"]);
    }
}
