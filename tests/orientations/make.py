"""Writes one small object in all eight orientations of its axes, by the libraries that people use.

    python make.py        (needs: pip install nibabel SimpleITK pydicom vtk numpy)

The object is a block of 6 x 5 x 4 voxels of 2 x 3 x 4 mm in LPS, whose first voxel is at (10, 20, 30), with a marker that
is different along each axis: a long arm to the left, a shorter one to the back, a short one up. `m++-` is stored with
its third axis reversed: the voxels are turned and so is the placement, so that the object stays where it is.
"""

import itertools
import os

import nibabel
import numpy as np
import pydicom
import SimpleITK as sitk
import vtk
from pydicom.dataset import FileDataset, FileMetaDataset
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian
from vtk.util.numpy_support import numpy_to_vtk

HERE = os.path.dirname(os.path.abspath(__file__))
DIMS = np.array([6, 5, 4])
SPACING = np.array([2.0, 3.0, 4.0])
ORIGIN = np.array([10.0, 20.0, 30.0])


def marker():
    voxels = np.zeros(DIMS, np.uint8)
    voxels[1:6, 1, 1] = 200
    voxels[1, 1:4, 1] = 140
    voxels[1, 1, 1:3] = 250
    return voxels


def turned(signs):
    """The voxels with some axes reversed, and directions and origin that leave them where they were."""
    voxels = marker()[tuple(slice(None, None, sign) for sign in signs)]
    last = (DIMS - 1) * SPACING
    origin = np.where(np.array(signs) < 0, ORIGIN + last, ORIGIN)
    return np.ascontiguousarray(voxels), np.diag(np.array(signs, float)), origin


def write_nifti(path, voxels, direction, origin):
    affine = np.eye(4)
    affine[:3, :3] = direction * SPACING
    affine[:3, 3] = origin
    nibabel.save(nibabel.Nifti1Image(voxels, np.diag([-1.0, -1.0, 1.0, 1.0]) @ affine), path)


def write_itk(path, voxels, direction, origin):
    image = sitk.GetImageFromArray(voxels.transpose(2, 1, 0))
    image.SetSpacing(SPACING.tolist())
    image.SetOrigin(origin.tolist())
    image.SetDirection(direction.flatten().tolist())
    sitk.WriteImage(image, path, useCompression=True)


def write_vti(path, voxels, direction, origin):
    image = vtk.vtkImageData()
    image.SetDimensions(DIMS.tolist())
    image.SetSpacing(SPACING.tolist())
    image.SetOrigin(origin.tolist())
    image.SetDirectionMatrix(direction.flatten().tolist())
    array = numpy_to_vtk(voxels.flatten(order="F"), deep=True)
    array.SetName("marker")
    image.GetPointData().SetScalars(array)
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(image)
    writer.Write()


def write_dicom(folder, voxels, direction, origin):
    os.makedirs(folder, exist_ok=True)
    for z in range(DIMS[2]):
        meta = FileMetaDataset()
        meta.MediaStorageSOPClassUID = CTImageStorage
        meta.MediaStorageSOPInstanceUID = f"1.2.3.{z + 1}"
        meta.TransferSyntaxUID = ExplicitVRLittleEndian
        data = FileDataset(None, {}, file_meta=meta, preamble=b"\0" * 128)
        data.SOPClassUID = CTImageStorage
        data.SOPInstanceUID = f"1.2.3.{z + 1}"
        data.SeriesInstanceUID = "1.2.3"
        data.Modality = "OT"
        data.Rows, data.Columns = int(DIMS[1]), int(DIMS[0])
        data.BitsAllocated = data.BitsStored = 8
        data.HighBit = 7
        data.PixelRepresentation = 0
        data.SamplesPerPixel = 1
        data.PhotometricInterpretation = "MONOCHROME2"
        data.PixelSpacing = [SPACING[1], SPACING[0]]
        data.SliceThickness = SPACING[2]
        data.ImageOrientationPatient = [*direction[:, 0], *direction[:, 1]]
        data.ImagePositionPatient = (origin + direction[:, 2] * SPACING[2] * z).tolist()
        data.PixelData = voxels[:, :, z].flatten(order="F").tobytes()
        data.save_as(os.path.join(folder, f"{z}.dcm"), enforce_file_format=True)


for signs in itertools.product((1, -1), repeat=3):
    name = "m" + "".join("+" if sign > 0 else "-" for sign in signs)
    parts = turned(signs)
    write_nifti(os.path.join(HERE, name + ".nii.gz"), *parts)
    write_itk(os.path.join(HERE, name + ".nrrd"), *parts)
    write_itk(os.path.join(HERE, name + ".mha"), *parts)
    write_vti(os.path.join(HERE, name + ".vti"), *parts)
    write_dicom(os.path.join(HERE, name + "_dicom"), *parts)
