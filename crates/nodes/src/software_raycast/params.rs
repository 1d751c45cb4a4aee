//! The parameters of a `software_raycast`: names, units and defaults are those of a raycast's shaders.

use volgraph_shader::ParamSpec;

use crate::transfer_table::size_param;

const UNITS: &[&str] = &["range", "normalised", "data"];

pub(super) fn params() -> Vec<ParamSpec> {
    let mut params = walk();
    params.extend(projection());
    params.extend(surface());
    params.extend(lights());
    params
}

fn walk() -> Vec<ParamSpec> {
    vec![
        ParamSpec::choice(
            "technique",
            &["dvr", "mip", "minip", "isosurface"],
            "dvr",
            "What a ray shows: emission and absorption, the largest scalar or the smallest, or the first isosurface.",
        ),
        ParamSpec::float(
            "step",
            1.0,
            "Length of a segment, in voxels of the smallest spacing; what goes from cell to cell has none.",
        )
        .range(0.01, 64.0)
        .unit("voxel"),
        ParamSpec::float(
            "early_termination",
            1.0 / 4096.0,
            "A ray ends where less than this share of the light behind could still reach the eye; 0 never.",
        )
        .range(0.0, 0.5),
        ParamSpec::choice(
            "classify",
            &["integral_1d", "post"],
            "integral_1d",
            "Colour and opacity of a segment: means from tables of integrals, or the transfer function at its centre.",
        ),
        ParamSpec::choice(
            "attenuation",
            &["exact", "four_lines"],
            "exact",
            "The opacity of an optical depth x with `integral_1d`: 1 - exp(-x), or the least of four lines, off by 0.0226.",
        ),
        ParamSpec::choice(
            "traverse",
            &["skip", "uniform"],
            "skip",
            "Whether rays leap over bricks of which nothing is seen; the picture is the same.",
        ),
        size_param(),
    ]
}

fn projection() -> Vec<ParamSpec> {
    vec![
        ParamSpec::choice(
            "extremum",
            &["samples", "field"],
            "field",
            "What a projection takes the extremum of: `samples` at whole steps, or the trilinear `field`, cell by cell: exact.",
        ),
        ParamSpec::float("window_low", 0.0, "The scalar that shows nothing."),
        ParamSpec::float(
            "window_high",
            1.0,
            "The scalar that shows most; below `window_low` for the negative.",
        ),
        ParamSpec::choice(
            "window_unit",
            UNITS,
            "range",
            "The unit of both: `range`, 0 to 1 over the values that the data has; `normalised`, over the range of the stored type (of floats: of the data); or `data`.",
        ),
        ParamSpec::vector(
            "window_color",
            &[1.0; 3],
            "Linear colour of the window's high end.",
        )
        .range(0.0, 1.0)
        .color(),
    ]
}

fn surface() -> Vec<ParamSpec> {
    vec![
        ParamSpec::float("isovalue", 0.5, "The scalar on the isosurface."),
        ParamSpec::choice(
            "isovalue_unit",
            UNITS,
            "range",
            "The unit of isovalues: `range`, 0 to 1 over the values that the data has; `normalised`, over the range of the stored type (of floats: of the data); or `data`.",
        ),
        ParamSpec::choice(
            "solid",
            &["above", "below"],
            "above",
            "Which side of the isovalue is solid.",
        ),
        ParamSpec::choice(
            "cut_faces",
            &["drawn", "open"],
            "drawn",
            "What is seen where a face of the volume's box lies in the solid: its face, or the hollow inside.",
        ),
        ParamSpec::choice(
            "refinement",
            &["linear", "cubic"],
            "cubic",
            "How crossings are found: `linear` between the ends of segments (order 2), or `cubic` cell by cell: exact, at any step, with all crossings.",
        ),
        ParamSpec::vector(
            "surface_color",
            &[0.8, 0.75, 0.65],
            "Linear colour of the isosurface.",
        )
        .range(0.0, 1.0)
        .color(),
    ]
}

fn lights() -> Vec<ParamSpec> {
    let share =
        |name: &str, default, doc: &str| ParamSpec::float(name, default, doc).range(0.0, 1.0);
    let mut params = vec![
        ParamSpec::choice(
            "light",
            &["unlit", "phong"],
            "unlit",
            "How an isosurface is lit: not at all, or Blinn-Phong by gradients from central differences.",
        ),
        share("ambient", 0.3, "Share of the colour that needs no light."),
        share("diffuse", 0.7, "Share of the colour that the light gives."),
        share("specular", 0.25, "Strength of the highlight."),
        ParamSpec::float("shininess", 32.0, "Sharpness of the highlight.").range(1.0, 256.0),
        ParamSpec::choice(
            "space",
            &["box", "world"],
            "box",
            "Where positions of lights count from: `box` from the middle of the volume's box, in halves of its smallest side; `world` from the world's origin, in its units.",
        ),
        ParamSpec::uint("lights", 1, "How many of the lights shine.").range(0.0, 4.0),
    ];
    for (number, word) in ["first", "second", "third", "fourth"]
        .into_iter()
        .enumerate()
    {
        let name = format!("light_{}", number + 1);
        params.push(ParamSpec::vector(
            name.as_str(),
            &[0.0; 4],
            format!("The {word} light: a world direction towards it and 0, or its position and 1 (see `space`); all zeros for a light at the eye."),
        ));
        params.push(
            ParamSpec::vector(
                format!("{name}_color"),
                &[1.0; 3],
                "Its linear colour, as bright as it is.",
            )
            .range(0.0, 100.0)
            .color(),
        );
    }
    params
}
