"""Writes expected_nifti.tsv, expected_vti.tsv and expected_npy.tsv beside this script.

    python make_expected_nifti_vti_npy.py FORMATS_FOLDER        (needs: pip install nibabel vtk numpy)

A row per file of the test data in FORMATS_FOLDER/nifti and FORMATS_FOLDER/vti, and per tiny file that is written
here by nibabel, VTK or NumPy; of these the bytes are in the table too (zlib, hexadecimal), one `name:hex` for each.
Columns: the options (part, component, time), the outcome (ok, or the code of the refusal), type, dimensions, the
columns of world_from_index (axis by axis) and its origin, min, max, mean, the mean of voxel * (index mod 1009) with x
fastest, ten probes `index:value`, and unit, meaning and time step as the file says them.

nibabel's RAS is turned to LPS here; VTK's coordinates are taken as LPS.
"""

import io
import os
import sys
import tempfile
import zlib

import nibabel as nib
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

HERE = os.path.dirname(os.path.abspath(__file__))
COLUMNS = ["file", "part", "component", "time", "outcome", "type", "dims", "columns", "origin", "min", "max", "mean",
           "weighted", "probes", "unit", "step_time", "note", "bytes"]


def numbers(values):
    return " ".join(repr(float(v) + 0.0) for v in np.ravel(values))


def row(file, data, affine_columns, origin, part="", component="", time="", unit="", step_time="", note="", files=None):
    """`data` is indexed x, y, z."""
    dims = list(data.shape) + [1] * (3 - data.ndim)
    flat = data.ravel(order="F")
    wide = flat.astype(np.float64)
    finite = wide[np.isfinite(wide)]
    weighted = (wide * (np.arange(wide.size) % 1009)).mean()
    at = [int(i) for i in np.linspace(0, flat.size - 1, 10)]
    probes = " ".join(f"{i}:{float(flat[i])!r}" for i in at)
    return [file, part, component, time, "ok", flat.dtype.name, " ".join(map(str, dims)), numbers(affine_columns),
            numbers(origin), repr(float(finite.min())), repr(float(finite.max())), repr(float(wide.mean())),
            repr(float(weighted)), probes, unit, step_time, note, packed(files)]


def refused(file, code, note, files=None, **options):
    filled = [options.get(key, "") for key in ("part", "component", "time")]
    return [file, *filled, code, *[""] * 11, note, packed(files)]


def packed(files):
    return " ".join(f"{name}:{zlib.compress(data, 9).hex()}" for name, data in (files or {}).items())


def write(name, rows):
    with open(os.path.join(HERE, name), "w", newline="\n") as file:
        for cells in [COLUMNS, *rows]:
            assert len(cells) == len(COLUMNS), cells
            file.write("\t".join(map(str, cells)) + "\n")


# NIfTI

def nifti_row(file, path, component="", time="", note="", files=None):
    image = nib.load(path)
    header = image.header
    affine = np.diag([-1.0, -1.0, 1.0, 1.0]) @ np.asarray(image.affine, dtype=np.float64)
    raw = np.asanyarray(image.dataobj.get_unscaled())
    slope, intercept = image.dataobj.slope, image.dataobj.inter
    stored = np.dtype(header.get_data_dtype())
    step = header["pixdim"][4]
    steps = raw.shape[3] if raw.ndim > 3 else 1
    step_time = ""
    if steps > 1 and step > 0:
        step_time = repr(float(header["toffset"]) + (time or 0) * float(step))
    data = raw
    if stored.names:
        data = raw[stored.names[component]]
    elif raw.ndim > 4:
        data = raw[..., component if component != "" else 0]
    if data.ndim > 3:
        data = data[..., time or 0]
    data = data.reshape(data.shape + (1,) * (3 - data.ndim))
    if stored.names is None and (slope, intercept) != (1.0, 0.0):
        scaled = data.astype(np.float64) * slope + intercept
        whole = float(slope).is_integer() and float(intercept).is_integer() and stored.kind in "iu" and stored.itemsize <= 2
        if whole:
            ends = np.array([np.iinfo(stored).min, np.iinfo(stored).max]) * slope + intercept
            fits = [t for t in (stored, np.dtype("i2"), np.dtype("u2"), np.dtype("i4")) if t != np.int8
                    and ends.min() >= np.iinfo(t).min and ends.max() <= np.iinfo(t).max]
            data = scaled.astype(fits[0] if fits else np.float32)
        else:
            wide = stored.itemsize >= 4 and stored != np.float32
            data = scaled.astype(np.float64 if wide else np.float32)
    data = data.astype(data.dtype.newbyteorder("="))
    unit = {"unknown": "", "meter": "m", "mm": "mm", "micron": "µm"}[header.get_xyzt_units()[0]]
    return row(file, data, affine[:3, :3].T, affine[:3, 3], "", component, time, unit, step_time, note, files)


NIFTI_REFUSED = {
    "fuzz_crash-1.nii": ("volume-unknown-type", "the datatype -9510 does not exist; nibabel says the same"),
    "nrjs_not-nifti.nii": ("volume-wrong-content", "noise"),
}


def nifti_files(folder):
    rows = []
    for name in sorted(os.listdir(folder)):
        file = f"nifti/{name}"
        path = os.path.join(folder, name)
        if name in NIFTI_REFUSED:
            rows.append(refused(file, *NIFTI_REFUSED[name]))
        elif name == "nrjs_5D_small.nii":
            rows.append(refused(file, "volume-component", "three values per voxel"))
            rows.append(nifti_row(file, path, component=2))
        elif name == "rgb_3D.nii":
            rows.extend(nifti_row(file, path, component=c) for c in range(3))
        else:
            rows.append(nifti_row(file, path))
    return rows


def nifti_tiny():
    rows = []
    grid = np.arange(24).reshape(2, 3, 4, order="F")
    turn = np.array([[0.0, -2.0, 0.3, 5.0], [1.5, 0.1, 0.0, 6.0], [0.0, 0.2, 3.0, -7.0], [0, 0, 0, 1]])

    def add(name, image, edit=None, note="", **options):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, name)
            if edit:
                edit(image.header)
            image.to_filename(path)
            files = {entry: open(os.path.join(folder, entry), "rb").read() for entry in sorted(os.listdir(folder))}
            rows.append(nifti_row(name, path, note=note, files=files, **options))

    def patched(name, image, note, *patches):
        """Bytes that nibabel would not write."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, name)
            image.to_filename(path)
            raw = bytearray(open(path, "rb").read())
            for at, data in patches:
                raw[at:at + len(data)] = data
            open(path, "wb").write(raw)
            rows.append(nifti_row(name, path, note=note, files={name: bytes(raw)}))

    def one(dtype=np.int16, affine=turn, data=grid, cls=nib.Nifti1Image, endian="<"):
        header = cls.header_class(endianness=endian)
        header.set_data_dtype(dtype)
        return cls(data.astype(dtype), affine, header)

    def q_only(header):
        header["sform_code"] = 0
        header["qform_code"] = 1

    neither = (252, bytes(4))

    def slope(value, intercept):
        return 112, np.array([value, intercept], "<f4").tobytes()

    def units(header):
        header.set_xyzt_units("mm", "sec")
        header["pixdim"][4] = 2.5
        header["toffset"] = 10

    rigid = nib.affines.from_matvec(np.diag([2.0, 3.0, 4.0]) @ np.eye(3), [1, 2, 3])
    angle = np.radians(30)
    rigid[:2, :2] = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ np.diag([2.0, 3.0])
    mirrored = rigid @ np.diag([1, 1, -1, 1.0])
    add("sform.nii", one())
    add("qform.nii", one(affine=rigid), q_only)
    add("qform_mirrored.nii", one(affine=mirrored), q_only, note="qfac is -1")
    add("half_turn.nii", one(affine=np.diag([-2.0, -3.0, 4.0, 1])), q_only, note="w is 0")
    patched("neither.nii", one(affine=rigid), "sizes alone", neither)
    patched("neither_two_axes.nii", one(data=grid[:, :, 0]), "sizes alone", neither)
    patched("slope.nii", one(np.int16), "", slope(0.5, 0.25))
    patched("slope_whole.nii", one(np.uint8), "", slope(2.0, -30.0))
    patched("slope_int32.nii", one(np.int32), "", slope(0.1, 7.0))
    patched("slope_float32.nii", one(np.float32), "", slope(0.1, 7.0))
    patched("slope_float64.nii", one(np.float64), "", slope(0.1, 7.0))
    patched("slope_two.nii", one(np.int8, cls=nib.Nifti2Image), "", (176, np.array([0.1, 7.0], "<f8").tobytes()))
    for endian, order in (("<", "little"), (">", "big")):
        for dtype in (np.uint16, np.int64, np.float32):
            add(f"two_{order}_{np.dtype(dtype).name}.nii", one(dtype, cls=nib.Nifti2Image, endian=endian))
        add(f"one_{order}.nii", one(np.float64, endian=endian))
    add("pair.hdr", one(cls=nib.Nifti1Pair))
    add("pair.img", one(cls=nib.Nifti1Pair), note="given by its voxels")
    add("pair_two.hdr", one(np.float32, cls=nib.Nifti2Pair, endian=">"))
    add("packed.nii.gz", one())
    series = np.arange(120).reshape(2, 3, 4, 5, order="F")
    for time in (0, 3):
        add(f"series_{time}.nii", one(data=series), units, time=time)
    add("series_packed.nii.gz", one(data=series, cls=nib.Nifti2Image), units, time=4)
    vectors = np.arange(96).reshape(2, 3, 4, 1, 4, order="F")
    add("vectors.nii", one(np.float32, data=vectors), component=2)
    both = np.arange(144).reshape(2, 3, 4, 2, 3, order="F")
    add("series_of_vectors.nii", one(np.int32, data=both), units, component=1, time=1)
    rgba = np.zeros((2, 3, 4), dtype=[("R", "u1"), ("G", "u1"), ("B", "u1"), ("A", "u1")])
    for index, channel in enumerate("RGBA"):
        rgba[channel] = grid * (index + 1)
    image = nib.Nifti1Image(rgba, turn)
    add("rgba.nii", image, component=3)
    extended = one()
    extended.header.extensions.append(nib.nifti1.Nifti1Extension("comment", b"several words" * 5))
    add("extension.nii", extended)
    patched("pixdim_zero.nii", one(affine=rigid), "0 is taken as 1, -3 as 3", neither, (80, np.array([0, -3], "<f4").tobytes()))
    turned = one(affine=rigid)
    q_only(turned.header)
    patched("qfac_zero.nii", turned, "taken as 1", (76, bytes(4)))
    patched("codes.nii", one(affine=rigid), "codes that do not exist are 0", (252, np.array([77, 99], "<i2").tobytes()))
    patched("slope_nan.nii", one(), "no slope", slope(np.nan, 3))
    patched("size_wrong.nii", one(), "nibabel takes it as 348", (0, np.array([347], "<i4").tobytes()))
    return rows


# VTI

def vti_row(file, path, part="", component="", note="", files=None, cells=False):
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    attributes = image.GetCellData() if cells else image.GetPointData()
    array = attributes.GetArray(part) if part else attributes.GetArray(0)
    extent = image.GetExtent()
    points = [extent[2 * i + 1] - extent[2 * i] + 1 for i in range(3)]
    dims = [max(n - 1, 1) for n in points] if cells else points
    data = vtk_to_numpy(array)
    if data.ndim > 1:
        data = data[:, component]
    data = data.reshape(dims, order="F")
    direction = image.GetDirectionMatrix()
    matrix = np.array([[direction.GetElement(i, j) for j in range(3)] for i in range(3)]) @ np.diag(image.GetSpacing())
    start = np.array([extent[0], extent[2], extent[4]], dtype=float)
    if cells:
        start += [0.5 if n > 1 else 0 for n in points]
    origin = matrix @ start + np.array(image.GetOrigin())
    return row(file, data, matrix.T, origin, part, component, note=note, files=files)


def vti_files(folder):
    rows = []
    for name in sorted(os.listdir(folder)):
        file, path = f"vti/{name}", os.path.join(folder, name)
        if name.startswith(("ttk_Built", "voreen")):
            rows.append(refused(file, "volume-component", "three values per voxel"))
            rows.extend(vti_row(file, path, component=c) for c in (0, 2))
        else:
            rows.append(vti_row(file, path))
    return rows


def vti_tiny():
    rows = []

    def image(dtype, components=1, extent=(0, 4, 0, 3, 0, 2), direction=None, cells=False):
        data = vtk.vtkImageData()
        data.SetExtent(*extent)
        data.SetOrigin(1, 2, 3)
        data.SetSpacing(0.5, 0.25, 2)
        if direction:
            data.SetDirectionMatrix(*direction)
        for attributes, count in ((data.GetPointData(), data.GetNumberOfPoints()), (data.GetCellData(), data.GetNumberOfCells())):
            if (attributes is data.GetCellData()) == cells:
                values = (np.arange(count * components) * 7 % 251).astype(dtype).reshape(count, components)
                array = numpy_to_vtk(values, deep=True)
                array.SetName("density")
                attributes.SetScalars(array)
        return data

    def add(name, data, mode="Appended", raw=False, compressor="ZLib", wide=False, big=False, pieces=1, note="", **options):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, name)
            writer = vtk.vtkXMLImageDataWriter()
            writer.SetFileName(path)
            writer.SetInputData(data)
            getattr(writer, f"SetDataModeTo{mode}")()
            writer.SetEncodeAppendedData(not raw)
            writer.SetCompressorType({"None": 0, "ZLib": 1, "LZ4": 2, "LZMA": 3}[compressor])
            writer.SetBlockSize(64)
            writer.SetHeaderTypeToUInt64() if wide else writer.SetHeaderTypeToUInt32()
            writer.SetByteOrderToBigEndian() if big else writer.SetByteOrderToLittleEndian()
            writer.SetNumberOfPieces(pieces)
            writer.Write()
            files = {name: open(path, "rb").read()}
            rows.append(vti_row(name, path, note=note, files=files, **options))

    add("ascii.vti", image(np.float32), mode="Ascii")
    add("ascii_int64.vti", image(np.int64), mode="Ascii")
    turn = (0, -1, 0, 1, 0, 0, 0, 0, 1)
    for mode, raw in (("Binary", False), ("Appended", False), ("Appended", True)):
        for compressor in ("None", "ZLib", "LZ4"):
            for wide, big in ((False, False), (True, True)):
                kind = f"{mode}{'_raw' if raw else ''}_{compressor}{'_wide_big' if wide else ''}".lower()
                add(f"{kind}.vti", image(np.uint16), mode, raw, compressor, wide, big)
    add("lzma.vti", image(np.uint16), compressor="LZMA")
    for dtype in (np.int8, np.uint8, np.int16, np.int32, np.uint32, np.uint64, np.float64):
        add(f"{np.dtype(dtype).name}.vti", image(dtype), raw=True, compressor="LZ4")
    add("extent.vti", image(np.float64, extent=(-3, 2, 5, 7, -1, 1)))
    add("direction.vti", image(np.float64, extent=(1, 4, 2, 5, -1, 1), direction=turn))
    add("cells.vti", image(np.float32, extent=(1, 4, 2, 6, -1, 1), direction=turn, cells=True), cells=True)
    add("cells_flat.vti", image(np.float32, extent=(0, 4, 0, 3, 2, 2), cells=True), cells=True)
    add("vectors.vti", image(np.float32, components=3), component=1)
    add("colors.vti", image(np.uint8, components=4), component=3)
    two = image(np.float32)
    other = numpy_to_vtk(np.arange(60, dtype=np.int16), deep=True)
    other.SetName("Temperature")
    two.GetPointData().AddArray(other)
    add("two.vti", two, part="Temperature")
    add("two_raw.vti", two, raw=True, part="density", compressor="None")
    add("pieces_alike.vti", image(np.float32), pieces=3, note="VTK writes the whole three times")

    def pieced(name, extents, cells=False, components=1):
        """VTK writes no pieces that are parts unless it runs in parallel; it reads them."""
        whole = (0, 4, -1, 2, 3, 5)
        dims = np.array([whole[1] - whole[0], whole[3] - whole[2], whole[5] - whole[4]]) + (0 if cells else 1)
        values = (np.arange(dims.prod() * components) * 7 % 251).reshape(*dims[::-1], components)
        body = ""
        for extent in extents:
            x0, x1, y0, y1, z0, z1 = np.array(extent) - [0, 0, -1, -1, 3, 3]
            more = 0 if cells else 1
            part = values[z0:z1 + more, y0:y1 + more, x0:x1 + more]
            text = " ".join(map(str, part.ravel()))
            array = f'<DataArray type="Int16" Name="a" NumberOfComponents="{components}" format="ascii">{text}</DataArray>'
            tag = "CellData" if cells else "PointData"
            body += f'<Piece Extent="{" ".join(map(str, extent))}"><{tag}>{array}</{tag}></Piece>\n'
        text = ('<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian">\n'
                f'<ImageData WholeExtent="{" ".join(map(str, whole))}" Origin="1 2 3" Spacing="1 2 3">\n{body}</ImageData></VTKFile>\n')
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, name)
            open(path, "w").write(text)
            component = 1 if components > 1 else ""
            rows.append(vti_row(name, path, component=component, cells=cells, files={name: text.encode()}))

    parts = [(0, 2, -1, 2, 3, 5), (2, 4, -1, 1, 3, 5), (2, 4, 1, 2, 3, 5)]
    pieced("pieces.vti", parts)
    pieced("pieces_cells.vti", parts, cells=True)
    pieced("pieces_vectors.vti", parts, components=3)
    return rows


# NumPy

def npy_tiny():
    rows = []

    def add(name, array, data=None, version=None, component=""):
        buffer = io.BytesIO()
        np.lib.format.write_array(buffer, array, version=version)
        data = array if data is None else data
        if component != "":
            data = data[..., component]
        data = data.astype(data.dtype.newbyteorder("=")).T
        if data.dtype == np.float16:
            data = data.astype(np.float32)
        if data.dtype == bool:
            data = data.astype(np.uint8)
        data = data.reshape(data.shape + (1,) * (3 - data.ndim))
        rows.append(row(name, data, np.eye(3), np.zeros(3), component=component, files={name: buffer.getvalue()}))

    def bad(name, array, code, note):
        buffer = io.BytesIO()
        np.lib.format.write_array(buffer, array)
        rows.append(refused(name, code, note, {name: buffer.getvalue()}))

    cube = (np.arange(60) * 7 % 251).reshape(3, 4, 5)
    for dtype in ("u1", "i1", "<u2", ">u2", "<i2", "<u4", ">i4", "<u8", ">i8", "<f2", ">f2", "<f4", ">f4", "<f8", ">f8"):
        name = dtype.replace("<", "little_").replace(">", "big_")
        add(f"{name}.npy", (cube / (4 if "f" in dtype else 1)).astype(dtype) if dtype != "i1" else (cube - 128).astype(dtype))
    add("bool.npy", cube % 3 == 0)
    add("fortran.npy", np.asfortranarray(cube.astype("<i2")))
    add("fortran_big_half.npy", np.asfortranarray((cube / 8).astype(">f2")))
    add("one_axis.npy", np.arange(7, dtype="<f4"))
    add("two_axes.npy", np.arange(12, dtype="<i4").reshape(3, 4))
    add("two_axes_fortran.npy", np.asfortranarray(np.arange(12, dtype="<i4").reshape(3, 4)))
    vectors = np.arange(180, dtype="<f4").reshape(3, 4, 5, 3)
    add("vectors.npy", vectors, component=2)
    add("vectors_fortran.npy", np.asfortranarray(vectors), component=1)
    add("colors.npy", np.arange(240, dtype="u1").reshape(3, 4, 5, 4), component=0)
    add("version_2.npy", cube.astype("<f4"), version=(2, 0))
    add("version_3.npy", cube.astype("<f4"), version=(3, 0))
    bad("objects.npy", np.array([None, 3], dtype=object), "volume-unsupported", "Python objects")
    bad("complex.npy", cube.astype("c8"), "volume-unsupported", "complex numbers")
    bad("text.npy", np.array(["a", "bc"]), "volume-unsupported", "text")
    bad("times.npy", np.zeros(3, dtype="M8[s]"), "volume-unsupported", "dates")
    bad("long_double.npy", np.zeros((2, 2, 2), dtype=np.longdouble), "volume-unsupported", "80 bits")
    bad("structured.npy", np.zeros(3, dtype=[("a", "f4"), ("b", "i2")]), "volume-unsupported", "fields")
    bad("four_axes.npy", np.zeros((2, 2, 2, 9), dtype="u1"), "volume-unsupported", "nobody knows what the last axis is")
    bad("scalar.npy", np.array(3.0), "volume-unsupported", "no axes")
    bad("empty.npy", np.zeros((0, 3, 3), dtype="u1"), "volume-grid", "no samples")
    return rows


data_folder = sys.argv[1]
write("expected_nifti.tsv", nifti_files(os.path.join(data_folder, "nifti")) + nifti_tiny())
write("expected_vti.tsv", vti_files(os.path.join(data_folder, "vti")) + vti_tiny())
write("expected_npy.tsv", npy_tiny())
