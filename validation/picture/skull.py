# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the CT skull of Debian's invesalius-examples as NIfTI, without the scanner's head rest."""

import plistlib
import tarfile

import nibabel
import numpy as np
from leaflight import Volume
from leaflight.volume.regions import LargestPart, changed

# Hounsfield units of bone.
BONE = 150


def write_skull(project, out):
    with tarfile.open(project) as archive:
        files = {member.name.split("/")[-1]: member for member in archive.getmembers()}
        described = plistlib.load(archive.extractfile(files["main.plist"]))
        matrix = described["matrix"]
        data = archive.extractfile(files[matrix["filename"]]).read()
    values = np.frombuffer(data, matrix["dtype"]).reshape(matrix["shape"])
    values = changed(Volume(values), [LargestPart(BONE)]).values
    # y points to the face and z up; the file does not tell left from right.
    image = nibabel.Nifti1Image(values.T, np.diag([*described["spacing"], 1.0]))
    image.header.set_xyzt_units("mm")
    nibabel.save(image, out)
