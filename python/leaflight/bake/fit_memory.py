# SPDX-License-Identifier: GPL-3.0-or-later
"""Chooses the texels of a bake in passes so that its light fits into memory."""

from collections.abc import Iterable
from math import prod

import leaflight._core as _core

from ..scene.scene import SceneDescription, core_scene
from ..volume.memory import is_limited, memory_of_light
from ..volume.setting_error import SettingError
from ..volume.volume import Volume
from .statistics import FINER_TEXELS, SkippedPass

# Upper bound on the bytes of the light of a texel.
_MOST_OF_A_TEXEL = 500
_MOST_TEXELS = 2**31


def fit_memory(
    volume: Volume,
    description: SceneDescription,
    isovalue_range: tuple[float, float],
    settings: _core.BakeSettings,
) -> None:
    """Sets the resolution of settings that have none, if the default would not fit into memory.

    settings: _core.BakeSettings. Raises SettingError if the resolution asked for does not fit.
    """
    field = volume.field()
    may_take = memory_of_light(prod(field.dims))
    asked = settings.resolution if any(settings.resolution) else None
    texels = prod(asked or field.dims)
    # Texels finer than voxels are few.
    if may_take is None or _MOST_OF_A_TEXEL * max(texels, prod(field.dims)) < may_take:
        return
    if asked and texels >= _MOST_TEXELS:
        return  # The core refuses so many texels with any memory.
    scene = core_scene(description, [field], isovalue_range)
    if not asked:
        settings.resolution = _core.fitting_resolution(scene, settings, may_take)
        return
    most = may_take if is_limited() else max(may_take, _core.machine_memory())
    # Try coarse texels first: they show quickly that a far too fine resolution cannot fit.
    for width in (8, 4, 2, 1):
        settings.resolution = tuple(max(2, n // width) for n in asked)
        takes = _core.light_memory(scene, settings)
        if takes <= most:
            continue
        settings.resolution = (0, 0, 0)
        fitting = _core.fitting_resolution(scene, settings, most)
        raise SettingError(
            f"The light of {_by(asked)} texels takes {'over' if width > 1 else 'about'} "
            f"{takes / 2**20:.0f} MiB of memory, but may take {most / 2**20:.0f} MiB: give a lower "
            f"resolution (without one it is {max(fitting) or max(field.dims)}), or more memory.",
            "resolution",
        )


def coarser_texels(resolution: object, settings: _core.BakeSettings) -> tuple[SkippedPass, ...]:
    """Returns why memory made texels coarser, as in skipped_passes; or ().

    resolution: the resolution that the user asked for, or None.
    """
    if resolution is not None or not any(settings.resolution):
        return ()
    reason = f"the memory has room for {_by(settings.resolution)} texels"
    return (SkippedPass(FINER_TEXELS, reason),)


def _by(numbers: Iterable[int]) -> str:
    return " x ".join(map(str, numbers))
