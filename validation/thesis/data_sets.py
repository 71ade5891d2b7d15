# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the thesis's data sets and some real ones: one bake against directly rendered
isosurfaces.

This is thesis Fig. 5.14. Only Colin27 of its four data sets is public. particles.py generates
others of the same kind. Scans are added if there are any.
"""

from collections.abc import Callable
from dataclasses import dataclass

from leaflight.bake.bake import bake
from leaflight.bake.settings import range_to_bake
from leaflight.io.scene_file import cornell_box, packaged_scene
from leaflight.scene.scene import fit_scene, match_isosurfaces
from leaflight.volume.particles import lapr, neuron, nucleons
from volume_recipes import bunny, colin27, generated, neuron_stack, nucleon

from .curves import Cost, measured
from .isosurfaces import isosurfaces


@dataclass(frozen=True)
class DataEffort:
    """The effort. fineness: ratio of nodes of generated volumes to those of the thesis; vertices,
    paths: of the reference, in total and per vertex.
    """

    fineness: float = 1.0
    vertices: int = 2000
    paths: int = 4096


QUICK_DATA = DataEffort(vertices=600, paths=2048)


@dataclass(frozen=True)
class Printed:
    """The thesis's figures: seconds of the bake and of one isosurface, and RMS error in percent."""

    bake: float
    direct: float
    error: float


@dataclass(frozen=True)
class DataSet:
    """A data set.

    volumes(folder, fineness): see volume_recipes.py. isovalues: common isovalues to judge; scene:
    of the package, None is the Cornell box.
    """

    name: str
    volumes: Callable
    isovalues: tuple
    printed: Printed = None
    scene: str = None


@dataclass(frozen=True)
class DataRow:
    """The result of a data set: its bake beside one isosurface rendered directly.

    texels, cost: texels and cost of the bake
    estimated: the error that the bake reports
    error: RMS error in percent, including the noise of the reference
    noise: noise of the reference in percent
    vertices: vertices of one isosurface, on average
    direct: seconds of a processor in which paths light these vertices with the same error
    """

    data_set: DataSet
    texels: int
    cost: Cost
    estimated: float
    error: float
    noise: float
    color: float
    vertices: float
    direct: float

    @property
    def break_even(self):
        """Number of isosurfaces whose direct rendering costs as much as one bake."""
        return self.cost.seconds / self.direct


DATA_SETS = (
    DataSet(
        "nucleons, 2 x 101^3 (generated)",
        generated(nucleons, 101),
        (0.2, 0.4, 0.6),
        Printed(9685, 2155, 5.61),
        "nucleons.json",
    ),
    DataSet(
        "LAPR, 2 x 120^3 (generated)",
        generated(lapr, 120),
        (0.2, 0.4, 0.6),
        Printed(5565, 522, 8.06),
        "lapr.json",
    ),
    DataSet(
        "neuron, 150^3 (generated)",
        generated(neuron, 150),
        (30.0, 60.0, 100.0),
        Printed(4587, 1229, 5.70),
    ),
    DataSet(
        "brain, Colin27 (ch2.nii.gz)",
        colin27,
        (24.5, 45.5, 70.5, 100.5, 150.5),
        Printed(5452, 1819, 6.53),
    ),
    DataSet(
        "nucleon (nucleon.raw)",
        nucleon,
        (20.5, 60.5, 100.5, 140.5, 180.5),
    ),
    DataSet(
        "neuron stack (rivulet_neuron.tif.zip)",
        neuron_stack,
        (20.5, 60.5, 100.5),
    ),
    DataSet(
        "bunny (bunny_ct_half.nrrd)",
        bunny,
        (400.5, 800.5, 1200.5),
    ),
)


def measure_data_sets(effort, folder=None):
    """Returns (rows, absent): a DataRow for each data set, and names of absent ones.

    folder: with the files of the real ones, or None.
    """
    rows, absent = [], []
    for data_set in DATA_SETS:
        volumes = data_set.volumes(folder, effort.fineness)
        if volumes is None:
            absent.append(data_set.name)
        else:
            rows.append(_row(data_set, volumes, effort))
    return rows, absent


def _row(data_set, volumes, effort):
    scene = packaged_scene(data_set.scene) if data_set.scene else cornell_box()
    scene = fit_scene(match_isosurfaces(scene, volumes), volumes)
    # Bakes in the thesis cover the whole range of the data; others have the default range.
    whole = (0.0, 1.0) if len(volumes) > 1 else volumes[0].data_range()
    isovalue_range = range_to_bake(whole if data_set.printed else None, volumes, scene.isosurfaces)

    baked, cost = measured(lambda: bake(volumes, scene, isovalues=isovalue_range))
    # Use another seed than the bake.
    reference = isosurfaces(
        volumes,
        scene,
        isovalue_range,
        data_set.isovalues,
        effort.vertices,
        effort.paths,
        seed=1,
    )
    error = reference.error(reference.radiance(baked))
    vertices = sum(len(one.vertices) for one in reference.surfaces) / len(data_set.isovalues)
    return DataRow(
        data_set,
        baked.statistics.texels,
        cost,
        baked.statistics.estimated_error_percent,
        error,
        reference.noise,
        reference.color,
        vertices,
        vertices * reference.seconds_to(error),
    )
