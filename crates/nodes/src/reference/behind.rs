//! What lies behind a raycast, for the reference.

use volgraph_graph::{NodeContext, NodeKind, View};
use volgraph_picture::Picture;
use volgraph_reference::Background;
use volgraph_report::Finding;

use super::scene::rays;
use super::values::Values;
use crate::background;
use crate::source::image::ImageSource;

/// The background behind a node; nothing where none is connected.
pub(crate) fn behind(node: &NodeContext<'_>, view: &View) -> Result<Background, Finding> {
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
    let values = Values::own(&writer);
    Ok(match writer.text("pattern") {
        "uniform" => Background::Uniform(values.vector("color")),
        "gradient" => Background::Gradient {
            bottom: values.vector("bottom"),
            top: values.vector("top"),
        },
        "checker" => Background::Checker {
            color: values.vector("color"),
            other_color: values.vector("other_color"),
            squares: writer.float("squares"),
        },
        "image" => image(&writer, view)?,
        other => {
            let message = format!("the reference does not compute the pattern `{other}`");
            return Err(writer
                .error("not-covered", message)
                .help("choose the pattern `uniform`, `gradient`, `checker` or `image`"));
        }
    })
}

/// An image, as high as the picture and repeated to the sides, bilinear between its pixels.
fn image(writer: &NodeContext<'_>, view: &View) -> Result<Background, Finding> {
    let source = writer
        .source::<ImageSource>("image")
        .ok_or_else(|| writer.error("missing-input", "its input `image` is not an image"))?;
    let rays = rays(view);
    let picture = source.picture.as_ref();
    let [width, height] = view.size;
    let aspect = rays.half_extent[0] / rays.half_extent[1];
    let mut pixels = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            let [across, up] = rays.place(x, y);
            let columns = f64::from(picture.width);
            let rows = f64::from(picture.height);
            // In pixels of the image, 0 at the middle of the first.
            let column = 0.5 * across * aspect * rows + 0.5 * columns - 0.5;
            let row = (0.5 - 0.5 * up) * rows - 0.5;
            pixels.push(bilinear(picture, column, row));
        }
    }
    Ok(Background::Picture(pixels))
}

fn bilinear(picture: &Picture, column: f64, row: f64) -> [f64; 4] {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "pixels of a picture, however often repeated"
    )]
    let [(x, u), (y, v)] = [column, row].map(|at| (at.floor() as i64, at - at.floor()));
    let wrapped =
        |at: i64, count: u32| usize::try_from(at.rem_euclid(i64::from(count).max(1))).unwrap_or(0);
    let mut sum = [0.0; 4];
    for (dx, dy, weight) in [
        (0, 0, (1.0 - u) * (1.0 - v)),
        (1, 0, u * (1.0 - v)),
        (0, 1, (1.0 - u) * v),
        (1, 1, u * v),
    ] {
        let at = wrapped(y + dy, picture.height) * picture.width as usize
            + wrapped(x + dx, picture.width);
        for (sum, value) in sum
            .iter_mut()
            .zip(picture.color.get(at).copied().unwrap_or_default())
        {
            *sum += weight * f64::from(value);
        }
    }
    sum
}
