# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the names and colors of labels: in files of label maps, and in tables beside them."""

import gzip
import json
import struct
from pathlib import Path

import leaflight
import nibabel
import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from leaflight.io.readers.label_files import read_label_table
from leaflight.scene.volume_texture import label_texture
from leaflight.srgb import linear_from_srgb, srgb_from_linear
from leaflight.volume.label_table import Label, label_numbers, labels_of
from nibabel import freesurfer
from outcomes import reads, refused, written

SCENES = Path(leaflight.__file__).parent / "scenes"
RED, TEAL = (1.0, 0.0, 0.0), (0.0, 128 / 255, 128 / 255)
CTBL = (
    "# Color table file\n# 3 values\n0 Background 0 0 0 0\n"
    "3 Left_Lung 255 0 0 255\n7 b 0 128 128 255\n"
)
LUT = "\n#No. Label Name:   R G B A\n\n0 Unknown 0 0 0 0\n3  ctx_lh-x  255 0 0 0\n7 b 0 128 128 0\n"
SNAP = (
    "################################\n# ITK-SnAP Label Description File\n"
    '    0     0    0    0        0  0  0    "Clear Label"\n'
    '    3   255    0    0        1  1  1    "Left Lung (L)"\n'
    '    7     0  128  128     0.50  0  1    "b"\n'
)
BIDS = "index\tname\tabbreviation\tcolor\n3\tLeft Lung\tLL\t#ff0000\n7\tb\tB\t#008080\n"
TABLES = {
    "of 3D Slicer": ("t.ctbl", CTBL, "Left Lung"),
    "of FreeSurfer": ("lut.txt", LUT, "ctx_lh-x"),
    "of ITK-SNAP": ("snap.txt", SNAP, "Left Lung (L)"),
    "of BIDS": ("a_dseg.tsv", BIDS, "Left Lung"),
}


@pytest.fixture
def map_of_labels():
    """Returns a map with the labels 3, 5 and 7, and the affine of a scan."""
    values = np.zeros((4, 5, 6), np.uint8)
    values[1:3, 1:3, 1:3], values[1:3, 3, 1:3], values[1:3, 1:3, 4] = 3, 5, 7
    return values


@pytest.fixture
def nifti(tmp_path, map_of_labels):
    path = tmp_path / "a_dseg.nii.gz"
    nibabel.Nifti1Image(map_of_labels.T, np.diag([1.0, 2.0, 3.0, 1.0])).to_filename(path)
    return path


def close_colors(label, color):
    np.testing.assert_allclose(label.color, color, atol=1e-6)


@pytest.mark.parametrize("name", TABLES)
def test_a_table(tmp_path, nifti, map_of_labels, name):
    file, content, first = TABLES[name]
    table = written(tmp_path / file, content)
    volume = reads(map_of_labels, nifti, label_table=table)
    assert [(label.number, label.name) for label in volume.labels] == [(3, first), (7, "b")]
    close_colors(volume.labels[0], RED)
    close_colors(volume.labels[1], TEAL)
    texture = label_texture(volume)
    colors = dict(texture.colors)
    assert sorted(colors) == [0.0, 3.0, 5.0, 7.0] and colors[3.0] == RED
    np.testing.assert_allclose(colors[7.0], linear_from_srgb(np.array(TEAL)), atol=1e-6)


@pytest.mark.parametrize("suffix", [".ctbl", ".tsv", ".txt"])
def test_a_table_beside_its_map(tmp_path, nifti, suffix):
    content = {".ctbl": CTBL, ".tsv": BIDS, ".txt": SNAP}[suffix]
    written(tmp_path / f"a_dseg{suffix}", content)
    assert [label.number for label in read_volume(nifti).labels] == [3, 7]


def test_a_table_of_bids_for_all_subjects(tmp_path, nifti):
    folder = tmp_path / "sub-1" / "anat"
    folder.mkdir(parents=True)
    path = nifti.rename(folder / "sub-1_desc-aseg_dseg.nii.gz")
    written(tmp_path / "desc-other_dseg.tsv", BIDS.replace("Left", "Right"))
    written(tmp_path / "desc-aseg_dseg.tsv", BIDS)
    assert [label.name for label in read_volume(path).labels] == ["Left Lung", "b"]


def test_labels_without_a_table_have_numbers_and_separate_colors(nifti):
    volume = read_volume(nifti)
    assert volume.labels == ()
    found = labels_of(volume.values)
    assert [label.name for label in found] == ["Label 3", "Label 5", "Label 7"]
    assert len({label.color for label in found}) == 3


def test_bids_without_colors(tmp_path, nifti):
    table = written(tmp_path / "t.tsv", "index\tname\n3\tLung\n")
    assert read_volume(nifti, label_table=table).labels == (Label.of(3, "Lung"),)


def test_bad_tables(tmp_path, nifti):
    for file, content, sentence in (
        ("x.ctbl", CTBL + "8 violet\n", "line 6 of the label table is not a number, a name"),
        ("x.txt", SNAP.replace(" 128 ", " 12a "), "line 5 of the label table"),
        ("x.tsv", BIDS + "x\ty\n", "line 4 of the label table is not a number and a name"),
        ("x.ctbl", "# nothing\n", "has no labels"),
        ("x.ctbl", CTBL.replace("\n3", "\n30").replace("\n7", "\n70"), "none of the labels in a_d"),
    ):
        table = written(tmp_path / file, content)
        refused(f"{file}: .*{sentence}", read_volume, nifti, label_table=table)
    refused("gone.ctbl: cannot read", read_volume, nifti, label_table=tmp_path / "gone.ctbl")


@pytest.mark.parametrize("name", TABLES)
def test_damage_of_a_table_is_one_error(tmp_path, name):
    """Checks that each damaged table is read or refused."""
    file, content, _ = TABLES[name]
    random = np.random.default_rng(7)
    for _ in range(200):
        data = bytearray(content.encode())
        for place in random.integers(len(data), size=random.integers(1, 5)):
            data[place] = random.choice(list(b'\0\t\n "#09\xff\xc2\x85'))
        try:
            read_label_table(written(tmp_path / file, bytes(data[: random.integers(len(data))])))
        except leaflight.LeaflightError as error:
            assert str(error).startswith(f"{tmp_path / file}: ")
    for line in ("9" * 5000 + " a 1 2 3", "² a 1 2 3", "-3 a 1 2 3", "1" + 100_000 * " " + "x"):
        refused("label table", read_label_table, written(tmp_path / file, f"{line}\n"))


def test_a_bad_table_beside_a_map_is_left_out(tmp_path, nifti):
    written(tmp_path / "a_dseg.ctbl", "1 violet\n")
    volume = read_volume(nifti)
    assert volume.labels == () and "line 1 of the label table" in volume.notes[0]
    (tmp_path / "a_dseg.ctbl").unlink()
    written(tmp_path / "a_dseg.txt", "Notes of the scan.\n")
    assert not any("table" in note for note in read_volume(nifti).notes)


def test_bad_labels(tmp_path):
    for values, sentence in (
        (np.full((3, 3, 3), 1 << 25, np.int32), "0 to 33554432 are outside 0 to 16777216"),
        (np.full((3, 3, 3), -2, np.int16), "-2 to 0 are outside 0 to 16777216: renumber"),
        (np.full((3, 3, 3), 0.5, np.float32), "not whole numbers"),
        (np.full((3, 3, 3), np.inf, np.float32), "are outside 0 to 16777216"),
        (np.arange(70_000, dtype=np.int32).reshape(70, 100, 10), "69999 labels, more than 65535"),
    ):
        values[0, 0, 0] = 0
        refused(sentence, label_numbers, values)
        np.save(tmp_path / "x.npy", values)
        if np.isfinite(values).all():
            refused(sentence, read_volume, tmp_path / "x.npy", field="labels")


def test_large_numbers_of_connected_components(tmp_path):
    values = np.zeros((4, 5, 6), np.uint32)
    values[1:3, 1:3, 1:3], values[1:3, 1:3, 3:5] = 70_001, 9_000_001
    np.save(tmp_path / "x.npy", values)
    volume = read_volume(tmp_path / "x.npy")
    assert label_numbers(volume.values) == [70_001, 9_000_001]
    colors = label_texture(volume).at(np.array([[1.0, 1.0, 1.0], [4.0, 2.0, 2.0]]))
    expected = [label.color for label in labels_of(values)]
    np.testing.assert_allclose(srgb_from_linear(colors), expected, atol=1e-3)
    assert read_volume(tmp_path / "x.npy", field="labels").values[1, 1, 4] > 0.5


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_downsampled_labels_are_the_nearest(tmp_path, dtype):
    z, y, x = np.mgrid[:20, :22, :24]
    values = (1 + 2 * (x > 11) + 3 * (y > 10)) * ((z > 3) & (z < 17))
    np.save(tmp_path / "x.npy", values.astype(dtype))
    for step in (2, 4):
        volume = read_volume(tmp_path / "x.npy", downsample=step)
        half = step // 2
        assert np.isin(volume.values, values).all()
        np.testing.assert_array_equal(
            volume.values, values[half::step, half::step, half::step][: 20 // step, : 22 // step]
        )
        np.testing.assert_array_equal(volume.index_to_world[:3, 3], (half, half, half))
    # A mask has soft edges, unless its surface is that of labels.
    mask = np.uint8(255 * (values > 0))
    np.save(tmp_path / "mask.npy", mask)
    assert 128 in read_volume(tmp_path / "mask.npy", downsample=8).values


def test_hidden_labels_are_zero(nifti, map_of_labels):
    hidden = np.where(map_of_labels == 3, 0, map_of_labels)
    volume = reads(hidden, nifti, hide=[3])
    field = read_volume(nifti, hide=[3], field="labels").values
    np.testing.assert_array_equal(field > 0.5, hidden > 0)
    # The label takes the place of a hidden one in the colors of its boundary.
    found = label_texture(volume).channels[0].values
    assert found[1, 2, 2] == 5 and map_of_labels[1, 2, 2] == 3
    refused("give the numbers of labels", read_volume, nifti, hide="3")
    refused("give the numbers of labels", read_volume, nifti, hide=3)
    refused("all labels are hidden", read_volume, nifti, hide=[3, 5, 7], field="labels")


# Keys as 3D Slicer writes them, also others that are not read.
SEGMENT = """Segment{n}_Color:={color}
Segment{n}_Extent:=0 5 0 4 0 3
Segment{n}_ID:=Segment_{n}
Segment{n}_LabelValue:={value}
Segment{n}_Layer:={layer}
Segment{n}_Name:={name}
"""


def write_segments(path, values, keys):
    """Writes a .seg.nrrd of values [z, y, x] or [z, y, x, layer]."""
    list_of = "list " if values.ndim == 4 else ""
    none = "none " if values.ndim == 4 else ""
    sizes = " ".join(map(str, values.shape[::-1]))
    header = (
        f"NRRD0004\ntype: unsigned char\ndimension: {values.ndim}\nspace: left-posterior-superior\n"
        f"sizes: {sizes}\nspace directions: {none}(1,0,0) (0,2,0) (0,0,3)\n"
        f"kinds: {list_of}domain domain domain\nencoding: raw\nspace origin: (10,20,30)\n{keys}\n"
    )
    return written(path, header.encode() + values.tobytes())


def keys_of(*segments):
    return "".join(
        SEGMENT.format(n=n, name=name, color=color, value=value, layer=layer)
        for n, (name, color, value, layer) in enumerate(segments)
    )


def test_segments_of_3d_slicer(tmp_path, map_of_labels):
    keys = keys_of(("Left: lung", "1 0 0", 3, 0), ("b", "0 0.501961 0.501961", 7, 0))
    path = write_segments(tmp_path / "a.seg.nrrd", map_of_labels, keys)
    volume = reads(map_of_labels, path)
    assert [(label.number, label.name) for label in volume.labels] == [(3, "Left: lung"), (7, "b")]
    close_colors(volume.labels[1], TEAL)
    np.testing.assert_array_equal(np.diag(volume.index_to_world), [-1, -2, 3, 1])
    assert volume.patient and volume.index_to_world[:3, 3].tolist() == [-10, -20, 30]
    by_pynrrd(path, volume)


def by_pynrrd(path, volume):
    """Compares the values and the keys with those of pynrrd, if it is installed."""
    try:
        import nrrd
    except ImportError:
        return
    values, header = nrrd.read(str(path))
    np.testing.assert_array_equal(volume.values, values.T)
    for n, label in enumerate(volume.labels):
        assert header[f"Segment{n}_Name"] == label.name


def test_layers_of_segments_are_merged(tmp_path, map_of_labels):
    """Checks two layers with equal values, of which the second hides the first."""
    layers = np.stack([map_of_labels == 3, map_of_labels >= 3], axis=-1).astype(np.uint8)
    layers[1, 1, 1, 1] = 0
    keys = keys_of(("inner", "1 0 0", 1, 0), ("outer", "0 1 0", 1, 1))
    path = write_segments(tmp_path / "a.seg.nrrd", layers, keys)
    stored = probe(path)
    assert stored.channels == 1 and stored.dims == (6, 5, 4)
    volume = reads(np.where(layers[..., 1], 2, layers[..., 0]), path)
    assert [(label.number, label.name) for label in volume.labels] == [(1, "inner"), (2, "outer")]
    assert "later ones hide earlier ones" in volume.notes[0]
    # Unequal values stay, and those of early versions are the places of the layers.
    keys = keys_of(("inner", "1 0 0", 4, 0), ("outer", "0 1 0", 9, 1))
    path = write_segments(tmp_path / "b.seg.nrrd", layers * np.uint8([4, 9]), keys)
    reads(np.where(layers[..., 1], 9, 4 * layers[..., 0]), path)
    early = "Segment0_Name:=inner\nSegment1_Name:=outer\n"
    path = write_segments(tmp_path / "c.seg.nrrd", layers, early)
    reads(np.where(layers[..., 1], 2, layers[..., 0]), path)


def test_damaged_segments(tmp_path, map_of_labels):
    for keys, sentence in (
        (keys_of(("a", "1 0", 3, 0)), "is not three numbers"),
        (keys_of(("a", "1 0 0", -3, 0)), "LabelValue '-3' of a segment is not in 0 to 65535"),
        (keys_of(("a", "1 0 0", 70000, 0)), "70000"),
        (keys_of(("a", "1 0 0", 3, 4)), "is in layer 4, but there are 1"),
    ):
        path = write_segments(tmp_path / "a.seg.nrrd", map_of_labels, keys)
        refused(f"header is damaged, because .*{sentence}", read_volume, path)


@pytest.fixture
def aseg(tmp_path, map_of_labels):
    """Returns a FreeSurfer volume, and the color table that nibabel writes for an annotation."""
    volume, annotation = tmp_path / "aseg.mgh", tmp_path / "lh.annot"
    nibabel.MGHImage(map_of_labels.T.astype(np.int32), np.eye(4)).to_filename(volume)
    colors = np.array([[0, 0, 0, 0, 0], *8 * [[1, 2, 3, 0, 0]]])
    colors[3, :3], colors[7, :3] = (255, 0, 0), (0, 128, 128)
    names = ["Unknown", "a", "b", "Left-Lung", "d", "e", "f", "g", "h"]
    freesurfer.write_annot(annotation, np.zeros(1, int), colors, names, fill_ctab=True)
    # A number of vertices, a vertex and its color come first.
    return volume, annotation.read_bytes()[12:]


# Another tag that FreeSurfer writes: a command line.
COMMAND = struct.pack(">iq", 3, 4) + b"mri\0"


@pytest.mark.parametrize("pack", [bytes, gzip.compress])
def test_the_color_table_of_freesurfer(aseg, map_of_labels, pack):
    path, table = aseg
    path.write_bytes(pack(path.read_bytes() + COMMAND + table + COMMAND))
    volume = reads(map_of_labels, path)
    assert [label.number for label in volume.labels] == list(range(1, 9))
    assert volume.labels[2].name == "Left-Lung"
    close_colors(volume.labels[2], RED)
    close_colors(volume.labels[6], TEAL)
    found = [label.name for label in labels_of(volume.values, volume.labels)]
    assert found == ["Left-Lung", "e", "g"]


def test_an_early_color_table_of_freesurfer(tmp_path, aseg, map_of_labels):
    """Checks the version of annotations that nibabel calls the old format."""
    path, _ = aseg
    entries = [(b"Unknown", (0, 0, 0)), (b"a", (1, 2, 3)), (b"b", (4, 5, 6))]
    entries.append((b"Lung", (255, 0, 0)))
    table = struct.pack(">3i2s", 1, len(entries), 2, b"x")
    for name, color in entries:
        table += struct.pack(f">i{len(name) + 1}s4i", len(name) + 1, name, *color, 0)
    annotation = written(tmp_path / "x.annot", struct.pack(">3i", 1, 0, 0) + table)
    _, colors, names = freesurfer.read_annot(annotation)
    path.write_bytes(path.read_bytes() + table)
    volume = reads(map_of_labels, path)
    assert [label.name.encode() for label in volume.labels] == names[1:]
    for label in volume.labels:
        np.testing.assert_allclose(np.array(label.color) * 255, colors[label.number, :3])


def test_a_damaged_color_table_of_freesurfer(aseg, map_of_labels):
    path, table = aseg
    whole = path.read_bytes()
    for end in range(4, len(table), 7):
        path.write_bytes(whole + table[:end])
        volume = reads(map_of_labels, path)
        assert volume.labels == () and "color table of the labels is damaged" in volume.notes[0]
    for rest in (b"\0", COMMAND, struct.pack(">iq", 3, -1), struct.pack(">iq", 3, 1 << 60)):
        path.write_bytes(whole + rest)
        volume = reads(map_of_labels, path)
        assert volume.labels == () and not any("table" in note for note in volume.notes)


def test_info_lists_labels(tmp_path, nifti, cli):
    table = written(tmp_path / "t.ctbl", CTBL)
    options = ("--label-table", table, "--hide", "5")
    assert "labels 3 Left Lung, 7 b" in cli.runs("info", nifti, *options)
    labels = cli.json("info", nifti, *options)["labels"]
    assert labels[0] == {"number": 3, "name": "Left Lung", "color": list(RED)}
    cli.refuses("(--label-table)", "info", nifti, "--label-table", nifti)


def test_a_scene_file_colors_by_labels(tmp_path, nifti):
    written(tmp_path / "t.ctbl", CTBL)
    channel = {"name": "a", "source": nifti.name, "reading": {"label_table": "t.ctbl"}}
    texture = {"channels": [channel], "labels": True}
    scene = json.loads((SCENES / "cornell.json").read_text())
    del scene["isosurface_albedo"]
    volume = {"name": "a", "albedo": [1, 1, 1], "source": nifti.name, "texture": texture}
    path = written(tmp_path / "scene.json", json.dumps({**scene, "volumes": [volume]}))
    found = leaflight.load_scene(path).isosurfaces[0].texture
    assert found.nearest and dict(found.colors)[3.0] == RED
