# SPDX-License-Identifier: GPL-3.0-or-later
"""The command export: a bake for other programs."""

from argparse import Namespace
from pathlib import Path

from .._core import Progress
from ..bake.baked import Surface
from ..bake.load_bake import load_bake
from ..words import figures
from ..export.export import export
from ..progress_bar import run_with_progress
from .output import Output, picked


def run_export(options: Namespace) -> Output:
    baked = load_bake(options.bake)

    def work(progress: Progress) -> dict[float, Surface]:
        how = picked(options, "volume back explode coarser embed")
        return export(baked, options.out, options.isovalue, progress=progress, **how)

    surfaces = run_with_progress(work, "export", writes=True)
    out = Path(options.out)
    if options.embed:
        out = out.with_suffix("")
    size = sum(file.stat().st_size for file in (out.iterdir() if options.embed else [out]))
    result = {
        "out": str(out),
        "bytes": size,
        "volume": options.volume,
        "isosurfaces": [
            {
                "isovalue": isovalue,
                "vertices": len(surface.vertices),
                "triangles": len(surface.triangles),
            }
            for isovalue, surface in surfaces.items()
        ],
    }
    what = "all isosurfaces"
    if surfaces:
        triangles = sum(len(surface.triangles) for surface in surfaces.values())
        shown = ", ".join(figures(*surfaces, *baked.isovalues)[: len(surfaces)])
        what = f"isovalue{'s' if len(surfaces) > 1 else ''} {shown}, {triangles} triangles"
    return result, [f"{out}: {what}, {size / 2**20:.1f} MiB"]
