"""Writes zarr_files.tsv and expected_zarr.tsv beside this script.

    python make_zarr.py        (needs: pip install zarr numpy)

zarr_files.tsv holds small Zarr folders that zarr-python wrote: case, path inside of it, bytes in hexadecimal.
expected_zarr.tsv has what zarr-python reads from them again: case, part, level, component, time step, outcome, type,
dimensions x y z, columns of world_from_index, origin, min, max, mean, and the mean of voxel * (index mod 1009) with x
fastest.
"""

import os
import tempfile

import numpy as np
import zarr
from zarr.codecs import BloscCodec, BytesCodec, Crc32cCodec, GzipCodec, ShardingCodec, TransposeCodec, ZstdCodec

HERE = os.path.dirname(os.path.abspath(__file__))
COLUMNS = ["case", "part", "level", "component", "time", "outcome", "type", "dims", "columns", "origin", "min", "max",
           "mean", "weighted"]
rng = np.random.default_rng(7)


def numbers(values):
    return " ".join(repr(float(v)) for v in np.ravel(values))


def row(case, data, scale=(1, 1, 1), origin=(0, 0, 0), part="", level="", component="", time="", ty=None):
    """`data` is z, y, x; scale and origin are x, y, z."""
    flat = np.asarray(data).astype(np.float64).ravel()
    weighted = (flat * (np.arange(flat.size) % 1009)).mean()
    return [case, part, level, component, time, "ok", ty or str(data.dtype),
            " ".join(str(n) for n in data.shape[::-1]), numbers(np.diag(scale)), numbers(origin),
            repr(float(flat.min())), repr(float(flat.max())), repr(float(flat.mean())), repr(float(weighted))]


def refused(case, code, part="", level="", component="", time=""):
    return [case, part, level, component, time, code, *[""] * 8]


def values(shape, dtype):
    dtype = np.dtype(dtype)
    if dtype.kind == "f":
        return (rng.integers(-800, 800, shape) / 8).astype(dtype)
    if dtype.kind == "b":
        return rng.integers(0, 2, shape).astype(bool)
    info = np.iinfo(dtype)
    small = rng.integers(max(info.min, -100), 100, shape).astype(dtype)
    return small


def main():
    rows, files = [], []
    with tempfile.TemporaryDirectory() as folder:
        def at(case):
            return os.path.join(folder, case)

        shape, chunks = (5, 6, 7), (2, 4, 3)

        def plain(case, dtype, **more):
            data = values(shape, dtype)
            array = zarr.create_array(at(case), shape=shape, chunks=more.pop("chunks", chunks), dtype=dtype, **more)
            array[...] = data
            back = zarr.open_array(at(case), mode="r")[...]
            assert (back == data).all()
            ty = {"bool": "uint8", "float16": "float32"}.get(np.dtype(dtype).name, np.dtype(dtype).newbyteorder("=").name)
            rows.append(row(case, back.astype(ty), ty=ty))

        for dtype in ["bool", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float16",
                      "float32", "float64"]:
            plain(f"v3_{dtype}", dtype, compressors=ZstdCodec(level=3), fill_value=0)
        for dtype in [">i2", "<u4", ">f4", "<f2", ">f8"]:
            plain(f"v2_{'big' if dtype[0] == '>' else 'little'}_{dtype[1:]}", dtype, zarr_format=2, compressors=None)
        import numcodecs
        for name, compressor in [("zlib", numcodecs.Zlib(4)), ("gzip", numcodecs.GZip(4)), ("zstd", numcodecs.Zstd(3)),
                                 ("bz2", numcodecs.BZ2(5))]:
            plain(f"v2_{name}", "int16", zarr_format=2, compressors=compressor, order="F" if name == "zlib" else "C")
        for cname in ["blosclz", "lz4", "lz4hc", "zlib", "zstd"]:
            for shuffle in [0, 1, 2]:
                plain(f"v2_blosc_{cname}_{shuffle}", "int32", zarr_format=2,
                      compressors=numcodecs.Blosc(cname=cname, clevel=5, shuffle=shuffle), chunks=(5, 6, 7))
        plain("v3_blosc", "float32", compressors=BloscCodec(cname="zstd", shuffle="bitshuffle", typesize=4))
        plain("v3_gzip_crc", "uint16", compressors=[GzipCodec(level=5), Crc32cCodec()])
        plain("v3_big", "int32", serializer=BytesCodec(endian="big"), compressors=None)
        plain("v3_transposed", "int16", filters=[TransposeCodec(order=(2, 0, 1))], compressors=ZstdCodec())
        plain("v3_sharded", "int16", shards=(4, 8, 6), compressors=ZstdCodec())
        plain("v3_shard_start", "uint8", chunks=(4, 8, 6), compressors=None, serializer=ShardingCodec(
            chunk_shape=(2, 4, 3), codecs=[BytesCodec(), GzipCodec()], index_location="start"))
        plain("v3_dots", "uint8", chunk_key_encoding={"name": "v2", "separator": "."})

        # Chunks that are not there, and a fill value.
        for version in (2, 3):
            case = f"v{version}_holes"
            array = zarr.create_array(at(case), shape=shape, chunks=chunks, dtype="float32", fill_value=-3.5,
                                      zarr_format=version)
            array[2:4, 0:4, 3:6] = values((2, 4, 3), "float32")
            rows.append(row(case, array[...]))

        # Fewer and more axes.
        array = zarr.create_array(at("one_axis"), shape=(9,), chunks=(4,), dtype="uint8")
        array[...] = values((9,), "uint8")
        rows.append(row("one_axis", array[...].reshape(1, 1, 9)))
        array = zarr.create_array(at("five_axes"), shape=(2, 3, 4, 5, 6), chunks=(1, 1, 4, 5, 6), dtype="uint8")
        array[...] = values((2, 3, 4, 5, 6), "uint8")
        rows.append(refused("five_axes", "volume-component"))
        rows.append(row("five_axes", array[1, 2], component="5"))
        array = zarr.create_array(at("named"), shape=(3, 4, 5, 6), chunks=(1, 2, 5, 6), dtype="int16",
                                  dimension_names=["x", "t", "z", "y"])
        array[...] = values((3, 4, 5, 6), "int16")
        rows.append(row("named", array[:, 2].transpose(1, 2, 0), time="2"))

        # A group of arrays.
        group = zarr.create_group(at("group"))
        for name in ("density", "deep/speed"):
            array = group.create_array(name, shape=shape, chunks=chunks, dtype="float32")
            array[...] = values(shape, "float32")
            rows.append(row("group", array[...], part=name.split("/")[-1][:4]))
        rows.append(refused("group", "volume-option"))
        rows.append(refused("group", "volume-option", part="mass"))
        zarr.create_group(at("empty_group"))
        rows.append(refused("empty_group", "volume-missing-field"))

        # OME-Zarr: two channels, three steps, two levels, labels.
        def ome(case, version, axes):
            zarr_format = 2 if version == "0.4" else 3
            group = zarr.create_group(at(case), zarr_format=zarr_format)
            labels = group.create_group("labels")
            datasets = []
            for level, (nz, ny, nx) in enumerate([(6, 8, 10), (3, 4, 5)]):
                factor = 2**level
                more = {"dimension_names": list("tczyx")} if zarr_format == 3 else {}
                array = group.create_array(str(level), shape=(3, 2, nz, ny, nx), chunks=(1, 1, 6, 4, 10),
                                           dtype="uint16", **more)
                array[...] = values(array.shape, "uint16")
                scale = [1.0, 1.0, 2.0 * factor, 0.5 * factor, 0.25 * factor]
                shift = [0.0, 0.0, 2.0 * level + 10, 0.25 * level, 0.125 * level]
                datasets.append({"path": str(level), "coordinateTransformations": [
                    {"type": "scale", "scale": scale}, {"type": "translation", "translation": shift}]})
                # All levels are scaled again: 3 in space, 0.5 s a step.
                for time in (0, 2):
                    rows.append(row(case, array[time, 1], [3 * s for s in scale[:1:-1]], [3 * s for s in shift[:1:-1]],
                                    level=str(level), component="1", time=str(time)))
            multiscales = {"name": "cells", "axes": axes, "datasets": datasets, "coordinateTransformations": [
                {"type": "scale", "scale": [0.5, 1, 3, 3, 3]}]}
            omero = {"channels": [{"label": "nuclei", "color": "0000FF"}, {"label": "actin", "color": "00FF00"}]}
            names = {"multiscales": [{"axes": axes[2:], "datasets": [
                {"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [2, 1, 0.5]}]}]}],
                "image-label": {"properties": [{"label-value": 1, "name": "one"}, {"label-value": 7, "name": "seven"}]}}
            nuclei = labels.create_group("nuclei")
            array = nuclei.create_array("0", shape=(3, 4, 5), chunks=(3, 4, 5), dtype="uint8")
            array[...] = values((3, 4, 5), "uint8") % 3
            rows.append(row(case, array[...], (0.5, 1, 2), part="labels/nuclei"))
            if version == "0.4":
                multiscales["version"] = "0.4"
                group.attrs.update({"multiscales": [multiscales], "omero": omero})
                labels.attrs.update({"labels": ["nuclei"]})
                nuclei.attrs.update(names)
            else:
                group.attrs["ome"] = {"version": version, "multiscales": [multiscales], "omero": omero}
                labels.attrs["ome"] = {"version": version, "labels": ["nuclei"]}
                nuclei.attrs["ome"] = {"version": version, **names}
            rows.append(refused(case, "volume-option", level="2", component="0"))
            rows.append(refused(case, "volume-option", time="3", component="0"))

        axes = [{"name": "t", "type": "time", "unit": "second"}, {"name": "c", "type": "channel"}] + [
            {"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
        ome("ome_0_4", "0.4", axes)
        ome("ome_0_5", "0.5", axes)

        # What is refused.
        zarr.create_array(at("complex"), shape=(2, 2, 2), chunks=(2, 2, 2), dtype="complex64")
        rows.append(refused("complex", "volume-unknown-type"))

        for case in sorted({row[0] for row in rows}):
            for where, _, names in sorted(os.walk(at(case))):
                for name in sorted(names):
                    path = os.path.join(where, name)
                    with open(path, "rb") as file:
                        files.append([case, os.path.relpath(path, at(case)), file.read().hex()])
    for name, head, lines in [("zarr_files.tsv", ["case", "path", "hex"], files), ("expected_zarr.tsv", COLUMNS, rows)]:
        with open(os.path.join(HERE, name), "w") as out:
            out.write("".join("\t".join(line) + "\n" for line in [head, *lines]))


main()
