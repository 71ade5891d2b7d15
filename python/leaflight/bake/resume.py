# SPDX-License-Identifier: GPL-3.0-or-later
"""Going on with a bake in rounds: with one that was stopped, or that shall err less."""

import json

import leaflight._core as _core

from .._core import LeaflightError
from ..progress_bar import with_progress
from ..version import __version__
from ..volume.setting_error import SettingError
from .bake import lit
from .settings import bake_settings


@with_progress("resume")
def resume(
    kept,
    *,
    error=None,
    time=None,
    surroundings=None,
    threads=0,
    on_round=None,
    progress=None,
    checkpoint=None,
    workers=None,
):
    """The Bake that goes on where another ended, with its volumes, its scene and its settings.

    What the other has learnt counts: its light is averaged with that of the rounds to come. The
    bake that results is a new one, whose statistics count the rounds, the seconds and the rays of
    both. A bake that was stopped at its first, coarse picture begins anew.

    kept: a Bake in rounds, or one that load_bake() read. error: percent, as of bake(); None is what
    was asked for then. time: seconds that are added at most, None for no limit. surroundings:
    whether the meshes are lit, too, which they are anew; None is as before. threads, on_round,
    progress, checkpoint, workers: as of bake().
    Raises LeaflightError where there is nothing to go on with, Cancelled.
    """
    metadata = kept.metadata
    if kept.original is not None:
        raise LeaflightError(
            "A bake with other lamps or in another scene does not go on: resume its original."
        )
    if not metadata["blocks"]:
        raise LeaflightError(
            "This bake did a fixed amount of work, so it cannot be continued: bake the volume "
            "again."
        )
    settings = _settings(kept, error, time, surroundings, threads)
    reached = kept.statistics["estimated_error_percent"]
    if reached <= settings.error:
        raise SettingError(
            f"The bake errs {reached:.2g} % already, and {settings.error:g} % is asked for: ask "
            "for a smaller error to continue it.",
            "error",
        )
    metadata = {
        **metadata,
        "leaflight_version": __version__,
        "error": json.dumps(settings.error),
        "surroundings": json.dumps(settings.surroundings),
    }
    lights = kept.volumes, kept.scene, kept.isovalues
    return lit(*lights, settings, metadata, kept, on_round, progress, checkpoint, workers)


def _settings(kept, error, time, surroundings, threads):
    """The core's settings, as those of the bake were."""
    known = {
        key: json.loads(kept.metadata[key])
        for key in ("error", "asked_resolution", "both_sides", "surroundings", "seed")
    }
    resolution = known["asked_resolution"]
    return bake_settings(
        _core.BakeSettings,
        kept.volume.field().dims,
        error=known["error"] if error is None else error,
        time=time,
        resolution=resolution if any(resolution) else None,
        seed=known["seed"],
        threads=threads,
        exposure=kept.scene.exposure,
        both_sides=known["both_sides"],
        surroundings=known["surroundings"] if surroundings is None else surroundings,
    )
