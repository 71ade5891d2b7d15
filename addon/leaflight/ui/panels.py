# SPDX-License-Identifier: GPL-3.0-or-later
"""The Leaflight tab of the 3D viewport's sidebar: its panels, from top to bottom."""

from . import (
    advanced_panel,
    animation,
    bake_panel,
    clip_panel,
    comparison_panel,
    data_panel,
    flatland_panel,
    label_panel,
    look_panel,
    slice_panel,
    stage_panel,
    volume_panel,
)

_PANELS = (
    volume_panel,
    data_panel,
    flatland_panel,
    stage_panel,
    bake_panel,
    advanced_panel,
    look_panel,
    clip_panel,
    slice_panel,
    animation,
    label_panel,
    comparison_panel,
)


def register():
    for panel in _PANELS:
        panel.register()


def unregister():
    for panel in reversed(_PANELS):
        panel.unregister()
