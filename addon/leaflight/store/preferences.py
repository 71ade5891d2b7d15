# SPDX-License-Identifier: GPL-3.0-or-later
"""The user's settings for all files: Edit > Preferences > Add-ons > Leaflight."""

import os
from pathlib import Path

import bpy
from leaflight import limit_memory

from ..props import BoolProperty, FloatProperty, IntProperty, StringProperty

# Name of the add-on's module in Blender.
PACKAGE = __package__.rpartition(".")[0]


class LeaflightPreferences(bpy.types.AddonPreferences):
    bl_idname = PACKAGE

    own_cache_folder: BoolProperty(
        "Own Cache Folder",
        "Store bakes of unsaved files outside Blender's user folder, if that is on a "
        "small or slow disk",
    )
    cache_folder: StringProperty(
        "Cache Folder", "Folder of bakes of unsaved files", subtype="DIR_PATH"
    )
    limit_threads: BoolProperty(
        "Limit Threads",
        "Limit the number of threads of a bake, to leave processors to other work",
    )
    threads: IntProperty(
        "Threads",
        "Number of threads of a bake. The result does not depend on it",
        max(1, (os.cpu_count() or 2) // 2),
        min=1,
        soft_max=64,
    )
    limit_memory: BoolProperty(
        "Limit Memory",
        "Limit the memory of volumes and bakes. Larger volumes are kept in a file, "
        "and texels become coarser to fit",
        update=lambda self, _context: _limit_memory(self),
    )
    memory: FloatProperty(
        "Memory (GB)",
        "Memory limit of volumes and bakes in gigabytes",
        8.0,
        min=0.5,
        soft_max=512.0,
        precision=1,
        update=lambda self, _context: _limit_memory(self),
    )

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        for switch, value in (
            ("own_cache_folder", "cache_folder"),
            ("limit_threads", "threads"),
            ("limit_memory", "memory"),
        ):
            layout.prop(self, switch)
            row = layout.row()
            row.active = getattr(self, switch)
            row.prop(self, value)
        layout.operator("leaflight.copy_report", icon="COPYDOWN")


def cache_folder():
    """Returns the folder chosen for the bakes of unsaved files, a Path or None."""
    chosen = _chosen()
    if chosen is None or not (chosen.own_cache_folder and chosen.cache_folder):
        return None
    return Path(bpy.path.abspath(chosen.cache_folder))


def threads():
    """Returns the number of threads that may bake at once, 0 for all."""
    chosen = _chosen()
    return chosen.threads if chosen is not None and chosen.limit_threads else 0


def _chosen():
    """Returns the add-on's preferences, or None if it has none."""
    addon = bpy.context.preferences.addons.get(PACKAGE)
    return addon.preferences if addon is not None else None


def _limit_memory(chosen):
    limit_memory(int(chosen.memory * 2**30) if chosen.limit_memory else None, cache_folder())


def register():
    chosen = _chosen()
    if chosen is not None:
        _limit_memory(chosen)
