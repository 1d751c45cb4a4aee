//! What matter looks like, from a raycast's parameters: one look of its own, and one for each label that differs.

use glam::DVec3;
use volgraph_graph::NodeContext;
use volgraph_optics::{Material, TransferFunction};
use volgraph_reference::{Lamp, Layer, Look, Materials, Matter, Place, Tone, Window};
use volgraph_report::Finding;

use super::covered::choice_of;
use super::space::Space;
use super::values::Values;
use crate::{placement, raycast, segmentation, transfer_table};

/// The isosurfaces that the technique draws, most of them.
const MAX_LAYERS: usize = 8;

/// Lights there are.
const MAX_LAMPS: usize = 4;

/// The look of a node's own parameters.
///
/// # Errors
/// `missing-input`.
pub(crate) fn own_look(node: &NodeContext<'_>) -> Result<Look, Finding> {
    look(&Values::own(node), 0)
}

/// The look of a node's own parameters, or of one label's; `transfer` is the row of its transfer function.
pub(super) fn look(values: &Values<'_>, transfer: usize) -> Result<Look, Finding> {
    let node = &values.node;
    let materials = Materials {
        default: Material {
            ambient: values.float("ambient"),
            diffuse: values.float("diffuse"),
            specular: values.float("specular"),
            shininess: values.float("shininess"),
        },
        by_transfer: choice_of(node, "material") != "uniform",
    };
    let technique = choice_of(node, "technique");
    let is_lit = choice_of(node, "light") != "unlit";
    let has_matter = matches!(technique, "dvr" | "isosurface_dvr")
        || (is_lit && materials.by_transfer)
        || (technique == "isosurface" && is_lit && choice_of(node, "shadow") == "transmittance")
        || (matches!(technique, "mip" | "minip" | "average")
            && choice_of(node, "tone") == "transfer");
    let matter = if has_matter {
        let transfer = transfer_of(node, transfer)?;
        Some(matter(node, &transfer, &materials)?)
    } else {
        None
    };
    let tone = if choice_of(node, "tone") == "transfer" {
        Tone::Matter
    } else {
        Tone::Window(window(values)?, values.vector("window_color"))
    };
    Ok(Look {
        matter,
        materials,
        lamps: is_lit.then(|| lamps(values)).transpose()?,
        layers: layers(values)?,
        is_solid_below: values.text("solid") == "below",
        tone,
    })
}

fn transfer_of(
    node: &NodeContext<'_>,
    row: usize,
) -> Result<std::sync::Arc<TransferFunction>, Finding> {
    if !segmentation::has_labels(node) {
        return transfer_table::transfer(node, "transfer");
    }
    let mut all = transfer_table::transfers(node)?;
    if row < all.len() {
        return Ok(all.swap_remove(row));
    }
    transfer_table::transfer(node, "transfer")
}

/// A transfer function in the units of the volume.
fn matter(
    node: &NodeContext<'_>,
    transfer: &TransferFunction,
    materials: &Materials,
) -> Result<Matter, Finding> {
    let volume = placement::volume(node, "volume")?;
    let value = |at: f64| raycast::data_value(volume, transfer.domain(), at);
    let low = value(0.0);
    let units = (low, value(1.0) - low);
    let spacing = volume.grid().min_spacing();
    Ok(Matter::new(transfer, units, spacing, materials))
}

/// A data value from one that the user gave in a unit, of the volume at a port.
pub(super) fn scalar(
    node: &NodeContext<'_>,
    port: &str,
    given: f64,
    unit: &str,
) -> Result<f64, Finding> {
    let volume = placement::volume(node, port)?;
    let (low, high) = match unit {
        "data" => return Ok(given),
        "normalised" => placement::normalised_range(volume),
        _ => placement::data_range(volume),
    };
    Ok(low + given * (high - low))
}

/// The window of scalars that projections show.
pub(super) fn window(values: &Values<'_>) -> Result<Window, Finding> {
    let unit = values.text("window_unit");
    let [low, high] = ["window_low", "window_high"]
        .map(|name| scalar(&values.node, "volume", values.float(name), unit));
    let (low, span) = (low?, high?);
    let span = span - low;
    // As `lib/window.wgsl` has it: a window of no width shows all or nothing.
    let range = placement::data_range(placement::volume(&values.node, "volume")?);
    let least = 1e-7 * (range.1 - range.0);
    let span = if span.abs() >= least {
        span
    } else if span >= 0.0 {
        least
    } else {
        -least
    };
    Ok(Window { low, span })
}

fn layers(values: &Values<'_>) -> Result<Vec<Layer>, Finding> {
    let unit = values.text("isovalue_unit");
    let level = |name: &str| scalar(&values.node, "volume", values.float(name), unit);
    let one = |opacity| -> Result<Vec<Layer>, Finding> {
        Ok(vec![Layer {
            level: level("isovalue")?,
            color: values.vector("surface_color"),
            opacity,
        }])
    };
    match choice_of(&values.node, "technique") {
        "isosurface" => one(1.0),
        "isosurface_dvr" => one(values.float("surface_opacity")),
        "isosurfaces_translucent" => (1..=values.uint("surfaces").min(MAX_LAYERS))
            .map(|number| {
                let [r, g, b, opacity] = values.vector(&format!("color_{number}"));
                Ok(Layer {
                    level: level(&format!("isovalue_{number}"))?,
                    color: [r, g, b],
                    opacity,
                })
            })
            .collect(),
        _ => Ok(Vec::new()),
    }
}

fn lamps(values: &Values<'_>) -> Result<Vec<Lamp>, Finding> {
    let space = Space::new(values)?;
    let count = values.uint("lights").min(MAX_LAMPS);
    Ok((1..=count)
        .map(|number| {
            let [x, y, z, w] = values.vector(&format!("light_{number}"));
            let given = DVec3::new(x, y, z);
            let place = if w != 0.0 {
                Place::At(space.point(given / w))
            } else if given == DVec3::ZERO {
                Place::Eye
            } else {
                Place::Towards(given.normalize())
            };
            Lamp {
                place,
                color: values.vector(&format!("light_{number}_color")),
            }
        })
        .collect())
}
