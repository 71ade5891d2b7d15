# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking: one radiance grid for every isosurface of a volume, and what to do with it."""

import json
import time
from dataclasses import dataclass, replace

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..io.output import check_writable
from ..io.scene_file import cornell_box, scene_from_json
from ..scene.on_mesh import interpolated
from ..scene.scene import SceneDescription, core_scene, fit_scene, isovalue_at, match_leaves
from ..volume.setting_error import SettingError
from ..volume.volume import Volume
from .color_error import estimated_rms_percent
from .settings import PhotonMap, fixed_settings, fixed_work, leaf_window, round_settings
from .settle import settle as settled
from .stamps import EARLIER, METADATA, Stamp, id_of, read_bake_id


# The standard error of a colour at which direct light has settled.
SETTLED_ERROR = 2e-3


@dataclass(frozen=True, eq=False)
class Surface:
    """One lit isosurface in world coordinates.

    vertices, normals (unit, away from the side that is lit), radiance (W/(m^2 sr), linear RGB):
    float32 (n, 3); triangles: int32 (m, 3); seconds: the time contouring and lookup took, and
    settling; error: None, or for a surface that has settled the standard error, of the radiance's
    mean over the channels, of what settling traced: float32 (n,).
    """

    vertices: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    radiance: np.ndarray
    seconds: float
    error: np.ndarray = None


@dataclass(frozen=True, eq=False)
class Bake:
    """Volumes, the scene in world coordinates they were lit in, and the radiance of all leaves.

    `isovalue` always is the leaf coordinate (see scene.py): the isovalue of a single volume, and
    0..1 with several. isovalues: (lo, hi), the baked window of it.
    grids: one _core.RadianceGrid for each volume; surroundings: _core.SurroundingsRadiance or None.
    statistics: seconds, rays, rays_per_second, texels, peak_memory_bytes, skipped_passes;
        rounds, 0 where the work was fixed; estimated_error_percent, of what compare calls
        rms_percent, None where the work was fixed; stopped, whether a stop or the time ended the
        bake before it reached its error; and estimated_rms_percent, the RMS of the noise that the
        texels report, in the units of compare.
    metadata: text by key, everything the result depends on; equal bakes have equal metadata.
    """

    volumes: list
    scene: SceneDescription
    isovalues: tuple
    grids: list
    surroundings: object
    statistics: dict
    metadata: dict

    @property
    def volume(self):
        return self.volumes[0]

    @property
    def grid(self):
        return self.grids[0]

    @property
    def id(self):
        """Tells bakes apart, 32 digits: equal bakes have equal ones, on any machine."""
        return id_of(self.metadata)

    def save(self, path):
        """Writes the bake as one .vdb under its final name or not at all. Raises LeaflightError."""
        check_writable(path, ".vdb")
        metadata = dict(self.metadata, id=self.id, statistics=json.dumps(self.statistics))
        fields = [volume.field() for volume in self.volumes]
        _core.write_bake(str(path), fields, self.grids, self.surroundings, metadata)

    def isovalue_of(self, volume, isovalue):
        """The isovalue, in data units, that a volume (its number) shows at a leaf coordinate."""
        return isovalue_at(self.scene, volume, isovalue)

    def surface(
        self, isovalue, volume=0, back=False, settle=False, seed=0, threads=0, progress=None
    ):
        """The isosurface of a volume with its radiance, a Surface; finer where texels are.

        back: its inner side, towards higher values. settle: whether direct light is traced at the
        vertices, and indirect light corrected there, instead of looked up alone; a number is the
        seconds after which that ends early. Inner sides settle whether they were baked or not.
        Raises LeaflightError outside the window, Cancelled.
        """
        self.check_isovalue(isovalue, volume)
        field = self.volumes[volume].field()
        start = time.perf_counter()
        vertices, normals, triangles = self.grids[volume].contour(
            field, self.isovalue_of(volume, isovalue)
        )
        if settle is False:
            radiance, error = self.radiance(vertices, volume, back), None
        else:
            settling = self.settling(isovalue, vertices, normals, triangles, volume, back, seed)
            limit = None if settle is True else settle
            radiance, error = settled(settling, limit, threads, progress)
        if back:
            normals, triangles = -normals, np.ascontiguousarray(triangles[:, ::-1])
        seconds = time.perf_counter() - start
        return Surface(vertices, normals, triangles, radiance, seconds, error)

    def settling(self, isovalue, vertices, normals, triangles, volume=0, back=False, seed=0):
        """A _core.Settle of an isosurface's mesh, as grids[volume].contour() returns it.

        Raises LeaflightError.
        """
        self.check_isovalue(isovalue, volume)
        return _core.Settle(
            self._core_scene(),
            self.grids[volume],
            vertices,
            normals,
            triangles,
            isovalue,
            volume,
            back,
            SETTLED_ERROR / self.scene.exposure,
            seed,
        )

    def radiance(self, points, volume=0, back=False):
        """Baked radiance of a volume's leaves, float32 (n, 3), at world points (n, 3).

        It is zero where no leaf passes. back: of the inner sides. Raises LeaflightError.
        """
        self._check_volume(volume)
        grid = self.grids[volume]
        if back and not grid.has_back:
            if not json.loads(self.metadata["both_sides"]):
                raise SettingError(
                    "The inner side was not baked: bake again with both sides.", "both-sides"
                )
            # The bake left it out because no light can reach it.
            return np.zeros((len(points), 3), dtype=np.float32)
        return grid.lookup(self.volumes[volume].field(), points, back)

    def radiance_error(self, points, volume=0):
        """The standard error of radiance(), of its mean over the channels: float32 (n,)."""
        self._check_volume(volume)
        return self.grids[volume].lookup_error(self.volumes[volume].field(), points)

    def reference(
        self, points, isovalue, spp=1024, seed=0, threads=0, progress=None, volume=0, back=False
    ):
        """Path-traced radiance at points (n, 3) of an isosurface, on its outer or inner side.

        Returns (radiance, standard_error), float32 (n, 3) each. Raises LeaflightError, Cancelled.
        """
        self.check_isovalue(isovalue, volume)
        scene = self._core_scene()
        progress = progress or _core.Progress()
        return _core.reference(
            scene, points, isovalue, spp, seed, threads, progress, volume=volume, back=back
        )

    def mesh_number(self, name):
        """The number of the mesh of the surroundings of that name. Raises LeaflightError."""
        names = [mesh.name for mesh in self.scene.meshes]
        if name not in names:
            raise LeaflightError(
                f'There is no mesh "{name}" around the volumes: choose one of {", ".join(names)}.'
            )
        return names.index(name)

    def mesh_radiance(self, mesh, points, isovalue, back=False):
        """Baked radiance, float64 (n, 3), at points (n, 3) of a mesh of the surroundings.

        mesh: its number; back: seen from where its normals point away. Raises LeaflightError.
        """
        self._check_window(isovalue)
        if self.surroundings is None:
            raise SettingError(
                "The surroundings were not baked: bake again with them.", "surroundings"
            )
        vertices, triangles = self.surroundings.mesh(mesh)
        radiance = self.surroundings.radiance(mesh, isovalue, back)
        return interpolated(vertices, triangles, radiance, points)

    def mesh_reference(
        self,
        mesh,
        facets,
        coordinates,
        isovalue,
        spp=1024,
        seed=0,
        threads=0,
        progress=None,
        back=False,
    ):
        """Path-traced radiance at points of a mesh (see on_mesh.py), as reference()."""
        self._check_window(isovalue)
        scene = self._core_scene()
        progress = progress or _core.Progress()
        return _core.reference_surroundings(
            scene, mesh, facets, coordinates, isovalue, spp, seed, threads, progress, back
        )

    def check_isovalue(self, isovalue, volume=0):
        """Raises LeaflightError unless the baked window and the volume's data hold the isovalue."""
        self._check_volume(volume)
        self._check_window(isovalue)
        low, high = self.volumes[volume].field().range
        own = self.isovalue_of(volume, isovalue)
        if not low < own <= high:
            low, high = self.volumes[volume].data_range()
            raise LeaflightError(
                f"Isovalue {own:g} lies outside the data, whose values are {low:g}..{high:g}: "
                "no isosurface exists there, choose one inside."
            )

    def _core_scene(self):
        fields = [volume.field() for volume in self.volumes]
        return core_scene(self.scene, fields, self.isovalues)

    def _check_window(self, isovalue):
        lo, hi = self.isovalues
        if not lo <= isovalue <= hi:
            raise SettingError(
                f"Isovalue {isovalue:g} lies outside the baked window {lo:g}..{hi:g}: choose one "
                "inside or bake again with a wider window.",
                "isovalues",
            )

    def _check_volume(self, volume):
        if not 0 <= volume < len(self.volumes):
            raise SettingError(
                f"There is no volume {volume}: the bake holds {len(self.volumes)}, "
                "numbered from 0.",
                "volume",
            )


def placed(volumes, scene, isovalues):
    """What is lit, from the arguments of bake(): (volumes, SceneDescription, window)."""
    volumes = list(volumes) if isinstance(volumes, (list, tuple)) else [volumes]
    for volume in volumes:
        if np.ndim(volume.values) != 3:
            raise LeaflightError(f"{volume.name}: this is no volume; light images with flatland.")
    description = match_leaves(scene or cornell_box(), volumes)
    volumes = [
        volume.capped() if leaves.capped else volume
        for volume, leaves in zip(volumes, description.leaves)
    ]
    description = fit_scene(description, volumes)
    # Not what the result depends on: the volumes themselves are stored.
    leaves = [replace(leaves, source=None) for leaves in description.leaves]
    return volumes, replace(description, leaves=leaves), leaf_window(isovalues, volumes, leaves)


def bake(
    volumes,
    scene=None,
    *,
    isovalues=None,
    error=None,
    time=None,
    resolution=None,
    samples=None,
    photons=None,
    caustic_photons=None,
    soft_spacing=None,
    refine=None,
    estimator=None,
    photon_map=None,
    scattered=None,
    seed=0,
    threads=0,
    both_sides=False,
    surroundings=False,
    only_at=None,
    on_round=None,
    progress=None,
):
    """Computes the radiance of every isosurface, within a window, of a volume or of several.

    The bake goes on in rounds, each of which leaves a better result, until it reaches the error or
    the time asked for, or progress.stop() is called; statistics of the Bake tell how far it came.

    volumes: a Volume or a list of them, which see each other (see scene.py).
    scene: SceneDescription, fitted around the volumes; None is the Cornell box.
    isovalues: (lo, hi) of the leaf coordinate: in data units for one volume, where None takes that
        of the scene or else default_window(volume); within 0..1 for several, where None is (0, 1).
    error: percent, of what compare() calls rms_percent; None is 1.5. time: seconds after which the
        bake ends with the round in progress, None for no limit.
    resolution: texels along the longest axis (the other axes in proportion of their nodes), or
        (nx, ny, nz); None is one texel a node.
    seed: same seed, same result, whatever the threads; threads: 0 takes every core.
    both_sides: the inner side of each isosurface, too; surroundings: the meshes around them, too.
    on_round: called with a Bake after each round but the last, in the thread that bakes; the
        statistics of that Bake lack estimated_rms_percent, which takes its time.
    progress: _core.Progress to poll, stop or cancel from another thread.

    Settings of research, None where they are not asked for. If any is given, the bake does that
    fixed amount of work, without rounds, and the others are as said:
    samples: rays per texel (32); photons: number of photons (2 million); caustic_photons: of those
        that come by mirrors and glass (as many as photons).
    estimator: "gather" (the default), "volumetric", "path" or "thesis"; photon_map: PhotonMap of
        the last (the thesis's); scattered: Scattered, for samples strewn over the domain instead of
        in each texel, with `samples` rays each.
    soft_spacing: texels between the points that soft light is gathered at (1); more is faster where
        the light is smooth, see docs/accuracy.md.
    refine: how many times texels are halved where light varies most, in a fifth of the cells each
        time (0); once doubles the time.
    only_at: world points (n, 3), to bake only the texels that lookups there use, with the estimator
        "path"; for measuring.
    Returns a Bake. Raises LeaflightError for input that cannot be baked, Cancelled.
    """
    volumes, description, window = placed(volumes, scene, isovalues)
    given = {
        "samples": samples,
        "photons": photons,
        "caustic_photons": caustic_photons,
        "soft_spacing": soft_spacing,
        "refine": refine,
        "estimator": estimator,
        "photon_map": photon_map,
        "scattered": scattered,
        "only_at": only_at,
    }
    fixed = fixed_work(error, time, given)
    if fixed is not None and fixed["estimator"] == "thesis" and photon_map is None:
        fixed["photon_map"] = PhotonMap()
    common = {
        "resolution": resolution,
        "seed": seed,
        "threads": threads,
        "exposure": description.exposure,
        "both_sides": both_sides,
        "surroundings": surroundings,
    }
    dims = volumes[0].field().dims
    if fixed is None:
        settings = round_settings(_core.BakeSettings, dims, error=error, time=time, **common)
    else:
        settings = fixed_settings(_core.BakeSettings, dims, **fixed, **common)
    stamp = Stamp(volumes, description, window, settings, fixed)

    def whole(baked):
        statistics = dict(baked.statistics)
        if fixed is not None:
            statistics.update(rounds=0, stopped=False, estimated_error_percent=None)
        statistics["rays_per_second"] = statistics["rays"] / max(statistics["seconds"], 1e-9)
        metadata = stamp.metadata(baked.grids, statistics["rounds"])
        grids, lit = baked.grids, baked.surroundings
        return Bake(volumes, description, window, grids, lit, statistics, metadata)

    core = core_scene(description, [volume.field() for volume in volumes], window)
    look = None if on_round is None else lambda baked: on_round(whole(baked))
    result = whole(_core.bake(core, settings, progress or _core.Progress(), on_round=look))
    noise = estimated_rms_percent(result.grids, description.exposure)
    result.statistics["estimated_rms_percent"] = noise
    if fixed is None and not result.statistics["estimated_error_percent"]:
        # What cannot be baked in rounds gets a fixed amount of work, and no estimate but this.
        result.statistics["estimated_error_percent"] = noise
    return result


def load_bake(path):
    """Reads what Bake.save wrote. Raises LeaflightError for any other file."""
    identifier = read_bake_id(path)
    try:
        fields, grids, surroundings, metadata = _core.read_bake(str(path))
        statistics = json.loads(metadata["statistics"])
        lo, hi = (float(isovalue) for isovalue in json.loads(metadata["isovalues"]))
        scene = scene_from_json(metadata["scene"], str(path))
        names = [str(record["name"]) for record in json.loads(metadata["volumes"])]
        if not len(names) == len(fields) == len(grids) == len(scene.leaves):
            raise ValueError("the number of volumes differs")
        if "rounds" not in metadata:
            raise LeaflightError(f"{path}: {EARLIER}.")
        # OpenVDB adds text of its own.
        metadata = {key: metadata[key] for key in METADATA}
    except (KeyError, TypeError, ValueError):
        raise LeaflightError(
            f"{path}: this .vdb lacks the metadata of a bake; bake the volume again."
        ) from None
    volumes = [Volume(*field, name, str(path)) for field, name in zip(fields, names)]
    if surroundings is not None:
        core = core_scene(scene, [volume.field() for volume in volumes], (lo, hi))
        _core.attach_surroundings(surroundings, core)
    bake = Bake(volumes, scene, (lo, hi), grids, surroundings, statistics, metadata)
    if bake.id != identifier:
        raise LeaflightError(f"{path}: its metadata were changed; bake the volume again.")
    return bake
