# SPDX-License-Identifier: GPL-3.0-or-later
"""Sources of volumes: files, and generated volumes by name."""

from collections.abc import Callable, Sequence
from numbers import Integral
from typing import Any

from .._core import Progress
from ..paths import AnyPath
from ..volume.particles import hydrogen, lapr, neuron, nucleons
from ..volume.regions import as_regions, changed
from ..volume.setting_error import SettingError
from ..volume.volume import Volume, bump_box
from .readers.option_types import check_types
from .readers.reading import read_volume, with_label_maps

# Name -> function from the number of nodes per axis to a Volume; defaults are those of the thesis.
_GENERATED: dict[str, Callable[..., Volume]] = {
    "bump_box": bump_box,
    "nucleons:0": lambda *n: nucleons(*n)[0],
    "nucleons:1": lambda *n: nucleons(*n)[1],
    "lapr:0": lambda *n: lapr(*n)[0],
    "lapr:1": lambda *n: lapr(*n)[1],
    "neuron": neuron,
    "hydrogen": hydrogen,
}
GENERATED = tuple(_GENERATED)


def is_generated(source: AnyPath) -> bool:
    """Returns True if the text names a generated volume, not a file."""
    return source in _GENERATED


def open_volume(source: AnyPath, *, dims: Sequence[int] | None = None, **layout: Any) -> Volume:
    """Returns the Volume of a file or folder, or a generated one.

    dims: For a .raw (nx, ny, nz); for a generated volume a list of one number, the nodes per axis.
    Other options are those of read_volume(). Raises LeaflightError.
    """
    if not is_generated(source):
        return read_volume(source, dims=dims, **layout)
    regions = with_label_maps(as_regions(layout.pop("regions", None)), Progress())
    for name, value in layout.items():
        if value is not None:
            raise SettingError(
                f"{source}: the option {name} does not apply to generated volumes; leave it out.",
                name,
            )
    check_types(source, {"dims": dims})
    if dims is not None and not (len(dims) == 1 and isinstance(dims[0], Integral)):
        raise SettingError(
            f"{source}: the size is not one whole number: give the nodes per side.", "dims"
        )
    return changed(_GENERATED[str(source)](*(dims or ())), regions)
