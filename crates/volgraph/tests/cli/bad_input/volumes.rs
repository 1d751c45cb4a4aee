//! Volumes that are not what they say.

use super::{Bad, PLAN, bad};
use crate::graph;

/// A volume file with this content, and the graph that draws it.
fn volume(
    what: &'static str,
    name: &'static str,
    content: impl Into<Vec<u8>>,
    code: &'static str,
    place: &'static str,
) -> Bad {
    let text = graph(&format!("volume(path: \"{name}\")"));
    bad(
        what,
        vec![(name, content.into()), ("g.ron", text.into_bytes())],
        &PLAN,
        code,
        place,
    )
}

fn nrrd(header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = format!("NRRD0004\n{header}\n\n").into_bytes();
    bytes.extend_from_slice(data);
    bytes
}

const EIGHT: [u8; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

pub fn volumes() -> Vec<Bad> {
    let header = "type: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw";
    let gzip = header.replace("raw", "gzip");
    let edited = |find: &str, with: &str| nrrd(&header.replace(find, with), &EIGHT);
    let mhd = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n";
    vec![
        volume(
            "truncated raw",
            "v_4x4x4_uint8.raw",
            [0; 63],
            "volume-data-too-short",
            "v_4x4x4_uint8.raw",
        ),
        volume(
            "overlong raw",
            "v_4x4x4_uint8.raw",
            [0; 65],
            "volume-data-too-long",
            "v_4x4x4_uint8.raw",
        ),
        volume(
            "10^12 voxels by name",
            "v_10000x10000x10000_uint8.raw",
            [0; 8],
            "volume-too-large",
            "v_10000x",
        ),
        volume(
            "10^12 voxels by header",
            "v.nrrd",
            edited("2 2 2", "10000 10000 10000"),
            "volume-too-large",
            "v.nrrd",
        ),
        volume(
            "zero size by name",
            "v_0x4x4_uint8.raw",
            [0; 8],
            "volume-",
            "v_0x4x4_uint8.raw",
        ),
        volume(
            "zero size by header",
            "v.nrrd",
            edited("2 2 2", "0 2 2"),
            "volume-",
            "v.nrrd:4",
        ),
        volume(
            "no such type",
            "v.nrrd",
            edited("uint8", "string"),
            "volume-unknown-type",
            "v.nrrd:2",
        ),
        volume(
            "spacing not a number",
            "v.nrrd",
            edited("encoding", "spacings: nan 1 1\nencoding"),
            "volume-",
            "v.nrrd",
        ),
        volume(
            "infinite spacing",
            "v.nrrd",
            edited("encoding", "spacings: inf 1 1\nencoding"),
            "volume-",
            "v.nrrd",
        ),
        volume(
            "truncated nrrd",
            "v.nrrd",
            nrrd(header, &EIGHT[..7]),
            "volume-data-too-short",
            "v.nrrd",
        ),
        volume(
            "no gzip",
            "v.nrrd",
            nrrd(&gzip, &[7; 64]),
            "volume-data-corrupt",
            "v.nrrd",
        ),
        volume(
            "a picture named nrrd",
            "v.nrrd",
            *b"GIF89a\0\0\0\0",
            "volume-wrong-content",
            "v.nrrd",
        ),
        volume(
            "a gzip cut off",
            "v_2x2x2_uint8.raw.gz",
            [0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3, 0x63],
            "volume-data-",
            "v_2x2x2_uint8.raw.gz",
        ),
        volume(
            "a name that does not tell",
            "engine.raw",
            EIGHT,
            "volume-raw-name",
            "engine.raw",
        ),
        volume(
            "no data file",
            "v.mhd",
            format!("{mhd}ElementDataFile = no.raw\n"),
            "volume-data-file",
            "no.raw",
        ),
        volume(
            "no type in MetaImage",
            "v.mha",
            mhd.replace("MET_UCHAR", "MET_ODD") + "ElementDataFile = LOCAL\n",
            "volume-unknown-type",
            "v.mha:4",
        ),
        volume("an empty file", "v.nrrd", [], "volume-", "v.nrrd"),
        bad(
            "no such volume",
            vec![(
                "g.ron",
                graph("volume(path: \"no_2x2x2_uint8.raw\")").into_bytes(),
            )],
            &PLAN,
            "data-missing",
            "no_2x2x2_uint8.raw",
        ),
        bad(
            "a folder as a volume",
            vec![("g.ron", graph("volume(path: \".\")").into_bytes())],
            &PLAN,
            "volume-unknown-format",
            "g.ron:3",
        ),
        bad(
            "over the device's limit",
            vec![
                ("v_4096x1x1_uint8.raw", vec![0; 4096]),
                (
                    "g.ron",
                    graph("volume(path: \"v_4096x1x1_uint8.raw\")").into_bytes(),
                ),
            ],
            &PLAN,
            "over-limit",
            "g.ron:8",
        ),
    ]
}
