# SPDX-License-Identifier: GPL-3.0-or-later
"""Flatland: all isolines of an image, lit within the plane (thesis chapter 3).

The height field is a Volume of two dimensions: arrays are [y, x] with y up, points (n, 2). Radiance
    is per length and angle. A diffuse line of albedo a reflects a / 2 of its irradiance in every
    direction; a surface in space reflects a / pi.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import leaflight._core as _core
import numpy as np
from numpy.typing import ArrayLike

from .._core import LeaflightError
from ..arrays import Array
from ..bake.checkpoint import Checkpoint
from ..bake.provenance import Provenance, provenance_of
from ..bake.settings import (
    BakeOptions,
    BakeSettings,
    CommonSettings,
    CoreSettings,
    range_to_bake,
)
from ..bake.statistics import Statistics, statistics_of
from ..io.images import display_colors, luminance, read_pixels
from ..paths import AnyPath
from ..progress_bar import with_progress
from ..volume.setting_error import SettingError, check_is_baked
from ..volume.volume import Volume, on_unit_cube
from .flat_scene import FlatScene, core_flat_scene, fit_flat_scene, flat_box, flat_scene_to_json

if TYPE_CHECKING:
    from PIL.Image import Image
    from typing_extensions import Unpack

# Factor for about the same brightness of a scene in the plane and in space (thesis 3.4.3).
BRIGHTNESS_CORRECTION = 2.0 / np.pi
# Constants of a picture: thickness of isolines, in longer sides; brightness of the image behind
# them; brightness of isolines, and the share of their points below it.
LINE_SHARE = 0.007
DIM = 0.5
BRIGHT, BRIGHT_SHARE = 0.8, 0.95
OVERSAMPLING = 3


@dataclass(frozen=True, eq=False)
class Isolines:
    """Lit isolines: vertices (n, 2) and radiance (n, 3), float32; segments int32 (m, 2)."""

    vertices: Array
    segments: Array
    radiance: Array


@dataclass(frozen=True, eq=False)
class FlatBake:
    """A height field, the scene in world coordinates, and the radiance of all its isolines.

    isovalues: The baked range (lo, hi).
    grid: A _core.RadianceGrid2.
    statistics, provenance, id: As in a Bake.
    """

    volume: Volume
    scene: FlatScene
    isovalues: tuple[float, float]
    grid: _core.RadianceGrid2
    statistics: Statistics
    provenance: Provenance

    @property
    def id(self) -> str:
        return self.provenance.id

    def texture(self) -> Array:
        """Returns radiance, linear float32 [y, x, RGB]; zero outside the isovalue range."""
        return self.grid.dense("radiance")

    def isolines(self, isovalue: float) -> Isolines:
        """Returns the Isolines of one isovalue.

        Raises LeaflightError outside the isovalue range.
        """
        check_is_baked(isovalue, self.isovalues)
        vertices, _, segments = _core.contour2(self.volume.flat_field(), isovalue)
        return Isolines(vertices, segments, self.radiance(vertices))

    def radiance(self, points: ArrayLike) -> Array:
        """Returns baked radiance, float32 (n, 3), at world points (n, 2); zero if there is none."""
        return self.grid.lookup(self.volume.flat_field(), points)

    def reference(
        self,
        points: ArrayLike,
        isovalue: float,
        spp: int = 1024,
        seed: int = 0,
        threads: int = 0,
        progress: _core.Progress | None = None,
    ) -> tuple[Array, Array]:
        """Computes path-traced radiance at points (n, 2) of an isoline, on its front.

        Returns (radiance, standard_error), float32 (n, 3) each. Raises LeaflightError, Cancelled.
        """
        scene = core_flat_scene(self.scene, self.volume.flat_field(), self.isovalues)
        progress = progress or _core.Progress()
        return _core.reference2(scene, points, isovalue, spp, seed, threads, progress)


def read_image(path: AnyPath) -> Volume:
    """Reads an image as a height field with a longest side of 1, a Volume of two dimensions.

    The image is PNG, JPEG, TIFF or EXR. Colors become their luminance (Rec. 709) in the stored
    numbers, 0..255 for 8 bits. Raises LeaflightError.
    """
    values = np.ascontiguousarray(luminance(read_pixels(path))[::-1])
    step = 1.0 / max(max(values.shape) - 1, 1)
    volume = Volume(values, np.diag([step, step, 1.0]), Path(path).stem, str(path))
    volume.field()
    return volume


def bump_box_2d(n: int = 200) -> Volume:
    """Returns the 2D bump box (thesis Eq. 2.1 without z): n^2 nodes, unit square, values 0..255."""
    return on_unit_cube(n, _core.bump_box2, "bump_box", "bump_box")


@with_progress("flatland")
def bake_flatland(
    volume: Volume,
    scene: FlatScene | None = None,
    *,
    on_pass: Callable[[FlatBake], object] | None = None,
    progress: _core.Progress | None = None,
    checkpoint: Checkpoint | None = None,
    **settings: "Unpack[BakeOptions]",
) -> FlatBake:
    """Computes the radiance of every isoline of a height field within the isovalue range.

    scene: A FlatScene, fitted around the height field. None is flat_box().
    settings: Fields of BakeSettings by name, as for leaflight.bake, except both_sides and walls.
    resolution: Texels along the longest axis, or (nx, ny).
    on_pass, progress, checkpoint: As for leaflight.bake.
    Returns a FlatBake. Raises Cancelled, and LeaflightError for input that cannot be baked.
    """
    asked = BakeSettings(**settings)
    refuse_sides(asked)
    scene, isovalue_range, core = flat_placed(volume, scene, asked.isovalues)
    exposure = BRIGHTNESS_CORRECTION * scene.exposure
    of_core = asked.core(_core.BakeSettings2, volume.flat_field().dims, exposure)
    provenance = flat_provenance(volume, scene, isovalue_range, of_core)

    def as_bake(baked: _core.Baked2) -> FlatBake:
        statistics = statistics_of(baked)
        known = provenance.after(baked.grids, statistics.passes, statistics.blocks)
        return FlatBake(volume, scene, isovalue_range, baked.grids[0], statistics, known)

    on_core_pass = None if on_pass is None else lambda baked: on_pass(as_bake(baked))
    rest = checkpoint.arguments(provenance) if checkpoint else {}
    return as_bake(
        _core.bake2(core, of_core, progress or _core.Progress(), on_pass=on_core_pass, **rest)
    )


def flat_provenance(
    volume: Volume,
    scene: FlatScene,
    isovalue_range: tuple[float, float],
    settings: CoreSettings,
    fixed: Mapping[str, Any] | None = None,
) -> Provenance:
    """Returns the Provenance of a FlatBake before its first pass, as provenance_of()."""
    text = flat_scene_to_json(scene)
    return provenance_of([volume], [scene.isosurfaces], text, isovalue_range, settings, fixed)


def refuse_sides(asked: CommonSettings) -> None:
    """Raises SettingError for light that a FlatBake does not hold."""
    for name, wished in (("both_sides", asked.both_sides), ("walls", asked.walls)):
        if wished:
            raise SettingError(
                f"Flatland bakes only the fronts of isolines, not {name}: leave it out.", name
            )


def flat_placed(
    volume: Volume, scene: FlatScene | None, isovalues: Sequence[float] | None
) -> tuple[FlatScene, tuple[float, float], _core.Scene2]:
    """Returns (FlatScene, range, _core.Scene2) for the arguments of bake_flatland()."""
    if np.ndim(volume.values) != 2:
        raise LeaflightError(
            f"{volume.name}: this is a volume, but flatland needs an image: read one with "
            "read_image()."
        )
    scene = fit_flat_scene(scene or flat_box(), volume)
    isovalue_range = range_to_bake(isovalues, [volume], [scene.isosurfaces])
    return scene, isovalue_range, core_flat_scene(scene, volume.flat_field(), isovalue_range)


def picture(bake: FlatBake, isovalues: Sequence[float], width: int = 1000) -> Array:
    """Draws lit isolines over their image in dim gray: uint8 [row, column, RGB], top row first.

    The exposure shows nearly all of their light and clips little of it.
    width: pixels of the longer side. Raises LeaflightError for an isovalue outside the range.
    """
    from PIL import ImageDraw

    low, high = np.asarray(bake.volume.field().bounds)
    # Draw larger, because Pillow does not smooth lines.
    scale = OVERSAMPLING * width / (high - low).max()
    size = np.maximum(1, np.rint(scale * (high - low))).astype(int)
    thickness = max(OVERSAMPLING, LINE_SHARE * max(size))
    image = _dim_image(bake.volume, size)
    draw = ImageDraw.Draw(image)
    isolines = [bake.isolines(isovalue) for isovalue in isovalues]
    exposure = _exposure([lines.radiance for lines in isolines])
    for lines in isolines:
        ends = scale * (lines.vertices - low)[lines.segments]
        ends[..., 1] = size[1] - ends[..., 1]
        colors = display_colors(lines.radiance[lines.segments].mean(axis=1), exposure)
        for (start, end), color in zip(ends.tolist(), map(tuple, colors.tolist())):
            draw.line([*start, *end], fill=color, width=round(thickness))
            # Fill the gaps where an isoline bends.
            for x, y in (start, end):
                box = np.add([x, y, x, y], 0.5 * thickness * np.array([-1, -1, 1, 1]))
                draw.ellipse(box.tolist(), fill=color)
    return np.asarray(image.reduce(OVERSAMPLING))


def _dim_image(volume: Volume, size: Array) -> "Image":
    from PIL import Image

    low, high = volume.field().range
    share = (np.nan_to_num(volume.values[::-1], nan=low) - low) / (high - low)
    gray = Image.fromarray(np.rint(255 * DIM * share).astype(np.uint8))
    # Nodes at the ends lie on the borders of the picture, not half a pixel within.
    across, down = ((n - 1) / m for n, m in zip(gray.size, size))
    place = (across, 0.0, 0.5, 0.0, down, 0.5)
    big = gray.transform(
        tuple(size.tolist()), Image.Transform.AFFINE, place, Image.Resampling.BILINEAR
    )
    return big.convert("RGB")


def _exposure(radiances: Sequence[Array]) -> float:
    brightest = np.concatenate(radiances).max(axis=1)
    positive = brightest[brightest > 0]
    return BRIGHT / np.quantile(positive, BRIGHT_SHARE) if len(positive) else 1.0
