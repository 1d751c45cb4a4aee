//! From a `raycast` node to the scene that the reference computes.
//!
//! Slots that only choose how an integral is taken (`classify`, `traverse`) do not matter here: all of them approximate
//! one picture. What the reference has no closed form for is refused by name (`not-covered`), never left out.

use volgraph_graph::{NodeContext, View};
use volgraph_reference::{Background, Field, Matter, Rays, Scene, Technique};
use volgraph_report::Finding;
use volgraph_shader::ParamValue;

use crate::raycast::Raycast;
use crate::{background, placement, raycast, transfer_table};
use volgraph_graph::NodeKind;

/// The rays of a view.
#[must_use]
pub fn rays(view: &View) -> Rays {
    let lens = view.lens();
    Rays {
        eye: view.camera.eye,
        right: view.camera.right,
        up: view.camera.up,
        forward: view.camera.forward,
        half_extent: lens.half_extent,
        is_orthographic: lens.is_orthographic,
        size: view.size,
    }
}

/// The scene of a `raycast` node in a view.
///
/// # Errors
/// `not-covered` where the reference does not know how to compute it; `missing-input`.
pub fn raycast_scene(node: &NodeContext<'_>, view: &View) -> Result<Scene, Finding> {
    if node.kind_name() != Raycast.name() {
        let message = format!(
            "the reference computes the pictures of raycasts, and this is a `{}`",
            node.kind_name()
        );
        return Err(node
            .error("not-covered", message)
            .help("connect the port `color` of a raycast"));
    }
    covered(node, "reconstruct", &["trilinear"])?;
    covered(node, "clip", &["none"])?;
    covered(node, "labels", &["none"])?;
    Ok(Scene {
        rays: rays(view),
        field: Field::new(placement::volume(node, "volume")?),
        technique: technique(node)?,
        background: background(node)?,
    })
}

/// Refuses choices that the reference does not know.
fn covered(node: &NodeContext<'_>, slot: &str, choices: &[&str]) -> Result<(), Finding> {
    let choice = node.slot(slot);
    if choice.is_empty() || choices.contains(&choice) {
        return Ok(());
    }
    let known = choices.join("`, `");
    Err(node
        .error(
            "not-covered",
            format!("the reference does not compute the choice `{choice}` of its slot `{slot}`"),
        )
        .help(format!(
            "compare with a choice that it computes (`{known}`), or with the same graph at a much smaller step"
        )))
}

fn technique(node: &NodeContext<'_>) -> Result<Technique, Finding> {
    covered(node, "technique", &["dvr"])?;
    covered(node, "light", &["unlit"])?;
    Ok(Technique::VolumeRendering {
        matter: matter(node)?,
    })
}

/// The transfer function in the units of the volume.
fn matter(node: &NodeContext<'_>) -> Result<Matter, Finding> {
    let transfer = transfer_table::transfer(node, "transfer")?;
    let volume = placement::volume(node, "volume")?;
    let value = |at: f64| raycast::data_value(volume, transfer.domain(), at);
    let low = value(0.0);
    let units = (low, value(1.0) - low);
    Ok(Matter::new(&transfer, units, volume.grid().min_spacing()))
}

fn background(node: &NodeContext<'_>) -> Result<Background, Finding> {
    let Some(writer) = node.writer("behind") else {
        return Ok(Background::Nothing);
    };
    if writer.kind_name() != background::Background.name() {
        let message = format!(
            "the reference does not compute a `{}` behind a raycast",
            writer.kind_name()
        );
        return Err(node
            .error("not-covered", message)
            .help("connect a `background` to `behind`"));
    }
    Ok(match writer.text("pattern") {
        "uniform" => Background::Uniform(color(&writer, "color")),
        "gradient" => Background::Gradient {
            bottom: color(&writer, "bottom"),
            top: color(&writer, "top"),
        },
        "checker" => Background::Checker {
            color: color(&writer, "color"),
            other_color: color(&writer, "other_color"),
            squares: writer.float("squares"),
        },
        other => {
            let message = format!("the reference does not compute the pattern `{other}`");
            return Err(writer
                .error("not-covered", message)
                .help("choose the pattern `uniform`, `gradient` or `checker`"));
        }
    })
}

/// A parameter of four numbers; zeros where there is none of that name.
fn color(node: &NodeContext<'_>, name: &str) -> [f64; 4] {
    let mut color = [0.0; 4];
    if let Some(ParamValue::Vector(values)) = node.param(name) {
        for (to, from) in color.iter_mut().zip(values) {
            *to = *from;
        }
    }
    color
}
