//! What the window remembers: the layout, the recent files, how the view is drawn.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// How many files are remembered.
const RECENT: usize = 12;

/// A panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Pane {
    /// The picture.
    View,
    /// Parameters and slots of the nodes.
    Parameters,
    /// What is wrong, and what was done.
    Messages,
    /// The transfer function over the histogram.
    Transfer,
    /// Nodes, sizes, times, and what any of them holds.
    Graph,
    /// Three planes through the volume.
    Slices,
    /// What the ray of a pixel met.
    Ray,
}

impl Pane {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::View,
        Self::Parameters,
        Self::Messages,
        Self::Transfer,
        Self::Graph,
        Self::Slices,
        Self::Ray,
    ];

    /// The name on its tab.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::View => "View",
            Self::Parameters => "Parameters",
            Self::Messages => "Messages",
            Self::Transfer => "Transfer function",
            Self::Graph => "Graph",
            Self::Slices => "Slices",
            Self::Ray => "Ray",
        }
    }
}

/// What stands over the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// Left of the bar the picture before the last change, right of it the present one.
    Wipe,
    /// How far the pictures before and after the last change are apart.
    Difference,
    /// How far a small picture is from its reference.
    Error,
}

impl Overlay {
    /// All of them, with their names.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::None, "Picture alone"),
        (Self::Wipe, "Before and after"),
        (Self::Difference, "Difference"),
        (Self::Error, "Error against the reference"),
    ];
}

/// Everything that outlives a window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Graphs and volumes, the newest first.
    pub recent: Vec<PathBuf>,
    /// Most milliseconds of a frame while the camera moves.
    pub budget_ms: f64,
    /// Picture pixels for each pixel of the screen.
    pub resolution: f32,
    /// Whether a bar tells lengths.
    pub has_scale_bar: bool,
    /// Whether the axes are marked.
    pub has_marker: bool,
    /// Whether clip shapes are dragged in the view.
    pub has_handles: bool,
    /// Whether a bar tells what colour stands for what value.
    pub has_color_bar: bool,
    /// Whether the mouse looks around and keys walk.
    pub is_walking: bool,
    /// What stands over the picture; a new window shows the picture alone.
    #[serde(skip)]
    pub overlay: Overlay,
    /// Where the wipe stands, 0 to 1.
    pub wipe: f32,
    /// Whether histograms count logarithmically.
    pub is_log: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            recent: Vec::new(),
            budget_ms: 60.0,
            resolution: 1.0,
            has_scale_bar: true,
            has_marker: true,
            has_handles: true,
            has_color_bar: false,
            is_walking: false,
            overlay: Overlay::None,
            wipe: 0.5,
            is_log: true,
        }
    }
}

impl Settings {
    /// Puts a file in front of the recent ones.
    pub fn remember(&mut self, file: &Path) {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        self.recent.retain(|other| *other != file);
        self.recent.insert(0, file);
        self.recent.truncate(RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recent_files_are_few_and_each_once() {
        let mut settings = Settings::default();
        for i in 0..30 {
            settings.remember(Path::new(&format!("/data/{}.ron", i % 15)));
        }
        assert_eq!(settings.recent.len(), RECENT);
        assert_eq!(settings.recent[0], Path::new("/data/14.ron"));
        settings.remember(Path::new("/data/9.ron"));
        assert_eq!(settings.recent.len(), RECENT);
        assert_eq!(settings.recent[0], Path::new("/data/9.ron"));
    }
}
