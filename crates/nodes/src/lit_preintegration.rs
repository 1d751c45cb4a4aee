//! `material_preintegration`, `material_moments`, `emission_moments`: integrals over segments for lit segments.
//!
//! The first is what segments make of light, for materials that change along them. The other two tell where in a
//! segment its light comes from, for light that changes along it: with the material, and without.

use volgraph_graph::{
    Demand, InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement,
    ResourceDesc, Size, Uniform, UploadBytes,
};
use volgraph_optics::{Material, OpticsError, TransferFunction};
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, UniformValue};
use wgpu_types::TextureFormat;

use crate::material_table::{default_material, default_params};
use crate::placement::{f32_value, placed};
use crate::preintegration::{self, segment_references, size_param, step_param};
use crate::raycast::table_range;
use crate::transfer_table::transfer;

/// One of the three node kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LitPreintegration {
    /// The node kind `material_preintegration`.
    Material,
    /// The node kind `material_moments`.
    MaterialMoments,
    /// The node kind `emission_moments`.
    EmissionMoments,
}

const MATERIAL: &[OutputPort] = &[OutputPort {
    name: "table",
    ty: PortType::Table2d,
    doc: "What a segment from front scalar (x) to back scalar (y) makes of light: ambient and highlight; below it, in \
          as many rows again, diffuse and the highlight times its shininess.",
}];

const MOMENTS: &[OutputPort] = &[OutputPort {
    name: "table",
    ty: PortType::Table2d,
    doc: "The share of light at its back end in what a segment from front scalar (x) to back scalar (y) shows: of \
          colour, and of opacity or highlight.",
}];

/// The port of a kind that calls for a table of one of these.
pub(crate) const fn port(
    name: &'static str,
    of: LitPreintegration,
    doc: &'static str,
) -> InputPort {
    InputPort {
        name,
        ty: PortType::Table2d,
        requirement: Requirement::Demanded(Demand {
            kind: of.kind_name(),
            inputs: &[("transfer", "transfer"), ("volume", "volume")],
            params: match of {
                LitPreintegration::Material | LitPreintegration::MaterialMoments => &[
                    ("step", "step"),
                    ("preintegration_size", "preintegration_size"),
                    ("ambient", "ambient"),
                    ("diffuse", "diffuse"),
                    ("specular", "specular"),
                    ("shininess", "shininess"),
                ],
                LitPreintegration::EmissionMoments => &[
                    ("step", "step"),
                    ("preintegration_size", "preintegration_size"),
                ],
            },
            slots: &[],
        }),
        doc,
    }
}

impl LitPreintegration {
    const fn kind_name(self) -> &'static str {
        match self {
            Self::Material => "material_preintegration",
            Self::MaterialMoments => "material_moments",
            Self::EmissionMoments => "emission_moments",
        }
    }

    fn tables(
        self,
        transfer: &TransferFunction,
        size: u32,
        segment: f64,
        default: Material,
    ) -> Result<Vec<u8>, OpticsError> {
        let of_moments = |default| {
            let table = transfer.preintegrated_moments(size, segment, default)?;
            Ok(bytemuck::cast_slice(&table.entries).to_vec())
        };
        match self {
            Self::Material => {
                let table = transfer.preintegrated_material(size, segment, default)?;
                let mut bytes = bytemuck::cast_slice(&table.ambient).to_vec();
                bytes.extend_from_slice(bytemuck::cast_slice(&table.diffuse));
                Ok(bytes)
            }
            Self::MaterialMoments => of_moments(Some(default)),
            Self::EmissionMoments => of_moments(None),
        }
    }
}

impl NodeKind for LitPreintegration {
    fn name(&self) -> &'static str {
        self.kind_name()
    }

    fn doc(&self) -> &'static str {
        match self {
            Self::Material => {
                "Integrates colour, extinction and material over all segments between two scalars."
            }
            Self::MaterialMoments => "Integrates where in a segment its material is seen.",
            Self::EmissionMoments => "Integrates where in a segment its emission is seen.",
        }
    }

    fn inputs(&self) -> &[InputPort] {
        preintegration::INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        match self {
            Self::Material => MATERIAL,
            Self::MaterialMoments | Self::EmissionMoments => MOMENTS,
        }
    }

    fn params(&self) -> Vec<ParamSpec> {
        let mut params = vec![step_param(), size_param()];
        if *self != Self::EmissionMoments {
            params.extend(default_params());
        }
        params
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let size = node.uint("preintegration_size");
        let tables = if *self == Self::Material { 2 } else { 1 };
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute([size, tables * size, 1]),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let transfer = transfer(node, "transfer")?;
        let segment = segment_references(node, &transfer)?;
        let (size, default) = (node.uint("preintegration_size"), default_material(node));
        let kind = *self;
        let bytes = UploadBytes::new(move || {
            kind.tables(&transfer, size, segment, default)
                .map_err(|error| Finding::error("table", error.to_string()))
        });
        Ok(vec![Pass::Upload {
            port: "table",
            bytes,
        }])
    }
}

/// The members of the uniform `lit_tables` (see `lib/lit_tables.wgsl`).
pub(crate) fn uniform(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let transfer = transfer(node, "transfer")?;
    let (low, span) = table_range(node, &transfer)?;
    let voxel = placed(node, "volume")?.grid().min_spacing();
    let last = |port: &str, param: &str| {
        let writer = node.writer(port)?;
        Some(f64::from(writer.uint(param).max(2) - 1))
    };
    let entries = last("material_table", "table_size").unwrap_or(1.0);
    // Last entry and world length of the segments; a shader reads one of the two tables of moments at most.
    let segments = |ports: &[&str]| {
        let found = ports.iter().find_map(|port| {
            let last = last(port, "preintegration_size")?;
            Some((last, node.writer(port)?.float("step")))
        });
        let (last, step) = found.unwrap_or((1.0, 1.0));
        UniformValue::Vec3([last / span, last, step * voxel].map(|value| value as f32))
    };
    Ok(vec![
        ("low", f32_value(low)),
        ("entry_scale", f32_value(entries / (span * (entries + 1.0)))),
        (
            "entry_bias",
            f32_value((0.5 - low * entries / span) / (entries + 1.0)),
        ),
        ("material", segments(&["material_preintegration_table"])),
        (
            "moments",
            segments(&["material_moments_table", "emission_moments_table"]),
        ),
    ])
}
