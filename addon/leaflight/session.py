# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's caches for the open file, which are cleared before another file is opened."""

_caches = []


def cache(kind=dict):
    """Returns a new dict or other container, which clear() empties. Modules call it at import."""
    made = kind()
    _caches.append(made)
    return made


def clear():
    for each in _caches:
        each.clear()
