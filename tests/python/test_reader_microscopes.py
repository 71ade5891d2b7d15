# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests CZI, LIF and ND2: frames, channels, positions and voxel sizes."""

import microscope_files as files
import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import format_of, probe
from microscope_files import needs
from outcomes import refused, written

# [t, p, c, z, y, x]
PIXELS = np.random.default_rng(1).integers(0, 60000, (2, 2, 3, 4, 5, 6)).astype(np.uint16)
RIGHT = np.diag([0.5, 0.25, 2, 1])
CHANNELS_LAST = np.moveaxis(PIXELS[:, 0], 1, -1)
# Package and writer of two times with three channels each.
WRITERS = {
    "czi": ("pylibCZIrw", lambda path: files.czi(path, PIXELS[:, 0])),
    "lif": (
        "liffile",
        lambda path: files.lif(path, {"a": ("TZCYX", PIXELS[:, 0].swapaxes(1, 2).copy())}),
    ),
    "nd2": ("nd2", lambda path: files.nd2(path, "TZYXC", CHANNELS_LAST)),
}


def check(path, values, **options):
    volume = read_volume(path, **options)
    np.testing.assert_array_equal(volume.values, values)
    right = np.diag([0.5, 0.5, 2, 1]) if path.suffix == ".nd2" else RIGHT
    np.testing.assert_allclose(volume.index_to_world, right)
    assert volume.unit == "µm"
    return volume


@pytest.fixture(params=WRITERS)
def whole(request, tmp_path):
    package, write = WRITERS[request.param]
    needs(package)
    path = tmp_path / f"x.{request.param}"
    write(path)
    return path


def test_times_and_channels(whole):
    stored = probe(whole)
    assert (stored.dims, stored.frames, stored.channels) == ((6, 5, 4), 2, 3)
    assert stored.dtype == np.uint16 and stored.notes == ()
    check(whole, PIXELS[1, 0, 2], frame=1, channel=2)


def test_truncated_files_are_refused(whole):
    data = whole.read_bytes()
    written(whole, data[: int(0.9 * len(data))])
    refused("damaged|ends before", read_volume, whole, frame=1, channel=2)


def test_scenes_of_czi(tmp_path):
    needs("pylibCZIrw")
    path = tmp_path / "x.czi"
    files.czi(path, PIXELS[:1, 0, :1], scenes=2)
    assert probe(path).datasets == ("scene 0", "scene 1")
    check(path, PIXELS[0, 0, 0] // 2, dataset="scene 1")


def test_a_missing_plane_of_czi_is_refused(tmp_path):
    """Checks a missing plane, which the library would return as black."""
    needs("pylibCZIrw")
    path = tmp_path / "x.czi"
    files.czi(path, PIXELS[:, 0, :1], without=[(1, 0, 2)])
    check(path, PIXELS[0, 0, 0], frame=0)
    refused("T 1, Z 2 .*missing", read_volume, path, frame=1)


def test_colors_of_czi(tmp_path):
    needs("pylibCZIrw")
    path = tmp_path / "x.czi"
    colors = np.moveaxis(PIXELS[0, 0] % 256, 0, -1).astype(np.uint8)
    files.czi(path, colors[None, None])
    check(path, colors[..., 1], channel=1)


def test_images_of_lif(tmp_path):
    """Checks images and positions of a mosaic; single planes are not volumes."""
    needs("liffile")
    path = tmp_path / "x.lif"
    first, tiles = PIXELS[0, 0, 0], np.ascontiguousarray(PIXELS[0, :, 0])
    files.lif(path, {"a": ("ZYX", first), "b": ("MZYX", tiles), "c": ("YX", first[0].copy())})
    assert probe(path).datasets == ("a", "b position 0", "b position 1")
    volume = check(path, PIXELS[0, 1, 0], dataset="b position 1")
    assert volume.notes == ("Single planes in the file are left out: c 6 x 5 pixels.",)


def test_planes_of_lif_that_stand_upright(tmp_path):
    """Checks xz planes, one behind the other: the volume must not be mirrored."""
    needs("liffile")
    path = tmp_path / "x.lif"
    upright = np.ascontiguousarray(PIXELS[0, 0, 0].swapaxes(0, 1))
    files.lif(path, {"xzy": ("YZX", upright)})
    volume = read_volume(path)
    np.testing.assert_array_equal(volume.values, upright)
    np.testing.assert_allclose(volume.index_to_world, RIGHT[:, [0, 2, 1, 3]])


def test_microscopes_are_known_by_their_contents(tmp_path):
    path = written(tmp_path / "x.unknown", b"ZISRAWFILE" + bytes(100))
    assert format_of(path).module == "czi"
    files.nd2(path, "ZYXC", PIXELS[0, 0, 0, ..., None])
    assert format_of(path).module == "nd2_file"


def test_positions_of_nd2(tmp_path):
    needs("nd2")
    path = tmp_path / "x.nd2"
    files.nd2(path, "TPZYXC", np.moveaxis(PIXELS[:, :, :1], 2, -1))
    assert probe(path).datasets == ("position 0", "position 1")
    check(path, PIXELS[1, 1, 0], dataset="position 1", frame=1)


def test_a_missing_frame_of_nd2_is_refused(tmp_path):
    """Checks a missing frame, which the package would return as zeros."""
    needs("nd2")
    path = tmp_path / "x.nd2"
    files.nd2(path, "TZYXC", CHANNELS_LAST, without=[6])
    check(path, PIXELS[0, 0, 2], frame=0, channel=2)
    refused("frame 6 .*missing", read_volume, path, frame=1, channel=2)


def test_single_planes_are_no_volume(tmp_path):
    needs("nd2")
    path = tmp_path / "x.nd2"
    files.nd2(path, "YXC", np.moveaxis(PIXELS[0, 0, :, 0], 0, -1))
    refused("single planes .6 x 5", read_volume, path)
