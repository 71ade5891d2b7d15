# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of a volume that the import keeps."""

from dataclasses import dataclass

import numpy as np
from leaflight import LeaflightError
from leaflight.volume.cuts import Box, crop_of

from . import regions


@dataclass(frozen=True)
class Crop:
    """Start and end of a part, in percent along each axis (x, y, z) of the voxels."""

    low: tuple
    high: tuple

    @classmethod
    def of(cls, operator):
        """Returns the Crop of an import, or None."""
        if not operator.crop:
            return None
        return cls(tuple(operator.crop_from), tuple(operator.crop_to))

    def dims(self, dims):
        """Returns the voxels (nx, ny, nz) of the part, 0 for an empty one."""
        planes = crop_of(Box.between(*self._ends(dims), cut="open"))[::-1]
        return tuple(
            kept.stop - kept.start if a < b else 0
            for kept, a, b in zip(planes, self.low, self.high)
        )

    def region_of(self, volume):
        """Returns the region of the part. Raises LeaflightError for an empty one."""
        if not all(np.subtract(self.high, self.low) > 0):
            raise LeaflightError(
                f"{volume.source or volume.name}: the crop is empty: let it end after its start "
                "along each axis."
            )
        first, last = self._ends(volume.values.shape[::-1])
        return regions.crop(first, last, volume.index_to_world)

    def _ends(self, dims):
        return (0.01 * np.array(end) * (np.array(dims) - 1) for end in (self.low, self.high))
