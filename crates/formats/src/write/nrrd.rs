//! NRRD: version 5 in LPS, attached or detached, raw or gzip.

use std::fmt::Write as _;
use std::path::Path;

use glam::DVec3;
use volgraph_volume::{ScalarType, Values, Volume, VolumeError};

use super::target::{Packing, Source, TempFile};
use super::{WriteOptions, Written, beside, deflate_level, ends_with};

pub(super) fn write(
    volume: &Volume,
    path: &Path,
    options: &WriteOptions,
) -> Result<Written, VolumeError> {
    let source = Source::colored(volume);
    let level = deflate_level(path, options);
    let detached = ends_with(path, ".nhdr");
    let data = beside(path, if level.is_some() { "raw.gz" } else { "raw" });
    let mut head = header(volume, source.colors, level.is_some());
    if detached {
        let name = data.file_name().unwrap_or_default().to_string_lossy();
        // Infallible, as all writing into a string.
        let _ = writeln!(head, "data file: {name}");
        super::target::check(&data, false, options)?;
    }
    head.push('\n');
    let mut file = TempFile::beside(path)?;
    file.put(head.as_bytes())?;
    let mut written = Written::default();
    let mut voxels = if detached {
        TempFile::beside(&data)?
    } else {
        file.put_voxels(&source, Packing::gzip(level), &options.watch)?;
        file.finish(options, &mut written)?;
        return Ok(written);
    };
    voxels.put_voxels(&source, Packing::gzip(level), &options.watch)?;
    // The data first: a header never names a file that is not there.
    voxels.finish(options, &mut written)?;
    file.finish(options, &mut written)?;
    written.files.reverse();
    Ok(written)
}

fn header(volume: &Volume, colors: bool, packed: bool) -> String {
    let grid = volume.grid();
    let [nx, ny, nz] = grid.dims;
    let matrix = grid.world_from_index.matrix3;
    let vector = |v: DVec3| format!("({},{},{})", v.x, v.y, v.z);
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis]
        .map(vector)
        .join(" ");
    let centring = if grid.node_centred { "node" } else { "cell" };
    let ty = if colors {
        ScalarType::U8
    } else {
        volume.voxels().scalar_type()
    };
    // The format's own words, which have no number of bits where it is a float.
    let ty = match ty {
        ScalarType::F32 => "float",
        ScalarType::F64 => "double",
        _ => ty.name(),
    };
    // What stands before the three axes of space where there are colours.
    let first = |word: &str| {
        if colors {
            format!("{word} ")
        } else {
            String::new()
        }
    };
    let mut text = format!(
        "NRRD0005\n# written by volgraph\ntype: {ty}\ndimension: {}\nspace: left-posterior-superior\n\
         sizes: {}{nx} {ny} {nz}\nspace directions: {}{columns}\nspace origin: {}\n\
         kinds: {}domain domain domain\ncenterings: {}{centring} {centring} {centring}\n\
         endian: little\nencoding: {}\n",
        3 + u32::from(colors),
        first("4"),
        first("none"),
        vector(grid.origin()),
        first("RGBA-color"),
        first("???"),
        if packed { "gzip" } else { "raw" },
    );
    let about = volume.about();
    let plain = |text: &str| !text.is_empty() && !text.contains(['"', '\\', '\n', '\r']);
    if let Some(unit) = about.length_unit.as_deref().filter(|unit| plain(unit)) {
        let _ = writeln!(text, "space units: \"{unit}\" \"{unit}\" \"{unit}\"");
    }
    if let Values::Labels(names) = &about.values {
        for (number, (label, name)) in names.iter().enumerate() {
            let name = if plain(name) { name.as_str() } else { "" };
            let _ = writeln!(
                text,
                "Segment{number}_LabelValue:={label}\nSegment{number}_Name:={name}"
            );
        }
    }
    text
}
