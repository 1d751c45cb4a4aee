//! volgraph's own small scenes, in which a slot's choice can be tested without a graph of its own.

use std::path::PathBuf;

use volgraph_graph::{EMBEDDED_GRAPHS, SourceDesc, read};

use crate::embedded;

/// A scene: a graph with the source `volume`, the transfer function `colors` and the raycast `image`, which leaves all
/// slots to the case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StockScene {
    /// Its name.
    pub name: &'static str,
    /// What it is good for, one sentence.
    pub doc: &'static str,
}

/// The scenes; the first is taken where a case names none.
pub const STOCK_SCENES: [StockScene; 5] = [
    StockScene {
        name: "gyroid",
        doc: "fills its box with a smooth haze, seen aslant: what is lost at faces and ends of rays shows",
    },
    StockScene {
        name: "fog",
        doc: "even fog in a cube, seen straight: every ray through it loses half of its light",
    },
    StockScene {
        name: "ramp",
        doc: "a scalar from 0 at the left to 1 at the right, seen straight: each column of pixels is even",
    },
    StockScene {
        name: "ball",
        doc: "falls off from the centre, one half at a radius of 0.35, seen from a distance of 4: depths are known",
    },
    StockScene {
        name: "rings",
        doc: "the rings of Marschner and Lobb, near what the grid can hold: what is hard to reconstruct",
    },
];

impl StockScene {
    /// The scene of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        STOCK_SCENES.iter().find(|scene| scene.name == name)
    }

    /// Its graph, which volgraph carries.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        PathBuf::from(format!("{EMBEDDED_GRAPHS}/stock/{}.ron", self.name))
    }

    /// The volume that it draws.
    pub(super) fn volume(&self) -> Option<SourceDesc> {
        let path = self.path();
        let mut desc = read::graph(&path, embedded::text(&path)?).ok()?;
        desc.sources.shift_remove("volume")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_carried_and_leaves_its_slots_open() {
        for scene in STOCK_SCENES {
            let path = scene.path();
            let desc = read::graph(&path, embedded::text(&path).unwrap()).unwrap();
            assert!(desc.nodes["image"].slots.is_empty(), "{}", scene.name);
            assert!(desc.sources.contains_key("colors"), "{}", scene.name);
            assert!(scene.volume().is_some(), "{}", scene.name);
        }
    }
}
