# SPDX-License-Identifier: GPL-3.0-or-later
"""Recipes of the measured volumes: generated, or read from a folder of real ones.

A recipe is a function of (folder, fineness). It returns a list of Volumes, or None if the folder
lacks them. folder: with the real volumes, or None. fineness: factor on the nodes per axis of
generated ones.
"""

import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from leaflight.io.readers import read_volume

COLIN27 = Path("/usr/share/mricron/templates/ch2.nii.gz")


def generated(make, nodes):
    """Returns a recipe that generates volumes by make(nodes), with this many nodes at a
    fineness of 1.
    """

    def volumes(_, fineness):
        made = make(max(8, round(fineness * nodes)))
        return made if isinstance(made, list) else [made]

    return volumes


def read(name, placed=True, **layout):
    """Returns a recipe that reads the file of that name, or the .tif within a zip.

    placed: False ignores the file's transform: the first voxel is at the origin, and axes are the
    world's. All measurements of these volumes have used this placement.
    layout: arguments of read_volume()
    """

    def volumes(folder, _):
        path = Path(folder) / name if folder else None
        if path is None or not path.exists():
            return None
        if path.suffix != ".zip":
            volume = read_volume(str(path), **layout)
            return [volume if placed else _at_the_origin(volume)]
        with tempfile.TemporaryDirectory(prefix="leaflight-") as unpacked:
            with zipfile.ZipFile(path) as archive:
                stack = next(one for one in archive.namelist() if one.lower().endswith(".tif"))
                return [read_volume(archive.extract(stack, unpacked), **layout)]

    return volumes


def together(*recipes):
    """Returns a recipe of the volumes of several."""

    def volumes(folder, fineness):
        found = [recipe(folder, fineness) for recipe in recipes]
        return None if None in found else sum(found, [])

    return volumes


def _at_the_origin(volume):
    sizes = np.linalg.norm(volume.index_to_world[:3, :3], axis=0)
    return replace(volume, index_to_world=np.diag([*sizes, 1.0]))


def colin27(folder, _):
    """Returns the thesis's brain, from the folder or from where Debian has it."""
    own = Path(folder) / COLIN27.name if folder else COLIN27
    path = own if own.exists() else COLIN27
    return [read_volume(str(path))] if path.exists() else None


def absent_text(absent):
    """Returns lines of Markdown about the volumes without data, for a document."""
    if not absent:
        return []
    return [
        f"- Absent, hence left out: {'; '.join(absent)}. Name the folder that holds "
        "the files with `--data DIR`."
    ]


nucleon = read("nucleon.raw", dims=(41, 41, 41), type="uint8")
tooth = read("tooth16.raw", dims=(103, 94, 161), type="uint16", endian="big")
neuron_stack = read("rivulet_neuron.tif.zip")
bunny = read("bunny_ct_half.nrrd")
aneurism = read("aneurism.nrrd")
heptane = read("heptane.nii.gz")
engine = read("engine.vti", placed=False)
hydrogen_vti = read("hydrogen.vti", placed=False)
isabel = read("isabel_02.vti", placed=False)
amos = read("amos_0336.mhd", placed=False)
electron_density = read("1jzv.ccp4", placed=False)
# Files of validation/picture/make_molecule.py.
caffeine = together(read("caffeine_density.cube"), read("caffeine_potential.cube"))
orbital = read("N2O_homo+lumo.cube.gz", placed=False, channel=0)
