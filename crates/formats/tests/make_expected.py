"""Writes expected_formats.tsv and expected_conventions.tsv beside this script.

    python make_expected.py FORMATS_FOLDER        (needs: pip install pynrrd SimpleITK numpy)

expected_formats.tsv has a row per file of the test data in FORMATS_FOLDER/nrrd and FORMATS_FOLDER/mhd;
expected_conventions.tsv a row per tiny file whose header is written below, together with that header.
Columns: which tool gave the row, the expected outcome (ok, or the code of the refusal), type, dimensions, the
component taken, the columns of world_from_index (axis by axis), its origin, min, max, mean, and the mean of
voxel * (index mod 1009) with x fastest, which sees the order of the voxels.

SimpleITK gives everything in LPS. pynrrd gives what the file says; where that is RAS, this script turns it.
"""

import os
import sys
import tempfile

import nrrd
import numpy as np
import SimpleITK as sitk

HERE = os.path.dirname(os.path.abspath(__file__))

# Files that volgraph refuses, with the code and the reason. What the tools do is said where it differs.
REFUSED = {
    "nrrd/BallBinary30x30x30_byteskip_minus_five.nhdr": (
        "volume-data-too-short", "-5 means 4 bytes behind the data; the file has none; both tools refuse"),
    "nrrd/BallBinary30x30x30_nifti.nhdr": (
        "volume-data-too-long", "a NIfTI header of 352 bytes before the data; pynrrd refuses, SimpleITK reads it as voxels"),
}
# Files with several values per voxel: refused without a choice, read with one.
COMPONENT = {"nrrd/slicer_deform2x2x2_ras.nrrd": 1}
PYNRRD = {
    "nrrd/BallBinary30x30x30_bz2.nrrd": "SimpleITK has no bzip2",
    "nrrd/test1d_ascii.nrrd": "SimpleITK has no 1D",
    "nrrd/test_customFields.nrrd": "SimpleITK has no 1D",
    "nrrd/test_simple4d_raw.nrrd": "SimpleITK refuses 4 axes in a 3D space; RAS turned to LPS here",
    "nrrd/threejs_stent.nrrd": "SimpleITK refuses directions without a space",
}
COLUMNS = ["tool", "outcome", "type", "dims", "component", "columns", "origin", "min", "max", "mean", "weighted", "note"]


def numbers(values):
    return " ".join(repr(float(v)) for v in np.ravel(values))


def row(tool, dtype, dims, component, columns, origin, data, note):
    """`data` is flat, x fastest."""
    data = data.astype(np.float64)
    weighted = (data * (np.arange(data.size) % 1009)).mean()
    return [tool, "ok", str(dtype), " ".join(map(str, dims)), component, numbers(columns), numbers(origin),
            repr(float(data.min())), repr(float(data.max())), repr(float(data.mean())), repr(float(weighted)), note]


def pad(vector):
    return list(vector) + [0.0] * (3 - len(vector))


def by_itk(path, component="", note=""):
    image = sitk.ReadImage(path)
    data = sitk.GetArrayFromImage(image)
    n = image.GetDimension()
    matrix = np.array(image.GetDirection()).reshape(n, n)
    columns = [pad(matrix[:, axis] * image.GetSpacing()[axis]) for axis in range(n)]
    if image.GetNumberOfComponentsPerPixel() > 1:
        data = data[..., component]
    return row("SimpleITK", data.dtype, image.GetSize(), component, columns, pad(image.GetOrigin()), data.ravel(), note)


def by_pynrrd(path, note):
    data, header = nrrd.read(path)
    directions = header.get("space directions")
    if directions is None:
        spacings = header.get("spacings", np.ones(data.ndim))
        columns = np.eye(3)[: data.ndim] * np.array(spacings)[:, None]
    else:
        columns = np.array([d for d in directions if not np.isnan(d).any()])
        data = data.reshape(data.shape[: len(columns)])
    origin = np.array(header.get("space origin", np.zeros(3)))
    if header.get("space") == "right-anterior-superior":
        columns, origin = columns * [-1, -1, 1] + 0.0, origin * [-1, -1, 1] + 0.0
    return row("pynrrd", data.dtype, data.shape, "", columns, origin, data.ravel(order="F"), note)


def formats(folder):
    rows = []
    for kind, endings in (("nrrd", (".nrrd", ".nhdr")), ("mhd", (".mhd", ".mha"))):
        for name in sorted(os.listdir(os.path.join(folder, kind))):
            if not name.endswith(endings):
                continue
            name = f"{kind}/{name}"
            path = os.path.join(folder, name)
            if name in REFUSED:
                code, note = REFUSED[name]
                rows.append([name, "none", code, *[""] * 9, note])
                continue
            if name in COMPONENT:
                rows.append([name, "none", "volume-component", *[""] * 9, "several values per voxel"])
            if name in PYNRRD:
                rows.append([name, *by_pynrrd(path, PYNRRD[name])])
            else:
                rows.append([name, *by_itk(path, COMPONENT.get(name, ""))])
    return rows


def conventions():
    meta = "ObjectType = Image\nNDims = 3\nDimSize = 2 3 4\n"
    last = "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    near = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 3 4\nencoding: raw\n"
    place = "space directions: (2,1,0) (0,3,0) (1,0,4)\nspace origin: (5,6,7)\n\n"
    data = bytes(range(24))
    big16 = np.arange(24, dtype=">i2").tobytes()
    long32 = np.arange(24, dtype="<i4").tobytes()
    cases = [
        ("transform_matrix.mha", meta + "TransformMatrix = 0 1 0 0 0 1 1 0 0\nOffset = 1 2 3\nElementSpacing = 2 3 4\n" + last, data),
        ("oblique.mha", meta + "TransformMatrix = 0.8 0.6 0 -0.6 0.8 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 2 3 4\n" + last, data),
        ("rotation_position.mha", meta + "Rotation = 0 1 0 0 0 1 1 0 0\nPosition = 1 2 3\nElementSpacing = 2 3 4\n" + last, data),
        ("orientation_origin_size.mha", meta + "Orientation = 0 1 0 0 0 1 1 0 0\nOrigin = 1 2 3\nElementSize = 2 3 4\n" + last, data),
        ("spacing_before_size.mha", meta + "ElementSpacing = 1 1 1\nElementSize = 2 3 4\n" + last, data),
        ("negative_spacing.mha", meta + "Offset = 1 2 3\nElementSpacing = -2 3 4\n" + last, data),
        ("directions_not_unit.mha", meta + "TransformMatrix = 2 0 0 0 1 0 0 0 1\n" + last, data),
        ("centre_of_rotation.mha", meta + "CenterOfRotation = 1 2 3\nTransformMatrix = 0 1 0 0 0 1 1 0 0\n" + last, data),
        ("slope_not_applied.mha", meta + "ElementToIntensityFunctionSlope = 2\n" + last, data),
        ("big_endian.mha", meta + "BinaryDataByteOrderMSB = True\nElementType = MET_SHORT\nElementDataFile = LOCAL\n", big16),
        ("element_big_endian.mha", meta + "ElementByteOrderMSB = True\nElementType = MET_SHORT\nElementDataFile = LOCAL\n", big16),
        ("long_is_4_bytes.mha", meta + "ElementType = MET_LONG\nElementDataFile = LOCAL\n", long32),
        ("text.mha", meta + "BinaryData = False\n" + last, b" ".join(b"%d" % i for i in range(24)) + b"\n"),
        ("colons.mha", (meta + last).replace(" =", ":"), data),
        ("crlf.mha", (meta + last).replace("\n", "\r\n"), data),
        ("two_axes.mha", "ObjectType = Image\nNDims = 2\nDimSize = 6 4\nElementSpacing = 2 3\nTransformMatrix = 0 1 -1 0\n" + last, data),
        ("channels.mha", "ObjectType = Image\nNDims = 3\nDimSize = 2 3 2\nElementNumberOfChannels = 2\n" + last, data),
        ("lps.nrrd", near + "space: left-posterior-superior\n" + place, data),
        ("ras.nrrd", near + "space: right-anterior-superior\n" + place, data),
        ("ras_short.nrrd", near + "space: RAS\n" + place, data),
        ("las.nrrd", near + "space: left-anterior-superior\n" + place, data),
        ("scanner.nrrd", near + "space: scanner-xyz\n" + place, data),
        ("unnamed_space.nrrd", near + "space dimension: 3\n" + place, data),
        ("mins_of_cells.nrrd", near + "axis mins: 0 1 2\nspacings: 2 2 2\ncenters: cell cell cell\n\n", data),
        ("mins_of_nodes.nrrd", near + "axis mins: 0 1 2\nspacings: 2 2 2\ncenterings: node node node\n\n", data),
        ("negative_spacing.nrrd", near + "spacings: -2 2 1\n\n", data),
        ("hex.nrrd", near.replace("raw", "hex") + "\n", data.hex().encode()),
        ("commas.nrrd", near.replace("raw", "ascii") + "\n", b", ".join(b"%d" % i for i in range(24))),
        ("crlf.nrrd", (near + "\n").replace("\n", "\r\n"), data),
    ]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, header, body in cases:
            path = os.path.join(folder, name)
            with open(path, "wb") as file:
                file.write(header.encode() + body)
            component = 1 if name == "channels.mha" else ""
            text = header.replace("\r", "\\r").replace("\n", "\\n")
            rows.append([name, *by_itk(path, component), text, body.hex()])
    return rows


def write(name, columns, rows):
    with open(os.path.join(HERE, name), "w", newline="\n") as file:
        for cells in [columns, *rows]:
            assert len(cells) == len(columns), cells
            file.write("\t".join(map(str, cells)) + "\n")


write("expected_formats.tsv", ["file", *COLUMNS], formats(sys.argv[1]))
write("expected_conventions.tsv", ["file", *COLUMNS, "header", "data_hex"], conventions())
