# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests TIFF of microscopes and ImageJ: sets of files, previews, units, colors."""

import numpy as np
import pytest
import tifffile
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written
from PIL import Image

PIXELS = np.random.default_rng(1).integers(0, 60000, (2, 4, 5, 6)).astype(np.uint16)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "x.tif"


def diagonal(volume):
    return np.diag(volume.index_to_world)[:3].tolist()


def ome(data, uuid="urn:uuid:0", more=""):
    """Returns OME-XML of two channels and four planes; data: its elements TiffData."""
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><OME UUID="{uuid}" '
        'xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06">'
        '<Image ID="Image:0" Name="cells"><Pixels ID="Pixels:0" DimensionOrder="XYZCT" '
        'Type="uint16" SizeX="6" SizeY="5" SizeZ="4" SizeC="2" SizeT="1" PhysicalSizeX="500" '
        'PhysicalSizeXUnit="nm" PhysicalSizeY="0.25" PhysicalSizeZ="2">'
        '<Channel ID="Channel:0:0" SamplesPerPixel="1"/>'
        f"{data}</Pixels></Image>{more}</OME>"
    )


def tiff_data(name, first="", ifd='IFD="0" PlaneCount="1"', uuid=0):
    return f'<TiffData {first} {ifd}><UUID FileName="{name}">urn:uuid:{uuid}</UUID></TiffData>'


def write(path, pages, xml):
    tifffile.imwrite(path, pages, photometric="minisblack", metadata=None, description=xml)


def of_channels(folder):
    """Writes one file per channel, each with the metadata of all."""
    names = ["set_C0.ome.tif", "set_C1.ome.tif"]
    ifd = 'IFD="0" PlaneCount="4"'
    data = "".join(tiff_data(n, f'FirstC="{c}"', ifd, c) for c, n in enumerate(names))
    for c, name in enumerate(names):
        write(folder / name, PIXELS[c], ome(data, f"urn:uuid:{c}"))
    return names


def of_planes(folder):
    """Writes one file per plane."""
    places = [(c, z) for c in range(2) for z in range(4)]
    names = [f"s_C{c}_Z{z}.ome.tif" for c, z in places]
    data = "".join(
        tiff_data(name, f'FirstC="{c}" FirstZ="{z}"', uuid=k)
        for k, (name, (c, z)) in enumerate(zip(names, places))
    )
    for k, (name, (c, z)) in enumerate(zip(names, places)):
        write(folder / name, PIXELS[c, z], ome(data, f"urn:uuid:{k}"))
    return names


def of_companion(folder):
    """Writes files of planes, and a companion file with the metadata."""
    names = ["a.tif", "b.tif"]
    data = "".join(tiff_data(n, f'FirstC="{c}"', "", c) for c, n in enumerate(names))
    (folder / "set.companion.ome").write_text(ome(data, "urn:uuid:9"))
    xml = '<OME UUID="urn:uuid:1"><BinaryOnly MetadataFile="set.companion.ome"/></OME>'
    for c, name in enumerate(names):
        write(folder / name, PIXELS[c], xml)
    return [*names, "set.companion.ome"]


@pytest.mark.parametrize("make", [of_channels, of_planes, of_companion])
def test_a_set_of_ome_tiff_is_read_whole_by_any_of_its_files(tmp_path, make):
    names = make(tmp_path)
    for name in names:
        stored = probe(tmp_path / name)
        assert (stored.dims, stored.channels, stored.unit) == ((6, 5, 4), 2, "µm")
        for channel in range(2):
            volume = reads(PIXELS[channel], tmp_path / name, channel=channel)
            np.testing.assert_allclose(diagonal(volume), [0.5, 0.25, 2])


@pytest.mark.parametrize("make", [of_channels, of_planes])
def test_a_folder_that_holds_a_set_of_ome_tiff(tmp_path, make):
    make(tmp_path)
    reads(PIXELS[1], tmp_path, channel=1)


@pytest.mark.parametrize("make", [of_channels, of_planes, of_companion])
def test_a_missing_file_of_a_set_is_refused_by_its_name(tmp_path, make):
    names = make(tmp_path)
    (tmp_path / names[1]).unlink()
    refused(f"'{names[1]}' is missing; put all files", read_volume, tmp_path / names[0], channel=0)


@pytest.mark.parametrize("name", ["../other.ome.tif", "/etc/passwd", "C:\\x.tif"])
def test_a_set_stays_in_its_folder(tmp_path, name):
    folder = tmp_path / "set"
    folder.mkdir()
    write(tmp_path / "other.ome.tif", PIXELS[1], "")
    ifd = 'IFD="0" PlaneCount="4"'
    data = tiff_data("x.ome.tif", "", ifd) + tiff_data(name, 'FirstC="1"', ifd, 1)
    write(folder / "x.ome.tif", PIXELS[0], ome(data))
    refused("outside", read_volume, folder / "x.ome.tif", channel=0)
    (folder / "x.ome.tif").unlink()
    write(folder / "x.ome.tif", PIXELS[0], f'<OME><BinaryOnly MetadataFile="{name}"/></OME>')
    refused("outside", read_volume, folder / "x.ome.tif")


@pytest.mark.parametrize("uuid", ["urn:uuid:0", "urn:uuid:7"])
def test_a_renamed_ome_tiff_is_read(tmp_path, uuid):
    """Checks a file whose metadata contain its former name."""
    data = tiff_data("old name.ome.tif", "", 'IFD="0" PlaneCount="8"')
    write(tmp_path / "new.ome.tif", PIXELS.reshape(8, 5, 6), ome(data, uuid))
    reads(PIXELS[1], tmp_path / "new.ome.tif", channel=1)


def test_a_plane_that_is_in_no_file_is_refused(tmp_path):
    path = tmp_path / "x.ome.tif"
    pages = PIXELS.reshape(8, 5, 6)
    write(path, pages[:7], ome(tiff_data("x.ome.tif", "", 'IFD="0" PlaneCount="8"')))
    refused("8 planes.* Z 3, C 1, T 0", read_volume, path, channel=0)
    write(path, np.concatenate([pages, pages[:1]]), ome(""))
    assert probe(path).notes == ("Pages without OME metadata are left out: 1.",)
    reads(PIXELS[1], path, channel=1)


@pytest.mark.parametrize(
    "xml", ["<OME><Image></OME>", "<OME></OME>", "<OME><Image><Pixels/></Image></OME>"]
)
def test_damaged_ome_metadata_are_refused(tmp_path, xml):
    write(tmp_path / "x.ome.tif", PIXELS[0], xml)
    refused("OME metadata|holds 0", read_volume, tmp_path / "x.ome.tif")


def test_several_images_of_ome_tiff_are_chosen_by_name(tmp_path):
    path = tmp_path / "x.ome.tif"
    with tifffile.TiffWriter(path, ome=True) as file:
        file.write(PIXELS[0], photometric="minisblack", metadata={"axes": "ZYX", "Name": "left"})
        file.write(PIXELS[1, :3], photometric="minisblack", metadata={"axes": "ZYX", "Name": "up"})
        file.write(PIXELS[1, 0, :2], photometric="minisblack", metadata={"axes": "YX"})
    stored = probe(path)
    assert stored.datasets == ("left", "up")
    refused("left, up", read_volume, path)
    volume = reads(PIXELS[1, :3], path, dataset="up")
    assert volume.notes == ("Other pictures in the file are left out: 1, of 6 x 2 pixels.",)


def test_colors_in_ome_tiff_are_channels(tmp_path):
    path = tmp_path / "x.ome.tif"
    colors = np.moveaxis(np.stack([PIXELS[0], PIXELS[1], PIXELS[0] // 2]), 0, -1)
    tifffile.imwrite(path, colors, photometric="rgb", ome=True, metadata={"axes": "ZYXS"})
    assert probe(path).channels == 3
    reads(PIXELS[0] // 2, path, channel=2)


UNITS = {unit: "µm" for unit in ("\\u00B5m", "micron", "um", "microns", "Âµm")}
UNITS |= {"nm": "nm", "\\u00C5": "Å", "mm": "mm", "cm": "cm", "pixel": "", "": ""}


@pytest.mark.parametrize("unit", UNITS)
def test_units_of_imagej(path, unit):
    text = f"ImageJ=1.53t\nimages=4\nslices=4\nunit={unit}\nspacing=3.0\nloop=false\n"
    write_imagej(path, PIXELS[0], text)
    volume = reads(PIXELS[0], path)
    np.testing.assert_allclose(diagonal(volume), [0.5, 0.25, 3])
    assert volume.unit == UNITS[unit]


def write_imagej(path, pages, text, resolution=(2, 4), unit=1):
    """Writes a file like ImageJ: its resolution has no valid unit; a text names the unit."""
    options = {"resolution": resolution, "resolutionunit": unit, "photometric": "minisblack"}
    tifffile.imwrite(path, pages, metadata=None, description=text.encode(), **options)


@pytest.mark.parametrize(
    "more, sizes, unit",
    [
        ("unit=um\n", [0.5, 0.25, 1], "µm"),
        ("spacing=2\n", [0.5, 0.25, 2], ""),
        ("unit=um\nspacing=-2\n", [0.5, 0.25, 2], "µm"),
        ("unit=um\nspacing=2,5\n", [0.5, 0.25, 2.5], "µm"),
        ("unit=micron\nspacing=0.002\nzunit=mm\n", [0.5, 0.25, 2], "µm"),
        ("unit=mm\nyunit=cm\nzunit=um\nspacing=1500\n", [0.5, 2.5, 1.5], "mm"),
        ("unit=inch\nspacing=0.5\n", [12.7, 6.35, 12.7], "mm"),
        ("", [0.5, 0.25, 1], ""),
    ],
)
def test_voxel_size_of_imagej(path, more, sizes, unit):
    """Checks that absent sizes are 1, and that an absent unit is that of x."""
    write_imagej(path, PIXELS[0], f"ImageJ=1.53t\nimages=4\nslices=4\n{more}")
    volume = read_volume(path)
    np.testing.assert_allclose(diagonal(volume), sizes)
    assert volume.unit == unit


def test_resolution_of_a_screen_says_nothing(path):
    text = "ImageJ=1.53t\nimages=4\nslices=4\n"
    write_imagej(path, PIXELS[0], text, (72, 72), 2)
    assert diagonal(read_volume(path)) == [1, 1, 1] and not read_volume(path).unit
    write_imagej(path, PIXELS[0], text, (100, 100), 3)
    volume = read_volume(path)
    np.testing.assert_allclose(diagonal(volume), [0.01, 0.01, 1])
    assert volume.unit == "cm"


@pytest.mark.parametrize(
    "c0, c1, dtype, note",
    [(-32768, 1, np.int16, "-32768 + 1 x"), (-10, 0.5, np.float32, "-10 [+] 0.5 x")],
)
def test_values_are_those_that_imagej_shows(path, c0, c1, dtype, note):
    text = f"ImageJ=1.53t\nimages=4\nslices=4\ncf=0\nc0={c0}\nc1={c1}\nvunit=Gray Value\n"
    write_imagej(path, PIXELS[0], text)
    volume = read_volume(path)
    np.testing.assert_allclose(volume.values, c0 + c1 * PIXELS[0].astype(float))
    assert volume.values.dtype == dtype
    assert volume.notes[0].startswith("The values are calibrated as in ImageJ: ")


def test_lsm(tmp_path):
    """Checks Zeiss' older microscopes: each page has all channels, and a thumbnail follows it."""
    path = tmp_path / "x.lsm"
    fields = [field for field in tifffile.TIFF.CZ_LSMINFO if field[0]]
    info = np.zeros(1, np.dtype([(name, kind) for name, kind in fields][:32]))
    known = {"MagicNumber": 67127628, "StructureSize": info.itemsize, "DimensionX": 6}
    known |= {"DimensionY": 5, "DimensionZ": 4, "DimensionChannels": 3, "DimensionTime": 1}
    known |= {"VoxelSizeX": 5e-7, "VoxelSizeY": 2.5e-7, "VoxelSizeZ": 2e-6}
    for name, value in known.items():
        info[name] = value
    tag = [(34412, "B", info.nbytes, info.tobytes(), True)]
    options = {"photometric": "minisblack", "metadata": None, "contiguous": False}
    whole = np.concatenate([PIXELS, PIXELS[:1] // 2])
    with tifffile.TiffWriter(path, byteorder="<") as file:
        for z in range(4):
            page = whole[:, z]
            file.write(page, planarconfig="separate", extratags=tag if z == 0 else [], **options)
            file.write(page[:, ::2, ::2], planarconfig="separate", subfiletype=1, **options)
    volume = reads(PIXELS[0] // 2, path, channel=2)
    np.testing.assert_allclose(diagonal(volume), [0.5, 0.25, 2])
    assert volume.unit == "µm"


def test_an_unknown_depth_of_a_voxel_is_reported(tmp_path):
    path = tmp_path / "x.ome.tif"
    metadata = {"axes": "ZYX", "PhysicalSizeX": 0.5, "PhysicalSizeY": 0.5}
    tifffile.imwrite(path, PIXELS[0], ome=True, metadata=metadata)
    volume = read_volume(path)
    assert diagonal(volume) == [0.5, 0.5, 1] and volume.unit == "µm"
    assert "no distance between planes; 1 µm is assumed." in volume.notes[0]


def pages(path, *pictures):
    """Writes a file of several pictures of any size."""
    with tifffile.TiffWriter(path) as file:
        for one in pictures:
            colors = one.ndim == 3 and one.shape[-1] == 3
            photometric = "rgb" if colors else "minisblack"
            for page in one if one.ndim > 2 and not colors else [one]:
                file.write(page, photometric=photometric, metadata=None, contiguous=False)


PREVIEW = np.arange(12, dtype=np.uint16).reshape(3, 4)
COLORED = np.arange(36, dtype=np.uint8).reshape(3, 4, 3)


@pytest.mark.parametrize(
    "before, after, said",
    [
        ([PREVIEW], [], "1, of 4 x 3 pixels"),
        ([COLORED], [], "1, of 4 x 3 pixels"),
        ([], [PREVIEW], "1, of 4 x 3 pixels"),
        ([], [COLORED, PREVIEW[:2]], "2, of 4 x 2 pixels, 4 x 3 pixels"),
        ([PREVIEW, PREVIEW], [], "1, of 4 x 3 x 2 voxels"),
    ],
)
def test_pictures_beside_a_stack_are_left_out(path, before, after, said):
    pages(path, *before, PIXELS[0], *after)
    volume = reads(PIXELS[0], path)
    assert volume.notes == (f"Other pictures in the file are left out: {said}.",)


def test_pictures_that_were_written_one_by_one_are_a_stack(path):
    with tifffile.TiffWriter(path) as file:
        file.write(np.zeros((3, 4, 3), np.uint8), photometric="rgb", subfiletype=1)
        for plane in PIXELS[0]:
            file.write(plane, photometric="minisblack", contiguous=False)
    volume = reads(PIXELS[0], path)
    assert volume.notes == ("Other pictures in the file are left out: 1, of 4 x 3 pixels.",)


def test_an_odd_page_within_a_stack_is_refused(path):
    whole = np.concatenate([PIXELS[0], PIXELS[1]])
    pages(path, whole[:3], PREVIEW, whole[3:])
    refused("plane 3 is 4 x 3|readable TIFF|ends before", read_volume, path)


def test_two_stacks_in_a_file_are_chosen_by_their_dims(path):
    pages(path, PIXELS[0], PIXELS[1, :3, :4])
    assert probe(path).datasets == ("6 x 5 x 4 voxels", "6 x 4 x 3 voxels")
    reads(PIXELS[1, :3, :4], path, dataset="6 x 4 x 3 voxels")


def test_gray_colors_are_gray_values(path):
    """Checks that gray pictures in color have one value; others have three channels."""
    gray = (PIXELS[0] % 256).astype(np.uint8)
    pages = [Image.fromarray(np.stack([page] * 3, axis=-1)) for page in gray]
    pages[0].save(path, save_all=True, append_images=pages[1:])
    reads(gray, path)
    pages[3] = Image.fromarray(np.stack([gray[3], gray[2], gray[3]], axis=-1))
    pages[0].save(path, save_all=True, append_images=pages[1:])
    assert probe(path).channels == 3
    np.testing.assert_array_equal(read_volume(path, channel=1).values[3], gray[2])
    pages[0].save(path, save_all=True, append_images=[pages[3], *pages[1:3]])
    refused("plane 1 .*color", read_volume, path)


def test_alpha_is_no_value(path):
    both = np.stack([PIXELS[0], PIXELS[1]], axis=-1)
    options = {"extrasamples": ["unassalpha"], "planarconfig": "contig", "metadata": None}
    tifffile.imwrite(path, both, photometric="minisblack", **options)
    reads(PIXELS[0], path)
    options["extrasamples"] = ["unspecified"]
    tifffile.imwrite(path, both, photometric="minisblack", **options)
    reads(PIXELS[1], path, channel=1)


@pytest.mark.parametrize("byteorder", "<>")
@pytest.mark.parametrize("options", [{}, {"tile": (16, 16)}, {"rowsperstrip": 2}])
def test_planes_are_read_one_by_one(path, byteorder, options):
    """Checks single frames and channels in files of tifffile and ImageJ, contiguous or not."""
    whole = np.stack([PIXELS, PIXELS + 1, PIXELS + 2])
    for kind, axes in (({}, "TCZYX"), ({"imagej": True}, "TZCYX")):
        if kind and "tile" in options:
            continue
        stored = whole if axes == "TCZYX" else whole.swapaxes(1, 2)
        packed = {} if kind else {"compression": "zlib"}
        for more in ({}, packed):
            about = {"byteorder": byteorder, "metadata": {"axes": axes}, **options, **kind, **more}
            tifffile.imwrite(path, stored, photometric="minisblack", **about)
            reads(PIXELS[1] + 2, path, frame=2, channel=1)


def test_pages_with_too_few_strips_are_refused(path):
    """Checks that a page with missing strips is refused; tifffile would return unwritten memory."""
    options = {"rowsperstrip": 2, "compression": "zlib", "photometric": "minisblack"}
    tifffile.imwrite(path, PIXELS[0], metadata=None, **options)
    data = bytearray(path.read_bytes())
    with tifffile.TiffFile(path) as file:
        tags = [file.pages[2].tags[name] for name in ("StripOffsets", "StripByteCounts")]
        assert tags[0].count == 3
        for tag in tags:
            # The count follows the number and the type; a single value is stored after it.
            data[tag.offset + 4 : tag.offset + 8] = (1).to_bytes(4, "little")
            data[tag.offset + 8 : tag.offset + 12] = tag.value[0].to_bytes(4, "little")
    refused("ends before|readable TIFF", read_volume, written(path, data))
