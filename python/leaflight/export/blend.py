# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake as a .blend whose isovalue moves in any Blender from 5.0 on, without the add-on.

Blender itself must write a .blend, so a background Blender runs blend_scene.py. The grids lie in a
.vdb beside the .blend, because Blender does not read packed ones.
"""

import json
import sys
import tempfile
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..bake.baked import Bake
from ..io.output import check_writable, replaced_together
from ..measure.cycles import SceneObject, find_blender, in_background, run_script, scene_data, wall
from ..paths import AnyPath
from ..scene.scene import ramp_at
from ..stills.first_view import camera_around_bake, default_isovalue_of

SCRIPT = Path(__file__).with_name("blend_scene.py")
OLDEST = (5, 0)
# Number of isovalues at which baked walls have their light; Blender mixes the nearest two.
LEVELS = 17
_SIZE = (1920, 1080)


def write_blend(path: AnyPath, bake: Bake, volume: int = 0) -> None:
    """Writes a volume (its number) of a Bake as a .blend, and its grids beside it.

    The grids are in grids_of(path), which is the whole bake.
    Raises LeaflightError.
    """
    path = Path(path)
    grids = grids_of(path)
    check_writable(path, ".blend")
    check_writable(grids, ".vdb")
    isosurfaces = bake.scene.isosurfaces[volume]
    if isosurfaces.texture is not None or isosurfaces.scattering != "diffuse":
        raise LeaflightError(
            f'{path}: "{isosurfaces.name}" is colored by another volume, a mirror or glass, which '
            "a grid of light cannot show: write an isosurface as .glb, or a web page."
        )
    isovalue = default_isovalue_of(bake, volume)
    camera = camera_around_bake(bake, isovalue=isovalue, size=_SIZE)
    objects, light = _walls(bake)
    settings, arrays = scene_data(bake.scene, objects)
    suffix = f"_{volume + 1}" if volume else ""
    settings |= {
        "name": isosurfaces.name,
        "grids": grids.name,
        "values": f"field{suffix}",
        "radiance": f"radiance{suffix}",
        "voxels": bake.volumes[volume].field().dims,
        "back": f"radiance_back{suffix}" if bake.grids[volume].has_back else "",
        "albedo": ramp_at(isosurfaces.albedo, bake.isovalue_of(volume, isovalue)).tolist(),
        "range": [bake.isovalue_of(volume, each) for each in bake.isovalues],
        "isovalue": bake.isovalue_of(volume, isovalue),
        "exposure": bake.scene.exposure,
        "camera": [*camera.axes().tolist(), camera.position, camera.target, camera.angle],
        "size": _SIZE,
    }
    with replaced_together(path, grids) as (temporary, beside):
        bake.save(beside)
        _build(path, temporary, settings, {**arrays, **light})


def grids_of(path: Path) -> Path:
    """Returns the path of the grids beside a .blend."""
    return path.with_name(f"{path.stem}_grids.vdb")


def _walls(bake: Bake) -> tuple[list[SceneObject], dict[str, Array]]:
    """Returns the walls, and the light of baked ones: float32 (2 sides, LEVELS, vertices, 3)."""
    objects = [wall(mesh) for mesh in bake.scene.meshes]
    light = {}
    if bake.walls is not None:
        for number, (one, mesh) in enumerate(zip(objects, bake.scene.meshes)):
            if mesh.scattering != "diffuse":
                continue  # their picture depends on the view, so a bake cannot hold it
            vertices, triangles = bake.walls.mesh(number)
            one.vertices, one.corners = {"vertices": vertices}, {"triangles": triangles}
            light[f"light{number}"] = np.array(
                [
                    [
                        bake.walls.radiance(number, isovalue, back)
                        for isovalue in np.linspace(*bake.isovalues, LEVELS)
                    ]
                    for back in (False, True)
                ]
            )
    return objects, light


def _build(path: Path, result: Path, settings: dict[str, object], arrays: dict[str, Array]) -> None:
    """Lets a Blender write the .blend. Raises LeaflightError."""
    with tempfile.TemporaryDirectory(prefix="leaflight-") as name:
        folder = Path(name)
        settings["out"] = str(result)
        np.savez(folder / "scene.npz", settings=json.dumps(settings), **arrays)
        command, refused = _blender(), folder / "version"
        try:
            run_script(command, SCRIPT, folder, result, None)
        except LeaflightError as error:
            if not refused.exists():
                raise LeaflightError(f"{path}: {error}") from None
            oldest = ".".join(map(str, OLDEST))
            raise LeaflightError(
                f"{path}: writing .blend needs Blender {oldest} or later, but {command[0]} is "
                f"{refused.read_text()}: put a later one first on the search path."
            ) from None


def _blender() -> Sequence[str]:
    """Returns the command that runs a script in this Blender, its module bpy, or one on the path.

    Raises LeaflightError.
    """
    if "bpy" in sys.modules:
        program = sys.modules["bpy"].app.binary_path
        return in_background(program) if program else [sys.executable]
    return [sys.executable] if find_spec("bpy") else in_background(find_blender())
