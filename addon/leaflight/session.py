# SPDX-License-Identifier: GPL-3.0-or-later
"""All that the add-on remembers of the open file beside it, forgotten before another is opened."""

_remembered = []


def remembered(kind=dict):
    """A dict, or an empty one of another kind, that forget() empties. Modules make theirs once."""
    made = kind()
    _remembered.append(made)
    return made


def forget():
    for each in _remembered:
        each.clear()
