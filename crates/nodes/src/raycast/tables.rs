//! The tables of transfer functions that a raycast reads: the uniform of one, and whether they fit.

use volgraph_graph::{InputPort, NodeContext, NodeKind, Requirement, Uniform};
use volgraph_optics::{Domain, IntegralTable, TransferFunction};
use volgraph_report::Finding;
use volgraph_shader::{ParamValue, UniformValue};

use super::ports::INPUTS;
use crate::encoding::Scalars;
use crate::placement::{self, f32_value};
use crate::preintegration::Preintegration;
use crate::segmentation;
use crate::source::segments::SegmentsSource;
use crate::transfer_table::transfers;

/// The table nodes may be the user's own, with sizes of their own.
pub(super) fn check_table_sizes(node: &NodeContext<'_>) -> Result<(), Finding> {
    for (port, param) in [
        ("transfer_table", "table_size"),
        ("step_table", "table_size"),
        ("refraction_table", "table_size"),
        ("preintegration_table", "preintegration_size"),
        ("preintegration_3d_table", "preintegration_3d_layers"),
        ("material_table", "table_size"),
        ("material_preintegration_table", "preintegration_size"),
        ("material_moments_table", "preintegration_size"),
        ("emission_moments_table", "preintegration_size"),
        ("transfer_tables", "table_size"),
        ("preintegration_tables", "preintegration_size"),
        ("preintegration_half_table", "preintegration_size"),
        ("preintegration_half_tables", "preintegration_size"),
        ("integral_table", "table_size"),
        ("integral_tables", "table_size"),
    ] {
        if let Some(writer) = node.writer(port)
            && writer.uint(param) < 2
        {
            return Err(node.error(
                "bad-param",
                format!("its input `{port}` comes from a node without `{param}`"),
            ));
        }
    }
    check_lookup(node)?;
    // Of a texture with several tables, places between entries are those of all together.
    for port in ["preintegration_table", "preintegration_half_table"] {
        if let Some(writer) = node.writer(port)
            && transfers(&writer).is_ok_and(|tables| tables.len() > 1)
        {
            return Err(node
                .error(
                    "bad-table",
                    format!("its input `{port}` holds the tables of several transfer functions"),
                )
                .help("give the node that makes it no `segments`"));
        }
    }
    Ok(())
}

/// What the fourth number of an entry of a pre-integrated table is depends on how entries are looked up: each table that a node
/// reads has to be made for the node's `lookup`, which labels share.
pub(crate) fn check_lookup(node: &NodeContext<'_>) -> Result<(), Finding> {
    let Some(ParamValue::Text(lookup)) = node.param("lookup") else {
        return Ok(());
    };
    for port in [
        "preintegration_table",
        "preintegration_tables",
        "preintegration_2_table",
        "preintegration_3_table",
        "preintegration_4_table",
    ] {
        let Some(writer) = node.writer(port) else {
            continue;
        };
        let is_whole = writer.kind_name() == Preintegration::Whole.name();
        let made_for = if is_whole {
            writer.text("lookup")
        } else {
            "bilinear"
        };
        if made_for != lookup {
            let message = format!(
                "its `lookup` is `{lookup}`, and its input `{port}` is made for `{made_for}`"
            );
            let help = format!("set `lookup` of the node that makes the table to `{lookup}`");
            return Err(node.error("bad-table", message).help(help));
        }
    }
    let is_other = |value: &ParamValue| match value {
        ParamValue::Text(theirs) => theirs != lookup,
        ParamValue::Int(index) => (*index == 1) != (lookup == "nearest"),
        _ => false,
    };
    let rows = segmentation::segments(node).map(SegmentsSource::param_rows);
    let mut given = rows.into_iter().flatten();
    if given.any(|row| row.get("lookup").is_some_and(|it| is_other(&it.value))) {
        let message =
            format!("its `lookup` is `{lookup}`, and labels have another: tables are made for one");
        return Err(node
            .error("labels-unsupported", message)
            .help("set `lookup` of the node, and leave it out of the labels' parameters"));
    }
    Ok(())
}

/// A table of one transfer function cannot serve labels that have others.
pub(super) fn check_tables_of_labels(node: &NodeContext<'_>) -> Result<(), Finding> {
    let has_others =
        segmentation::segments(node).is_some_and(|segments| !segments.transfers.is_empty());
    let is_of_one = |port: &&InputPort| match port.requirement {
        Requirement::Demanded(demand) => {
            let is_made_of = |mine: &str| demand.inputs.iter().any(|(_, it)| *it == mine);
            is_made_of("transfer") && !is_made_of("segments") && node.uses_binding(port.name)
        }
        _ => false,
    };
    match INPUTS.iter().find(is_of_one).filter(|_| has_others) {
        None => Ok(()),
        Some(port) => Err(node
            .error(
                "labels-unsupported",
                format!(
                    "labels have transfer functions of their own, but its shader reads `{}`, which is made of one",
                    port.name
                ),
            )
            .help("choose the slot `classify` \"post\" or \"preintegrated_2d\"")),
    }
}

/// Beyond all scalars, in f32.
const NO_SCALAR: f64 = 3.0e38;

/// The ports of a volume and of the tables of one transfer function, or of many.
pub(crate) struct TablePorts {
    pub volume: &'static str,
    pub transfer: &'static str,
    pub preintegration: &'static str,
    pub half: &'static str,
    pub integral: &'static str,
}

impl TablePorts {
    pub const ONE: Self = Self {
        volume: "volume",
        transfer: "transfer_table",
        preintegration: "preintegration_table",
        half: "preintegration_half_table",
        integral: "integral_table",
    };
    pub const MANY: Self = Self {
        volume: "volume",
        transfer: "transfer_tables",
        preintegration: "preintegration_tables",
        half: "preintegration_half_tables",
        integral: "integral_tables",
    };

    /// Whether a node's shader reads any of them.
    pub fn are_read(&self, node: &NodeContext<'_>) -> bool {
        [self.transfer, self.preintegration, self.half, self.integral]
            .iter()
            .any(|table| node.uses_binding(table))
    }
}

/// The members of the uniform `transfer` (see `lib/transfer_row.wgsl`), for tables at these ports.
pub(crate) fn transfer_uniform(
    node: &NodeContext<'_>,
    transfer: &TransferFunction,
    ports: &TablePorts,
) -> Result<Uniform, Finding> {
    let volume = placement::placed(node, ports.volume)?;
    let scalar = |at: f64| data_value(volume, transfer.domain(), at);
    let voxel = volume.grid().min_spacing();
    let last = |port: &str, param: &str| {
        node.writer(port)
            .map_or(1.0, |writer| f64::from(writer.uint(param).max(2) - 1))
    };
    let entries = last(ports.transfer, "table_size");
    let refraction = last("refraction_table", "table_size");
    let preintegration = last(ports.preintegration, "preintegration_size");
    let half = last(ports.half, "preintegration_size");
    // A table of the user's own may be of the other kind.
    let length = |port: &str| {
        node.writer(port).map_or(voxel, |writer| {
            let is_half = writer.kind_name() == Preintegration::Half.name();
            let kind = if is_half {
                Preintegration::Half
            } else {
                Preintegration::Whole
            };
            kind.steps() * writer.float("step") * voxel
        })
    };
    let integral = node.writer(ports.integral).map_or(1.0, |writer| {
        f64::from(IntegralTable::cells(writer.uint("table_size")))
    });
    let [color_least, color_most] = transfer
        .color_bounds()
        .map(|color| UniformValue::Vec3(color.map(|value| value as f32)));
    let (low, span) = table_range_at(node, ports.volume, transfer)?;
    // Shaders count scalars from the encoding's reference.
    let reference = placement::encoding_at(node, ports.volume)?.reference;
    // Of a transfer function that bends nothing, no scalar is between the two.
    let (first_bent, last_bent) = transfer
        .refraction_span()
        .map_or((NO_SCALAR, -NO_SCALAR), |(first, last)| {
            (scalar(first) - reference, scalar(last) - reference)
        });
    let references_per_world = transfer.reference_length().extinction_per_world(voxel);
    Ok(vec![
        // The first and the last entry stand in the middle of their texels.
        ("entry_scale", f32_value(entries / (span * (entries + 1.0)))),
        (
            "entry_bias",
            f32_value((0.5 - low * entries / span) / (entries + 1.0)),
        ),
        ("low", f32_value(low)),
        ("refraction_per_scalar", f32_value(refraction / span)),
        ("refraction_last", f32_value(refraction)),
        ("refraction_from", f32_value(first_bent)),
        ("refraction_to", f32_value(last_bent)),
        (
            "preintegration_per_scalar",
            f32_value(preintegration / span),
        ),
        ("preintegration_last", f32_value(preintegration)),
        (
            "halvings_per_world",
            f32_value(references_per_world * std::f64::consts::LOG2_E),
        ),
        (
            "preintegration_length",
            f32_value(length(ports.preintegration)),
        ),
        ("entries", f32_value(entries + 1.0)),
        ("half_per_scalar", f32_value(half / span)),
        ("half_last", f32_value(half)),
        ("half_length", f32_value(length(ports.half))),
        ("integral_per_scalar", f32_value(integral / span)),
        ("integral_last", f32_value(integral)),
        ("color_least", color_least),
        ("color_most", color_most),
    ])
}

/// The scalar that tables of the transfer function start at, as shaders count scalars, and how many they span.
pub(crate) fn table_range(
    node: &NodeContext<'_>,
    transfer: &TransferFunction,
) -> Result<(f64, f64), Finding> {
    table_range_at(node, "volume", transfer)
}

/// The same for the volume at another port.
fn table_range_at(
    node: &NodeContext<'_>,
    port: &str,
    transfer: &TransferFunction,
) -> Result<(f64, f64), Finding> {
    let volume = placement::placed(node, port)?;
    let (low, high) = transfer.range();
    let [low, high] = [low, high].map(|at| data_value(volume, transfer.domain(), at));
    // Shaders count scalars from the encoding's reference.
    let reference = placement::encoding_at(node, port)?.reference;
    Ok((low - reference, high - low))
}

/// The data value at a position of a transfer function.
#[must_use]
pub fn data_value(volume: impl Into<Scalars>, domain: Domain, at: f64) -> f64 {
    let (from, to) = match domain {
        Domain::Data => return at,
        Domain::Normalised => placement::normalised_range(volume),
        Domain::Range => placement::data_range(volume),
    };
    from + at * (to - from)
}
