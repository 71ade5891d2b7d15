# SPDX-License-Identifier: GPL-3.0-or-later
"""Which isosurface to show next: one inside those that are shown, or a tissue by its name."""

from leaflight.volume.first_isovalue import inner_isovalue

from ..show import added, isovalues
from ..store import cache
from . import distribution

_PROPOSED = "PROPOSED"
# In Hounsfield units.
TISSUES = {"SKIN": -300.0, "MUSCLE": 50.0, "BONE": 300.0}
TISSUE_ITEMS = [
    (_PROPOSED, "What Is Inside", "The isosurface that best parts what is inside the present one"),
    ("SKIN", "Skin", "The border of the body to the air, -300 HU"),
    ("MUSCLE", "Muscle", "Muscles and organs within fat, 50 HU"),
    ("BONE", "Bone", "300 HU"),
]
# Of the air around a patient, -1000 HU, and of what scanners write beside their circle.
_AIR = (-3100.0, -900.0)


def is_hounsfield(obj):
    """Whether the values of an object's volume are those of a CT scan; False until it was seen."""
    found = distribution.of(obj)
    low, high = (found.low, found.high) if found is not None else (0.0, 0.0)
    return _AIR[0] <= low <= _AIR[1] and high > TISSUES["BONE"]


def next_isovalue(volume, tissue=_PROPOSED):
    """Of an isosurface to show beside those that a volume object shows. Raises LeaflightError."""
    if tissue != _PROPOSED:
        return TISSUES[tissue]
    low, high = isovalues.isovalue_range(volume.leaflight)
    shown = [obj.leaflight.isovalue for obj in (volume, *added.added_to(volume))]
    inner = inner_isovalue(cache.volume_of(volume), max(shown))
    if inner is not None and max(shown) < inner < high:
        return inner
    # Nothing to be seen is inside.
    if min(shown) - low > 0.1 * (high - low):
        return 0.5 * (low + min(shown))
    return 0.5 * (max(shown) + high)


def shown_outside(volume, isovalue):
    """The isosurfaces of a volume object around another one."""
    surfaces = (volume, *added.added_to(volume))
    return [obj for obj in surfaces if obj.leaflight.isovalue < isovalue]
