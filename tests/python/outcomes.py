# SPDX-License-Identifier: GPL-3.0-or-later
"""What becomes of a file: the values that it holds, or a sentence for the user."""

import numpy as np
import pytest
from leaflight import LeaflightError, read_volume


def written(path, content):
    """Writes bytes, or a text, and returns the path."""
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def reads(values, path, **options):
    """Reads a volume, which has these values, and returns it."""
    __tracebackhide__ = True
    volume = read_volume(path, **options)
    np.testing.assert_array_equal(volume.values, values)
    return volume


def refused(sentence, function, *arguments, **options):
    """The call raises a LeaflightError of this sentence, a regular expression; returns its text."""
    __tracebackhide__ = True
    with pytest.raises(LeaflightError, match=sentence) as caught:
        function(*arguments, **options)
    return str(caught.value)
