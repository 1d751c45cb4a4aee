//! Editing a transfer function: points, undo and redo, and the file that the session reads meanwhile.
//!
//! While it is edited, the source of the graph reads a file of the viewer's own; the user's file changes only when the
//! edit is saved.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use volgraph_engine::{Findings, ParamOverride, Scene};
use volgraph_graph::Source;
use volgraph_nodes::source::transfer::TransferSource;
use volgraph_optics::{ControlPoint, Domain, TransferFunction};
use volgraph_report::Finding;

use crate::worker::Request;

/// How many steps are kept.
const STEPS: usize = 200;

/// A transfer function under edit.
pub struct TransferEdit {
    /// The graph's source.
    pub source: String,
    /// As it is now.
    pub transfer: Arc<TransferFunction>,
    /// The point that is edited.
    pub selected: Option<usize>,
    /// Whether the drag is one in the panel.
    pub is_panel_dragging: bool,
    /// What is wrong with the last edit.
    pub findings: Findings,
    /// The user's file.
    file: PathBuf,
    undo: Vec<Arc<TransferFunction>>,
    redo: Vec<Arc<TransferFunction>>,
    scratch: Option<tempfile::TempDir>,
    is_applied: bool,
    /// Whether edits belong to one drag, and so to one step.
    is_dragging: bool,
    /// The points where a drag of all of them began, and by how much it has shifted and stretched them.
    whole: Option<(Vec<ControlPoint>, f64, f64)>,
}

impl TransferEdit {
    /// The first transfer function of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Option<Self> {
        scene.sources.iter().find_map(|(name, source)| {
            let found: &TransferSource = source.as_any().downcast_ref()?;
            Some(Self {
                source: name.clone(),
                transfer: Arc::clone(&found.transfer),
                selected: None,
                is_panel_dragging: false,
                findings: Findings::new(),
                file: found.files().into_iter().next().unwrap_or_default(),
                undo: Vec::new(),
                redo: Vec::new(),
                scratch: None,
                is_applied: false,
                is_dragging: false,
                whole: None,
            })
        })
    }

    /// Takes over what was changed on disk, where nothing is edited.
    pub fn follow(&mut self, scene: &Scene) {
        if self.is_changed() {
            return;
        }
        if let Some(found) = Self::of(scene)
            && (found.source != self.source
                || found.file != self.file
                || *found.transfer != *self.transfer)
        {
            *self = found;
        }
    }

    /// Whether it differs from the user's file.
    #[must_use]
    pub fn is_changed(&self) -> bool {
        self.is_applied
    }

    /// The user's file.
    #[must_use]
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> Vec<ControlPoint> {
        self.transfer.control_points()
    }

    /// Says that what follows is one drag, until [`Self::end_drag`].
    pub fn begin_drag(&mut self) {
        if !self.is_dragging {
            self.push();
            self.is_dragging = true;
        }
    }

    /// Ends a drag.
    pub fn end_drag(&mut self) {
        self.is_dragging = false;
        self.whole = None;
    }

    fn push(&mut self) {
        self.undo.push(Arc::clone(&self.transfer));
        if self.undo.len() > STEPS {
            self.undo.remove(0);
        }
        self.redo.clear();
    }

    /// Replaces the points; those that were dragged out of the domain lie at its ends.
    pub fn set_points(&mut self, points: &[ControlPoint]) -> Vec<Request> {
        let (low, high) = match self.transfer.domain() {
            Domain::Data => (f64::NEG_INFINITY, f64::INFINITY),
            Domain::Range | Domain::Normalised => (0.0, 1.0),
        };
        let points = points.iter().map(|point| ControlPoint {
            at: point.at.clamp(low, high),
            ..*point
        });
        let points: Vec<ControlPoint> = points.collect();
        let changed = self.transfer.with_control_points(&points);
        self.change(changed)
    }

    /// Replaces all of it.
    pub fn change(&mut self, changed: Result<TransferFunction, Findings>) -> Vec<Request> {
        match changed {
            Ok(changed) if changed == *self.transfer => Vec::new(),
            Ok(changed) => {
                if !self.is_dragging {
                    self.push();
                }
                self.transfer = Arc::new(changed);
                self.apply()
            }
            Err(findings) => {
                self.findings = findings;
                Vec::new()
            }
        }
    }

    /// Shifts and stretches all points: scalars `s` become `middle + (s - middle) · stretch + shift`.
    ///
    /// Of one drag all shifts and stretches count from where it began: what was pushed against an end comes back.
    pub fn window(&mut self, shift: f64, stretch: f64) -> Vec<Request> {
        let (mut points, before_shift, before_stretch) = match self.whole.take() {
            Some(whole) => whole,
            None => (self.points(), 0.0, 1.0),
        };
        let (shift, stretch) = (before_shift + shift, before_stretch * stretch.max(1e-3));
        if self.is_dragging {
            self.whole = Some((points.clone(), shift, stretch));
        }
        let (Some(first), Some(last)) = (points.first(), points.last()) else {
            return Vec::new();
        };
        let middle = 0.5 * (first.at + last.at);
        for point in &mut points {
            point.at = middle + (point.at - middle) * stretch + shift;
        }
        self.set_points(&points)
    }

    /// Takes back the last step.
    pub fn undo(&mut self) -> Vec<Request> {
        let Some(before) = self.undo.pop() else {
            return Vec::new();
        };
        self.redo
            .push(std::mem::replace(&mut self.transfer, before));
        self.selected = None;
        self.apply()
    }

    /// Takes the last undone step again.
    pub fn redo(&mut self) -> Vec<Request> {
        let Some(after) = self.redo.pop() else {
            return Vec::new();
        };
        self.undo.push(std::mem::replace(&mut self.transfer, after));
        self.selected = None;
        self.apply()
    }

    /// Whether there is a step to take back, and one to take again.
    #[must_use]
    pub fn steps(&self) -> (bool, bool) {
        (!self.undo.is_empty(), !self.redo.is_empty())
    }

    /// Lets the session read what is edited.
    fn apply(&mut self) -> Vec<Request> {
        self.findings = Findings::new();
        match self.write_scratch() {
            Ok(file) if self.is_applied => vec![Request::Files(BTreeSet::from([file]))],
            Ok(file) => {
                self.is_applied = true;
                let typed = format!("{}.path={:?}", self.source, file.display().to_string());
                match ParamOverride::parse(&typed) {
                    Ok(set) => vec![Request::Set(vec![set])],
                    Err(_) => Vec::new(),
                }
            }
            Err(error) => {
                let message = format!("the edited transfer function cannot be kept: {error}");
                self.findings = Finding::error("io", message).into();
                Vec::new()
            }
        }
    }

    fn write_scratch(&mut self) -> std::io::Result<PathBuf> {
        let folder = match &self.scratch {
            Some(folder) => folder,
            None => self.scratch.insert(tempfile::tempdir()?),
        };
        let file = folder.path().join("edited.ron");
        replace(&file, &self.transfer.to_ron())?;
        Ok(file)
    }

    /// Saves into a file; where that is the graph's own, the session reads it again.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn save(&mut self, file: &Path) -> Result<Vec<Request>, Findings> {
        let written = replace(file, &self.transfer.to_ron());
        written.map_err(|error| -> Findings {
            let message = format!("{} cannot be written: {error}", file.display());
            Finding::error("io", message)
                .help("choose another file, or a folder that you may write to")
                .into()
        })?;
        let mut requests = vec![Request::Files(BTreeSet::from([file.to_owned()]))];
        if file == self.file && self.is_applied {
            self.is_applied = false;
            let typed = format!("{}.path={:?}", self.source, file.display().to_string());
            requests.extend(
                ParamOverride::parse(&typed)
                    .ok()
                    .map(|set| Request::Set(vec![set])),
            );
        }
        Ok(requests)
    }
}

/// Writes a whole file in the place of the one before.
fn replace(file: &Path, text: &str) -> std::io::Result<()> {
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let mut beside = tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new(".")))?;
    std::io::Write::write_all(&mut beside, text.as_bytes())?;
    if let Ok(known) = std::fs::metadata(file) {
        // What cannot be kept of them is no reason not to save.
        let _ = beside.as_file().set_permissions(known.permissions());
    }
    beside.persist(file).map_err(|error| error.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edit() -> TransferEdit {
        let text = r##"(points: [(at: 0.25, color: "#000000", opacity: 0), (at: 0.75, color: "#ffffff", opacity: 0.5)])"##;
        TransferEdit {
            source: "colors".to_owned(),
            transfer: Arc::new(TransferFunction::parse(Path::new("test.ron"), text).unwrap()),
            selected: None,
            is_panel_dragging: false,
            findings: Findings::new(),
            file: PathBuf::new(),
            undo: Vec::new(),
            redo: Vec::new(),
            scratch: None,
            is_applied: false,
            is_dragging: false,
            whole: None,
        }
    }

    #[test]
    fn what_a_drag_pushes_against_an_end_comes_back_and_is_one_step() {
        let mut edit = edit();
        let places = |edit: &TransferEdit| -> Vec<f64> {
            edit.points().iter().map(|point| point.at).collect()
        };
        edit.begin_drag();
        edit.window(0.5, 1.0);
        assert_eq!(places(&edit), [0.75, 1.0]);
        edit.window(-0.5, 1.0);
        assert_eq!(places(&edit), [0.25, 0.75]);
        edit.window(0.0, 2.0);
        assert_eq!(places(&edit), [0.0, 1.0]);
        edit.end_drag();
        edit.undo();
        assert_eq!(
            (places(&edit), edit.steps()),
            (vec![0.25, 0.75], (false, true))
        );
    }
}
