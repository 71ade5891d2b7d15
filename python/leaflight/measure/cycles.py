# SPDX-License-Identifier: GPL-3.0-or-later
"""An independent reference: radiance by Cycles, Blender's path tracer.

A background Blender builds the same scene. Volumes become marching-cubes meshes with the core's
normals as custom split normals, so they are shaded smoothly. Walls are flat, lights have Blender's
units, and mirrors and glass have roughness 0. Cycles then measures points of one mesh without
options that trade noise for bias (cycles_scene.py).

The two models differ in these points. Cycles sees triangles instead of the trilinear surface. If
the shading normal faces a light but the triangle does not, Cycles traces the shadow ray through the
triangle. In a closed cavity it finds about a thousandth of the light outside. Cycles does not scale
radiance with the square of the refractive index within glass. A point lamp of Blender 3.4 is a disc
that faces the shaded point. It is 1 + (radius / distance)^2 times weaker than the sphere of the
core.
"""

import json
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import leaflight._core as _core
import numpy as np

from .._core import Cancelled, Field, LeaflightError, Progress
from ..arrays import Array
from ..scene.on_mesh import positions, random_facets
from ..scene.scene import Isosurfaces, Mesh, SceneDescription, isovalue_at, ramp_at
from ..scene.volume_texture import VolumeTexture
from ..volume.setting_error import SettingError
from .sampling import Sampling, Target

SCRIPT = Path(__file__).with_name("cycles_scene.py")
# Number of runs with different seeds. Their spread gives the standard error.
PASSES = 8
POLL_SECONDS = 0.1


@dataclass(frozen=True, eq=False)
class Probes:
    """Points of a mesh, spread over its area.

    points: World positions, float64 (n, 3).
    facets: Triangle numbers, int (n,).
    coordinates: Barycentric coordinates of the second and third vertex, float64 (n, 2).
    weights: Shares of the area, float64 (n,).
    """

    points: Array
    facets: Array
    coordinates: Array
    weights: Array


@dataclass(frozen=True, eq=False)
class Measured:
    """Radiance by Cycles at the probes: passes, float64 [pass, probe, RGB] in W/(m^2 sr)."""

    probes: Probes
    passes: Array


def measure(
    description: SceneDescription,
    fields: Sequence[Field],
    c: float,
    target: Target = Target(),
    sampling: Sampling = Sampling(),
    *,
    detail: int = 1,
    progress: Progress | None = None,
) -> Measured:
    """Measures radiance by Cycles on the isosurface of a volume, or on a mesh of the walls.

    description: Scene in world coordinates, with one Isosurfaces for each of the fields
        (_core.Field).
    c: The common isovalue.
    detail: Marching cubes uses cells cut into detail^3. 1 gives the mesh that users see.
    Returns a Measured. Raises LeaflightError, Cancelled.
    """
    # A finer mesh is not a better reference for diffuse isosurfaces. The trilinear isosurface has
    # kinks at the faces of cells, where normals and facets face different lights (see above). At
    # isovalue 100.5 of nucleon.raw the core's path tracer differs by 0.44 % from the mesh itself;
    # 0.36 % is noise. It differs by 1.2 to 1.8 % from cells cut in 2, 4 or 8. Glass refracts at
    # facets and needs the finer mesh.
    isosurfaces = [_isosurface(description, field, k, c, detail) for k, field in enumerate(fields)]
    meshes = [wall(mesh) for mesh in description.meshes]
    surface = isosurfaces[target.volume] if target.mesh is None else meshes[target.mesh]
    if len(surface.corners["triangles"]) == 0:
        raise LeaflightError(
            f'"{surface.material["name"]}" has no surface at this isovalue: choose another.'
        )
    seed = sampling.seed
    probes, pixels, size, surface.corners["target_uv"] = _lay_out(surface, sampling.points, seed)
    if target.back:
        surface.flip()
    settings, arrays = _scene(description, isosurfaces + meshes, surface, sampling.threads)
    settings["image_size"] = size
    each = -(-sampling.spp // PASSES)
    settings["passes"] = [(each, seed * PASSES + number) for number in range(PASSES)]
    radiance, _ = _run(settings, arrays | {"pixels": pixels}, progress)
    return Measured(probes, radiance.astype(np.float64))


@dataclass(frozen=True, eq=False)
class VertexBakes:
    """The light that Cycles baked into the vertices of one isosurface, by pass.

    radiance: Radiance in W/(m^2 sr), float32 [pass, vertex, RGB].
    seconds: Wall-clock time of each pass.
    processor_seconds: Processor time of all threads for each pass.
    peaks: Peak memory of Blender so far, in bytes.
    """

    radiance: Array
    seconds: Array
    processor_seconds: Array
    peaks: Array


def bake_vertices(
    description: SceneDescription,
    isovalue: float,
    mesh: tuple[Array, Array, Array],
    passes: Sequence[tuple[int, int]],
    *,
    threads: int = 0,
    progress: Progress | None = None,
) -> VertexBakes:
    """Bakes one isosurface into its mesh's vertices by Cycles, the alternative in plain Blender.

    description: Scene in world coordinates, with one Isosurfaces.
    isovalue: Isovalue of the mesh.
    mesh: Its (vertices, normals, triangles).
    passes: (samples, seed) of each pass. Samples are paths at each corner of a triangle.
    Returns VertexBakes. Raises LeaflightError, Cancelled.
    """
    isosurfaces = description.isosurfaces[0]
    albedo, emission = (
        ramp_at(ramp, isovalue) for ramp in (isosurfaces.albedo, isosurfaces.emission)
    )
    vertices, normals, triangles = mesh
    arrays = {"vertices": vertices, "normals": normals}
    target = SceneObject(_material(isosurfaces, albedo, emission), arrays, {"triangles": triangles})
    target.color_by(isosurfaces.texture)
    objects = [target, *(wall(mesh) for mesh in description.meshes)]
    settings, arrays = _scene(description, objects, target, threads)
    settings["image_size"] = None
    settings["passes"] = passes
    radiance, costs = _run(settings, arrays, progress)
    return VertexBakes(radiance, *costs.T)


def _scene(
    description: SceneDescription,
    objects: Sequence["SceneObject"],
    target: "SceneObject",
    threads: int,
) -> tuple[dict[str, Any], dict[str, Array]]:
    """Returns the settings and arrays for cycles_scene.py, except those of the target."""
    settings, arrays = scene_data(description, objects)
    return settings | {"target": objects.index(target), "threads": threads}, arrays


def scene_data(
    description: SceneDescription, objects: Sequence["SceneObject"]
) -> tuple[dict[str, Any], dict[str, Array]]:
    """Returns the settings and arrays from which cycles_scene.py builds objects and lights."""
    environment = description.environment
    settings: dict[str, Any] = {
        "objects": [one.material for one in objects],
        "lights": [{"type": type(light).__name__, **asdict(light)} for light in description.lights],
        "environment": environment
        and {"radiance": environment.radiance, "world_to_image": environment.world_to_image},
    }
    arrays: dict[str, Array] = {}
    for i, one in enumerate(objects):
        arrays |= {f"object{i}.{key}": value for key, value in one.arrays().items()}
    if environment is not None and environment.image is not None:
        arrays["environment"] = environment.image
    return settings, arrays


@dataclass(eq=False)
class SceneObject:
    """A mesh for Blender: its material as JSON data, and arrays by vertex and by corner."""

    material: dict[str, Any]
    vertices: dict[str, Array]  # vertices, optionally normals and colors, float32 (n, 3)
    corners: dict[str, Array]  # triangles, (m, 3), optionally uv and target_uv, float32 (m, 3, 2)

    def arrays(self) -> dict[str, Array]:
        return self.vertices | self.corners

    def color_by(self, texture: VolumeTexture | None) -> None:
        """Gives the vertices the color of the albedo times the texture."""
        if texture is not None:
            albedo = np.float32(self.material["albedo"])
            self.vertices["colors"] = albedo * texture.at(self.vertices["vertices"])

    def flip(self) -> None:
        self.corners = {key: array[:, [0, 2, 1]] for key, array in self.corners.items()}
        if "normals" in self.vertices:
            self.vertices["normals"] = -self.vertices["normals"]


def _isosurface(
    description: SceneDescription, field: Field, volume: int, c: float, detail: int
) -> SceneObject:
    isosurfaces = description.isosurfaces[volume]
    isovalue = isovalue_at(description, volume, c)
    # The mesh of a cut is flat there, but between the nodes its isosurface is not.
    if field.is_cut:
        vertices, normals, triangles = _core.contour(field, isovalue)
    else:
        vertices, _, triangles = _core.contour(_finer(field, detail), isovalue)
        normals = _core.normals(field, vertices)
    albedo, emission = (
        ramp_at(ramp, isovalue) for ramp in (isosurfaces.albedo, isosurfaces.emission)
    )
    material = _material(isosurfaces, albedo, emission)
    target = SceneObject(
        material, {"vertices": vertices, "normals": normals}, {"triangles": triangles}
    )
    target.color_by(isosurfaces.texture)
    return target


def _finer(field: Field, detail: int) -> Field:
    """Returns the same trilinear field with each cell cut into detail^3."""
    values = field.values.astype(np.float32, copy=False)
    for _ in range(3):
        fine = np.empty((detail * (len(values) - 1) + 1, *values.shape[1:]), np.float32)
        fine[::detail] = values
        for i in range(1, detail):
            step = np.float32(i / detail) * (values[1:] - values[:-1])
            fine[i::detail] = values[:-1] + step
        # Three turns restore the order of the axes.
        values = np.moveaxis(fine, 0, -1)
    index_to_world = field.index_to_world @ np.diag([1 / detail] * 3 + [1.0])
    return _core.Field(np.ascontiguousarray(values), index_to_world)


def wall(mesh: Mesh) -> SceneObject:
    """Returns a mesh of the walls for Blender."""
    material = _material(mesh, mesh.albedo, mesh.emission)
    corners = {"triangles": mesh.triangles.astype(np.int32)}
    one = SceneObject(material, {"vertices": mesh.vertices}, corners)
    if mesh.texture is not None:
        assert mesh.uv is not None
        one.vertices["texture"] = mesh.texture
        one.corners["uv"] = mesh.uv
    return one


def _material(
    item: Isosurfaces | Mesh, albedo: Iterable[float], emission: Iterable[float]
) -> dict[str, Any]:
    material: dict[str, Any] = {"name": item.name, "scattering": item.scattering, "ior": item.ior}
    return material | {"albedo": tuple(albedo), "emission": tuple(emission)}


def _lay_out(
    target: SceneObject, points: int, seed: int
) -> tuple[Probes, Array, tuple[int, int], Array]:
    """Returns Probes on a mesh, and the pixels into which Cycles bakes them.

    Each facet gets a random number k of points in proportion to its area. It is cut into n x n
    pieces, as few as contain k upright ones. The centroid of each piece lies at the center of a
    pixel in the facet's square of the image.
    Returns (Probes, pixel numbers (n,), image size (width, height), uv float32 (m, 3, 2)).
    """
    vertices, triangles = target.vertices["vertices"], target.corners["triangles"]
    chosen = random_facets(vertices, triangles, points, np.random.default_rng(seed))
    counts = np.bincount(chosen, minlength=len(triangles))
    cuts = np.ceil((np.sqrt(8 * counts + 1) - 1) / 2).astype(int)
    places, (width, height) = _pack(cuts)
    # Facets without a probe lie outside the image.
    uv = np.full((len(triangles), 3, 2), -9.0)
    facets, coordinates, weights, pixels = [], [], [], []
    for facet, (x, y) in places.items():
        n = cuts[facet]
        uv[facet] = (np.array([x, y]) + 1 / 6 + n * np.array([[0, 0], [1, 0], [0, 1]])) / (
            width,
            height,
        )
        i, j = (k.ravel() for k in np.mgrid[:n, :n])
        i, j = i[i + j < n], j[i + j < n]
        facets.append(np.full(len(i), facet))
        coordinates.append((np.stack([i, j], axis=1) + 1 / 3) / n)
        weights.append(np.full(len(i), counts[facet] / len(i)))
        pixels.append((y + j) * width + x + i)
    on, at, weight, pixel = map(np.concatenate, (facets, coordinates, weights, pixels))
    probes = Probes(positions(vertices, triangles, on, at), on, at, weight / weight.sum())
    return probes, pixel, (width, height), uv.astype(np.float32)


def _pack(sides: Array) -> tuple[dict[int, tuple[int, int]], tuple[int, int]]:
    """Returns positions (x, y) of all squares with a side above 0, and the image size."""
    order = [number for number in np.argsort(-sides, kind="stable") if sides[number] > 0]
    width = int(max(sides.max(), np.ceil(np.sqrt((sides**2).sum()))))
    places: dict[int, tuple[int, int]] = {}
    x, y, row = 0, 0, 0
    for number in order:
        if x + sides[number] > width or not places:
            x, y, row = 0, y + row, int(sides[number])
        places[number] = (x, y)
        x += int(sides[number])
    return places, (width, y + row)


def find_blender() -> str:
    """Returns the path of Blender. Raises LeaflightError."""
    blender = shutil.which("blender")
    if blender is None:
        raise SettingError(
            "Blender is not on the search path: install the Debian package blender, or compare "
            "with the path tracer.",
            "reference path",
        )
    return blender


def _run(
    settings: dict[str, Any], arrays: Mapping[str, Array], progress: Progress | None
) -> tuple[Array, Array]:
    """Returns the radiance and the costs that cycles_scene.py writes."""
    with tempfile.TemporaryDirectory(prefix="leaflight-") as name:
        folder = Path(name)
        np.savez(folder / "scene.npz", settings=json.dumps(settings), **arrays)
        run_script(in_background(find_blender()), SCRIPT, folder, folder / "radiance.npy", progress)
        return np.load(folder / "radiance.npy"), np.load(folder / "costs.npy")


def in_background(blender: str) -> list[str]:
    """Returns the command of a background Blender with factory settings that runs a script."""
    return [blender, "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python"]


def run_script(
    command: Sequence[str], script: Path, folder: Path, result: Path, progress: Progress | None
) -> None:
    """Runs a script of Blender with a folder as its last argument, until it has written a result.

    Raises LeaflightError, Cancelled.
    """
    with open(folder / "log", "w+b") as log:
        process = subprocess.Popen(
            [*command, script, "--", folder], stdin=subprocess.DEVNULL, stdout=log, stderr=log
        )
        try:
            while process.poll() is None:
                if progress is not None and progress.cancelled:
                    raise Cancelled("Blender's work was cancelled.")
                time.sleep(POLL_SECONDS)
        finally:
            process.kill()
            process.wait()
    if process.returncode != 0 or not result.exists():
        lines = (folder / "log").read_text(errors="replace").strip().splitlines()
        raise LeaflightError(f"Blender failed: {' / '.join(lines[-3:])}")
