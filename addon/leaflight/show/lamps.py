# SPDX-License-Identifier: GPL-3.0-or-later
"""Relighting of bakes for the present strengths and colors of the scene's lamps.

An object stores the lamps of its bake as text. Factors of the lamps whose strength has changed are
computed after each change (stage/staleness.py). They are never saved.
"""

import dataclasses
import json
from typing import Any

from leaflight.bake.relit import scales_exactly
from leaflight.scene.lights import LIGHTS, Cone, strengths_of

from .. import session
from ..store import cache

# Id of a bake -> ((name of a lamp, factors (r, g, b)), ...) of the changed lamps.
_factors = session.cache()
# Id of a bake -> (factors as above, the relit bake).
_relit = session.cache()


def record(bake, lights):
    """Returns the lamps of a bake as text. lights: those of the exported scene, in the same order.

    The text is empty if the bake cannot be relit.
    """
    names = [light.name for light in bake.scene.lights]
    exact = all(grid.can_be_relit for grid in bake.grids)
    if not exact or len(set(names)) < len(names) or len(lights) != len(names):
        return ""
    rows = [
        (name, type(light).__name__, dataclasses.asdict(light))
        for name, light in zip(names, lights)
    ]
    return json.dumps(rows)


def as_baked(settings, lights):
    """Returns the lights of an object's bake, including those that are dark or gone now.

    Returns None if the scene has other lights than at the bake.
    """
    baked = _baked_lights(settings)
    if baked is None:
        return None
    known = {light.name: light for _, light in baked}
    for light in lights:
        if light.name not in known or _shape(light) != _shape(known[light.name]):
            return None
    return [light for _, light in baked] if len({x.name for x in lights}) == len(lights) else None


def follow(settings, lights):
    """Updates the factors of the lamps that lit an object. Returns True if they have changed.

    lights: those of the scene, or None for the strengths of the bake.
    """
    found, before = _found(settings, lights), _factors.get(settings.bake_id, ())
    _factors[settings.bake_id] = found
    return found != before


def factors_of(settings):
    """Returns ((name, (r, g, b)), ...) of the lamps that have changed since an object's bake."""
    return _factors.get(settings.bake_id, ())


def label(settings):
    """Returns a key of the lamps' strengths, empty for those of the bake."""
    factors = factors_of(settings)
    return repr(factors) if factors else ""


def light_of(obj):
    """Returns light_of() of the cache, relit for the present lamps. Raises LeaflightError."""
    return _with_lamps(cache.light_of(obj), factors_of(obj.leaflight))


def whole_of(obj):
    """Returns whole_of() of the cache, relit for the present lamps. Raises LeaflightError."""
    wait, factors = cache.whole_of(obj), factors_of(obj.leaflight)
    return lambda progress: _with_lamps(wait(progress), factors)


def _with_lamps(bake, factors):
    if bake is None or not factors:
        return bake
    known = _relit.get(bake.id)
    if known is None or known[0] != factors or known[1].original is not bake:
        for identifier in [one for one in _relit if not _factors.get(one)]:
            del _relit[identifier]
        known = _relit[bake.id] = factors, bake.relit(dict(factors))
    return known[1]


def sentence(obj):
    """Returns a sentence about a bake that is shown relit, or an empty text."""
    if not factors_of(obj.leaflight):
        return ""
    known = _relit.get(obj.leaflight.bake_id)
    if known is not None and scales_exactly(known[1]):
        return "Lamps have changed since the bake: their light is scaled, which is exact"
    return "Lamps have changed since the bake: direct light is exact, indirect light is scaled"


def _found(settings, lights):
    if lights is None or as_baked(settings, lights) is None:
        return ()
    now, found = {light.name: light for light in lights}, []
    for name, light in _baked_lights(settings):
        before = strengths_of(light)
        after = strengths_of(now[light.name]) if light.name in now else (0.0, 0.0, 0.0)
        if any(a > 0 and not b > 0 for a, b in zip(after, before)):
            # The bake has no light of this color to scale.
            return ()
        factor = tuple(a / b if b > 0 else 1.0 for a, b in zip(after, before))
        if factor != (1.0, 1.0, 1.0):
            found.append((name, factor))
    return tuple(found)


def _baked_lights(settings):
    """Returns [(name in the bake, light), ...], or None if the bake cannot be relit."""
    if not settings.bake_lamps:
        return None
    return [(name, _light(kind, fields)) for name, kind, fields in json.loads(settings.bake_lamps)]


def _light(kind, fields):
    known: dict[str, Any] = {
        key: tuple(x) if isinstance(x, list) else x for key, x in fields.items()
    }
    if known.get("cone") is not None:
        cone = known["cone"]
        known["cone"] = Cone(**{**cone, "axis": tuple(cone["axis"])})
    return LIGHTS[kind](**known)


def _shape(light):
    """Returns all data of a lamp except its strength and color."""
    fields = dataclasses.asdict(light)
    return type(light), {key: x for key, x in fields.items() if key != light.STRENGTH}
