//! "Did you mean": the nearest of the known names.

/// A remedy for an unknown name: the nearest known one if it is near, else the list of what is known.
/// `None` where nothing is known.
#[must_use]
pub fn did_you_mean<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let known: Vec<&str> = known.into_iter().collect();
    let nearest = known
        .iter()
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), *candidate))
        .min();
    match nearest {
        Some((distance, candidate)) if distance <= 1.max(name.chars().count() / 3) => {
            Some(format!("did you mean `{candidate}`?"))
        }
        Some(_) => Some(format!("known here: {}", list_names(known))),
        None => None,
    }
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
}
