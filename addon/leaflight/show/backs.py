# SPDX-License-Identifier: GPL-3.0-or-later
"""Isosurfaces that are seen from their back, and are not lit there."""

from leaflight import LeaflightError
from leaflight.volume.backs import MOSTLY, back_shares

from .. import session
from ..store import cache
from ..translations import iface_
from . import added, look
from .isosurface import RADIANCE_BACK

# (the address of a volume, isovalue) -> the share of the isosurface that shows its back.
_shares = session.remembered()


def note(volume):
    """A sentence for the panel where a bake lacks the side that is seen, or an empty text."""
    if not volume.leaflight.bake_id or RADIANCE_BACK in volume.data.attributes:
        return ""
    surfaces = (volume, *added.added_to(volume))
    try:
        data = cache.volume_of(volume)
    except LeaflightError:
        return ""
    if any(_share(data, obj.leaflight.isovalue) > MOSTLY for obj in surfaces):
        return iface_(
            "This isosurface is seen from its back, which is not baked: turn on Both Sides and "
            "bake again"
        )
    if any(look.box_of(obj) is not None for obj in surfaces):
        return iface_("The cut shows backs, which are not baked: turn on Both Sides and bake again")
    return ""


def _share(data, isovalue):
    key = id(data), isovalue
    if key not in _shares:
        (_shares[key],) = back_shares(data.data(), data.index_to_world, [isovalue])
    return _shares[key]
