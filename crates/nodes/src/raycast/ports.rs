//! What a raycast reads and writes.

use volgraph_graph::{Demand, InputPort, OutputPort, PortType, Requirement};

use crate::distance_map;
use crate::lit_preintegration::{self, LitPreintegration};
use crate::scout;
use crate::stride_map;
use crate::{material_table, preintegration};

pub(super) const INPUTS: &[InputPort] = &[
    InputPort {
        name: "volume",
        ty: PortType::Volume,
        requirement: Requirement::Required,
        doc: "The volume.",
    },
    InputPort {
        name: "rays",
        ty: PortType::Mesh,
        requirement: Requirement::Required,
        doc: "The proxy geometry that starts the rays.",
    },
    InputPort {
        name: "transfer",
        ty: PortType::Transfer,
        requirement: Requirement::Optional,
        doc: "The transfer function, for techniques that classify.",
    },
    InputPort {
        name: "labels",
        ty: PortType::Volume,
        requirement: Requirement::Optional,
        doc: "What the volume is made of, a whole number of 0 to 255 per voxel; outside of it is label 0.",
    },
    InputPort {
        name: "segments",
        ty: PortType::Segments,
        requirement: Requirement::Optional,
        doc: "What the labels mean; they are all drawn alike where it is open.",
    },
    InputPort {
        name: "behind",
        ty: PortType::Color,
        requirement: Requirement::Optional,
        doc: "What lies behind the volume; nothing where it is open.",
    },
    InputPort {
        name: "image",
        ty: PortType::Image,
        requirement: Requirement::Optional,
        doc: "The image of the pattern that bent rays see; where it is open, that of the background behind.",
    },
    InputPort {
        name: "image_texture",
        ty: PortType::ImageTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "image_texture",
            inputs: &[("image", "image")],
            params: &[],
            slots: &[],
        }),
        doc: "That image on the device.",
    },
    InputPort {
        name: "clip_volume",
        ty: PortType::Volume,
        requirement: Requirement::Optional,
        doc: "Another volume, of any size and placement, whose isosurface cuts: for the clip `volume`.",
    },
    InputPort {
        name: "volume_texture",
        ty: PortType::VolumeTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "volume_texture",
            inputs: &[("volume", "volume")],
            params: &[("volume_storage", "volume_storage")],
            slots: &[],
        }),
        doc: "The volume on the device.",
    },
    InputPort {
        name: "brick_pool",
        ty: PortType::BrickPool,
        requirement: Requirement::DemandedAlike("brick_pool"),
        doc: "Bricks of the volume on the device, where it is in bricks.",
    },
    InputPort {
        name: "page_table",
        ty: PortType::PageTable,
        requirement: Requirement::DemandedAlike("brick_pool"),
        doc: "Which of them has the scalars of which part of the volume.",
    },
    InputPort {
        name: "color_volume",
        ty: PortType::ColorVolume,
        requirement: Requirement::Demanded(Demand {
            kind: "color_texture",
            inputs: &[("volume", "volume")],
            params: &[],
            slots: &[],
        }),
        doc: "The volume's own colours on the device.",
    },
    InputPort {
        name: "brick_ranges",
        ty: PortType::BrickRanges,
        requirement: Requirement::Demanded(distance_map::RANGES),
        doc: "The least and the largest scalar of each brick.",
    },
    InputPort {
        name: "distance_map",
        ty: PortType::DistanceMap,
        requirement: Requirement::DemandedAlike("distance_map"),
        doc: "How far each brick is from the next one of which anything may be seen.",
    },
    InputPort {
        name: "spans",
        ty: PortType::Spans,
        requirement: Requirement::Demanded(scout::SPANS),
        doc: "The parts of rays that may see anything.",
    },
    InputPort {
        name: "active_blocks",
        ty: PortType::Buffer,
        requirement: Requirement::Demanded(scout::SPANS),
        doc: "The blocks of pixels whose rays may see anything.",
    },
    InputPort {
        name: "stride_map",
        ty: PortType::StrideMap,
        requirement: Requirement::Demanded(stride_map::STRIDES),
        doc: "How long segments may be in each brick.",
    },
    InputPort {
        name: "clip_volume_texture",
        ty: PortType::VolumeTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "volume_texture",
            inputs: &[("volume", "clip_volume")],
            params: &[("volume_storage", "clip_volume_storage")],
            slots: &[],
        }),
        doc: "The clip volume on the device.",
    },
    InputPort {
        name: "gradient_volume",
        ty: PortType::GradientTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "gradient",
            inputs: &[("volume", "volume")],
            params: &[("volume_storage", "volume_storage")],
            slots: &[
                ("gradient_method", "gradient_method"),
                ("gradient_storage", "gradient_storage"),
            ],
        }),
        doc: "Gradients of the volume.",
    },
    InputPort {
        name: "transfer_table",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "transfer_table",
            inputs: &[("transfer", "transfer")],
            params: &[("table_size", "table_size")],
            slots: &[],
        }),
        doc: "The transfer function as a table.",
    },
    InputPort {
        name: "step_table",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "step_table",
            inputs: &[("transfer", "transfer"), ("volume", "volume")],
            params: &[("step", "step"), ("table_size", "table_size")],
            slots: &[],
        }),
        doc: "The transfer function as a table of what a step emits and lets through.",
    },
    InputPort {
        name: "refraction_table",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "refraction_table",
            inputs: &[("transfer", "transfer")],
            params: &[("table_size", "table_size")],
            slots: &[],
        }),
        doc: "The transfer function's refractive index as a table.",
    },
    InputPort {
        name: "preintegration_table",
        ty: PortType::Table2d,
        requirement: Requirement::Demanded(Demand {
            kind: "preintegration",
            inputs: &[("transfer", "transfer"), ("volume", "volume")],
            params: preintegration::DEMANDED_PARAMS,
            slots: &[],
        }),
        doc: "The transfer function integrated over segments.",
    },
    InputPort {
        name: "preintegration_half_table",
        ty: PortType::Table2d,
        requirement: Requirement::Demanded(Demand {
            kind: "preintegration_half",
            inputs: &[("transfer", "transfer"), ("volume", "volume")],
            params: preintegration::DEMANDED_PARAMS_OF_HALVES,
            slots: &[],
        }),
        doc: "The transfer function integrated over halves of segments.",
    },
    InputPort {
        name: "integral_table",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "integral_table",
            inputs: &[("transfer", "transfer")],
            params: &[("table_size", "table_size")],
            slots: &[],
        }),
        doc: "The transfer function's integrals over the scalar.",
    },
    InputPort {
        name: "preintegration_3d_table",
        ty: PortType::Table3d,
        requirement: Requirement::Demanded(Demand {
            kind: "preintegration_3d",
            inputs: &[("transfer", "transfer"), ("volume", "volume")],
            params: &[
                ("step", "step"),
                ("preintegration_3d_size", "preintegration_3d_size"),
                ("preintegration_3d_layers", "preintegration_3d_layers"),
                ("preintegration_3d_longest", "preintegration_3d_longest"),
            ],
            slots: &[],
        }),
        doc: "The transfer function integrated over segments of all lengths.",
    },
    InputPort {
        name: "label_texture",
        ty: PortType::LabelTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "label_texture",
            inputs: &[("labels", "labels")],
            params: &[],
            slots: &[],
        }),
        doc: "The labels on the device.",
    },
    InputPort {
        name: "transfer_tables",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "transfer_table",
            inputs: &[("transfer", "transfer"), ("segments", "segments")],
            params: &[("table_size", "table_size")],
            slots: &[],
        }),
        doc: "The transfer functions of all labels as rows of a table.",
    },
    InputPort {
        name: "preintegration_tables",
        ty: PortType::Table2d,
        requirement: Requirement::Demanded(Demand {
            kind: "preintegration",
            inputs: &[
                ("transfer", "transfer"),
                ("segments", "segments"),
                ("volume", "volume"),
            ],
            params: preintegration::DEMANDED_PARAMS,
            slots: &[],
        }),
        doc: "The transfer functions of all labels integrated over segments.",
    },
    InputPort {
        name: "preintegration_half_tables",
        ty: PortType::Table2d,
        requirement: Requirement::Demanded(Demand {
            kind: "preintegration_half",
            inputs: &[
                ("transfer", "transfer"),
                ("segments", "segments"),
                ("volume", "volume"),
            ],
            params: preintegration::DEMANDED_PARAMS_OF_HALVES,
            slots: &[],
        }),
        doc: "The transfer functions of all labels integrated over halves of segments.",
    },
    InputPort {
        name: "integral_tables",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "integral_table",
            inputs: &[("transfer", "transfer"), ("segments", "segments")],
            params: &[("table_size", "table_size")],
            slots: &[],
        }),
        doc: "The integrals of all labels' transfer functions.",
    },
    InputPort {
        name: "environment",
        ty: PortType::Image,
        requirement: Requirement::Optional,
        doc: "The image of what surfaces mirror.",
    },
    InputPort {
        name: "environment_texture",
        ty: PortType::ImageTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "image_texture",
            inputs: &[("image", "environment")],
            params: &[],
            slots: &[],
        }),
        doc: "The image of what surfaces mirror, on the device.",
    },
    InputPort {
        name: "light_volume",
        ty: PortType::LightGrid,
        requirement: Requirement::DemandedAlike("light_volume"),
        doc: "How much of each light reaches the points of a grid.",
    },
    InputPort {
        name: "material_table",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "material_table",
            inputs: &[("transfer", "transfer")],
            params: material_table::DEMANDED_PARAMS,
            slots: &[],
        }),
        doc: "The transfer function's material as a table.",
    },
    lit_preintegration::port(
        "material_preintegration_table",
        LitPreintegration::Material,
        "The transfer function's material integrated over segments.",
    ),
    lit_preintegration::port(
        "material_moments_table",
        LitPreintegration::MaterialMoments,
        "Where in a segment its material is seen.",
    ),
    lit_preintegration::port(
        "emission_moments_table",
        LitPreintegration::EmissionMoments,
        "Where in a segment its emission is seen.",
    ),
];

pub(super) const OUTPUTS: &[OutputPort] = &[
    OutputPort {
        name: "color",
        ty: PortType::Color,
        doc: "Linear premultiplied colour, over what lies behind.",
    },
    OutputPort {
        name: "depth",
        ty: PortType::Scalar2d,
        doc: "World distance from the eye to what the ray shows.",
    },
    OutputPort {
        name: "opacity",
        ty: PortType::Scalar2d,
        doc: "Opacity of what the ray met in the volume.",
    },
    OutputPort {
        name: "position",
        ty: PortType::Vector2d,
        doc: "World position of what the ray shows, counted from the middle of all volumes; the fourth is 1 where there is one.",
    },
    OutputPort {
        name: "normal",
        ty: PortType::Vector2d,
        doc: "World normal of what the ray shows, towards the eye; the fourth is 1 where there is one.",
    },
    OutputPort {
        name: "samples",
        ty: PortType::Scalar2d,
        doc: "Samples of the volume that the walk along the ray took.",
    },
    OutputPort {
        name: "label",
        ty: PortType::Scalar2d,
        doc: "Label of what the ray shows.",
    },
    OutputPort {
        name: "error",
        ty: PortType::Scalar2d,
        doc: "Estimated integration error of the colour: the largest absolute one of its four linear premultiplied components.",
    },
    OutputPort {
        name: "trace",
        ty: PortType::Trace,
        doc: "The walk along the ray of the pixel `trace_pixel`, segment by segment: what `volgraph ray` prints.",
    },
];

/// The outputs beside the colour; each is written by a slot of its own, `<name>_layer`.
pub(super) const LAYERS: [&str; 8] = [
    "depth", "opacity", "position", "normal", "samples", "label", "error", "trace",
];

/// Width and height of the output `trace` in texels (`TRACE_LAYER_WIDTH` in `slot/trace_layer/written.wgsl`).
pub(super) const TRACE_SIZE: [u32; 2] = [1024, 192];
