//! The slots of a raycast, and what they hold where nothing is said.

use volgraph_graph::SlotSpec;

pub(super) const SLOTS: &[SlotSpec] = &[
    SlotSpec {
        name: "technique",
        default: "dvr",
        doc: "What does a segment add to the pixel?",
    },
    SlotSpec {
        name: "reconstruct",
        default: "trilinear",
        doc: "What is the scalar at a point?",
    },
    SlotSpec {
        name: "gradient",
        default: "stored",
        doc: "What is the gradient at a point?",
    },
    SlotSpec {
        name: "gradient_method",
        default: "central",
        doc: "How are stored gradients made?",
    },
    SlotSpec {
        name: "gradient_storage",
        default: "rgba16f",
        doc: "How are gradients stored?",
    },
    SlotSpec {
        name: "classify",
        // Right for every transfer function; a sample passes narrow peaks by.
        default: "preintegrated_2d",
        doc: "What are colour and opacity of a segment?",
    },
    SlotSpec {
        name: "colors",
        default: "transfer",
        doc: "Where do the colours of a segment come from?",
    },
    SlotSpec {
        name: "tone",
        default: "window",
        doc: "What does a projected scalar look like?",
    },
    SlotSpec {
        name: "traverse",
        default: "uniform",
        doc: "Where does the next segment end?",
    },
    crate::distance_map::EMPTINESS,
    SlotSpec {
        name: "heed",
        default: "all",
        doc: "Which segments does the technique look into?",
    },
    SlotSpec {
        name: "walk",
        default: "segments",
        doc: "How is a part of a ray walked along?",
    },
    SlotSpec {
        name: "light",
        default: "unlit",
        doc: "How is a point lit?",
    },
    SlotSpec {
        name: "material",
        default: "uniform",
        doc: "What does a point make of light?",
    },
    SlotSpec {
        name: "shadow",
        default: "none",
        doc: "How much of a light reaches a point?",
    },
    SlotSpec {
        name: "environment",
        default: "none",
        doc: "What does a surface mirror?",
    },
    SlotSpec {
        name: "clip",
        default: "none",
        doc: "Which part of the volume is visible?",
    },
    SlotSpec {
        name: "labels",
        default: "none",
        doc: "What is the volume made of?",
    },
];
