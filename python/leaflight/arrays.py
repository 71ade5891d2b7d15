# SPDX-License-Identifier: GPL-3.0-or-later
"""The type of arrays in annotations. Docstrings give shapes, units and types of elements."""

from typing import Any

from numpy.typing import NDArray

Array = NDArray[Any]
