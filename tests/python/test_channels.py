# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the names and colors of channels, and their choice by name."""

import h5py
import microscope_files
import numpy as np
import pytest
import tifffile
from leaflight import read_volume
from leaflight.io.readers import probe
from leaflight.io.readers.channels import Channel, channel_of
from microscope_files import needs
from outcomes import reads, refused, written
from PIL import Image

# [c, z, y, x]
PIXELS = np.random.default_rng(3).integers(0, 60000, (4, 5, 6, 7)).astype(np.uint16)
NAMES = ("DAPI", "GFP", "Cy5", "bright field")
BYTES = ((0, 0, 255), (0, 255, 0), (255, 0, 128), (255, 255, 255))
# The linear value of 128 in sRGB.
HALF = 0.21586


def check(path, names=NAMES, colors=BYTES):
    """Checks the names and colors of the channels of a file, and returns its StoredVolume."""
    stored = probe(path)
    assert stored.channels == len(stored.channel_list) == len(names)
    assert [channel.name for channel in stored.channel_list] == list(names)
    for channel, color in zip(stored.channel_list, colors):
        linear = np.select([np.array(color) == 128], [HALF], np.array(color) / 255)
        np.testing.assert_allclose(channel.color, linear, atol=1e-5)
    return stored


def ome_tiff(path, names=NAMES, pixels=PIXELS):
    """Writes an OME-TIFF. Its colors are signed integers with the bytes RGBA."""
    colors = [np.array([*color, 255], np.uint8).view(">i4")[0] for color in BYTES]
    about = {"Name": list(names), "Color": [int(color) for color in colors]}
    metadata = {"axes": "CZYX", "Channel": about, "PhysicalSizeX": 0.5, "PhysicalSizeY": 0.25}
    metadata |= {"PhysicalSizeZ": 2.0}
    tifffile.imwrite(path, pixels, ome=True, photometric="minisblack", metadata=metadata)
    return path


def test_ome_tiff(tmp_path):
    path = ome_tiff(tmp_path / "cells.ome.tif")
    stored = check(path)
    assert (stored.dims, stored.unit, stored.voxel_size) == ((7, 6, 5), "µm", (0.5, 0.25, 2))
    xml = tifffile.xml2dict(tifffile.TiffFile(path).ome_metadata)
    described = xml["OME"]["Image"]["Pixels"]["Channel"]
    for number, one in enumerate(described):
        assert int(one["Color"]) >> 24 & 255 == BYTES[number][0]
        volume = reads(tifffile.imread(path)[number], path, channel=one["Name"])
        assert volume.name == f"cells.ome {NAMES[number]}"
        np.testing.assert_array_equal(np.diag(volume.index_to_world), [0.5, 0.25, 2, 1])


def test_several_channels_give_the_greatest_values(tmp_path):
    path = ome_tiff(tmp_path / "cells.ome.tif")
    volume = reads(PIXELS[[0, 2]].max(axis=0), path, channel=(0, "Cy5"))
    assert volume.name == "cells.ome" and volume.values.dtype == np.uint16


@pytest.mark.parametrize(
    "chosen, sentence",
    [
        ("gfp", "no channel 'gfp' among DAPI, GFP, Cy5, bright field; choose one of 0..3."),
        (4, "no channel 4; choose one of 0..3."),
        (None, r"4 channels \(DAPI, GFP, Cy5, bright field\); choose one of 0..3."),
        ([], r"4 channels \(DAPI, GFP"),
        (["GFP", -1], "no channel -1"),
    ],
)
def test_an_absent_channel_is_refused(tmp_path, chosen, sentence):
    path = ome_tiff(tmp_path / "cells.ome.tif")
    refused(sentence, read_volume, path, channel=chosen)


def test_ambiguous_and_absent_names_are_refused(tmp_path):
    tifffile.imwrite(tmp_path / "x.tif", np.moveaxis(PIXELS, 0, 1), imagej=True)
    refused("no channel 'GFP'; choose one of 0..3.", read_volume, tmp_path / "x.tif", channel="GFP")
    np.save(tmp_path / "x.npy", PIXELS[0])
    refused("'GFP'; choose none, because", read_volume, tmp_path / "x.npy", channel="GFP")
    path = ome_tiff(tmp_path / "x.ome.tif", ("a", "b", "a", "c"))
    refused("'a' is that of 2 channels; choose one of 0, 2.", read_volume, path, channel="a")
    reads(PIXELS[2], path, channel=2)


def test_wavelengths_are_names(tmp_path, cli):
    path = ome_tiff(tmp_path / "x.ome.tif", ("405", "488", "1", "640"))
    reads(PIXELS[1], path, channel=488)
    # A number that exists counts first, because other files have no names.
    reads(PIXELS[1], path, channel=1)
    reads(PIXELS[2], path, channel="1")
    cli.runs("info", path, "--channel", "640")


def test_the_command_line(tmp_path, cli):
    path = ome_tiff(tmp_path / "cells.ome.tif")
    assert "(DAPI, GFP, Cy5, bright field)" in cli("info", path).err
    chosen = ("info", path, "--channel", "bright field")
    assert "channels 0 DAPI, 1 GFP, 2 Cy5, 3 bright field" in cli.runs(*chosen)
    result = cli.json(*chosen)
    assert result["name"] == "cells.ome bright field"
    assert result["channels"][1] == {"name": "GFP", "color": [0, 1, 0]}
    assert "(--channel)" in cli.refuses("among DAPI", "info", path, "--channel", "x")


def test_colors_that_say_nothing():
    assert channel_of(" two\n words ") == Channel("two words")
    assert channel_of("x" * 1000).name == "x" * 60
    for color in ((0, 0, 0), (1, 1), (np.nan, 0, 1), "red", None):
        assert channel_of(7, color) == Channel()


def imagej(path, labels=()):
    ramp = np.arange(256) / 255
    tables = [np.rint(np.outer(color, ramp)).astype(np.uint8) for color in BYTES]
    metadata = {"axes": "ZCYX", "mode": "composite", "LUTs": tables}
    if labels:
        metadata["Labels"] = labels
    tifffile.imwrite(path, np.moveaxis(PIXELS, 0, 1), imagej=True, metadata=metadata)
    return path


def test_imagej(tmp_path):
    """Checks the colors of lookup tables, and labels of slices as Bio-Formats writes them."""
    labels = [f"c:{c + 1}/4 z:{z + 1}/5 - {NAMES[c]}" for z in range(5) for c in range(4)]
    path = imagej(tmp_path / "cells.tif", labels)
    check(path)
    assert np.array_equal(tifffile.TiffFile(path).imagej_metadata["LUTs"][2][:, -1], BYTES[2])
    reads(PIXELS[2], path, channel="Cy5")


@pytest.mark.parametrize(
    "labels", [[], ["cells"] * 20, [f"slice {k}" for k in range(20)], ["DAPI", "GFP"]]
)
def test_labels_of_imagej_that_name_no_channels(tmp_path, labels):
    names = ("DAPI", "GFP", "", "") if len(labels) == 2 else ("",) * 4
    volume = check(imagej(tmp_path / "x.tif", labels), names)
    assert volume.dims == (7, 6, 5)


def test_planes_of_colors(tmp_path):
    """Checks colors of TIFF, of pictures and of NRRD; gray pictures have no channels."""
    colors = np.moveaxis(PIXELS[:3] >> 8, 0, -1).astype(np.uint8)
    tifffile.imwrite(tmp_path / "x.tif", colors, photometric="rgb", metadata={"axes": "ZYXS"})
    header = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 7 6 5\nencoding: raw\n"
    kinds = "kinds: RGB-color domain domain domain\n\n"
    written(tmp_path / "x.nrrd", header.encode() + kinds.encode() + colors.tobytes())
    (tmp_path / "x").mkdir()
    for z, picture in enumerate(colors):
        Image.fromarray(picture).save(tmp_path / "x" / f"{z}.png")
    for name in ("x.tif", "x.nrrd", "x"):
        check(tmp_path / name, ("red", "green", "blue"), np.diag([255] * 3))
        volume = reads(colors[..., 1], tmp_path / name, channel="green")
        assert volume.name == "x green"
    gray = np.repeat(colors[..., :1], 3, axis=-1)
    tifffile.imwrite(tmp_path / "g.tif", gray, photometric="rgb", metadata={"axes": "ZYXS"})
    assert probe(tmp_path / "g.tif").channel_list == ()


def ome_zarr(path, channels, version="0.4"):
    zarr = pytest.importorskip("zarr")
    is_new = int(zarr.__version__.partition(".")[0]) > 2
    group = zarr.open_group(str(path), mode="w", **({"zarr_format": 2} if is_new else {}))
    group.create_dataset("0", data=PIXELS, shape=PIXELS.shape, chunks=(1, 2, 3, 4))
    axes = [{"name": "c", "type": "channel"}, *({"name": a, "type": "space"} for a in "zyx")]
    scale = [{"type": "scale", "scale": [1, 2, 0.25, 0.5]}]
    datasets = [{"path": "0", "coordinateTransformations": scale}]
    about = {"multiscales": [{"axes": axes, "datasets": datasets}], "omero": {"channels": channels}}
    group.attrs.update({"ome": about} if version == "0.5" else about)
    return path


@pytest.mark.parametrize("version", ["0.4", "0.5"])
def test_ome_zarr(tmp_path, version):
    channels = [
        {"label": name, "color": bytes(color).hex().upper(), "window": {"start": 0, "end": 9}}
        for name, color in zip(NAMES, BYTES)
    ]
    path = ome_zarr(tmp_path / "x.zarr", channels, version)
    assert check(path).voxel_size == (0.5, 0.25, 2)
    reads(PIXELS[3], path, channel="bright field")
    path = ome_zarr(tmp_path / "y.zarr", channels[:3], version)
    assert probe(path).channel_list == ()


def test_names_of_ome_zarr_that_are_no_text(tmp_path):
    channels = [{"label": label, "color": "00FF00"} for label in (3, ["a"], None, "b")]
    stored = check(ome_zarr(tmp_path / "x.zarr", channels), ("", "", "", "b"), BYTES[1:2] * 4)
    assert stored.notes == ("Names of channels that are not text are left out; choose by number.",)
    for number, channels in enumerate(({}, [1, 2, 3, 4], None)):
        assert probe(ome_zarr(tmp_path / f"{number}.zarr", channels)).channel_list == ()


def test_imaris(tmp_path):
    path = tmp_path / "x.ims"
    with h5py.File(path, "w") as file:
        for number, (name, color) in enumerate(zip(NAMES, BYTES)):
            file[f"DataSet/ResolutionLevel 0/TimePoint 0/Channel {number}/Data"] = PIXELS[number]
            info = file.create_group(f"DataSetInfo/Channel {number}")
            shown = " ".join(f"{byte / 255:.8f}" for byte in color)
            for key, text in (("Name", name), ("Color", shown)):
                info.attrs[key] = np.frombuffer(text.encode(), "S1")
    check(path)
    reads(PIXELS[2], path, channel="Cy5")


def test_components_of_vtk(tmp_path):
    vtk = pytest.importorskip("vtkmodules.all")
    support = pytest.importorskip("vtkmodules.util.numpy_support")
    image, path = vtk.vtkImageData(), tmp_path / "x.vti"
    image.SetDimensions(7, 6, 5)
    array = support.numpy_to_vtk(PIXELS[:2].reshape(2, -1).T.copy(), deep=True)
    array.SetName("flow")
    for number, name in enumerate(("along", "across")):
        array.SetComponentName(number, name)
    image.GetPointData().AddArray(array)
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(image)
    writer.Write()
    assert [channel.name for channel in probe(path).channel_list] == ["along", "across"]
    assert reads(PIXELS[1], path, channel="across").name == "x across"


def test_czi(tmp_path):
    needs("pylibCZIrw")
    microscope_files.czi(tmp_path / "x.czi", PIXELS[None], names=NAMES, colors=BYTES)
    check(tmp_path / "x.czi")
    reads(PIXELS[2], tmp_path / "x.czi", channel="Cy5")


def test_lif(tmp_path):
    needs("liffile")
    tables = ("Blue", "Green", "Magenta", "Gray")
    images = {"cells": ("CZYX", PIXELS)}
    microscope_files.lif(tmp_path / "x.lif", images, names=NAMES, tables=tables)
    check(tmp_path / "x.lif", NAMES, (*BYTES[:2], (255, 0, 255), BYTES[3]))
    reads(PIXELS[2], tmp_path / "x.lif", channel="Cy5")


def test_nd2(tmp_path):
    needs("nd2")
    pixels = np.ascontiguousarray(np.moveaxis(PIXELS, 0, -1))
    microscope_files.nd2(tmp_path / "x.nd2", "ZYXC", pixels, names=NAMES, colors=BYTES)
    check(tmp_path / "x.nd2")
    reads(PIXELS[2], tmp_path / "x.nd2", channel="Cy5")
