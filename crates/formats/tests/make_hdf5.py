"""Writes expected_hdf5.tsv beside this script.

    python make_hdf5.py        (needs: pip install h5py netCDF4 xarray SimpleITK numpy)

A row per reading of a tiny file that h5py, netCDF4, xarray or SimpleITK wrote; its bytes are in the table too (zlib,
hexadecimal, `name:hex`). Columns as in make_expected_nifti_vti_npy.py. The values are those that were read again by
the software that wrote them.
"""

import os
import tempfile
import zlib

import h5py
import netCDF4
import numpy as np
import SimpleITK as sitk
import xarray as xr

HERE = os.path.dirname(os.path.abspath(__file__))
COLUMNS = ["file", "part", "component", "time", "outcome", "type", "dims", "columns", "origin", "min", "max", "mean",
           "weighted", "probes", "unit", "step_time", "note", "bytes"]
rng = np.random.default_rng(5)
rows = []


def numbers(values):
    return " ".join(repr(float(v) + 0.0) for v in np.ravel(values))


def packed(path):
    with open(path, "rb") as file:
        return f"{os.path.basename(path)}:{zlib.compress(file.read(), 9).hex()}"


def ok(path, data, columns=np.eye(3), origin=(0, 0, 0), part="", component="", time="", unit="", step_time="",
       note="", ty=None):
    """`data` is indexed z, y, x; `columns` has one row for each axis of the grid."""
    flat = np.asarray(data).astype(ty or data.dtype.newbyteorder("=")).ravel()
    wide = flat.astype(np.float64)
    finite = wide[np.isfinite(wide)]
    weighted = (wide * (np.arange(wide.size) % 1009)).mean()
    probes = " ".join(f"{i}:{float(flat[i])!r}" for i in np.linspace(0, flat.size - 1, 10).astype(int))
    mean = finite.mean()
    rows.append([os.path.basename(path), part, component, time, "ok", flat.dtype.name,
                 " ".join(map(str, data.shape[::-1])), numbers(columns), numbers(origin), repr(float(finite.min())),
                 repr(float(finite.max())), repr(float(mean)), repr(float(weighted)), probes, unit, step_time, note,
                 packed(path)])


def refused(path, code, note, part="", component="", time=""):
    rows.append([os.path.basename(path), part, component, time, code, *[""] * 11, note, packed(path)])


def values(shape, dtype):
    dtype = np.dtype(dtype)
    if dtype.kind == "f":
        return (rng.integers(-800, 800, shape) / 8).astype(dtype)
    if dtype.kind == "b":
        return rng.integers(0, 2, shape).astype(bool)
    return rng.integers(max(np.iinfo(dtype).min, -100), 100, shape).astype(dtype)


def written(folder, name, write, **options):
    path = os.path.join(folder, name)
    with h5py.File(path, "w", **options) as file:
        write(file)
    return path


def types(folder):
    for dtype in ["|u1", "|i1", "<u2", ">u2", "<i2", ">i2", "<u4", ">u4", "<i4", ">i4", "<u8", ">u8", "<i8", ">i8",
                  "<f2", ">f2", "<f4", ">f4", "<f8", ">f8", "|b1"]:
        data = values((3, 4, 5), dtype)
        name = f"{ {'<': 'little', '>': 'big', '|': 'one'}[dtype[0]]}_{dtype[1:]}.h5"
        path = written(folder, name, lambda file: file.create_dataset("volume", data=data))
        ty = {"b1": "uint8", "f2": "float32"}.get(dtype[1:])
        with h5py.File(path) as file:
            ok(path, file["volume"][...], ty=ty)


def layouts(folder):
    data = values((5, 6, 7), "<u2")
    chunks = (2, 4, 3)
    cases = {
        "chunked": dict(chunks=chunks),
        "gzip": dict(chunks=chunks, compression="gzip", shuffle=True, fletcher32=True),
        "lzf": dict(chunks=chunks, compression="lzf", shuffle=True),
        "lzf_long": dict(chunks=(5, 6, 7), compression="lzf"),
        "grows": dict(chunks=chunks, compression="gzip", maxshape=(None, 6, 7)),
        "grows_twice": dict(chunks=chunks, maxshape=(None, None, 7)),
        "one_chunk": dict(chunks=(5, 6, 7), compression="gzip"),
        "scaled": dict(chunks=chunks, scaleoffset=0),
    }
    for libver in ["earliest", "v108", "v110", "v112", "latest"]:
        for case, options in cases.items():
            if libver not in ("earliest", "latest") and case not in ("gzip", "grows"):
                continue
            path = written(folder, f"{case}_{libver}.h5", lambda file: file.create_dataset("a/b", data=data, **options),
                           libver=(libver, "latest"))
            with h5py.File(path) as file:
                ok(path, file["a/b"][...])
    # Long runs, so that LZF has long and near repeats.
    long = np.repeat(np.arange(8, dtype="<u2"), 300).reshape(8, 15, 20)
    path = written(folder, "lzf_runs.h5", lambda file: file.create_dataset("a", data=long, compression="lzf"))
    ok(path, long)
    path = written(folder, "user_block.h5", lambda file: file.create_dataset("a", data=data), userblock_size=512)
    ok(path, data)
    path = written(folder, "long_block.h5", lambda file: file.create_dataset("a", data=data), userblock_size=1024)
    ok(path, data)

    def compact(file):
        plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        plist.set_layout(h5py.h5d.COMPACT)
        space = h5py.h5s.create_simple((3, 4, 5))
        inner = h5py.h5d.create(file.id, b"compact", h5py.h5t.STD_I16BE, space, plist)
        inner.write(h5py.h5s.ALL, h5py.h5s.ALL, np.arange(60, dtype="i2").reshape(3, 4, 5))
    path = written(folder, "compact.h5", compact)
    ok(path, np.arange(60, dtype="i2").reshape(3, 4, 5))

    def holes(file):
        array = file.create_dataset("a", (6, 4, 5), "<f4", chunks=(2, 4, 5), fillvalue=-2.5)
        array[2:4] = values((2, 4, 5), "<f4")
    path = written(folder, "holes.h5", holes)
    with h5py.File(path) as file:
        ok(path, file["a"][...])


def axes(folder):
    for shape in [(9,), (4, 6)]:
        data = values(shape, "<i2")
        path = written(folder, f"axes_{len(shape)}.h5", lambda file: file.create_dataset("a", data=data))
        ok(path, data.reshape((1,) * (3 - len(shape)) + shape))
    data = values((3, 4, 5, 3), "<i2")
    path = written(folder, "vectors.h5", lambda file: file.create_dataset("a", data=data))
    refused(path, "volume-component", "three values per voxel")
    ok(path, data[..., 1], component=1)
    data = values((6, 4, 5, 7), "<i2")
    path = written(folder, "steps.h5", lambda file: file.create_dataset("a", data=data, chunks=(1, 2, 5, 7),
                                                                          compression="gzip"))
    ok(path, data[0])
    ok(path, data[4], time=4)
    data = values((2, 4, 5, 6, 3), "<i2")
    path = written(folder, "five_axes.h5", lambda file: file.create_dataset("a", data=data))
    ok(path, data[1, ..., 2], time=1, component=2)
    data = values((2, 3, 4, 5, 6, 7), "|u1")
    path = written(folder, "six_axes.h5", lambda file: file.create_dataset("a", data=data))
    refused(path, "volume-unsupported", "six axes")

    def labelled(file):
        array = file.create_dataset("a", data=values((4, 3, 5, 2), "<i2"))
        for axis, label in zip(array.dims, ["x", "t", "y", "z"]):
            axis.label = label
    path = written(folder, "labelled.h5", labelled)
    with h5py.File(path) as file:
        ok(path, file["a"][:, 1].transpose(2, 1, 0), time=1)
    tags = ('{"axes": [{"key": "c", "typeFlags": 1, "resolution": 0, "description": ""}, {"key": "z", "typeFlags": 2},'
            ' {"key": "y", "typeFlags": 2}, {"key": "x", "typeFlags": 2}]}')

    def ilastik(file):
        file.create_dataset("exported_data", data=values((2, 3, 4, 5), "<f4")).attrs["axistags"] = tags
    path = written(folder, "ilastik.h5", ilastik)
    with h5py.File(path) as file:
        ok(path, file["exported_data"][1], component=1)


def places(folder):
    data = values((3, 4, 5), "<u2")

    def sized(file):
        file.create_dataset("t0/channel0", data=data).attrs["element_size_um"] = [2.0, 0.5, 0.25]
    path = written(folder, "element_size.h5", sized)
    ok(path, data, np.diag([0.25, 0.5, 2.0]), unit="µm")

    def unclear(file):
        array = file.create_dataset("a", data=data)
        array.attrs["spacing"] = [2.0, 0.5, 0.25]
        array.attrs["origin"] = [0.0, 1.0, 2.0]
    path = written(folder, "unclear.h5", unclear)
    ok(path, data, note="a warning: see hdf5.rs")

    image = sitk.GetImageFromArray(data)
    image.SetSpacing((0.5, 0.75, 2))
    image.SetOrigin((10, -20, 30))
    c, s = np.cos(0.3), np.sin(0.3)
    image.SetDirection((c, -s, 0, s, c, 0, 0, 0, 1))
    path = os.path.join(folder, "itk.h5")
    sitk.WriteImage(image, path)
    image = sitk.ReadImage(path)
    columns = (np.array(image.GetDirection()).reshape(3, 3) * np.array(image.GetSpacing())).T
    ok(path, sitk.GetArrayFromImage(image), columns, image.GetOrigin())
    flat = sitk.GetImageFromArray(data[0])
    flat.SetSpacing((0.5, 0.75))
    path = os.path.join(folder, "itk_flat.h5")
    sitk.WriteImage(flat, path)
    ok(path, data[:1], np.diag([0.5, 0.75, 0.5]))
    vectors = sitk.GetImageFromArray(values((3, 4, 5, 2), "<f4"), isVector=True)
    path = os.path.join(folder, "itk_vectors.h5")
    sitk.WriteImage(vectors, path)
    ok(path, sitk.GetArrayFromImage(vectors)[..., 1], component=1)


def netcdf(folder):
    path = os.path.join(folder, "netcdf.nc")
    with netCDF4.Dataset(path, "w") as file:
        for name, size in [("time", None), ("lev", 3), ("lat", 4), ("lon", 5)]:
            file.createDimension(name, size)
        for name, start, step, unit in [("lev", 100, 50, "m"), ("lat", 60, -10, "m"), ("lon", -4, 2, "m")]:
            variable = file.createVariable(name, "f4", (name,))
            variable[:] = start + step * np.arange(len(file.dimensions[name]))
            variable.units = unit
        time = file.createVariable("time", "f8", ("time",))
        time[:] = [0, 6]
        time.units = "hours since 2000-01-01"
        packed_values = file.createVariable("speed", "i2", ("time", "lev", "lat", "lon"), zlib=True, fill_value=-999)
        packed_values.scale_factor = 0.25
        packed_values.add_offset = 10.0
        packed_values.units = "m/s"
        data = np.ma.array(10 + 0.25 * rng.integers(-50, 50, (2, 3, 4, 5)), mask=False)
        packed_values[:] = data
    with netCDF4.Dataset(path) as file:
        data = np.asarray(file["speed"][...]).astype("f4")
    columns, origin = np.diag([2, -10, 50]), (-4, 60, 100)
    for step in (0, 1):
        ok(path, data[step], columns, origin, time=step, unit="m", step_time=repr([0.0, 6.0][step]))

    path = os.path.join(folder, "xarray.nc")
    data = values((3, 4, 5), "<f4")
    xr.DataArray(data, dims=("z", "y", "x"), name="density",
                 coords={"x": np.linspace(0, 1, 5), "y": np.linspace(2, 5, 4), "z": [0.0, 2.0, 4.0]},
                 attrs={"units": "kg m-3"}).to_netcdf(path, engine="h5netcdf")
    ok(path, xr.open_dataarray(path).values, np.diag([0.25, 1, 2]), (0, 2, 0))

    path = os.path.join(folder, "uneven.nc")
    xr.DataArray(data, dims=("z", "y", "x"), name="density", coords={"z": [0.0, 2.0, 10.0]}).to_netcdf(path)
    ok(path, data, np.diag([1, 1, 5]))

    path = os.path.join(folder, "masked.nc")
    with netCDF4.Dataset(path, "w") as file:
        for name, size in [("z", 2), ("y", 3), ("x", 4)]:
            file.createDimension(name, size)
        heat = file.createVariable("heat", "f4", ("z", "y", "x"), fill_value=9.96921e36)
        heat.units = "K"
        heat[:] = np.ma.array(np.arange(24.0).reshape(2, 3, 4), mask=np.isin(np.arange(24), [3, 23]).reshape(2, 3, 4))
    rows.append(["masked.nc", "", "", "", "ok", "float32", "4 3 2", numbers(np.eye(3)), "0.0 0.0 0.0", "0.0", "22.0",
                 repr(float((np.arange(23).sum() - 3) / 22)), "nan", "", "", "", "see told.rs", packed(path)])

    path = os.path.join(folder, "bare_dimensions.nc")
    xr.DataArray(data, dims=("a", "b", "d"), name="density").to_netcdf(path, engine="netcdf4")
    ok(path, data)


def choices(folder):
    one, two = values((3, 4, 5), "|u1"), values((4, 4, 4), "<i4")

    def several(file):
        file["raw/ct"] = one
        file["raw/pet"] = two
        file["table"] = np.arange(6.0)
        file["note"] = "text"
        file["again"] = h5py.SoftLink("/raw")
        file["away"] = h5py.ExternalLink("other.h5", "/a")
        file["itself"] = file["/"]
    path = written(folder, "several.h5", several)
    refused(path, "volume-option", "two volumes")
    refused(path, "volume-option", "no such part", part="mr")
    ok(path, one, part="raw/ct")
    ok(path, two, part="pet")
    ok(path, np.arange(6.0).reshape(1, 1, 6), part="table")

    def many(file):
        for i in range(12):
            file[f"group/small_{i}"] = np.float32(i)
            file["group"].attrs[f"attribute_{i}"] = i
        file["group/volume"] = one
        for i in range(12):
            file["group/volume"].attrs[f"attribute_{i}"] = "text" * i
    for libver in ("earliest", "latest"):
        path = written(folder, f"many_{libver}.h5", many, libver=libver)
        ok(path, one)

    def nothing(file):
        file["note"] = "text"
    refused(written(folder, "nothing.h5", nothing), "volume-missing-field", "no array")

    def structures(file):
        file["a"] = np.zeros((2, 2, 2), [("a", "<i4"), ("b", "<f4")])
        file["b"] = np.zeros((2, 2, 2), "<c8")
    refused(written(folder, "structures.h5", structures), "volume-missing-field", "structures and complex numbers")

    def bits(file):
        twelve = h5py.h5t.STD_U16LE.copy()
        twelve.set_precision(12)
        space = h5py.h5s.create_simple((2, 3, 4))
        h5py.h5d.create(file.id, b"bits", twelve, space)
    refused(written(folder, "bits.h5", bits), "volume-unknown-type", "12 bits of 16")

    def elsewhere(file):
        file.create_dataset("a", (2, 3, 4), "<i2", external=[("voxels.raw", 0, 48)])
    refused(written(folder, "elsewhere.h5", elsewhere), "volume-unsupported", "values in another file")

    def linked(file):
        file["a"] = one
        file["latest"] = h5py.SoftLink("/a")
    path = written(folder, "linked.h5", linked)
    ok(path, one)
    ok(path, one, part="latest")

    def virtual(file):
        layout = h5py.VirtualLayout((2, 3, 4), "<i2")
        layout[0] = h5py.VirtualSource("other.h5", "a", (3, 4))
        file.create_virtual_dataset("a", layout)
    refused(written(folder, "virtual.h5", virtual), "volume-unsupported", "a virtual array")

    def filtered(file):
        space = h5py.h5s.create_simple((2, 3, 4))
        plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        plist.set_chunk((2, 3, 4))
        plist.set_szip(h5py.h5z.SZIP_NN_OPTION_MASK, 8)
        inner = h5py.h5d.create(file.id, b"a", h5py.h5t.STD_I16LE, space, plist)
        inner.write(h5py.h5s.ALL, h5py.h5s.ALL, np.arange(24, dtype="i2").reshape(2, 3, 4))
    path = written(folder, "szip.h5", filtered)
    ok(path, np.arange(24, dtype="i2").reshape(2, 3, 4))


def main():
    with tempfile.TemporaryDirectory() as folder:
        for step in [types, layouts, axes, places, netcdf, choices]:
            step(folder)
    with open(os.path.join(HERE, "expected_hdf5.tsv"), "w", newline="\n") as file:
        for cells in [COLUMNS, *rows]:
            assert len(cells) == len(COLUMNS), cells
            file.write("\t".join(map(str, cells)) + "\n")


if __name__ == "__main__":
    main()
