# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin for napari (napari.yaml): bakes as lit surfaces, and a slider of the isovalue.

napari has its axes in the order z, y, x.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from magicgui.widgets import Container, FloatSlider, Label

from .._core import LeaflightError
from ..bake.baked import Bake
from ..bake.load_bake import load_bake
from ..io.images import display_colors
from ..stills.first_view import default_isovalue_of

# Key of a layer's metadata: its bake.
_BAKE = "leaflight_bake"


def reader_of(path: Any) -> Callable[[Any], list[Any]] | None:
    """Returns the reader of a bake, or None for other files."""
    if not isinstance(path, str) or not path.lower().endswith(".vdb"):
        return None
    try:
        bake = load_bake(path)
    except LeaflightError:
        return None
    return lambda _path: [_layer(bake, default_isovalue_of(bake))]


class IsovalueSlider(Container):  # type: ignore[misc]
    """The widget with the isovalue of the selected lit surface, or of the first one."""

    def __init__(self, napari_viewer: Any) -> None:
        layers = [*napari_viewer.layers.selection, *napari_viewer.layers]
        lit = next((layer for layer in layers if _BAKE in layer.metadata), None)
        if lit is None:
            super().__init__(widgets=[Label(value="Open a bake of Leaflight (.vdb) first.")])
            return
        low, high = lit.metadata[_BAKE].isovalues
        shown = default_isovalue_of(lit.metadata[_BAKE])
        slider = FloatSlider(value=shown, min=low, max=high, name="Isovalue")
        slider.changed.connect(lambda isovalue: show(lit, isovalue))
        super().__init__(widgets=[slider])


def show(layer: Any, isovalue: float) -> None:
    """Shows another isosurface of its bake in a layer; keeps the present one if it is empty."""
    bake = layer.metadata[_BAKE]
    try:
        data, options, _ = _layer(bake, isovalue)
    except LeaflightError:
        return
    if len(data[1]):
        # Colors of another number of vertices are refused.
        layer.vertex_colors = None
        layer.data = data
        layer.vertex_colors = options["vertex_colors"]


def _layer(bake: Bake, isovalue: float) -> tuple[Any, dict[str, Any], str]:
    surface = bake.surface(isovalue)
    colors = display_colors(surface.radiance, bake.scene.exposure) / np.float32(255)
    data = surface.vertices[:, ::-1], surface.triangles[:, ::-1]
    options = {
        "name": bake.volume.name,
        "vertex_colors": colors,
        "shading": "none",
        "metadata": {_BAKE: bake},
    }
    return data, options, "surface"
