# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's caches for the open file, which are cleared before another file is opened."""

_remembered = []


def remembered(kind=dict):
    """Returns a new dict or other container, which forget() clears. Modules call it at import."""
    made = kind()
    _remembered.append(made)
    return made


def forget():
    for each in _remembered:
        each.clear()
