//! `preintegration_pieces`: what pre-integrated tables are made of, for the shader that makes them.
//!
//! One texture for all transfer functions. First two texels for each entry of each table: colour and depth, and the
//! number of the first piece behind it. Then four for each piece: depth, longest share of the segment and number of the
//! next piece; mean; slope; curve. Whole numbers are floats: there are too few for that to matter.

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ResourceDesc, Size, UploadBytes,
};
use volgraph_optics::PreintegrationPieces as Pieces;
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::preintegration::{INPUTS, segment_references, size_param, step_param};
use crate::transfer_table::transfers;

/// The node kind `preintegration_pieces`.
pub struct PreintegrationPieces;

/// Texels in a row (`PREINTEGRATION_ROW` in `node/preintegration.wgsl`).
const ROW: usize = 2048;

/// Most pieces: the last whole number that floats count up to one by one.
const MAX_PIECES: usize = 1 << 24;

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "pieces",
    ty: PortType::Pieces,
    doc: "The parts of transfer functions between the entries of a pre-integrated table.",
}];

/// The pieces of all tables.
fn pieces(node: &NodeContext<'_>) -> Result<Vec<Pieces>, Finding> {
    let size = node.uint("preintegration_size");
    let of_one = |transfer: &_| {
        let references = segment_references(node, transfer)?;
        volgraph_optics::TransferFunction::preintegration_pieces(transfer, size, references)
            .map_err(|error| Finding::error("table", error.to_string()))
    };
    let all: Vec<Pieces> = transfers(node)?
        .iter()
        .map(|transfer| of_one(transfer))
        .collect::<Result<_, _>>()?;
    let count: usize = all.iter().map(|one| one.pieces.len()).sum();
    if count > MAX_PIECES {
        let message = format!("{count} pieces of transfer functions, of {MAX_PIECES} at most");
        return Err(node
            .error("over-limit", message)
            .help("set `preintegration_built_on` to \"cpu\""));
    }
    Ok(all)
}

/// Rows of the texture.
fn rows(all: &[Pieces]) -> usize {
    let texels = |one: &Pieces| 2 * one.entries.len() + 4 * one.pieces.len();
    all.iter().map(texels).sum::<usize>().div_ceil(ROW)
}

#[expect(clippy::cast_precision_loss, reason = "at most MAX_PIECES")]
fn texels(all: &[Pieces]) -> Vec<[f32; 4]> {
    let mut texels = Vec::with_capacity(rows(all) * ROW);
    let mut before = 0_u32;
    for one in all {
        for (entry, first) in &one.entries {
            texels.extend([*entry, [(before + first) as f32, 0.0, 0.0, 0.0]]);
        }
        before += u32::try_from(one.pieces.len()).unwrap_or(u32::MAX);
    }
    let mut before = 0_u32;
    for one in all {
        for piece in &one.pieces {
            let color = |[r, g, b]: [f32; 3]| [r, g, b, 0.0];
            texels.extend([
                [
                    piece.depth,
                    piece.longest,
                    (before + piece.next) as f32,
                    0.0,
                ],
                color(piece.mean),
                color(piece.slope),
                color(piece.curve),
            ]);
        }
        before += u32::try_from(one.pieces.len()).unwrap_or(u32::MAX);
    }
    texels.resize(rows(all) * ROW, [0.0; 4]);
    texels
}

impl NodeKind for PreintegrationPieces {
    fn name(&self) -> &'static str {
        "preintegration_pieces"
    }

    fn doc(&self) -> &'static str {
        "Cuts transfer functions into the parts that pre-integrated tables are made of."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![step_param(), size_param()]
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let whole = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute([whole(ROW), whole(rows(&pieces(node)?)), 1]),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let pieces = pieces(node)?;
        let bytes = UploadBytes::new(move || Ok(bytemuck::cast_slice(&texels(&pieces)).to_vec()));
        Ok(vec![Pass::Upload {
            port: "pieces",
            bytes,
        }])
    }
}
