"""The DICOM files of make_slices.py, written by pydicom."""

import os
import shutil

import imagecodecs
import numpy as np
import pydicom
import SimpleITK as sitk
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.encaps import encapsulate
from pydicom.uid import (DeflatedExplicitVRLittleEndian, ExplicitVRBigEndian, ExplicitVRLittleEndian,
                         ImplicitVRLittleEndian, JPEG2000Lossless, JPEGBaseline8Bit, JPEGLosslessSV1, JPEGLSLossless,
                         RLELossless)

from slices_table import HERE, add, random, refuse, rng

UID = "1.2.826.0.1.3680043.8.498."


def dicom(pixels, syntax=ExplicitVRLittleEndian, modality="MR", sop="1.2.840.10008.5.1.4.1.1.4", series=1, **more):
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = sop
    meta.MediaStorageSOPInstanceUID = UID + str(rng.integers(1 << 40))
    meta.TransferSyntaxUID = syntax
    meta.ImplementationClassUID = UID + "1"
    data = FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
    data.SOPClassUID = sop
    data.SOPInstanceUID = meta.MediaStorageSOPInstanceUID
    data.Modality = modality
    data.PatientName = "Secret^Name"
    data.SeriesInstanceUID = UID + str(series)
    data.SeriesNumber = series
    data.InstanceNumber = 1
    data.SamplesPerPixel = 1
    data.PhotometricInterpretation = "MONOCHROME2"
    frames = pixels if pixels.ndim == 3 and more.get("NumberOfFrames") else pixels[None]
    data.Rows, data.Columns = frames.shape[1:3]
    data.BitsAllocated = data.BitsStored = 8 * pixels.dtype.itemsize
    data.HighBit = data.BitsStored - 1
    data.PixelRepresentation = int(pixels.dtype.kind == "i")
    if pixels.dtype == np.uint8 or not syntax.is_encapsulated:
        order = ">" if syntax == ExplicitVRBigEndian else "<"
    else:
        order = "<"
    raw = pixels.astype(pixels.dtype.newbyteorder(order)).tobytes()
    data.PixelData = raw + b"\0" * (len(raw) % 2)
    data["PixelData"].VR = "OW" if pixels.dtype.itemsize > 1 else "OB"
    for key, value in more.items():
        setattr(data, key, value)
    return data


def save(data, *path):
    path = os.path.join(HERE, "dicom", *path)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    syntax = data.file_meta.TransferSyntaxUID
    if syntax.is_little_endian:
        data.save_as(path, enforce_file_format=True)
    else:
        pydicom.filewriter.dcmwrite(path, data, implicit_vr=False, little_endian=False, force_encoding=True)
    assert os.path.getsize(path) < 3072, path
    return path


def rescaled(data):
    array = pydicom.pixels.apply_modality_lut(data.pixel_array, data).astype(np.float64)
    return array


def series(name, count, make, order=None, first=(10.0, -20.0, 5.0), row=(1, 0, 0), column=(0, 1, 0), spacing=(2.0, 1.5),
           step=None, gap=3.0, heights=None):
    """Files of a series, in names that say nothing about their order."""
    row, column, first = (np.array(v, float) for v in (row, column, first))
    normal = np.cross(row, column)
    step = normal * gap if step is None else np.array(step, float)
    slices = []
    for i in range(count):
        height = heights[i] if heights else i
        data = make(i)
        data.ImageOrientationPatient = [f"{v:.10g}"[:16] for v in (*row, *column)]
        position = [f"{v:.10g}"[:16] for v in first + step * height]
        data.ImagePositionPatient = position
        data.PixelSpacing = list(spacing)
        data.InstanceNumber = i + 1
        file = (order or list(range(count)))[i]
        slices.append(pydicom.dcmread(save(data, name, f"s{file}.dcm")))
    stack = np.stack([rescaled(data) for data in slices])
    starts = [np.array(data.ImagePositionPatient, float) for data in slices]
    step = (starts[-1] - starts[0]) / (count - 1)
    orientation = np.array(slices[0].ImageOrientationPatient, float)
    row, column = orientation[:3], orientation[3:]
    row, column = row / np.linalg.norm(row), column / np.linalg.norm(column)
    return stack, [row * spacing[1], column * spacing[0], step], starts[0]


def by_itk(path, stack, columns, origin):
    """Stops where SimpleITK reads other values or another place."""
    path = os.path.join(HERE, "dicom", path)
    if os.path.isdir(path):
        reader = sitk.ImageSeriesReader()
        reader.SetFileNames(reader.GetGDCMSeriesFileNames(path))
        image = reader.Execute()
    else:
        try:
            image = sitk.ReadImage(path)
        except RuntimeError as error:
            print(os.path.basename(path), "is not read by SimpleITK:", str(error).splitlines()[-1])
            return False
    n = image.GetDimension()
    matrix = np.array(image.GetDirection()).reshape(n, n)
    np.testing.assert_array_equal(np.squeeze(sitk.GetArrayFromImage(image)), np.squeeze(stack))
    for axis in range(min(n, 3) if stack.shape[0] > 1 else 2):
        np.testing.assert_allclose(matrix[:3, axis] * image.GetSpacing()[axis], columns[axis], atol=1e-6)
    np.testing.assert_allclose(image.GetOrigin()[:3], origin[:n], atol=1e-6)
    return True


def dicoms():
    shutil.rmtree(os.path.join(HERE, "dicom"), ignore_errors=True)
    ct = "1.2.840.10008.5.1.4.1.1.2"

    def slice12(i, **more):
        pixels = random((8, 6), np.uint16, 0, 4095)
        return dicom(pixels, modality="CT", sop=ct, BitsStored=12, HighBit=11, RescaleIntercept=-1024, RescaleSlope=1,
                     PixelPaddingValue=63536 & 0xFFF, SeriesDescription="Oblique head", **more)
    turned = np.array([[0.8, 0.6, 0.0], [-0.36, 0.48, 0.8]])
    got = series("ct_oblique", 4, slice12, order=[2, 0, 3, 1], row=turned[0], column=turned[1])
    by_itk("ct_oblique", *got)
    add("dicom/ct_oblique", "pydicom, SimpleITK", "int16", *got, note="12 bits, oblique, names out of order")

    got = series("mr_signed", 3, lambda i: dicom(random((5, 8), np.int16), ImplicitVRLittleEndian),
                 row=(0, 1, 0), column=(0, 0, -1), gap=1.25)
    by_itk("mr_signed", *got)
    add("dicom/mr_signed", "pydicom, SimpleITK", "int16", *got, note="signed, sagittal, implicit VR")

    got = series("tilt", 4, slice12, step=(0.0, 0.8, 3.0))
    add("dicom/tilt", "pydicom", "int16", *got, warns="sheared by 14.93 degrees", note="gantry tilt, kept as a shear")

    got = series("missing", 4, slice12, heights=[0, 1, 3, 4])
    add("dicom/missing", "pydicom", "int16", *got, warns="not evenly spaced", note="a slice is missing")

    series("twice", 3, slice12)
    again = pydicom.dcmread(os.path.join(HERE, "dicom", "twice", "s1.dcm"))
    save(again, "twice", "t1.dcm")
    refuse("dicom/twice", "volume-unsupported", "two files at one position", warns="s1.dcm")

    slopes = [0.5, 0.25, 2.0]
    got = series("slopes", 3, lambda i: dicom(random((6, 6), np.uint16, 0, 30000), modality="PT", Units="BQML",
                                              RescaleSlope=slopes[i], RescaleIntercept=0))
    by_itk("slopes", *got)
    add("dicom/slopes", "pydicom, SimpleITK", "float32", *got, warns="slope or intercept differ")
    whole = [1, 3, -2]
    got = series("whole_slopes", 3, lambda i: dicom(random((6, 6), np.uint16, 0, 30000), RescaleSlope=whole[i],
                                                    RescaleIntercept=i))
    add("dicom/whole_slopes", "pydicom", "int32", *got, warns="slope or intercept differ")

    # Time steps in files of their own.
    stacks = []
    for time in range(2):
        for z in range(3):
            data = dicom(random((4, 4), np.uint8), TemporalPositionIdentifier=time + 1,
                         ImageOrientationPatient=[1, 0, 0, 0, 1, 0], ImagePositionPatient=[0, 0, 2 * z],
                         PixelSpacing=[1, 1], InstanceNumber=10 - 3 * time - z)
            stacks.append(pydicom.dcmread(save(data, "times", f"{z}{time}.dcm")).pixel_array)
    for time in range(2):
        add("dicom/times", "pydicom", "uint8", np.stack(stacks[3 * time:3 * time + 3]), np.diag([1, 1, 2]),
            step=time, steps=2)

    # Two series and a directory in one folder.
    parts = []
    for number, text in ((1, "Scout"), (2, "Thin head")):
        parts.append(series("two_series", 2, lambda i: dicom(random((4, 4), np.uint8), series=number,
                                                             SeriesDescription=text), order=[2 * number, 2 * number + 1]))
    listing = dicom(random((4, 4), np.uint8))
    del listing.PixelData
    save(listing, "two_series", "DICOMDIR")
    refuse("dicom/two_series", "volume-option", "several series", warns="2 Thin head, MR, axial 4×4, 2 slices")
    refuse("dicom/two_series", "volume-option", "no such series", part="nose")
    add("dicom/two_series", "pydicom", "uint8", *parts[1], part="thin", warns="2 files of other series")
    add("dicom/two_series", "pydicom", "uint8", *parts[0], part=UID + "1", warns="2 files of other series")

    # Single files.
    place = dict(ImageOrientationPatient=[1, 0, 0, 0, 1, 0], ImagePositionPatient=[1, 2, 3], PixelSpacing=[0.5, 0.75],
                 SliceThickness=4)
    columns, origin = np.diag([0.75, 0.5, 4.0]), (1, 2, 3)

    def single(name, data, dtype, warns="single slice", itk=True, stack=None, **more):
        path = save(data, name)
        stack = rescaled(pydicom.dcmread(path))[None] if stack is None else stack
        itk = itk and by_itk(name, stack, columns, origin)
        add("dicom/" + name, "pydicom, SimpleITK" if itk else "pydicom", dtype, stack, columns, origin, warns=warns, **more)

    single("mono1.dcm", dicom(random((8, 8), np.uint8), PhotometricInterpretation="MONOCHROME1", **place), "uint8",
           warns="MONOCHROME1", itk=False, note="SimpleITK turns the values around")
    single("big_endian.dcm", dicom(random((8, 8), np.int16), ExplicitVRBigEndian, **place), "int16", itk=False)
    single("wide.dcm", dicom(random((8, 8), np.uint32), **place), "uint32", itk=False)
    dirty = random((8, 8), np.uint16)
    single("bits_beside.dcm", dicom(dirty, BitsStored=10, HighBit=9, **place), "uint16", stack=(dirty & 1023)[None].astype(float))
    signed12 = random((8, 8), np.int16, -2048, 2047)
    packed = (signed12.view(np.uint16) & 0xFFF)
    data = dicom(packed, **place)
    data.BitsStored, data.HighBit, data.PixelRepresentation = 12, 11, 1
    single("signed_12.dcm", data, "int16", stack=signed12[None].astype(float))
    data = dicom(random((8, 8), np.uint16), RLELossless, **place)
    pixels = np.frombuffer(data.PixelData, np.uint16).reshape(8, 8)
    data.PixelData = b""
    data.compress(RLELossless, pixels, generate_instance_uid=False)
    single("rle.dcm", data, "uint16")

    def encoded(pixels, syntax, bytes_, **more):
        data = dicom(pixels, syntax, **more)
        data.PixelData = encapsulate([bytes_])
        data["PixelData"].is_undefined_length = True
        data["PixelData"].VR = "OB"
        return data
    sixteen = random((8, 8), np.uint16)
    single("jpeg_lossless.dcm", encoded(sixteen, JPEGLosslessSV1, imagecodecs.ljpeg_encode(sixteen), **place), "uint16",
           stack=sixteen[None].astype(float))
    single("jpeg_2000.dcm", encoded(sixteen, JPEG2000Lossless, imagecodecs.jpeg2k_encode(
        sixteen, level=0, reversible=True, codecformat="j2k"), **place), "uint16", stack=sixteen[None].astype(float))
    signed = random((8, 8), np.int16)
    single("jpeg_2000_signed.dcm", encoded(signed, JPEG2000Lossless, imagecodecs.jpeg2k_encode(
        signed, level=0, reversible=True, codecformat="j2k"), **place), "int16", stack=signed[None].astype(float))
    smooth = (np.add.outer(np.arange(16), np.arange(16)) * 8).astype(np.uint8)
    jpeg = imagecodecs.jpeg8_encode(smooth, level=95)
    single("jpeg.dcm", encoded(smooth, JPEGBaseline8Bit, jpeg, **place), "uint8", itk=False,
           stack=imagecodecs.jpeg8_decode(jpeg)[None].astype(float), note="lossy")

    color = random((8, 8, 3), np.uint8)
    for name, more in (("rgb.dcm", dict(PlanarConfiguration=0)), ("rgb_planes.dcm", dict(PlanarConfiguration=1))):
        stored = color if name == "rgb.dcm" else np.moveaxis(color, 2, 0)
        data = dicom(color[..., 0], SamplesPerPixel=3, **more, **place)
        data.PhotometricInterpretation = "RGB"
        data.PixelData = stored.tobytes()
        path = save(data, name)
        assert (pydicom.dcmread(path).pixel_array == color).all()
        add("dicom/" + name, "pydicom", "uint8", color[None, ..., 1], columns, origin, component=1)

    # Without preamble, and without anything before the data set.
    whole = save(dicom(random((8, 8), np.uint8), **place), "no_preamble.dcm")
    stack = pydicom.dcmread(whole).pixel_array[None]
    content = open(whole, "rb").read()
    open(whole, "wb").write(content[132:])
    add("dicom/no_preamble.dcm", "pydicom", "uint8", stack, columns, origin)
    data = dicom(random((8, 8), np.uint8), ImplicitVRLittleEndian, **place)
    stack = data.pixel_array[None]
    path = os.path.join(HERE, "dicom", "bare.dcm")
    buffer = pydicom.filebase.DicomBytesIO()
    buffer.is_little_endian, buffer.is_implicit_VR = True, True
    pydicom.filewriter.write_dataset(buffer, Dataset({k: data[k] for k in data.keys()}))
    open(path, "wb").write(buffer.getvalue())
    add("dicom/bare.dcm", "pydicom", "uint8", stack, columns, origin)

    # Many frames.
    def groups(position, time=None, **values):
        group = Dataset()
        group.PlanePositionSequence = [Dataset()]
        group.PlanePositionSequence[0].ImagePositionPatient = list(position)
        if time is not None:
            group.FrameContentSequence = [Dataset()]
            group.FrameContentSequence[0].TemporalPositionIndex = time
        if values:
            group.PixelValueTransformationSequence = [Dataset()]
            for key, value in values.items():
                setattr(group.PixelValueTransformationSequence[0], key, value)
        return group

    def shared(gap=2.5):
        group = Dataset()
        group.PlaneOrientationSequence = [Dataset()]
        group.PlaneOrientationSequence[0].ImageOrientationPatient = [0, 1, 0, 0, 0, -1]
        group.PixelMeasuresSequence = [Dataset()]
        group.PixelMeasuresSequence[0].PixelSpacing = [0.5, 0.75]
        group.PixelMeasuresSequence[0].SliceThickness = gap
        return group
    frames = random((6, 4, 4), np.uint16, 0, 4095)
    data = dicom(frames, sop="1.2.840.10008.5.1.4.1.1.4.1", NumberOfFrames=6, BitsStored=12, HighBit=11)
    data.SharedFunctionalGroupsSequence = [shared()]
    # x of the row's cross product: normal is -x, so that frames come in falling order of the normal.
    data.PerFrameFunctionalGroupsSequence = [groups((2.5 * z, 1, 2), time=t + 1) for z in range(3) for t in range(2)]
    save(data, "enhanced.dcm")
    columns2 = [[0, 0.75, 0], [0, 0, -0.5], [-2.5, 0, 0]]
    for t in range(2):
        add("dicom/enhanced.dcm", "pydicom", "uint16", frames[t::2][::-1], columns2, (5.0, 1, 2), step=t, steps=2)
    frames = random((3, 4, 4), np.int16, 0, 2000)
    data = dicom(frames, modality="CT", sop="1.2.840.10008.5.1.4.1.1.2.1", NumberOfFrames=3)
    data.SharedFunctionalGroupsSequence = [shared()]
    data.PerFrameFunctionalGroupsSequence = [groups((-2.5 * z, 1, 2), RescaleSlope=z + 1, RescaleIntercept=-10,
                                                    RescaleType="HU") for z in range(3)]
    save(data, "enhanced_slopes.dcm")
    add("dicom/enhanced_slopes.dcm", "pydicom", "int32", frames * np.arange(1, 4)[:, None, None] - 10, columns2,
        (0, 1, 2), warns="slope or intercept differ")
    frames = random((3, 4, 4), np.uint8)
    data = dicom(frames, sop="1.2.840.10008.5.1.4.1.1.3.1", modality="US", NumberOfFrames=3)
    save(data, "ultrasound.dcm")
    add("dicom/ultrasound.dcm", "pydicom", "uint8", frames, warns="without positions")
    frames = random((3, 4, 4), np.uint32, 0, 1 << 20)
    data = dicom(frames, sop="1.2.840.10008.5.1.4.1.1.481.2", modality="RTDOSE", NumberOfFrames=3, DoseUnits="GY",
                 DoseGridScaling=0.001, GridFrameOffsetVector=[0, 5, 10], **place)
    save(data, "dose.dcm")
    add("dicom/dose.dcm", "pydicom", "float64", frames * 0.001, np.diag([0.75, 0.5, 5.0]), (1, 2, 3))
    frames = random((3, 8, 8), np.uint16)
    data = dicom(frames, RLELossless, NumberOfFrames=3)
    data.PixelData = b""
    data.compress(RLELossless, frames, generate_instance_uid=False)
    save(data, "rle_frames.dcm")
    add("dicom/rle_frames.dcm", "pydicom", "uint16", pydicom.dcmread(os.path.join(HERE, "dicom", "rle_frames.dcm")).pixel_array,
        warns="without positions")

    # A segmentation: two segments, the slice between is empty and left out.
    bits = (rng.random((3, 5, 5)) < 0.5).astype(np.uint8)
    data = dicom(bits, sop="1.2.840.10008.5.1.4.1.1.66.4", modality="SEG", NumberOfFrames=3, SegmentationType="BINARY")
    data.BitsAllocated = data.BitsStored = 1
    data.HighBit = 0
    raw = np.packbits(bits.ravel(), bitorder="little").tobytes()
    data.PixelData = raw + b"\0" * (len(raw) % 2)
    data.SharedFunctionalGroupsSequence = [shared(2.5)]
    per_frame = []
    for z, segment in ((0, 1), (2, 1), (2, 2)):
        group = groups((-2.5 * z, 1, 2))
        group.SegmentIdentificationSequence = [Dataset()]
        group.SegmentIdentificationSequence[0].ReferencedSegmentNumber = segment
        per_frame.append(group)
    data.PerFrameFunctionalGroupsSequence = per_frame
    data.SegmentSequence = [Dataset(), Dataset()]
    for number, (item, text) in enumerate(zip(data.SegmentSequence, ("liver", "kidney")), 1):
        item.SegmentNumber, item.SegmentLabel = number, text
    path = save(data, "segments.dcm")
    read = pydicom.dcmread(path).pixel_array
    labels = np.stack([read[0], read[0] * 0, np.where(read[2] > 0, 2, read[1])])
    add("dicom/segments.dcm", "pydicom", "uint16", labels, columns2, (0, 1, 2))

    # Refused.
    data = dicom(random((8, 8), np.uint8), PhotometricInterpretation="PALETTE COLOR", **place)
    save(data, "palette.dcm")
    refuse("dicom/palette.dcm", "volume-unsupported", "palette")
    save(encoded(sixteen, JPEGLSLossless, b"\xff\xd8\xff\xf7" + b"\0" * 60, **place), "jpeg_ls.dcm")
    refuse("dicom/jpeg_ls.dcm", "volume-unsupported", "JPEG-LS", warns="JPEG-LS")
    save(dicom(random((8, 8), np.uint8), DeflatedExplicitVRLittleEndian, **place), "deflated.dcm")
    refuse("dicom/deflated.dcm", "volume-unsupported", "deflated")
    save(dicom(random((8, 8), np.uint8), Rows=80, **place), "short.dcm")
    refuse("dicom/short.dcm", "volume-data-too-short", "fewer pixels than rows say")
    refuse("dicom/two_series/DICOMDIR", "volume-unsupported", "no pixels")
