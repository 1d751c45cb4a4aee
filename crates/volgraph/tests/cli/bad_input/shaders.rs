//! Shaders that do not link or compile, or ask for what nobody fills.

use super::{Bad, bad};
use crate::{SPHERE, graph};

/// The right graph with shaders of one's own.
fn shader(
    what: &'static str,
    files: &[(&'static str, &str)],
    code: &'static str,
    place: &'static str,
) -> Bad {
    let mut all = vec![("g.ron", graph(SPHERE).into_bytes())];
    all.extend(
        files
            .iter()
            .map(|(name, text)| (*name, text.as_bytes().to_vec())),
    );
    bad(what, all, &["plan", "g.ron", "--shaders", "s"], code, place)
}

pub fn shaders() -> Vec<Bad> {
    let light = "s/slot/light/unlit.wgsl";
    let function =
        "fn light_segment(classified: Classified, segment: Segment, ray: Ray) -> vec3f {\n";
    let with = |body: &str| format!("#import \"lib/classified.wgsl\"\n{function}{body}\n}}\n");
    vec![
        shader(
            "syntax",
            &[(light, &with("    return classified.color)"))],
            "wgsl-syntax",
            "s/slot/light/unlit.wgsl:3",
        ),
        shader(
            "type",
            &[(light, &with("    return classified.colour;"))],
            "wgsl-type",
            "s/slot/light/unlit.wgsl:3",
        ),
        shader(
            "return type",
            &[(light, &with("    return segment.length;"))],
            "wgsl-validation",
            "s/slot/light/unlit.wgsl:3",
        ),
        shader(
            "a binding that is taken",
            &[(
                light,
                &format!(
                    "@group(1) @binding(1) var mine: texture_2d<f32>;\n{}",
                    with("    return textureLoad(mine, vec2i(0), 0).xyz;")
                ),
            )],
            "binding-clash",
            "s/slot/light/unlit.wgsl:1",
        ),
        shader(
            "a binding that nothing fills",
            &[(
                light,
                &format!(
                    "@group(3) @binding(5) var mine: texture_2d<f32>;\n{}",
                    with("    return textureLoad(mine, vec2i(0), 0).xyz;")
                ),
            )],
            "unknown-binding",
            "s/slot/light/unlit.wgsl:1",
        ),
        shader(
            "missing import",
            &[(light, "#import \"lib/no.wgsl\"\n")],
            "missing-import",
            "s/slot/light/unlit.wgsl:1",
        ),
        shader(
            "cyclic import",
            &[
                (light, "#import \"a.wgsl\"\n"),
                ("s/a.wgsl", "// A.\n#import \"b.wgsl\"\n"),
                ("s/b.wgsl", "#import \"a.wgsl\"\n"),
            ],
            "import-cycle",
            "s/b.wgsl:1",
        ),
        shader(
            "not text",
            &[(light, "\0\u{1}\u{2}")],
            "wgsl-syntax",
            "s/slot/light/unlit.wgsl:1",
        ),
    ]
}
