# SPDX-License-Identifier: GPL-3.0-or-later
"""The type of paths in annotations."""

import os

AnyPath = str | os.PathLike[str]
