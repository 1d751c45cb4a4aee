//! `material_table`: a transfer function's material as a table over the scalar.

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_optics::Material;
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::transfer_table::{size_param, transfer};

/// The node kind `material_table`.
pub struct MaterialTable;

const INPUTS: &[InputPort] = &[InputPort {
    name: "transfer",
    ty: PortType::Transfer,
    requirement: Requirement::Required,
    doc: "The transfer function.",
}];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "table",
    ty: PortType::Table1d,
    doc: "Ambient, diffuse, specular and shininess.",
}];

/// Whose values they are where a shader calls for this kind.
pub(crate) const DEMANDED_PARAMS: &[(&str, &str)] = &[
    ("table_size", "table_size"),
    ("ambient", "ambient"),
    ("diffuse", "diffuse"),
    ("specular", "specular"),
    ("shininess", "shininess"),
];

/// The parameters with the material where the transfer function gives none, for kinds that make tables of it. They are
/// those of `lib/material_params.wgsl`.
#[must_use]
pub fn default_params() -> [ParamSpec; 4] {
    let fraction = |name, default, doc| ParamSpec::float(name, default, doc).range(0.0, 1.0);
    [
        fraction("ambient", 0.3, "Share of the colour that needs no light."),
        fraction("diffuse", 0.7, "Share of the colour that the light gives."),
        fraction("specular", 0.25, "Strength of the highlight."),
        ParamSpec::float("shininess", 32.0, "Sharpness of the highlight.").range(1.0, 256.0),
    ]
}

/// The values of [`default_params`].
#[must_use]
pub fn default_material(node: &NodeContext<'_>) -> Material {
    Material {
        ambient: node.float("ambient"),
        diffuse: node.float("diffuse"),
        specular: node.float("specular"),
        shininess: node.float("shininess"),
    }
}

impl NodeKind for MaterialTable {
    fn name(&self) -> &'static str {
        "material_table"
    }

    fn doc(&self) -> &'static str {
        "Samples what a transfer function says of the material into a table."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        let mut params = vec![size_param()];
        params.extend(default_params());
        params
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute([node.uint("table_size"), 1, 1]),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let transfer = transfer(node, "transfer")?;
        let (size, default) = (node.uint("table_size"), default_material(node));
        let bytes = UploadBytes::new(move || {
            let table = transfer
                .material_table(size, default)
                .map_err(|error| Finding::error("table", error.to_string()))?;
            Ok(bytemuck::cast_slice(&table).to_vec())
        });
        Ok(vec![Pass::Upload {
            port: "table",
            bytes,
        }])
    }
}
