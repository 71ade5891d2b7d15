# SPDX-License-Identifier: GPL-3.0-or-later
"""Decides if a bake includes the backs of isosurfaces when the user has not."""

from collections.abc import Sequence

from ..scene.scene import Isosurfaces
from ..volume.backs import MOSTLY, back_shares
from ..volume.first_isovalue import default_isovalue
from ..volume.volume import Volume

# Values of both signs may be lobes if the shorter of their ranges below and above 0 is at least
# this part of the longer one. Negative values of densities and images are noise.
_BALANCED = 0.5
# Above this share of the visible area, unlit backs spoil the picture. An example is labels that
# fill the volume up to its border.
_MUCH = 1.0 / 3.0


def why_both_sides(volume: Volume, isovalues: tuple[float, float]) -> str:
    """Returns the begin of a sentence on isosurfaces seen from their backs, or "".

    isovalues: the isovalue range of the volume.
    Examines the isosurface that is shown first and, if values have both signs, one of negative
    values.
    """
    lo, hi = isovalues
    first = default_isovalue(volume)
    first = first if lo < first < hi else 0.5 * (lo + hi)
    looked_at = [first]
    if _are_balanced(lo, hi) and _are_balanced(*volume.data_range()):
        looked_at.append(0.5 * lo)
    shares = back_shares(volume.values, volume.index_to_world, looked_at)
    if shares[0] > MOSTLY:
        return f"{volume.name}: its isosurfaces are seen from their backs"
    if shares[0] > _MUCH:
        return f"{volume.name}: much of its isosurfaces is seen from the back"
    if shares[-1] > MOSTLY:
        return f"{volume.name}: its isosurfaces below 0 are seen from their backs"
    return ""


def _are_balanced(low: float, high: float) -> bool:
    return low < 0 < high and min(-low, high) >= _BALANCED * max(-low, high)


def why_both_sides_of(
    volumes: Sequence[Volume],
    isosurfaces: Sequence[Isosurfaces],
    isovalues: tuple[float, float],
) -> str:
    """Returns why_both_sides() of the volumes of a scene, skipping mirrors and glass.

    Mirrors and glass store no light.

    isovalues: the range of the common isovalue.
    """
    for volume, material in zip(volumes, isosurfaces):
        low, high = material.isovalues if len(volumes) > 1 and material.isovalues else isovalues
        why = "" if material.scattering != "diffuse" else why_both_sides(volume, (low, high))
        if why:
            return why
    return ""
