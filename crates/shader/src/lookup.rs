//! What a path or a slot's choice leads to, and what to say where it leads nowhere.

use std::path::{Path, PathBuf};

use volgraph_report::{Finding, did_you_mean, list_names, near_names};

use crate::roots::{Found, NotFound};
use crate::scan::is_plain_name;
use crate::{LinkRequest, ShaderRoots};

/// The file that fills a slot.
pub(crate) fn find_choice(
    roots: &ShaderRoots,
    request: &LinkRequest,
    slot: &str,
) -> Result<Found, Box<Finding>> {
    let choices = roots.choices(slot);
    let listed = || list_names(choices.iter().map(String::as_str));
    let Some(choice) = request.slots.get(slot) else {
        let finding = Finding::error(
            "slot-unset",
            format!("no choice is set for the slot `{slot}`"),
        );
        let set = request.slots.keys().map(String::as_str);
        if let Some(near) = near_names(slot, set).first() {
            let help = format!("did you mean the slot `{near}`?");
            return Err(Box::new(finding.help(help)));
        }
        return Err(Box::new(if choices.is_empty() {
            finding.help("set it to a path that ends in `.wgsl`")
        } else {
            finding.help(format!(
                "choices here: {}, or a path that ends in `.wgsl`",
                listed()
            ))
        }));
    };
    let is_path = choice.ends_with(".wgsl");
    let (folders, path) = if is_path {
        (
            roots.folders(request.base.as_deref()),
            PathBuf::from(choice),
        )
    } else {
        let path = Path::new("slot").join(slot).join(format!("{choice}.wgsl"));
        (roots.folders(None), path)
    };
    let not_found = if is_path || is_plain_name(choice) {
        match roots.find(&folders, &path) {
            Ok(found) => return Ok(found),
            Err(not_found) => not_found,
        }
    } else {
        NotFound::Nowhere(Vec::new())
    };
    let what = format!("the choice `{choice}` for the slot `{slot}`");
    Err(Box::new(match not_found {
        NotFound::Nowhere(_) if !is_path => {
            let known = choices.iter().map(String::as_str);
            let help = did_you_mean(choice, known).map(|near| {
                if near.starts_with("did") {
                    format!("{near} Choices here: {}", listed())
                } else {
                    near
                }
            });
            Finding::error("unknown-choice", format!("{what} is unknown")).help_opt(help)
        }
        NotFound::Nowhere(tried) => {
            let message = format!("{what} is not found; tried {}", list_paths(&tried));
            Finding::error("unknown-choice", message).help_opt(suggest(roots, &folders, &path))
        }
        NotFound::Unreadable(path, error) => unreadable(&path, &error),
    }))
}

/// What to say of a path that led to no file.
pub(crate) fn lookup_error(
    code: &'static str,
    what: &str,
    path: &Path,
    not_found: NotFound,
    help: impl FnOnce() -> Option<String>,
) -> Finding {
    match not_found {
        NotFound::Nowhere(tried) => {
            let message = format!(
                "{what} `{}` is not found; tried {}",
                path.display(),
                list_paths(&tried)
            );
            Finding::error(code, message).help_opt(help())
        }
        NotFound::Unreadable(path, error) => unreadable(&path, &error),
    }
}

fn unreadable(path: &Path, error: &std::io::Error) -> Finding {
    Finding::error(
        "shader-read",
        format!("`{}` cannot be read: {error}", path.display()),
    )
}

fn list_paths(paths: &[PathBuf]) -> String {
    if paths.is_empty() {
        return "no folder: there is no shader root".to_owned();
    }
    let shown: Vec<String> = paths
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    list_names(shown.iter().map(String::as_str))
}

/// Folders of a root that a path may have missed.
const FOLDERS: [&str; 3] = ["lib", "node", ""];

/// Files like `path` in these folders: of the same name in another folder, or of nearly the same path.
pub(crate) fn suggest(roots: &ShaderRoots, folders: &[PathBuf], path: &Path) -> Option<String> {
    let below = path.parent().unwrap_or(Path::new(""));
    let names = |below: &Path| -> Vec<String> {
        roots
            .names_in(folders, below)
            .into_iter()
            .map(|name| below.join(name).display().to_string())
            .collect()
    };
    let beside = names(below);
    let elsewhere: Vec<String> = FOLDERS
        .iter()
        .map(Path::new)
        .filter(|folder| *folder != below)
        .flat_map(names)
        .collect();
    let shown = path.display().to_string();
    let known = || beside.iter().chain(&elsewhere).map(String::as_str);
    let near = near_names(&shown, known()).into_iter().next();
    let namesake = || known().find(|known| Path::new(known).file_name() == path.file_name());
    match near.or_else(namesake) {
        Some(near) => Some(format!("did you mean `{near}`?")),
        None => did_you_mean(&shown, beside.iter().map(String::as_str)),
    }
}
