# SPDX-License-Identifier: GPL-3.0-or-later
"""Presses and drags of the mouse, for stepwise.run(). A Blender without the add-on can use it."""

import stepwise

# Steps of the mouse per second.
PER_SECOND = 30


def gesture(window, places):
    """Presses the mouse at the first position, and releases it at the last."""
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=places[0][0], y=places[0][1])
    yield 0.05
    window.event_simulate(type="LEFTMOUSE", value="PRESS", x=places[0][0], y=places[0][1])
    for x, y in places[1:]:
        yield 1.0 / PER_SECOND
        window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
    yield 1.0 / PER_SECOND
    window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=places[-1][0], y=places[-1][1])


def find_slider(window, x, rows, value):
    """Presses and drags slightly in each row until value() changes; returns the position."""
    for y in rows:
        before = value()
        yield from gesture(window, [(x, y), *((x + 3 * k, y) for k in range(1, 6))])
        yield from stepwise.wait(0.3)
        if value() != before:
            return x, y
    raise RuntimeError("There is no slider of the isovalue.")
