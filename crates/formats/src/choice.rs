//! Which of several named parts of a file is meant: the option `part`, or the only one that can be.

use volgraph_volume::{Trouble, VolumeError};

/// Most names that an error lists, and most characters of each.
const MOST_NAMES: usize = 20;
const LONGEST: usize = 60;

/// Something that can be named.
pub(crate) struct Candidate<'a> {
    pub path: &'a str,
    /// Whether it can be meant where nothing is named.
    pub main: bool,
}

/// The part that is named (by its whole path or a piece of it that no other has), or the one that is meant where
/// nothing is: the only main one, or the only one. `what` counts them in the error: `arrays or images in this group`.
pub(crate) fn choose(
    candidates: &[Candidate<'_>],
    name: Option<&str>,
    what: &str,
) -> Result<usize, VolumeError> {
    let choice = |cause: String, of: &[usize]| {
        let names = of.iter().map(|&i| candidates[i].path);
        let names: Vec<&str> = names.filter(|path| !path.is_empty()).collect();
        let some: Vec<String> = names
            .iter()
            .take(MOST_NAMES)
            .map(|name| cut(name))
            .collect();
        let more = if names.len() > MOST_NAMES {
            " and more"
        } else {
            ""
        };
        VolumeError::Option(Trouble::new(
            cause,
            if names.is_empty() {
                "leave the option out".to_owned()
            } else {
                format!("name one with the option `part`: {}{more}", some.join(", "))
            },
        ))
    };
    let all: Vec<usize> = (0..candidates.len()).collect();
    let Some(name) = name else {
        let main = all.iter().copied().filter(|&i| candidates[i].main);
        let main: Vec<usize> = main.collect();
        return match (main.as_slice(), all.as_slice()) {
            ([one], _) | ([], [one]) => Ok(*one),
            _ => Err(choice(format!("there are {} {what}", all.len()), &all)),
        };
    };
    let name = name.trim_matches('/');
    if let Some(exact) = all.iter().find(|&&i| candidates[i].path == name) {
        return Ok(*exact);
    }
    let having = all.iter().copied();
    let having: Vec<usize> = having
        .filter(|&i| candidates[i].path.contains(name))
        .collect();
    match having.as_slice() {
        [one] => Ok(*one),
        [] => Err(choice(format!("there is no part {name:?}"), &all)),
        several => Err(choice(
            format!("{} parts have {name:?} in their names", several.len()),
            several,
        )),
    }
}

/// A name that fits into a message.
pub(crate) fn cut(name: &str) -> String {
    let name = name.chars().filter(|letter| !letter.is_control());
    name.take(LONGEST).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(paths: &[(&str, bool)], name: Option<&str>) -> Result<usize, VolumeError> {
        let candidates: Vec<Candidate<'_>> = paths
            .iter()
            .map(|&(path, main)| Candidate { path, main })
            .collect();
        choose(&candidates, name, "things")
    }

    #[test]
    fn the_only_one_is_meant_and_a_piece_of_a_name_is_enough() {
        let two = [("raw/ct", true), ("raw/ct/labels", false)];
        assert_eq!(chosen(&two, None).unwrap(), 0);
        assert_eq!(chosen(&[("labels", false)], None).unwrap(), 0);
        assert_eq!(chosen(&two, Some("/raw/ct")).unwrap(), 0);
        assert_eq!(chosen(&two, Some("lab")).unwrap(), 1);
        for name in [Some("raw"), Some("pet")] {
            let error = chosen(&two, name).unwrap_err();
            assert!(
                error.to_string().contains("raw/ct, raw/ct/labels"),
                "{error}"
            );
        }
        let error = chosen(&[("a", true), ("b", true)], None).unwrap_err();
        assert!(error.to_string().contains("there are 2 things"), "{error}");
    }
}
