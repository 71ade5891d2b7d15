# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that only show results, such as photons: the next bake does not see them."""

_DISPLAY = "leaflight_display"


def mark(obj, kind):
    obj[_DISPLAY] = kind


def is_display(obj, kind=None):
    """Whether an object only shows results, of this kind or of any."""
    return _DISPLAY in obj and kind in (None, obj[_DISPLAY])
