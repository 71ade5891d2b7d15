# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/images/refine.png: what finer texels show.

An isosurface baked with a texel a voxel, refined once and twice, and traced by paths.
"""

import sys

import leaflight
from leaflight.io.images import write_png
from leaflight.volume.particles import neuron
from leaflight.report.pictures import side_by_side, surface_picture

ISOVALUE = 40.0
PATHS = 256


def main(path):
    volume, pictures = neuron(48), []
    for refine in (0, 1, 2):
        baked = leaflight.bake(volume, isovalues=(10, 200), refine=refine)
        surface, exposure = baked.surface(ISOVALUE), baked.scene.exposure
        pictures.append(
            surface_picture(surface.vertices, surface.triangles, surface.radiance, exposure)
        )
    traced, _ = baked.reference(surface.vertices, ISOVALUE, PATHS)
    pictures.append(surface_picture(surface.vertices, surface.triangles, traced, exposure))
    write_png(path, side_by_side(pictures, reduction=2))


if __name__ == "__main__":
    main(sys.argv[1])
