//! The picture of a frame: colour, and of the graph's other outputs those that belong to each pixel.

use volgraph_gpu::{Installation, Runner, Texels};
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
            Ok(Some(runner.read(installation, name)?.to_f32()))
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
        let numbers = texels.to_f32();
        let values = if numbers.len() == picture.color.len() {
            LayerValues::Scalar(numbers)
        } else {
            let pixels = numbers.chunks_exact(4).map(|p| {
                let shift = if is_position && p[3] > 0.0 {
                    origin.as_vec3().to_array()
                } else {
                    [0.0; 3]
                };
                [p[0] + shift[0], p[1] + shift[1], p[2] + shift[2], p[3]]
            });
            LayerValues::Vector(pixels.collect())
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
    let numbers = texels.to_f32();
    let [width, height, _] = texels.extent;
    let pixels = width as usize * height as usize;
    let color: Vec<[f32; 4]> = if numbers.len() == 4 * pixels {
        numbers
            .chunks_exact(4)
            .map(|p| [p[0], p[1], p[2], p[3]])
            .collect()
    } else if numbers.len() == pixels {
        numbers
            .iter()
            .map(|&value| [value, value, value, 1.0])
            .collect()
    } else {
        return Err(Finding::error(
            "output",
            format!("output `{output}` is no picture but {:?}", texels.format),
        )
        .help("name an output of a port of type color or scalar_2d")
        .into());
    };
    Picture::from_color(width, height, color)
        .map_err(|error| Finding::error("picture", error.to_string()).into())
}
