# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a bake with a fixed number of samples, checked."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, astuple, dataclass
from typing import Any, TypeVar

import _thesis
import numpy as np
from leaflight import LeaflightError
from leaflight.bake.provenance import sha256
from leaflight.bake.settings import CommonOptions, CommonSettings, whole
from numpy.typing import ArrayLike

_Settings = TypeVar("_Settings", _thesis.FixedSettings, _thesis.FixedSettings2)


@dataclass(frozen=True)
class PhotonMap:
    """The settings of the photon map of the estimator "thesis" (thesis 4.3.5).

    k: Number of photons per estimate.
    radius: Upper bound on the radius of an estimate, in longest sides of the volumes; 0 is no
        limit.
    g: Length of a unit of the isovalue range, in units of the domain.
    region: "sphere", "clipped_sphere", "box", "cylinder" or "graph".
    """

    k: int = 200
    radius: float = 0.0
    g: float = 10.0
    region: str = "clipped_sphere"


@dataclass(frozen=True)
class Scattered:
    """Samples scattered over the domain and interpolated to texels (thesis 3.4, 4.4 and 4.5).

    strategy: "uniform", "stratified", "importance", "level_set", "letters", "slabs", "regular".
    count: Number of samples, each with all rays.
    isovalues: Isovalues of "level_set": a sequence, or a number of adaptively chosen ones.
    filter: "shepard" (Eq. 3.11), "tent" or "box".
    radius: Radius of the filter in texels.
    """

    strategy: str
    count: int
    isovalues: int | Sequence[float] = 9
    filter: str = "shepard"
    radius: int = 3


class SampleOptions(CommonOptions, total=False):
    """The fields of FixedSamples by name."""

    samples: int
    photons: int
    caustic_photons: int | None
    estimator: str
    photon_map: PhotonMap | None
    scattered: Scattered | None
    only_at: ArrayLike | None


@dataclass(frozen=True, eq=False)
class FixedSamples(CommonSettings):
    """The settings of a bake with a fixed number of samples; bake() explains them."""

    samples: int = 32
    photons: int = 2_000_000
    caustic_photons: int | None = None
    estimator: str = "gather"
    photon_map: PhotonMap | None = None
    scattered: Scattered | None = None
    only_at: ArrayLike | None = None

    def core(self, kind: Callable[[], _Settings], dims: Sequence[int]) -> _Settings:
        """Returns core settings, a kind (_thesis.FixedSettings or FixedSettings2), for nodes dims.

        Raises LeaflightError.
        """
        settings = self.set_common(kind(), dims)
        settings.samples = whole("samples", self.samples, 1)
        settings.photons = whole("photons", self.photons, 1)
        settings.caustic_photons = whole("caustic_photons", self._caustic_photons, 0)
        settings.estimator = self.estimator
        if self.only_at is not None:
            if np.shape(self.only_at)[0] == 0:
                raise LeaflightError("only_at is empty: give points, or None for all texels.")
            settings.set_only_at(np.ascontiguousarray(self.only_at, dtype=np.float64))
        if self.photon_map is not None:
            if self.estimator != "thesis":
                raise LeaflightError(
                    f'The photon map belongs to the estimator "thesis", not to "{self.estimator}": '
                    "leave it out or choose that estimator."
                )
            whole("k", self.photon_map.k, 2)
            settings.set_photon_map(*astuple(self.photon_map))
        if self.scattered is not None:
            whole("count", self.scattered.count, 1)
            isovalues: Any = self.scattered.isovalues
            if np.ndim(isovalues) == 0:
                whole("isovalues", isovalues, 1)
            whole("radius", self.scattered.radius, 0)
            settings.set_scattered(*astuple(self.scattered))
        return settings

    def record(self) -> dict[str, Any]:
        """Returns the settings that a bake depends on, in JSON's types."""
        photon_map = self.photon_map or (PhotonMap() if self.estimator == "thesis" else None)
        return {
            "samples": self.samples,
            "photons": self.photons,
            "caustic_photons": self._caustic_photons,
            "estimator": self.estimator,
            "photon_map": photon_map and asdict(photon_map),
            "scattered": self.scattered and asdict(self.scattered),
            "only_at_sha256": ""
            if self.only_at is None
            else sha256(np.asarray(self.only_at, np.float64)),
        }

    @property
    def _caustic_photons(self) -> int:
        return self.photons if self.caustic_photons is None else self.caustic_photons
