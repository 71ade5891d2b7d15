# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes docs/images/regions.webp, stills of cut volumes on a lit floor.

    validation/run cut_pictures DIR

DIR holds the real volumes ch2.nii.gz and amos_0336.mhd.
"""

import argparse
from dataclasses import dataclass, replace
from pathlib import Path

import leaflight
import numpy as np
from leaflight.io.scene_file import packaged_scene
from leaflight.scene.scene import Fit, fitted
from leaflight.stills.first_view import camera_around_bake
from leaflight.volume.meshes import contour
from leaflight.volume.regions import LargestPart, changed

from measure.edits_against_cycles import outside_of_box

from .sheets import save_webp, sheet

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
PANEL = (560, 420)
# Error of the bakes in percent, which a picture of this size does not show.
ERROR = 4.0
# Exposure relative to that of the scene, whose floor is wide.
EXPOSURE = 2.2
# Gap between isosurface and floor, in sizes of the scene.
GAP = 0.01


@dataclass(frozen=True)
class Panel:
    """A still of a volume. angles: Degrees to the camera, around and above.

    colors: Color map of the slice on the cut, or an empty text.
    """

    volume: leaflight.Volume
    regions: tuple
    isovalue: float
    angles: tuple
    colors: str = ""

    def draw(self):
        isovalues = leaflight.default_isovalue_range(self.volume)
        volume = changed(self.volume, self.regions)
        scene = standing(volume, self.isovalue)
        if self.colors:
            slices = leaflight.slices_of(self.volume, self.regions)
            scene = scene.colored_by(leaflight.texture_of(slices, self.colors, isovalues))
        is_open = any(getattr(region, "cut", "") == "open" for region in self.regions)
        bake = leaflight.bake(
            volume,
            scene,
            isovalues=isovalues,
            walls=True,
            both_sides=is_open,
            error=ERROR,
            progress=False,
        )
        azimuth, elevation = self.angles
        camera = camera_around_bake(bake, azimuth, elevation, isovalue=self.isovalue, size=PANEL)
        return bake.still(self.isovalue, camera=camera, size=PANEL).convert("RGB")


def standing(volume, isovalue):
    """Returns a floor with lamps, on which an isosurface stands."""
    description = packaged_scene("open_floor.json")
    vertices, *_ = contour(volume.field(), isovalue)
    fit = Fit.of_box(vertices.min(axis=0), vertices.max(axis=0))
    floor = min(mesh.vertices[:, 2].min() for mesh in description.meshes)
    center = (*fit.center[:2], vertices[:, 2].min() - (floor + GAP) * fit.scale)
    description = replace(description, exposure=EXPOSURE * description.exposure)
    return fitted(description, Fit(np.array(center), fit.scale))


def regions(folder):
    """Returns a head cut in four ways, and a body with and without the table under it."""
    head = leaflight.read_volume(folder / "ch2.nii.gz")
    quarter = [
        outside_of_box((-0.1, 0.5, 0.4), (0.5, 1.2, 1.2), 0.2, cut)(head)[1][0]
        for cut in ("capped", "open")
    ]
    angles = (200, 25)
    body = leaflight.read_volume(folder / "amos_0336.mhd")
    return [
        Panel(head, quarter[:1], 24.5, angles),
        Panel(head, quarter[1:], 24.5, angles),
        Panel(head, quarter[:1], 24.5, angles, "CET_L1"),
        Panel(head, quarter[:1], 24.5, angles, "VIRIDIS"),
        Panel(body, (), -200.5, (150, 20)),
        Panel(body, (LargestPart(-200.5),), -200.5, (150, 20)),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="DIR")
    panels = regions(parser.parse_args().folder)
    save_webp(sheet([panel.draw() for panel in panels], 3, gap=0), IMAGES / "regions.webp", 88)


if __name__ == "__main__":
    main()
