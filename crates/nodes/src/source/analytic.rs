//! `analytic(field: "marschner_lobb", dims: (64, 64, 64))`: a volume sampled from a known function.

use std::collections::BTreeMap;
use std::sync::Arc;

use volgraph_graph::{Folders, PortType, Source, SourceKind};
use volgraph_report::{Finding, Findings, did_you_mean};
use volgraph_shader::{ParamSpec, ParamValue};
use volgraph_volume::analytic::{AnalyticField, sample, sample_nodes};
use volgraph_volume::{ScalarType, Volume, VolumeError};

use super::Given;
use super::volume::VolumeSource;

/// The source kind `analytic`.
pub struct AnalyticKind;

/// The fields of the source that are not the function's own parameters.
const OWN: [&str; 6] = [
    "field",
    "dims",
    "type",
    "levels",
    "node_centred",
    "transform",
];

impl SourceKind for AnalyticKind {
    fn name(&self) -> &'static str {
        "analytic"
    }

    fn doc(&self) -> &'static str {
        "A volume sampled from a known function on a unit cube around the origin; needs no file."
    }

    fn ty(&self) -> PortType {
        PortType::Volume
    }

    fn params(&self) -> Vec<ParamSpec> {
        let names: Vec<&str> = AnalyticField::names().collect();
        let mut specs = vec![
            ParamSpec::text("field", "", format!("The function: {}.", names.join(", "))),
            ParamSpec::vector("dims", &[64.0; 3], "Voxels along x, y, z."),
            ParamSpec::text(
                "type",
                "float32",
                "Scalar type; whole-number types hold 0..1 over their range.",
            ),
            ParamSpec::int(
                "levels",
                0,
                "Makes labels of it: so many even steps of 0..1, numbered from 0, as uint8; 0 leaves the values.",
            )
            .range(0.0, 256.0),
            ParamSpec::bool(
                "node_centred",
                false,
                "Samples run from face to face of the cube, instead of lying at the centres of voxels.",
            ),
            super::transform_param(),
        ];
        for info in names.iter().filter_map(|name| AnalyticField::info(name)) {
            for parameter in info.parameters {
                let doc = format!("{}: {}", info.name, parameter.doc);
                match specs.iter_mut().find(|spec| spec.name == parameter.name) {
                    // Fields share parameter names; the field itself checks its own range.
                    Some(spec) => spec.doc = format!("{} {doc}", spec.doc),
                    None => specs.push(ParamSpec::float(parameter.name, parameter.default, doc)),
                }
            }
        }
        specs
    }

    fn load(
        &self,
        params: &BTreeMap<String, ParamValue>,
        _folders: &Folders,
        progress: volgraph_graph::Progress<'_>,
    ) -> Result<Arc<dyn Source>, Findings> {
        let given = Given(params);
        let name = given.text("field").unwrap_or("");
        let type_name = given.text("type").unwrap_or("float32");
        let Some(scalar_type) = ScalarType::parse(type_name) else {
            return Err(Finding::error(
                "bad-param",
                format!("field `type`: `{type_name}` is not a scalar type"),
            )
            .help_opt(did_you_mean(
                type_name,
                ["uint8", "uint16", "float32", "float64"],
            ))
            .into());
        };
        let own: Vec<(String, f64)> = params
            .iter()
            .filter(|(name, _)| !OWN.contains(&name.as_str()))
            .filter_map(|(name, value)| match value {
                ParamValue::Float(value) => Some((name.clone(), *value)),
                _ => None,
            })
            .collect();
        let dims = given.dims("dims")?.unwrap_or([64; 3]);
        let sample = if given.is_set("node_centred") {
            sample_nodes
        } else {
            sample
        };
        let volume = AnalyticField::by_name(name, &own)
            .and_then(
                |field| match given.uint("levels").filter(|levels| *levels > 0) {
                    Some(levels) => sample(&field, dims, ScalarType::F32)
                        .and_then(|volume| quantised(&volume, levels)),
                    None => sample(&field, dims, scalar_type),
                },
            )
            .and_then(|volume| match given.affine("transform") {
                Some(transform) => volume.moved(transform),
                None => Ok(volume),
            })
            .map_err(|error| Findings::from(Finding::from(error)))?;
        progress(1, 1);
        Ok(Arc::new(VolumeSource::new(Arc::new(volume))))
    }
}

/// The level of each voxel: 0..1 in so many even steps, numbered from 0.
fn quantised(volume: &Volume, levels: u32) -> Result<Volume, VolumeError> {
    let last = f64::from(levels.min(256)) - 1.0;
    let mut labels: Vec<u8> = Vec::with_capacity(volume.voxels().len());
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a byte"
    )]
    volume.voxels().for_each(|value| {
        labels.push((value * (last + 1.0)).floor().clamp(0.0, last) as u8);
    });
    Volume::new(volume.name(), *volume.grid(), labels.into())
}
