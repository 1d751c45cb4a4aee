"""The TIFF, PNG and JPEG files of make_slices.py, written by tifffile and pillow."""

import os
import shutil

import numpy as np
import tifffile
from PIL import Image

from slices_table import HERE, ROWS, add, folder, random, refuse, rng


def tiffs():
    shutil.rmtree(os.path.join(HERE, "tiff"), ignore_errors=True)
    base = folder("tiff")

    def write(name, data, dtype=None, columns=np.eye(3), component="", expected=None, warns="", **more):
        path = os.path.join(base, name)
        tifffile.imwrite(path, data, **more)
        assert os.path.getsize(path) < 5000, (path, os.path.getsize(path))
        stack = tifffile.imread(path) if expected is None else expected
        add("tiff/" + name, "tifffile", dtype or str(stack.dtype), stack, columns, component=component, warns=warns)

    gray = dict(photometric="minisblack", metadata=None)
    for name in ("uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float16", "float32", "float64"):
        dtype = np.dtype(name)
        data = random((3, 4, 6), dtype) if dtype.kind in "ui" else rng.normal(0, 100, (3, 4, 6)).astype(dtype)
        if dtype.itemsize == 8 and dtype.kind in "ui":
            data = data >> 12
        write(f"{name}.tif", data, "float32" if name == "float16" else name, **gray)
        write(f"{name}_be.tif", data, "float32" if name == "float16" else name, byteorder=">", **gray)
    data = random((2, 9, 7), np.uint16, 0, 50)
    write("big.tif", data, bigtiff=True, **gray)
    write("big_be.tif", data, bigtiff=True, byteorder=">", **gray)
    for name, more in (("lzw", dict(compression="lzw")), ("lzw_predictor", dict(compression="lzw", predictor=True)),
                       ("deflate", dict(compression="zlib")), ("deflate_predictor", dict(compression="zlib", predictor=True)),
                       ("packbits", dict(compression="packbits"))):
        write(f"{name}.tif", data, rowsperstrip=4, **gray, **more)
    floats = rng.normal(0, 1, (2, 16, 16)).astype(np.float32)
    write("float_predictor.tif", floats, compression="zlib", predictor=3, **gray)
    tall = random((2, 20, 24), np.uint8)
    write("tiles.tif", tall, tile=(16, 16), **gray)
    write("tiles_deflate.tif", tall, tile=(16, 16), compression="zlib", **gray)
    color = random((2, 5, 6, 3), np.uint8)
    write("rgb.tif", color, expected=color[..., 2], component=2, photometric="rgb", metadata=None)
    planes = np.moveaxis(color, 3, 1)
    write("rgb_planes.tif", planes, expected=color[..., 2], component=2, photometric="rgb", planarconfig="separate",
          metadata=None)
    write("rgba.tif", random((5, 6, 4), np.uint16), photometric="rgb", extrasamples=["unassalpha"], metadata=None,
          expected=np.zeros((1, 5, 6), np.uint16), component=3)
    ROWS.pop()
    add("tiff/rgba.tif", "tifffile", "uint16", tifffile.imread(os.path.join(base, "rgba.tif"))[None, ..., 3], component=3)
    write("white_is_zero.tif", data, photometric="miniswhite", metadata=None, warns="zero is white")
    write("palette.tif", random((2, 5, 6), np.uint8), photometric="palette", metadata=None, warns="palette",
          colormap=random((3, 256), np.uint16))
    bits = rng.random((2, 5, 11)) < 0.5
    write("bits.tif", bits, "uint8", **gray)
    write("resolution.tif", data, columns=np.diag([0.1, 0.2, 0.1]), resolution=(100, 50), resolutionunit="CENTIMETER", **gray)
    with tifffile.TiffWriter(os.path.join(base, "thumbnail.tif")) as tif:
        for page in data:
            tif.write(page, **gray)
            tif.write(page[::2, ::2], subfiletype=1, **gray)
        tif.write(page[:3], **gray)
    add("tiff/thumbnail.tif", "tifffile", "uint16", data, warns="3 pages of another size")

    hyper = random((2, 3, 2, 4, 5), np.uint8)
    path = os.path.join(base, "imagej.tif")
    tifffile.imwrite(path, hyper, imagej=True, resolution=(4.0, 2.0), metadata={
        "axes": "TZCYX", "spacing": 3.5, "unit": "um", "finterval": 0.5})
    read = tifffile.imread(path)
    for step in range(2):
        add("tiff/imagej.tif", "tifffile", "uint8", read[step, :, 1], np.diag([0.25, 0.5, 3.5]), component=1, step=step,
            steps=2)
    path = os.path.join(base, "imagej_raw.tif")
    volume = random((5, 4, 6), np.uint16)
    tifffile.imwrite(path, volume, imagej=True, metadata={"axes": "ZYX", "spacing": 2.0, "unit": "mm"}, resolution=(1, 1))
    content = bytearray(open(path, "rb").read())
    with tifffile.TiffFile(path) as tif:
        page, order = tif.pages[0], tif.byteorder
        last = page.offset + 2 + 12 * len(page.tags)
    content[last:last + 4] = b"\0" * 4
    open(path, "wb").write(content)
    with tifffile.TiffFile(path) as tif:
        assert len(tif.pages) == 1
    assert (tifffile.imread(path) == volume).all()
    add("tiff/imagej_raw.tif", "tifffile", "uint16", volume, np.diag([1, 1, 2]), note="pages without directories")

    for axes in ("TCZYX", "CTZYX", "ZCTYX"):
        sizes = {"T": 2, "C": 2, "Z": 3, "Y": 3, "X": 4}
        data = random([sizes[a] for a in axes], np.uint8)
        name = f"ome_{axes.lower()}.ome.tif"
        tifffile.imwrite(os.path.join(base, name), data, ome=True, photometric="minisblack", metadata={
            "axes": axes, "PhysicalSizeX": 0.5, "PhysicalSizeXUnit": "µm", "PhysicalSizeY": 0.25,
            "PhysicalSizeYUnit": "µm", "PhysicalSizeZ": 2.0, "PhysicalSizeZUnit": "µm", "TimeIncrement": 0.1,
            "TimeIncrementUnit": "s"})
        with tifffile.TiffFile(os.path.join(base, name)) as tif:
            data = tif.series[0].asarray()
            where = [tif.series[0].axes.index(a) for a in "TZCYX"]
        sorted_ = np.transpose(data, where)
        for step in range(2):
            add("tiff/" + name, "tifffile", "uint8", sorted_[step, :, 0], np.diag([0.5, 0.25, 2.0]), component=0,
                step=step, steps=2)
    with tifffile.TiffWriter(os.path.join(base, "images.ome.tif"), ome=True) as tif:
        first, second = random((2, 4, 4), np.uint8), random((3, 4, 4), np.uint8)
        tif.write(first, photometric="minisblack", metadata={"axes": "ZYX", "Name": "left"})
        tif.write(second, photometric="minisblack", metadata={"axes": "ZYX", "Name": "right"})
    refuse("tiff/images.ome.tif", "volume-option", "two images", warns="Image:1 right")
    add("tiff/images.ome.tif", "tifffile", "uint8", second, part="right")
    data = random((4, 5, 6), np.uint16)
    os.makedirs(os.path.join(base, "slices"))
    for z, page in enumerate(data):
        tifffile.imwrite(os.path.join(base, "slices", f"s{z * 4}.tif"), page, **gray)
    add("tiff/slices", "tifffile", "uint16", data, note="s0, s4, s8, s12")
    os.makedirs(os.path.join(base, "steps"))
    for t in range(2):
        tifffile.imwrite(os.path.join(base, "steps", f"t{t}.tif"), data[2 * t:2 * t + 2], **gray)
        add("tiff/steps", "tifffile", "uint16", data[2 * t:2 * t + 2], step=t, steps=2)
    tifffile.imwrite(os.path.join(base, "jpeg.tif"), np.add.outer(np.arange(16), np.arange(32)).astype(np.uint8),
                     compression="jpeg", **gray)
    add("tiff/jpeg.tif", "tifffile", "uint8", tifffile.imread(os.path.join(base, "jpeg.tif"))[None], note="lossy")


# PNG and JPEG

def pictures():
    shutil.rmtree(os.path.join(HERE, "pictures"), ignore_errors=True)
    base = folder("pictures")

    def write(name, images, data, dtype, component="", end="png", note="", **more):
        os.makedirs(os.path.join(base, name))
        for z, image in enumerate(images):
            image.save(os.path.join(base, name, f"p{z * 5}.{end}"), **more)
        add("pictures/" + name, "pillow", dtype, data, component=component, note=note)

    gray = random((4, 5, 6), np.uint8)
    write("gray8", [Image.fromarray(a) for a in gray], gray, "uint8")
    wide = random((3, 5, 6), np.uint16)
    write("gray16", [Image.fromarray(a) for a in wide], wide, "uint16")
    for mode, channels in (("LA", 2), ("RGB", 3), ("RGBA", 4)):
        data = random((2, 5, 6, channels), np.uint8)
        write(mode.lower(), [Image.fromarray(a, mode) for a in data], data[..., channels - 1], "uint8",
              component=channels - 1)
    bits = [Image.fromarray(a > 128) for a in gray]
    write("bits", bits, np.stack([np.array(b.convert("L")) for b in bits]), "uint8")
    palettes = [Image.fromarray(a, "RGB").quantize(16) for a in random((2, 8, 8, 3), np.uint8)]
    write("palette", palettes, np.stack([np.array(p.convert("RGB"))[..., 0] for p in palettes]), "uint8", component=0)
    y, x = np.mgrid[:16, :24]
    smooth = [Image.fromarray((5 * x + 6 * y + 9 * z).astype(np.uint8)) for z in range(2)]
    paths = []
    write("jpeg_gray", smooth, np.zeros((1, 1, 1)), "uint8", end="jpg", quality=95)
    ROWS.pop()
    read = np.stack([np.array(Image.open(os.path.join(base, "jpeg_gray", f"p{z * 5}.jpg"))) for z in range(2)])
    add("pictures/jpeg_gray", "pillow", "uint8", read, note="lossy")
    colored = [Image.merge("RGB", [s, s.transpose(Image.ROTATE_180), s]) for s in smooth]
    write("jpeg_rgb", colored, np.zeros((1, 1, 1)), "uint8", end="jpg", quality=95, subsampling=0)
    ROWS.pop()
    read = np.stack([np.array(Image.open(os.path.join(base, "jpeg_rgb", f"p{z * 5}.jpg")))[..., 1] for z in range(2)])
    add("pictures/jpeg_rgb", "pillow", "uint8", read, component=1, note="lossy")
    os.makedirs(os.path.join(base, "unlike"))
    Image.fromarray(gray[0]).save(os.path.join(base, "unlike", "a.png"))
    Image.fromarray(gray[0][:4]).save(os.path.join(base, "unlike", "b.png"))
    refuse("pictures/unlike", "volume-unsupported", "sizes differ", warns="b.png: this slice is 6×4 uint8, and a.png is 6×5")
    add("pictures/unlike/a.png", "pillow", "uint8", gray[:1], note="one picture")
