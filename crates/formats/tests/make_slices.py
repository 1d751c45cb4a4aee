"""Writes the folders dicom, tiff and pictures beside this script, and expected_slices.tsv.

    python make_slices.py [FORMATS_FOLDER]
    (needs: pip install pydicom SimpleITK tifffile imagecodecs pillow numpy)

Each case is a file or a folder of files of 8x8 pixels or so. Values are what pydicom (with the modality's slope and
intercept), tifffile or pillow read from the files; DICOM series whose axes are perpendicular are also read by
SimpleITK, sorted by GDCM, and this script stops where values or placement differ. Columns are as in
make_expected.py, with the options part, component and step, and ten probed voxels (index:value).
With FORMATS_FOLDER there are rows for the test data there too (their paths begin with `formats/`).
"""

import io
import os
import sys
import zipfile

import numpy as np
import SimpleITK as sitk
import tifffile

from make_dicom import dicoms
from make_pictures import pictures, tiffs
from slices_table import COLUMNS, HERE, ROWS, add


def test_data(formats):
    reader = sitk.ImageSeriesReader()
    path = os.path.join(formats, "dicom_slicer_cthead")
    reader.SetFileNames(reader.GetGDCMSeriesFileNames(path))
    image = reader.Execute()
    matrix = np.array(image.GetDirection()).reshape(3, 3)
    columns = [matrix[:, axis] * image.GetSpacing()[axis] for axis in range(3)]
    data = sitk.GetArrayFromImage(image)
    add("formats/dicom_slicer_cthead", "SimpleITK", "int16", data, columns, image.GetOrigin())
    with zipfile.ZipFile(os.path.join(formats, "tiff", "cthead-8bit.zip")) as file:
        # Written by a program that says \\ in one place and / in the other.
        for info in file.infolist():
            info.orig_filename = info.orig_filename.replace("\\", "/")
        infos = sorted((i for i in file.infolist() if i.filename.endswith(".tif")), key=lambda i: i.filename)
        data = np.stack([tifffile.imread(io.BytesIO(file.read(i))) for i in infos])
    add("formats/tiff/cthead-8bit.zip", "tifffile", str(data.dtype), data)


dicoms()
tiffs()
pictures()
if len(sys.argv) > 1:
    test_data(sys.argv[1])
with open(os.path.join(HERE, "expected_slices.tsv"), "w", newline="\n") as file:
    for cells in [COLUMNS, *ROWS]:
        assert len(cells) == len(COLUMNS), cells
        file.write("\t".join(map(str, cells)) + "\n")
