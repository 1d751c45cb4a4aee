"""Reads what the test `every_type_and_placement_comes_back` left in a folder with other software.

    VOLGRAPH_WRITTEN=FOLDER cargo nextest run -p volgraph-formats --test write every_type
    python check_written.py FOLDER        (needs: pip install nibabel SimpleITK pynrrd zarr numpy)
"""

import csv
import os
import sys

import nibabel
import nrrd
import numpy as np
import SimpleITK as sitk
import zarr

csv.field_size_limit(1 << 24)


def check(path, name, want, affine):
    """The largest error of the placement; refuses other voxels."""
    def voxels(got):
        assert got.dtype.newbyteorder("=") == want.dtype, (got.dtype, want.dtype)
        assert got.shape == want.shape and (got == want).all(), "voxels differ"

    def by_itk():
        image = sitk.ReadImage(path)
        voxels(sitk.GetArrayFromImage(image))
        got = np.eye(4)
        got[:3, :3] = np.array(image.GetDirection()).reshape(3, 3) @ np.diag(image.GetSpacing())
        got[:3, 3] = image.GetOrigin()
        return np.abs(got - affine).max()

    errors = {}
    sheared = "sheared" in name
    if name.endswith((".nrrd", ".nhdr")):
        data, header = nrrd.read(path)
        voxels(data.T)
        got = np.eye(4)
        got[:3, :3] = header["space directions"].T
        got[:3, 3] = header["space origin"]
        errors["pynrrd"] = np.abs(got - affine).max()
    if name.endswith((".nrrd", ".nhdr", ".mha", ".mhd")) and not sheared:
        errors["SimpleITK"] = by_itk()
    if name.endswith((".nii", ".nii.gz")):
        image = nibabel.load(path)
        voxels(np.asanyarray(image.dataobj).T)
        ras = np.diag([-1, -1, 1, 1]) @ affine
        kind = type(image).__name__
        assert kind == ("Nifti2Image" if "_2.nii" in name else "Nifti1Image")
        errors[f"{kind} sform"] = np.abs(image.get_sform() - ras).max()
        qform, code = image.get_qform(coded=True)
        assert (code == 0) == sheared, code
        if not sheared:
            errors[f"{kind} qform"] = np.abs(qform - ras).max()
            if kind == "Nifti1Image":  # SimpleITK reads no NIfTI-2
                errors["SimpleITK NIfTI"] = by_itk()
    if name.endswith(".npy"):
        voxels(np.load(path))
    if name.endswith(".zarr"):
        group = zarr.open_group(path, mode="r")
        voxels(group["0"][...])
        ome = group.attrs["ome"]
        scale, shift = [step for step in ome["multiscales"][0]["datasets"][0]["coordinateTransformations"]]
        errors["zarr spacing"] = np.abs(scale["scale"][::-1] - np.linalg.norm(affine[:3, :3], axis=0)).max()
        errors["zarr origin"] = np.abs(shift["translation"][::-1] - affine[:3, 3]).max()
    return errors


def main(folder):
    worst, failed, count = {}, 0, 0
    with open(os.path.join(folder, "written.tsv")) as lines:
        for row in csv.DictReader(lines, delimiter="\t"):
            want = np.frombuffer(bytes.fromhex(row["data"]), dtype=row["type"]).reshape(3, 5, 7)
            numbers = np.array(row["affine"].split(), dtype=float).reshape(4, 3)
            affine = np.eye(4)
            affine[:3, :] = numbers.T
            count += 1
            try:
                for tool, error in check(os.path.join(folder, row["file"]), row["file"], want, affine).items():
                    worst[tool] = max(worst.get(tool, 0), error)
            except Exception as error:  # every file is looked at
                failed += 1
                print(row["file"], type(error).__name__, str(error)[:300])
    print(f"{count} files, {failed} failed; largest errors of placement: {worst}")
    sys.exit(failed > 0)


main(sys.argv[1])
