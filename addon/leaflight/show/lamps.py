# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes as they are shown: with the lamps of the scene at their present strengths and colors.

An object remembers the lamps that its bake was made with, as text. Factors of those whose strength
has changed since are found anew after each change (stage/staleness.py), and are never saved.
"""

import dataclasses
import json
from typing import Any

from leaflight.bake.relit import scales_exactly, strengths_of
from leaflight.scene.scene import AreaLight, Cone, PointLight, SunLight

from .. import session
from ..store import cache

_KINDS = {kind.__name__: kind for kind in (AreaLight, PointLight, SunLight)}
_STRENGTHS = ("radiance", "intensity", "irradiance")

# Id of a bake -> ((name of a lamp, factors (r, g, b)), ...), of those that have changed.
_factors = session.remembered()
# Id of a bake -> (such factors, the Bake with them).
_relit = session.remembered()


def record(bake, lights):
    """Text of the lamps that a bake was made with, as the scene has them: [leaflight's lights].

    It is empty where their strengths cannot be changed.
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
    """The present lights of a scene, with the strengths that they had at the bake of an object.

    Those that are dark or gone now are among them. None where the scene has others than then.
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
    """Learns how strong the lamps that lit an object are now; returns whether that is new.

    lights: those of the scene, None as they were baked.
    """
    found, before = _found(settings, lights), _factors.get(settings.bake_id, ())
    _factors[settings.bake_id] = found
    return found != before


def factors_of(settings):
    """((name, (r, g, b)), ...) of the lamps that are not as strong as at the bake of an object."""
    return _factors.get(settings.bake_id, ())


def label(settings):
    """A key, different for each set of strengths of the lamps; empty for those of the bake."""
    factors = factors_of(settings)
    return repr(factors) if factors else ""


def light_of(obj):
    """light_of() of the cache, with its lamps as strong as they are now. Raises LeaflightError."""
    return _with_lamps(cache.light_of(obj), factors_of(obj.leaflight))


def whole_of(obj):
    """whole_of() of the cache, with its lamps as strong as they are now. Raises LeaflightError."""
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
    """A sentence about a bake that is shown with other strengths, or an empty text."""
    if not factors_of(obj.leaflight):
        return ""
    known = _relit.get(obj.leaflight.bake_id)
    if known is not None and scales_exactly(known[1]):
        return "Lamps have changed since the bake: all light is scaled, exactly"
    return "Lamps have changed since the bake: direct light is exact, indirect light scaled"


def _found(settings, lights):
    if lights is None or as_baked(settings, lights) is None:
        return ()
    now, found = {light.name: light for light in lights}, []
    for name, light in _baked_lights(settings):
        before = strengths_of(light)
        after = strengths_of(now[light.name]) if light.name in now else (0.0, 0.0, 0.0)
        if any(a > 0 and not b > 0 for a, b in zip(after, before)):
            # Light of a color that was not baked.
            return ()
        factor = tuple(a / b if b > 0 else 1.0 for a, b in zip(after, before))
        if factor != (1.0, 1.0, 1.0):
            found.append((name, factor))
    return tuple(found)


def _baked_lights(settings):
    """[(name in the bake, light), ...], None where strengths cannot be changed."""
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
    return _KINDS[kind](**known)


def _shape(light):
    """All of a lamp but its strength and color, as plain data."""
    fields = dataclasses.asdict(light)
    return type(light), {key: x for key, x in fields.items() if key not in _STRENGTHS}
