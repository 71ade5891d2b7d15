# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a bake in the format of a file's suffix."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import leaflight._core as _core

from .._core import LeaflightError
from ..bake.baked import Bake, Surface
from ..io.output import check_writable
from ..paths import AnyPath
from ..progress_bar import with_progress
from ..stills.first_view import default_isovalue_of
from ..volume.exploded import explode_offsets
from ..volume.setting_error import SettingError
from .page import PageOptions, export_page

if TYPE_CHECKING:
    from typing_extensions import Unpack

# Suffix -> (module, function), for a web page, the whole volume, one isosurface, and one or a
# sequence.
PAGE = ".html"
OF_VOLUME = {
    ".vti": ("vtk_files", "write_vti"),
    ".am": ("amira", "write_amira"),
    ".blend": ("blend", "write_blend"),
}
OF_SURFACE = {".vtp": ("vtk_files", "write_vtp"), ".ply": ("ply", "write_ply")}
OF_SEQUENCE = {
    ".glb": ("gltf", "write_glb"),
    **{suffix: ("usd", "write_usd") for suffix in (".usda", ".usdc", ".usd")},
}
_WRITERS = {**OF_VOLUME, **OF_SURFACE, **OF_SEQUENCE}
SUFFIXES = (*_WRITERS, PAGE)

# Suffix -> the library that writes it, and its package on PyPI.
_LIBRARIES = {
    ".vti": ("vtkmodules", "vtk"),
    ".vtp": ("vtkmodules", "vtk"),
    ".ply": ("meshio", "meshio"),
    **{suffix: ("pxr", "usd-core") for suffix in (".usda", ".usdc", ".usd")},
}
# Module -> its package: of Debian or, if Debian has none, of PyPI.
_BROUGHT_BY = {
    "vtkmodules": "python3-vtk9, or pip install vtk",
    "pxr": "it with pip install usd-core",
}


@with_progress("export")
def export(
    bake: Bake,
    path: AnyPath,
    isovalues: Iterable[float] | None = None,
    *,
    volume: int = 0,
    back: bool = False,
    explode: Sequence[float] | None = None,
    progress: _core.Progress | None = None,
    **page: "Unpack[PageOptions]",
) -> dict[float, Surface]:
    """Writes a Bake in another program's format (docs/export.md); leaves no incomplete file.

    path: File whose suffix chooses the format. A .vti, .am or .blend holds the volume with the
        light of all isosurfaces. A .vtp or .ply holds one lit isosurface. A .glb, .usda, .usdc or
        .usd holds one or a sequence. An .html shows all isosurfaces of all volumes.
    isovalues: Common isovalues of the isosurfaces, in their order. None is the default one. An
        .html shows the given one first.
    volume: Number of the volume, if there are several.
    back: True writes the back.
    explode: Direction and distance (x, y, z) by which the outermost parts move apart. Each part
        keeps the light of the closed arrangement.
    page: Options coarser, embed and lengths of an .html, see export_page().
    Returns {isovalue: Surface} of the written surfaces, empty for a volume. Raises LeaflightError,
    Cancelled.
    """
    path, suffix = Path(path), Path(path).suffix.lower()
    isovalues = None if isovalues is None else [float(isovalue) for isovalue in isovalues]
    _check(path, suffix, isovalues, back, explode)
    if suffix != PAGE and any(page.values()):
        raise SettingError(
            f"{path}: coarser and embed apply only to a web page (.html): leave them out.",
            "coarser",
            "embed",
        )
    bake.check_volume(volume)
    check_writable(path, suffix)
    if suffix == PAGE:
        if volume:
            raise SettingError(f"{path}: a web page shows all volumes: leave out volume.", "volume")
        first = isovalues[0] if isovalues else None
        export_page(bake, path, first, progress=progress, **page)
        return {}
    write = _writer(path, suffix)
    if suffix in OF_VOLUME:
        write(path, bake, volume)
        return {}
    progress = progress or _core.Progress()
    surfaces = {}
    for isovalue in isovalues or [default_isovalue_of(bake, volume)]:
        progress.check()
        surface = bake.surface(isovalue, volume, back)
        if len(surface.triangles) == 0:
            raise LeaflightError(
                f"{path}: the isosurface at {isovalue:g} is empty: choose another isovalue."
            )
        if explode is not None:
            moved = explode_offsets(
                bake.volumes[volume],
                bake.isovalue_of(volume, isovalue),
                surface.vertices,
                surface.triangles,
                np.asarray(explode),
            )
            surface = replace(surface, vertices=surface.vertices + moved)
        surfaces[isovalue] = surface
    exposure = bake.scene.exposure
    if suffix in OF_SEQUENCE:
        write(path, surfaces, exposure)
    else:
        ((isovalue, surface),) = surfaces.items()
        write(path, surface, exposure, *([isovalue] if suffix == ".vtp" else []))
    return surfaces


def absent_package(suffix: str) -> str | None:
    """Returns the package on PyPI that a format needs and that is absent, or None."""
    module, package = _LIBRARIES.get(suffix, ("", ""))
    return package if module and find_spec(module) is None else None


def _check(
    path: Path,
    suffix: str,
    isovalues: Sequence[float] | None,
    back: bool,
    explode: Sequence[float] | None,
) -> None:
    """Raises LeaflightError unless the format exists and supports these options."""
    if suffix not in SUFFIXES:
        raise LeaflightError(
            f"{path}: the suffix {suffix or '(none)'} is unknown: choose one of "
            f"{', '.join(SUFFIXES)}."
        )
    if suffix in OF_VOLUME or suffix == PAGE:
        of_one = ("isovalue", isovalues if suffix in OF_VOLUME else None)
        options = (of_one, ("back", back), ("explode", explode))
        given = [name for name, value in options if value not in (None, False)]
        if given:
            raise SettingError(
                f"{path}: a {suffix} holds the baked light of all isosurfaces: leave out the "
                "options for single ones.",
                *given,
            )
    elif isovalues is not None and len(set(isovalues)) != len(isovalues):
        raise SettingError(f"{path}: two isovalues are equal: give different ones.", "isovalue")
    elif suffix in OF_SURFACE and isovalues is not None and len(isovalues) != 1:
        raise SettingError(
            f"{path}: a {suffix} holds one isosurface: give one isovalue, or write a sequence as "
            f"{', '.join(OF_SEQUENCE)}.",
            "isovalue",
        )


def _writer(path: Path, suffix: str) -> Callable[..., None]:
    """Returns the function that writes the format. Raises LeaflightError if a library is absent."""
    module, function = _WRITERS[suffix]
    try:
        loaded = import_module(f".{module}", __package__)
        if suffix == ".ply":
            loaded.library(path)  # fail early, because it is loaded only to write
    except ImportError as error:
        package = (error.name or "").partition(".")[0]
        raise LeaflightError(
            f"{path}: writing {suffix} needs the Python package {package}, which is not "
            f"installed; install {_BROUGHT_BY.get(package, package)}."
        ) from None
    writer: Callable[..., None] = getattr(loaded, function)
    return writer
