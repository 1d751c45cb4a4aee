"""Writes zarr_zip.tsv beside this script.

    python make_zarr_zip.py        (needs: pip install zarr numpy)

Small zip archives that zarr-python's ZipStore wrote, or that hold a folder which it wrote: case, what zarr-python reads
from them again (type, dimensions x y z, min, max, the mean of voxel * (index mod 1009) with x fastest), the archive in
hexadecimal.
"""

import os
import tempfile
import zipfile

import numpy as np
import zarr
from zarr.codecs import GzipCodec, ZstdCodec

HERE = os.path.dirname(os.path.abspath(__file__))
COLUMNS = ["case", "type", "dims", "min", "max", "weighted", "hex"]
rng = np.random.default_rng(11)
rows = []


def row(path, array):
    data = array[...]
    flat = data.astype(np.float64).ravel()
    weighted = (flat * (np.arange(flat.size) % 1009)).mean()
    with open(path, "rb") as file:
        rows.append([os.path.basename(path), data.dtype.name, " ".join(map(str, data.shape[::-1])),
                     repr(float(flat.min())), repr(float(flat.max())), repr(float(weighted)), file.read().hex()])


def stored(folder, name, compression=zipfile.ZIP_STORED, **options):
    path = os.path.join(folder, name)
    data = rng.integers(-100, 100, (5, 6, 7)).astype("int16")
    store = zarr.storage.ZipStore(path, mode="w", compression=compression)
    array = zarr.create_array(store, shape=data.shape, dtype="int16", **options)
    array[...] = data
    store.close()
    store = zarr.storage.ZipStore(path, mode="r")
    row(path, zarr.open_array(store, mode="r"))
    store.close()


def zipped(folder, name, below, write, compression=zipfile.ZIP_DEFLATED, comment=b""):
    path, inner = os.path.join(folder, name), os.path.join(folder, name + ".folder")
    array = write(inner)
    with zipfile.ZipFile(path, "w", compression) as archive:
        archive.comment = comment
        for parent, _, files in os.walk(inner):
            for file in sorted(files, reverse=True):
                full = os.path.join(parent, file)
                archive.write(full, os.path.join(below, os.path.relpath(full, inner)))
    row(path, array)


def image(inner):
    group = zarr.create_group(inner, zarr_format=3)
    for level, shape in enumerate([(6, 8, 10), (3, 4, 5)]):
        array = group.create_array(str(level), shape=shape, chunks=(3, 4, 5), dtype="uint8",
                                   shards=(6, 8, 10) if level == 0 else None, compressors=ZstdCodec())
        array[...] = rng.integers(0, 200, shape)
    group.attrs["ome"] = {"version": "0.5", "multiscales": [{
        "axes": [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"],
        "datasets": [{"path": str(level), "coordinateTransformations": [
            {"type": "scale", "scale": [2.0 ** level] * 3}, {"type": "translation", "translation": [level / 2] * 3}]}
            for level in range(2)]}]}
    return group["0"]


def main():
    with tempfile.TemporaryDirectory() as folder:
        chunks, shards = (2, 3, 4), (4, 6, 8)
        stored(folder, "v2.zarr.zip", zarr_format=2, chunks=chunks)
        stored(folder, "v3.zarr.zip", chunks=chunks, compressors=GzipCodec())
        stored(folder, "plain.zarr.zip", chunks=chunks, compressors=None)
        stored(folder, "shards.zarr.zip", chunks=chunks, shards=shards)
        stored(folder, "deflated.zarr.zip", zipfile.ZIP_DEFLATED, chunks=chunks, compressors=None)
        stored(folder, "deflated_shards.zip", zipfile.ZIP_DEFLATED, chunks=chunks, shards=shards, compressors=None)
        zipped(folder, "image.ozx", "", image, zipfile.ZIP_STORED, b'{"ome": {"version": "0.5"}}')
        zipped(folder, "below.zip", "cells.zarr", image)
    with open(os.path.join(HERE, "zarr_zip.tsv"), "w", newline="\n") as file:
        for cells in [COLUMNS, *rows]:
            file.write("\t".join(cells) + "\n")


if __name__ == "__main__":
    main()
