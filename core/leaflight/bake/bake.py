# SPDX-License-Identifier: GPL-3.0-or-later
"""Baking: one radiance grid for every isosurface of a volume, and what to do with it."""

import json
import time
from dataclasses import dataclass, replace

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..io.output import check_writable
from ..io.scene_file import cornell_box
from ..scene.on_mesh import interpolated
from ..scene.scene import SceneDescription, core_scene, fit_scene, isovalue_at, match_leaves
from ..volume.setting_error import SettingError
from .color_error import estimated_rms_percent
from .settings import PhotonMap, fixed_settings, fixed_work, leaf_window, round_settings
from .settle import LEAST_VERTICES
from .settle import settle as settled
from .stamps import id_of, stamp, stamp_after


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
        rms_percent, worst_error_percent and worst_isovalue, the same of the isosurfaces that err
        most, all None where the work was fixed; stopped, whether a stop or the time ended the
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

    def save(self, path, progress=None):
        """Writes the bake as one .vdb under its final name or not at all.

        Raises LeaflightError, and Cancelled where progress, a _core.Progress, is cancelled before
        the file is whole.
        """
        check_writable(path, ".vdb")
        metadata = dict(self.metadata, id=self.id, statistics=json.dumps(self.statistics))
        fields = [volume.field() for volume in self.volumes]
        _core.write_bake(path, fields, self.grids, self.surroundings, metadata, progress)

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
        start = time.perf_counter()
        if settle is False:
            field, own = self.volumes[volume].field(), self.isovalue_of(volume, isovalue)
            dark = self._is_dark(volume, back)
            vertices, normals, triangles, *sides = self.grids[volume].lit_contour(
                field, own, normals=True, front=not back, back=back and not dark
            )
            radiance = np.zeros((len(vertices), 3), np.float32) if dark else sides[back]
            error = None
        else:
            vertices, normals, triangles = self.contour(isovalue, volume, at_rest=True)
            settling = self.settling(isovalue, vertices, normals, triangles, volume, back, seed)
            limit = None if settle is True else settle
            radiance, error = settled(settling, limit, threads, progress)
        if back:
            normals, triangles = -normals, np.ascontiguousarray(triangles[:, ::-1])
        seconds = time.perf_counter() - start
        return Surface(vertices, normals, triangles, radiance, seconds, error)

    def contour(self, isovalue, volume=0, at_rest=False):
        """The mesh of an isosurface: (vertices float32 (n, 3), outward normals, triangles (m, 3)).

        It is finer where texels are, and everywhere if it is to settle and would have few vertices.
        """
        return self.grids[volume].contour(
            self.volumes[volume].field(),
            self.isovalue_of(volume, isovalue),
            LEAST_VERTICES if at_rest else 0,
        )

    def settling(self, isovalue, vertices, normals, triangles, volume=0, back=False, seed=0):
        """A _core.Settle of an isosurface's mesh, as contour() returns it.

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
        if self._is_dark(volume, back):
            return np.zeros((len(points), 3), dtype=np.float32)
        return self.grids[volume].lookup(self.volumes[volume].field(), points, back)

    def _is_dark(self, volume, back):
        """Whether the bake left the inner side out because no light can reach it.

        Raises SettingError where it was not baked.
        """
        if not back or self.grids[volume].has_back:
            return False
        if not json.loads(self.metadata["both_sides"]):
            raise SettingError(
                "The inner side was not baked: bake again with both sides.", "both-sides"
            )
        return True

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
    checkpoint=None,
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
    checkpoint: Checkpoint, the file where a bake in rounds leaves its state, at most half a minute
        apart; one that was interrupted goes on from it with the bits that it would have had.

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
    metadata = stamp(volumes, description, window, settings, fixed)
    lights = volumes, description, window
    return lit(*lights, settings, metadata, None, on_round, progress, checkpoint)


def lit(
    volumes, description, window, settings, metadata, kept, on_round, progress, checkpoint=None
):
    """The Bake of volumes and a scene that fit each other, as placed() leaves them.

    settings: _core.BakeSettings. metadata: of stamp(). kept: the Bake in rounds that this one goes
    on with, or None. on_round, progress, checkpoint: as of bake().
    Raises LeaflightError, Cancelled.
    """
    in_rounds = bool(metadata["error"])

    def whole(baked):
        statistics = dict(baked.statistics)
        blocks = [statistics.pop(f"{light}_blocks") for light in ("direct", "indirect")]
        if not in_rounds:
            statistics.update(rounds=0, stopped=False)
            for name in ("estimated_error_percent", "worst_error_percent", "worst_isovalue"):
                statistics[name] = None
        grids, continued = baked.grids, ""
        # A first picture, of other texels, is not gone on with: the bake is a new one.
        if kept is not None and grids[0].resolution == kept.grid.resolution:
            continued = kept.id
            for name in ("seconds", "rays"):
                statistics[name] += kept.statistics[name]
        statistics["rays_per_second"] = statistics["rays"] / max(statistics["seconds"], 1e-9)
        known = stamp_after(metadata, grids, statistics["rounds"], blocks, continued)
        surroundings = baked.surroundings
        return Bake(volumes, description, window, grids, surroundings, statistics, known)

    light = None
    if kept is not None:
        light = (kept.grid, int(kept.metadata["rounds"]), *json.loads(kept.metadata["blocks"]))
    core = core_scene(description, [volume.field() for volume in volumes], window)
    look = None if on_round is None else lambda baked: on_round(whole(baked))
    progress = progress or _core.Progress()
    kept_state = checkpoint.arguments(metadata) if checkpoint and in_rounds else {}
    result = whole(_core.bake(core, settings, progress, on_round=look, kept=light, **kept_state))
    noise = estimated_rms_percent(result.grids, description.exposure)
    result.statistics["estimated_rms_percent"] = noise
    if in_rounds and not result.statistics["estimated_error_percent"]:
        # What cannot be baked in rounds gets a fixed amount of work, and no estimate but this.
        result.statistics["estimated_error_percent"] = noise
    return result
