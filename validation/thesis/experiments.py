# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the thesis's tables on sampling again, with the same scenes, samples and error measure.

Each table is a function of its Effort.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from leaflight.bake.color_error import rms_percent
from leaflight.flatland.flatland import BRIGHTNESS_CORRECTION, bump_box_2d
from leaflight.io.scene_file import cornell_box, packaged_scene
from leaflight.scene.scene import fit_scene, match_isosurfaces
from leaflight.volume.particles import neuron
from leaflight.volume.volume import bump_box

from .bake import bake
from .flatland import bake_flatland
from .isosurfaces import isosurfaces
from .pictures import slice_picture, surface_picture, texture_picture
from .settings import Scattered

# Strategies that leave gaps, whose errors must be several times those of uniform samples.
BAD = ("letters", "slabs", "level_set")
CLEARLY_WORSE = 3.0
# The isosurface of thesis Table 4.2, and the isovalues of its level sets.
ISOVALUE = 47.0
THESIS_ISOVALUES = (0.01, 6.4744, 13.17, 19.3451, 24.8489, 29.5883, 39.0118, 56.6704, 160.873)
NEURON_ISOVALUE = 30.0
# Further isosurfaces for the samples of Table 4.2, for which it has no figures.
OTHER_ISOVALUES = (20.0, 100.0)


@dataclass(frozen=True)
class Effort:
    """The work of the tables, by default in full.

    The reference in the plane is a texture of regular samples. The reference in space are paths at
    some vertices of an isosurface.
    rays: shadow and gather rays of each scattered sample
    repetitions: repetitions of the first row of Table 4.2, with other seeds
    filters: True to add its rows with other filters and estimators
    """

    photons: int = 2_000_000
    flat_texels: int = 800
    flat_samples: int = 20_000
    flat_rays: int = 64
    flat_reference_samples: int = 10_000_000
    flat_reference_rays: int = 16
    texels: int = 100
    # Samples and rays of the columns of Table 4.2.
    samples_and_rays: tuple = ((1_000_000, 64), (10_000_000, 32))
    repetitions: int = 2
    filters: bool = True
    vertices: int = 4000
    paths: int = 16_384
    picture_paths: int = 256
    neuron_texels: int = 60
    neuron_samples: int = 64_000
    neuron_rays: int = 16
    # Ratios of the number of stratified samples to that of importance samples.
    neuron_factors: tuple = (1, 4, 8, 32)


QUICK = Effort(
    flat_reference_samples=2_560_000,
    samples_and_rays=((1_000_000, 64),),
    repetitions=0,
    filters=False,
    vertices=1000,
    paths=8192,
    picture_paths=64,
    neuron_factors=(1, 8),
)


@dataclass(frozen=True)
class Trial:
    """The settings of a row.

    scattered: None for samples in each texel
    printed: the error in the thesis, if it has one
    judged: True if the error must be as low as the thesis's, or high for a bad strategy
    repetition: the seed
    """

    name: str
    samples: int
    rays: int
    scattered: object = None
    printed: object = None
    estimator: str = "gather"
    judged: bool = True
    repetition: int = 0


@dataclass(frozen=True)
class Row:
    """The result of a trial: a bake, its error and its seconds.

    error: RMS error in percent
    others: further errors in percent, by their names
    verdict: the verdict in words
    passed: True if the error is as it must be; None if it is not judged
    """

    trial: Trial
    error: float
    seconds: float
    others: dict = field(default_factory=dict)
    verdict: str = "for comparison"
    passed: object = None


@dataclass(frozen=True)
class Table:
    """name: of its files; notes: sentences; pictures: of each kind {name: uint8 [y, x, RGB]}."""

    name: str
    title: str
    rows: list
    notes: list
    pictures: dict


def table_3_1(effort):
    """Textures of the 2D bump box (thesis Table 3.1)."""
    box = bump_box_2d(effort.flat_texels)

    def baked(trial, seed=0):
        return bake_flatland(
            box,
            isovalues=box.data_range(),
            samples=trial.rays,
            photons=effort.photons,
            scattered=trial.scattered,
            seed=seed,
        )

    # Use another seed, because noise of equal photons would cancel.
    reference = baked(_flat_reference(effort, "shepard", 1), seed=1)
    truth, exposure = reference.texture(), BRIGHTNESS_CORRECTION * reference.scene.exposure
    averaged = baked(_flat_reference(effort, "box", 0), seed=1).texture()
    rows, pictures = [], {"reference": texture_picture(truth, exposure)}
    for trial in _flat_trials(effort):
        result = baked(trial)
        texture = result.texture()
        errors = [rms_percent(texture, wanted, exposure) for wanted in (truth, averaged)]
        others = {"averaged reference": errors[1]}
        rows.append(Row(trial, errors[0], result.statistics.seconds, others))
        if trial.printed:
            pictures[trial.name] = texture_picture(texture, exposure)
    notes = [
        f"{effort.flat_texels} x {effort.flat_texels} texels, all isovalues. The error is that of "
        "the texture's pixels.",
        f"The reference is made of {effort.flat_reference_samples:,} regular samples with "
        f"{effort.flat_reference_rays} rays each, like the thesis's. Shepard's filter of 1 texel "
        "takes little but the nearest sample. The mean color is "
        f'{np.clip(truth * exposure, 0, 1).mean():.2f}. The column "averaged reference" has the '
        "same samples averaged over each texel. The two references differ by "
        f"{rms_percent(averaged, truth, exposure):.2f} %, from the noise of the first and the "
        "changes of light within a texel. Nothing is subtracted.",
        "Shepard's filter, as far-reaching as in figures 3.17 to 3.19 of the thesis: 16 texels, "
        "but 566 and 400 to fill the gaps of letters and level sets.",
    ]
    title = "Table 3.1: textures of the 2D bump box"
    return Table("table_3_1", title, judged(rows), notes, {"textures": pictures})


def _flat_reference(effort, filtering, radius):
    scattered = Scattered("regular", effort.flat_reference_samples, 10, filtering, radius)
    return Trial(
        f"reference, {filtering}",
        effort.flat_reference_samples,
        effort.flat_reference_rays,
        scattered,
    )


def _flat_trials(effort):
    def trial(name, printed=None, strategy=None, reach=16):
        radius = max(1, reach * effort.flat_texels // 800)
        scattered = Scattered(strategy or name, effort.flat_samples, 10, radius=radius)
        return Trial(name, effort.flat_samples, effort.flat_rays, scattered, printed)

    return [
        trial("uniform", 2.2),
        trial("non-uniform (letters)", 18.9, "letters", 566),
        trial("level sets (10 adaptive)", 7.4, "level_set", 400),
        trial("stratified"),
        trial("regular"),
        trial("importance"),
    ]


def table_4_2(effort):
    """Returns the rows of an isosurface of the 3D bump box (thesis Table 4.2)."""
    scene = packaged_scene("bump_box.json")
    volume = bump_box(effort.texels)
    box = _Isosurface(volume, scene, ISOVALUE, effort)
    others = {
        f"isosurface {isovalue:g}": _Isosurface(volume, scene, isovalue, effort)
        for isovalue in OTHER_ISOVALUES
    }
    rows, slices, views = [], {}, {}
    for column, work in enumerate(effort.samples_and_rays):
        block = []
        for trial in _space_trials(effort, column, *work):
            result = box.bake(trial)
            row = box.row(trial, result)
            errors = {name: other.row(trial, result).error for name, other in others.items()}
            block.append(replace(row, others=errors))
            if trial.printed and not trial.repetition and column == 0:
                texture = result.grid.dense("radiance")
                slices[trial.name] = slice_picture(texture, result.scene.exposure, zoom=4)
                views[trial.name] = box.picture(result.radiance(box.vertices))
        rows += judged(block)
    views = {"reference": box.reference_picture(), **views}
    notes = [
        f"{effort.texels}^3 texels, all isovalues. {box.note()}",
        *(f"{name.capitalize()}: {other.note()}" for name, other in others.items()),
        "Shepard's filter with a reach of 3 texels is the thesis's. The tent of 1 texel (thesis "
        "3.4.2) averages more samples, and needs them to leave no gaps.",
        "The thesis does not say how many slabs it has; here they are five. Where samples leave "
        "gaps, the gather rays of others look up what was filled in.",
        "Samples in each texel have as many rays in all as the scattered ones.",
    ]
    title = f"Table 4.2: isosurface {ISOVALUE:g} of the 3D bump box"
    return Table("table_4_2", title, rows, notes, {"slices": slices, "isosurfaces": views})


def _space_trials(effort, column, samples, rays):
    """Returns the rows of a column of thesis Table 4.2, numbered from 0.

    The second column has only the thesis's filter.
    """

    def trial(name, strategy, filtering=("shepard", 3), isovalues=9, **options):
        return Trial(
            name, samples, rays, Scattered(strategy, samples, isovalues, *filtering), **options
        )

    tent = ("tent", 1)
    uniform, slabs, level_sets = ((1.29, 9.55, 3.59), (1.08, 9.57, 3.47))[column]
    trials = [
        trial("uniform", "uniform", printed=uniform),
        trial("non-uniform (slabs)", "slabs", printed=slabs),
        trial(
            "level sets (the thesis's 9)",
            "level_set",
            isovalues=THESIS_ISOVALUES,
            printed=level_sets,
        ),
        trial("importance", "importance"),
    ]
    if column > 0 or not effort.filters:
        return trials
    again = [
        trial(f"uniform, seed {i}", "uniform", printed=uniform, repetition=i)
        for i in range(1, effort.repetitions + 1)
    ]
    return [
        *trials,
        *again,
        trial("uniform, tent", "uniform", tent),
        trial("importance, tent", "importance", tent),
        Trial("samples in each texel", samples, rays),
        trial("stratified", "stratified"),
        trial("stratified, tent", "stratified", tent),
        trial("level sets (9 of our own)", "level_set"),
        trial("uniform, the thesis's estimator", "uniform", estimator="thesis", judged=False),
    ]


def table_4_9(effort):
    """Returns the rows of importance and stratified samples on a neuron (thesis Fig. 4.9)."""
    volume = neuron(effort.neuron_texels)
    surface = _Isosurface(volume, cornell_box(), NEURON_ISOVALUE, effort)

    def row(strategy, samples):
        scattered = Scattered(strategy, samples, filter="tent", radius=1)
        trial = Trial(strategy, samples, effort.neuron_rays, scattered)
        return surface.row(trial, surface.bake(trial))

    importance = row("importance", effort.neuron_samples)
    rows = [importance]
    for factor in effort.neuron_factors:
        stratified = row("stratified", factor * effort.neuron_samples)
        passed = importance.error <= stratified.error
        verdict = f"{'no better' if passed else 'better'} than importance"
        rows.append(replace(stratified, passed=passed, verdict=verdict))
    notes = [
        f"A neuron-like volume of {effort.neuron_texels}^3 voxels in the Cornell box, one texel a "
        f"voxel; isosurface {NEURON_ISOVALUE:g}. {surface.note()}",
        "The thesis shows 2 million samples by importance (Eq. 4.12) to be as good as 64 million "
        "stratified ones on its neuron of 150^3 voxels.",
    ]
    views = {"reference": surface.reference_picture()}
    title = "Figure 4.9: importance against stratified samples"
    return Table("figure_4_9", title, rows, notes, {"isosurfaces": views})


def judged(rows):
    """Returns the rows with their verdicts; the first row has uniform samples and a printed error.

    Good strategies must not exceed the printed error of uniform samples, bad ones must be clearly
    worse than ours.
    """
    uniform = rows[0]
    limit = uniform.trial.printed
    judged = []
    for row in rows:
        if not row.trial.judged:
            pass
        elif row.trial.scattered and row.trial.scattered.strategy in BAD:
            ratio = row.error / uniform.error
            passed = ratio >= CLEARLY_WORSE
            verdict = f"{ratio:.1f} times uniform" + ("" if passed else ", too good")
            row = replace(row, passed=passed, verdict=verdict)
        else:
            passed = row.error <= limit
            verdict = f"{'at or below' if passed else 'above'} {limit:g}"
            row = replace(row, passed=passed, verdict=verdict)
        judged.append(row)
    return judged


class _Isosurface:
    """An isosurface of a volume, with path-traced radiance at some of its vertices."""

    def __init__(self, volume, scene, isovalue, effort):
        self._volume, self._isovalue, self._effort = volume, isovalue, effort
        self._scene = fit_scene(match_isosurfaces(scene, [volume]), [volume])
        self._reference = self._lit(effort.vertices, effort.paths)
        self._mesh = self._reference.surfaces[0]
        self.vertices = self._mesh.vertices

    def bake(self, trial):
        """Returns the Bake of a trial; samples in texels get the trial's total number of rays."""
        texels = self._volume.values.size
        rays = trial.rays if trial.scattered else max(1, trial.samples * trial.rays // texels)

        return bake(
            self._volume,
            self._scene,
            isovalues=self._volume.data_range(),
            samples=rays,
            photons=self._effort.photons,
            estimator=trial.estimator,
            scattered=trial.scattered,
            seed=trial.repetition,
        )

    def row(self, trial, baked):
        error = self._reference.error(self._reference.radiance(baked))
        return Row(trial, error, baked.statistics.seconds)

    def note(self):
        """Returns a note on the points of the errors, and on their reference."""
        return (
            f"The error is that at {len(self._mesh.chosen)} of the isosurface's "
            f"{len(self.vertices)} vertices, against {self._effort.paths} paths at each; mean "
            f"color {self._reference.color:.2f}. The "
            f"reference's own noise is {self._reference.noise:.2f} %; nothing is subtracted."
        )

    def picture(self, radiance):
        """Returns the isosurface with a radiance (n, 3) of its vertices."""
        return surface_picture(self.vertices, self._mesh.triangles, radiance, self._scene.exposure)

    def reference_picture(self):
        return self.picture(self._lit(len(self.vertices), self._effort.picture_paths).truth)

    def _lit(self, vertices, paths):
        """Returns Isosurfaces with only this one."""
        isovalue_range = self._volume.data_range()
        return isosurfaces(
            [self._volume], self._scene, isovalue_range, [self._isovalue], vertices, paths, seed=0
        )
