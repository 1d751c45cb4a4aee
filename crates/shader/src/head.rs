//! Tags in the comment at the head of a shader file: lines such as `// @order 2`.

use std::path::Path;

use volgraph_report::{Finding, Place};

use crate::lookup::find_choice;
use crate::{LinkRequest, ShaderRoots};

/// A line with a tag: its words behind the tag, and where it stands.
pub(crate) struct TagLine<'t> {
    pub words: Vec<&'t str>,
    pub place: Place,
}

/// The lines of a file's head comment that begin with a tag (`"order"` for `@order`).
pub(crate) fn tag_lines<'t>(file: &Path, text: &'t str, tag: &str) -> Vec<TagLine<'t>> {
    let mut lines = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let start = at;
        at += line.len();
        let Some(comment) = line.trim().strip_prefix("//") else {
            break;
        };
        let mut words = comment.trim_start_matches('/').split_whitespace();
        if words.next().and_then(|word| word.strip_prefix('@')) != Some(tag) {
            continue;
        }
        let indent = line.len() - line.trim_start().len();
        lines.push(TagLine {
            words: words.collect(),
            place: Place::in_text(file, text, start + indent, line.trim().len()),
        });
    }
    lines
}

/// The choice for another slot that the file which fills `slot` states behind a tag: `// @skips transfer`. `None` where
/// it states none, and where there is no such file, which the linker tells better.
///
/// # Errors
/// `tag-doc` where it states no one word, or several lines.
pub fn stated_choice(
    roots: &ShaderRoots,
    request: &LinkRequest,
    slot: &str,
    tag: &str,
) -> Result<Option<String>, Finding> {
    let Ok(found) = find_choice(roots, request, slot) else {
        return Ok(None);
    };
    let lines = tag_lines(&found.display, &found.text, tag);
    match lines.as_slice() {
        [] => Ok(None),
        [line] if line.words.len() == 1 => Ok(Some(line.words[0].to_owned())),
        [line, ..] => Err(Finding::error(
            "tag-doc",
            format!("`@{tag}` takes one word, in one line"),
        )
        .at(line.place.clone())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MemoryFiles;
    use std::sync::Arc;

    #[test]
    fn a_file_states_one_choice_in_its_head() {
        let stated = |text: &str| {
            let files = MemoryFiles::new().with("/s/slot/technique/mine.wgsl", text);
            let roots = ShaderRoots::new(Arc::new(files)).root("/s");
            let request = LinkRequest::new("root.wgsl").slot("technique", "mine");
            stated_choice(&roots, &request, "technique", "skips")
        };
        assert_eq!(
            stated("// What it does.\nfn f() {}\n// @skips late"),
            Ok(None)
        );
        let some = stated("// What it does.\n// @skips transfer\nfn f() {}\n");
        assert_eq!(some, Ok(Some("transfer".to_owned())));
        for bad in [
            "// @skips\n",
            "// @skips a b\n",
            "// @skips a\n// @skips b\n",
        ] {
            let finding = stated(bad).unwrap_err();
            assert_eq!(finding.code, "tag-doc", "{bad}");
            assert!(finding.place.is_some());
        }
    }
}
