# SPDX-License-Identifier: GPL-3.0-or-later
"""The light of a bake on data that regions have changed since, such as the cut of a moved box.

It is an estimate (leaflight.bake.changed_values), until Live or a bake follows.
"""

import bpy
import numpy as np
from leaflight.bake.changed_values import with_values

from .. import session
from ..store import cache, source_files
from . import lamps

# Full name of an object -> (bake, values of its volume, the bake with an estimate for them).
_estimates = session.cache()


def light_of(obj):
    """Returns lamps.light_of(), with an estimate near changes. Raises as cache.light_of()."""
    bake, settings = lamps.light_of(obj), obj.leaflight
    if bake is None or not source_files.regions_alone_changed(settings):
        _estimates.pop(obj.name_full, None)
        return bake
    known = _estimate(obj, bake)
    if known is None:
        volumes = list(bake.volumes)
        volumes[settings.bake_index] = volume_in_bake(obj)
        known = with_values(bake, volumes)
        for name in set(_estimates) - {each.name_full for each in bpy.data.objects}:
            del _estimates[name]
        _estimates[obj.name_full] = bake, cache.volume_of(obj).values, known
    return known


def _estimate(obj, bake):
    """Returns the bake with an estimate that light_of() made for the present values, or None."""
    known = _estimates.get(obj.name_full)
    is_present = known and known[0] is bake and known[1] is cache.volume_of(obj).values
    return known[2] if is_present else None


def volume_in_bake(obj):
    """Returns the volume of an object where it was when it was baked. Raises as light_of()."""
    volume, settings = cache.volume_of(obj), obj.leaflight
    to_world = np.array(settings.bake_matrix, np.float64).reshape(4, 4)
    return cache.placed(volume, to_world @ volume.index_to_world)


def with_present_values(objects):
    """Returns a function of a bake that lights objects to one with their present values.

    The result may lack direct light. The function works in any thread. Raises as light_of().
    """
    objects = [obj for obj in objects if source_files.regions_alone_changed(obj.leaflight)]
    changed = {obj.leaflight.bake_index: volume_in_bake(obj) for obj in objects}
    # An estimate takes as long as direct light, so take the one that is shown.
    shown = lamps.light_of(objects[0]) if len(objects) == 1 else None
    estimate = shown and _estimate(objects[0], shown)

    def changed_bake(bake):
        if estimate and bake is shown:
            return estimate
        volumes = [changed.get(number, volume) for number, volume in enumerate(bake.volumes)]
        return with_values(bake, volumes, direct=False) if changed else bake

    return changed_bake
