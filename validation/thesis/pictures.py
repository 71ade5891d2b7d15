# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of textures, slices and isosurfaces as uint8 [row, column, RGB]."""

import numpy as np
from leaflight.io.images import display_colors

# View direction towards isosurfaces, with y up.
TOWARDS = (0.3, 0.45, -1.0)
SIZE = 600
BACKGROUND = 40
GAP = 8


def texture_picture(texture, exposure):
    """Returns a displayed texture of radiance [y, x, RGB], y up."""
    return display_colors(texture[::-1], exposure)


def slice_picture(texture, exposure, zoom):
    """Returns the middle slice of a texture [z, y, x, RGB], y up; a texel is zoom pixels wide."""
    picture = texture_picture(texture[len(texture) // 2], exposure)
    return picture.repeat(zoom, axis=0).repeat(zoom, axis=1)


def surface_picture(vertices, triangles, radiance, exposure):
    """Returns an isosurface with the radiance of its vertices, (n, 3) both, without perspective."""
    from PIL import Image, ImageDraw

    forward = np.array(TOWARDS) / np.linalg.norm(TOWARDS)
    right = np.cross(forward, (0.0, 1.0, 0.0))
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(right, forward), forward], axis=1)
    seen = np.float64(vertices) @ axes
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
    scale = 0.94 * SIZE / (high - low).max()
    pixels = (seen[:, :2] - 0.5 * (low + high)) * (scale, -scale) + 0.5 * SIZE

    image = Image.new("RGB", (SIZE, SIZE), (BACKGROUND,) * 3)
    draw = ImageDraw.Draw(image)
    colors = display_colors(radiance[triangles].mean(axis=1), exposure)
    # Paint from far to near.
    for t in np.argsort(-seen[triangles, 2].mean(axis=1), kind="stable"):
        draw.polygon(pixels[triangles[t]].ravel().tolist(), fill=tuple(colors[t].tolist()))
    return np.asarray(image)


def side_by_side(pictures, reduction=1):
    """Returns pictures of one height in a row with white gaps; each pixel is the mean of
    reduction^2.
    """
    from PIL import Image

    images = [Image.fromarray(picture).reduce(reduction) for picture in pictures]
    width = sum(image.width for image in images) + GAP * (len(images) - 1)
    row = Image.new("RGB", (width, images[0].height), (255, 255, 255))
    left = 0
    for image in images:
        row.paste(image, (left, 0))
        left += image.width + GAP
    return np.asarray(row)
