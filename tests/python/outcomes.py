# SPDX-License-Identifier: GPL-3.0-or-later
"""Helpers that write a file and check how it is read: its values, or an error."""

import numpy as np
import pytest
from leaflight import LeaflightError, read_volume


def written(path, content):
    """Writes bytes or text, and returns the path."""
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def reads(values, path, **options):
    """Checks that a file has these values, and returns its volume."""
    __tracebackhide__ = True
    volume = read_volume(path, **options)
    np.testing.assert_array_equal(volume.values, values)
    return volume


def refused(sentence, function, *arguments, **options):
    """Checks that a call raises LeaflightError, and returns its message.

    sentence: regular expression that the message contains.
    """
    __tracebackhide__ = True
    with pytest.raises(LeaflightError, match=sentence) as caught:
        function(*arguments, **options)
    return str(caught.value)
