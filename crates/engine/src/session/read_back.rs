//! The picture of a frame: colour, and of the graph's other outputs those that belong to each pixel.

use glam::Vec4;
use volgraph_gpu::{Installation, Runner, TexelValues, Texels};
use volgraph_graph::View;
use volgraph_nodes::raycast::NO_DEPTH;
use volgraph_picture::{Layer, LayerValues, Picture};
use volgraph_report::{Finding, Findings};

use crate::metadata;
use crate::scene::Scene;

/// The picture of an installation's last frame.
pub(super) fn picture(
    runner: &Runner,
    installation: &Installation,
    scene: &Scene,
    view: &View,
    has_layers: bool,
) -> Result<Picture, Findings> {
    let plan = installation.plan();
    let mut picture = read(runner, installation, "color")?;
    let layer = |name: &str| -> Result<Option<Vec<f32>>, Findings> {
        if plan.graph.outputs.contains_key(name) {
            let texels = runner.read(installation, name)?;
            match texels.values {
                TexelValues::Scalars(numbers) => Ok(Some(numbers)),
                _ => Err(unfit(name, &texels, "one number for each pixel")),
            }
        } else {
            Ok(None)
        }
    };
    picture.opacity = layer("opacity")?;
    picture.depth = layer("depth")?;
    for depth in picture.depth.iter_mut().flatten() {
        if *depth >= NO_DEPTH {
            *depth = f32::INFINITY;
        }
    }
    if has_layers {
        picture.layers = layers(runner, installation, &picture)?;
    }
    picture.metadata = metadata::of(scene, plan, view, runner.gpu().adapter());
    Ok(picture)
}

/// The graph's other outputs that have a number or a vector for each pixel, by their names. Positions count from the
/// world's own origin in pictures, not from the scene's.
fn layers(
    runner: &Runner,
    installation: &Installation,
    picture: &Picture,
) -> Result<Vec<Layer>, Findings> {
    let plan = installation.plan();
    let origin = plan.graph.origin();
    let mut layers = Vec::new();
    for (name, link) in &plan.graph.outputs {
        if ["color", "depth", "opacity"].contains(&name.as_str()) {
            continue;
        }
        let texels = runner.read(installation, name)?;
        if texels.extent != [picture.width, picture.height, 1] {
            continue;
        }
        let is_position = link.port == "position";
        let values = match texels.values {
            TexelValues::Scalars(numbers) => LayerValues::Scalar(numbers),
            TexelValues::Colors(mut vectors) => {
                for at in vectors.iter_mut().filter(|at| is_position && at[3] > 0.0) {
                    *at = (Vec4::from_array(*at) + origin.as_vec3().extend(0.0)).to_array();
                }
                LayerValues::Vector(vectors)
            }
            TexelValues::Pairs(_) | TexelValues::Bytes(_) => continue,
        };
        layers.push(Layer {
            name: name.clone(),
            values,
        });
    }
    Ok(layers)
}

/// Any 2D colour output of an installation's last frame.
pub(super) fn read(
    runner: &Runner,
    installation: &Installation,
    output: &str,
) -> Result<Picture, Findings> {
    let texels: Texels = runner.read(installation, output)?;
    let [width, height, _] = texels.extent;
    let color = match texels.values {
        TexelValues::Colors(colors) => colors,
        TexelValues::Scalars(numbers) => numbers
            .iter()
            .map(|&value| [value, value, value, 1.0])
            .collect(),
        TexelValues::Pairs(_) | TexelValues::Bytes(_) => {
            return Err(unfit(output, &texels, "a picture"));
        }
    };
    Picture::from_color(width, height, color)
        .map_err(|error| Finding::error("picture", error.to_string()).into())
}

fn unfit(output: &str, texels: &Texels, what: &str) -> Findings {
    let format = texels.format;
    Finding::error(
        "output",
        format!("output `{output}` is not {what} but {format:?}"),
    )
    .help("name an output of a port of type color or scalar_2d")
    .into()
}
