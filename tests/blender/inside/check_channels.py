# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the import of files with several channels."""

from types import SimpleNamespace

import bpy
import numpy as np
import passes
import pytest
import tifffile
from boxes import build_cornell_box
from leaflight.io.readers import probe
from leaflight.io.readers.channels import Channel
from leaflight_addon.importing import channels
from leaflight_addon.show import texture
from leaflight_addon.store import cache
from tools import close, colors_of, error_of, vertices_of


def _balls(places):
    """Returns volumes with a ball each at these places along x."""
    axis = np.linspace(-1.0, 1.0, 20)
    x, y, z = axis, axis[:, None], axis[:, None, None]
    shares = [np.exp(-8.0 * ((x - at) ** 2 + y**2 + z**2)) for at in places]
    return np.rint(250 * np.stack(shares)).astype(np.uint8)


def _four_channels(path, names=("DAPI", "GFP", "Cy5", "WGA"), values=None):
    """Writes an OME-TIFF of a ball in each channel: blue, green, red and gray."""
    colors = [0x0000FFFF, 0x00FF00FF, -0x00FFFF01, 0x808080FF]
    values = _balls((-0.6, -0.2, 0.2, 0.6)) if values is None else values
    about = {"axes": "CZYX", "Channel": {"Name": list(names), "Color": colors}}
    tifffile.imwrite(path, values, ome=True, photometric="minisblack", metadata=about)
    return values


def _volumes():
    return [obj for obj in bpy.data.objects if obj.leaflight.is_volume]


def _ticked(*numbers):
    return [number in numbers for number in range(channels.MOST)]


def check_four_channels_have_their_names_and_colors(tmp_path):
    values = _four_channels(tmp_path / "cells.ome.tif")
    bpy.ops.leaflight.import_volume(
        filepath=str(tmp_path / "cells.ome.tif"), channels=_ticked(0, 1, 2, 3)
    )
    found = {obj.leaflight.channel: obj for obj in _volumes()}
    assert [found[k].name for k in range(4)] == [
        f"cells.ome {name}" for name in ("DAPI", "GFP", "Cy5", "WGA")
    ]
    gray = 0.85 * ((128 / 255 + 0.055) / 1.055) ** 2.4
    colors = [(0, 0, 0.85), (0, 0.85, 0), (0.85, 0, 0), (gray,) * 3]
    for number, color in enumerate(colors):
        close(found[number].leaflight.isosurface_albedo, color, 1e-5)
        close(found[number].matrix_world, found[0].matrix_world, 1e-6)
        close(cache.volume_of(found[number]).values, values[number], 0)
    build_cornell_box()
    found[0].leaflight.error, found[0].leaflight.resolution = 50.0, 12
    found[0].leaflight.bake_folder = str(tmp_path / "bakes")
    bpy.ops.leaflight.bake()
    assert len(cache.bake_of(found[0]).volumes) == 4
    assert len({obj.leaflight.bake_id for obj in _volumes()}) == 1


def check_channels_without_names_are_numbered(tmp_path):
    """Checks channels of a NRRD file, which are read again as they were."""
    values = np.moveaxis(_balls((-0.4, 0.0, 0.4)), 0, -1)
    header = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 20 20 20\nencoding: raw\n"
    path = tmp_path / "cells.nrrd"
    path.write_bytes(f"{header}kinds: vector domain domain domain\n\n".encode() + values.tobytes())
    bpy.ops.leaflight.import_volume(filepath=str(path), all_channels=True)
    assert [obj.leaflight.channel for obj in _volumes()] == [0, 1, 2]
    assert [obj.name for obj in _volumes()] == [f"cells channel {k}" for k in range(3)]
    assert len({tuple(obj.leaflight.isosurface_albedo) for obj in _volumes()}) == 3
    for k, obj in enumerate(_volumes()):
        close(cache.volume_of(obj).values, values[..., k], 0)
    cache.forget_unused()
    bpy.ops.leaflight.import_volume(filepath=str(path), channel=1)
    assert bpy.context.object.leaflight.channel == 1


def _drawn(path, **chosen):
    """Returns what the file dialog draws for the channels of a file."""
    no_choice = {"channel": -1, "channels": _ticked(), "all_channels": False, "as_rgb": False}
    found, operator = [], SimpleNamespace(**{**no_choice, **chosen})
    channels.draw(passes.Layout(found), operator, probe(path))
    return found


def check_the_dialog_lists_channels(tmp_path):
    _four_channels(tmp_path / "x.ome.tif")
    names = ["channels", ""] * 4
    assert _drawn(tmp_path / "x.ome.tif") == ["all_channels", *names, "as_rgb"]
    # A property of Blender has at most 32 numbers.
    many = np.zeros((5, 40, 6, 7), np.uint8)
    tifffile.imwrite(tmp_path / "many.tif", many, imagej=True)
    assert _drawn(tmp_path / "many.tif") == ["all_channels", "channel", "as_rgb"]
    colors = np.arange(5 * 6 * 7 * 3, dtype=np.uint16).astype(np.uint8).reshape(5, 6, 7, 3)
    tifffile.imwrite(tmp_path / "rgb.tif", colors, photometric="rgb", metadata={"axes": "ZYXS"})
    assert _drawn(tmp_path / "rgb.tif")[-1] == "In the colors of the picture"
    assert _drawn(tmp_path / "rgb.tif", channels=_ticked(1))[-1] == "as_rgb"


def check_some_channels_are_chosen(tmp_path):
    path = str(tmp_path / "cells.ome.tif")
    _four_channels(path)
    assert "(DAPI, GFP, Cy5, WGA)" in error_of(bpy.ops.leaflight.import_volume, filepath=path)
    bpy.ops.leaflight.import_volume(filepath=path, channels=_ticked(1, 3))
    assert [obj.leaflight.channel for obj in _volumes()] == [1, 3]
    bpy.ops.leaflight.import_volume(filepath=path, channels=_ticked(2))
    obj = bpy.context.object
    assert (obj.name, obj.leaflight.channel) == ("cells.ome Cy5", 2)
    close(obj.leaflight.isosurface_albedo, (0.85, 0, 0), 1e-5)


def check_channels_without_colors_or_with_one_name(tmp_path):
    """Checks a name of two channels, and a channel whose voxels are equal."""
    values = _balls((-0.5, 0.0, 0.5, 0.0))
    values[3] = 7
    _four_channels(tmp_path / "x.ome.tif", ("a", "b", "a", "dark"), values)
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "x.ome.tif"), all_channels=True)
    found = sorted(_volumes(), key=lambda obj: obj.leaflight.channel)
    assert [obj.name for obj in found] == ["x.ome a", "x.ome b", "x.ome a.001"]


def check_three_channels_color_one_volume(tmp_path):
    """Checks that red is the red channel of the file, wherever it is, and the brightest values."""
    path = str(tmp_path / "cells.ome.tif")
    values = _four_channels(path)
    sentence = error_of(bpy.ops.leaflight.import_volume, filepath=path, as_rgb=True)
    assert "As RGB takes three channels, not 4" in sentence and not _volumes()
    bpy.ops.leaflight.import_volume(filepath=path, channels=_ticked(0, 1, 2), as_rgb=True)
    obj = bpy.context.object
    settings = obj.leaflight
    others = [settings.texture_volume, settings.texture_green, settings.texture_blue]
    assert [other.leaflight.channel for other in others] == [2, 1, 0]
    assert all(other.hide_render for other in others) and not obj.hide_render
    assert obj.name == "cells.ome" and not settings.texture_srgb
    close(cache.volume_of(obj).values, values[:3].max(axis=0), 0)
    places, colors = vertices_of(obj)[:, 0], colors_of(obj, "texture")
    left, right = colors[places < -5], colors[places > 3]
    assert len(left) and len(right)
    assert (left[:, 2] > left[:, 0]).all() and (right[:, 0] > right[:, 2]).all()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    obj = bpy.data.objects["cells.ome"]
    close(cache.volume_of(obj).values, values[:3].max(axis=0), 0)


def check_a_red_picture_is_a_red_volume(tmp_path):
    (red,) = _balls((0.0,))
    picture = np.stack([red, np.zeros_like(red), np.zeros_like(red)], axis=-1)
    path = tmp_path / "x.tif"
    tifffile.imwrite(path, picture, photometric="rgb", metadata={"axes": "ZYXS"})
    bpy.ops.leaflight.import_volume(filepath=str(path))
    (obj,) = _volumes()
    close(obj.leaflight.isosurface_albedo, (0.85, 0, 0), 1e-5)
    picture[:] = 3, 4, 5
    tifffile.imwrite(path, picture, photometric="rgb", metadata={"axes": "ZYXS"})
    assert "same value" in error_of(
        bpy.ops.leaflight.import_volume, filepath=str(path), channels=_ticked(0, 1)
    )


def check_equal_colors_are_replaced():
    def stored(*colors):
        listed = tuple(Channel(str(number), color) for number, color in enumerate(colors))
        return SimpleNamespace(channels=len(listed), channel=listed.__getitem__)

    green = (0.0, 1.0, 0.0)
    assert len(set(channels.albedos(stored(green, green, green)))) == 3
    assert channels.albedos(stored(None, green))[1] == (0.0, 0.85, 0.0)


@pytest.mark.parametrize("as_rgb", [False, True])
def check_all_channels_play(tmp_path, as_rgb):
    """Checks two frames with three channels, of which the second frame has other balls."""
    values = np.stack([_balls((-0.6, 0.0, 0.6)), _balls((0.6, 0.0, -0.6))])
    order = {"axes": "TZCYX"}
    frames = np.ascontiguousarray(values.swapaxes(1, 2))
    tifffile.imwrite(tmp_path / "x.tif", frames, imagej=True, metadata=order)
    bpy.ops.leaflight.import_volume(
        filepath=str(tmp_path / "x.tif"), channels=_ticked(0, 1, 2), as_rgb=as_rgb, animate=True
    )
    obj = bpy.context.object
    for frame in (0, 1, 0):
        bpy.context.scene.frame_set(1 + frame)
        for each in _volumes():
            channel = each.leaflight.channel
            expected = values[frame].max(axis=0) if channel < 0 else values[frame, channel]
            close(cache.volume_of(each).values, expected, 0)
        if as_rgb:
            colors, right = colors_of(obj, "texture"), vertices_of(obj)[:, 0] > 3
            is_red = colors[right, 0] > colors[right, 2]
            assert right.any() and (is_red == (frame == 1)).all()


def check_a_picture_is_imported_in_its_colors(tmp_path):
    """Checks the first click on pictures whose blue is black everywhere."""
    red, green = _balls((-0.4, 0.4))
    picture = np.stack([red, green, np.zeros_like(red)], axis=-1)
    path = tmp_path / "picture.tif"
    tifffile.imwrite(path, picture, photometric="rgb", metadata={"axes": "ZYXS"})
    bpy.ops.leaflight.import_volume(filepath=str(path))
    obj = bpy.context.object
    settings = obj.leaflight
    assert settings.texture_srgb and settings.texture_blue is None
    assert (settings.texture_low, settings.texture_high) == (0, 255)
    assert [other.name for other in texture.volumes_that_color(obj)] == [
        "picture red",
        "picture green",
    ]
    isovalue = settings.isovalue
    bright = ((isovalue / 255 + 0.055) / 1.055) ** 2.4
    colors = colors_of(obj, "texture")
    close(colors.max(axis=1), bright, 0.02)
    assert (colors[:, 2] == 0).all()
    bpy.ops.leaflight.import_volume(filepath=str(path), channels=_ticked(1))
    assert bpy.context.object.leaflight.texture_volume is None
    assert bpy.context.object.name == "picture green.001"
