# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests scans that nibabel writes or contains: NIfTI, Analyze, FreeSurfer, AFNI and MINC."""

import gzip
import re
from pathlib import Path

import nibabel
import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written

AFFINE = np.array([[-2.0, 0, 0, 90], [0, 2.5, 0, -126], [0, 0.5, 3.0, -72], [0, 0, 0, 1]])
DATA = Path(nibabel.__file__).parent / "tests" / "data"


@pytest.fixture
def shorts(values):
    return values.astype(np.int16)


@pytest.fixture
def image(shorts):
    return nibabel.Nifti1Image(shorts.T, AFFINE)


@pytest.mark.parametrize("frames", [1, 2])
def test_colors_of_nifti_are_channels(tmp_path, values, frames):
    colors = np.random.default_rng(0).integers(0, 256, (3, frames, *values.shape), np.uint8)
    stored = np.rec.fromarrays(colors.T.transpose(4, 0, 1, 2, 3), names="R,G,B")
    path = tmp_path / "x.nii.gz"
    nibabel.save(nibabel.Nifti1Image(np.asarray(stored), AFFINE), path)
    found = probe(path)
    assert (found.frames, found.channels, found.dtype) == (frames, 3, np.uint8)
    assert [channel.name for channel in found.channel_list] == ["red", "green", "blue"]
    reads(colors[2, frames - 1], path, frame=frames - 1, channel=2)
    reads(colors[0, 0], path, frame=0, channel="red")
    refused("channel", read_volume, path, **({"frame": 0} if frames > 1 else {}))


@pytest.mark.parametrize("name, pack", [("x.nii.gz", bytes), ("x.nii", gzip.compress)])
@pytest.mark.parametrize("slope", [1, 0.5])
def test_names_that_are_wrong_about_the_packing(tmp_path, shorts, image, name, pack, slope):
    image.header.set_slope_inter(slope, 0)
    volume = reads(slope * shorts, written(tmp_path / name, pack(image.to_bytes())))
    assert volume.name == "x"


# Unit code of the header, unit, and text of the note.
UNITS = [(0, "mm", ""), (1, "m", ""), (2, "mm", ""), (3, "µm", ""), (2 + 8, "mm", "")]
UNITS += [(5, "mm", "code 5"), (7 + 0xF8, "mm", "code 7")]


@pytest.mark.parametrize("code, unit, note", UNITS)
def test_units(tmp_path, shorts, image, code, unit, note):
    data = bytearray(image.to_bytes())
    data[123] = code
    volume = reads(shorts, written(tmp_path / "x.nii", data))
    assert volume.unit == unit and note in " ".join(volume.notes)
    assert bool(note) == bool(volume.notes)


@pytest.mark.parametrize("suffix", [".nii", ".nii.gz"])
@pytest.mark.parametrize("slope", [1, 2])
def test_vectors_of_nifti_have_channels(tmp_path, shorts, suffix, slope):
    """Checks that the fifth axis has channels and the fourth has times."""
    data = np.empty((6, 5, 4, 2, 3), np.int16)
    for frame in range(2):
        for channel in range(3):
            data[..., frame, channel] = shorts.T + 10 * frame + channel
    for count in (1, 2):
        image = nibabel.Nifti1Image(data[:, :, :, :count], AFFINE)
        image.header.set_slope_inter(slope, 1)
        nibabel.save(image, tmp_path / f"x{suffix}")
        stored = probe(tmp_path / f"x{suffix}")
        assert (stored.frames, stored.channels) == (count, 3)
        expected = slope * (shorts + 10 * (count - 1) + 2) + 1
        frame = 1 if count == 2 else None
        reads(expected, tmp_path / f"x{suffix}", channel=2, frame=frame)


@pytest.mark.parametrize("kind", ["Nifti1Image", "Nifti2Image"])
def test_nifti_without_orientation(tmp_path, shorts, kind):
    image = getattr(nibabel, kind)(shorts.T, np.diag([-2.0, 3, 4, 1]))
    for code, patient in ((1, True), (0, False)):
        image.set_sform(None, 0)
        image.set_qform(image.affine, code)
        volume = reads(shorts, written(tmp_path / "x.nii", image.to_bytes()))
        assert volume.spacing == (2, 3, 4) and volume.patient == patient
        assert [note for note in volume.notes if "right to left" in note] == list(volume.notes)
        assert patient != bool(volume.notes)


PAIRS = ("Nifti1Pair", "Nifti2Pair", "AnalyzeImage", "Spm99AnalyzeImage", "Spm2AnalyzeImage")


@pytest.mark.parametrize("kind", PAIRS)
@pytest.mark.parametrize("end", ["", ".gz"])
def test_pairs(tmp_path, shorts, kind, end):
    """Checks that either file can be opened; Analyze's header does not tell left from right."""
    if "Spm" in kind:
        pytest.importorskip("scipy")
    plain = kind == "AnalyzeImage"
    image = getattr(nibabel, kind)(shorts.T, None if plain else AFFINE)
    nibabel.save(image, tmp_path / f"x.img{end}")
    theirs = nibabel.load(tmp_path / f"x.img{end}")
    for name in (f"x.hdr{end}", f"x.img{end}"):
        volume = reads(shorts, tmp_path / name)
        np.testing.assert_allclose(volume.index_to_world, theirs.affine)
        assert volume.unit == "mm" and volume.patient and volume.name == "x"
        assert plain == bool(volume.notes)
    (tmp_path / f"x.hdr{end}").unlink()
    refused("header x.hdr is missing", read_volume, tmp_path / f"x.img{end}")


def test_damaged_pairs(tmp_path, shorts):
    nibabel.save(nibabel.Nifti1Pair(shorts.T, AFFINE), tmp_path / "x.img")
    header, values = (tmp_path / "x.hdr").read_bytes(), (tmp_path / "x.img").read_bytes()
    (tmp_path / "x.img").write_bytes(values[:-1])
    refused("x.hdr: .*6 x 5 x 4", read_volume, tmp_path / "x.hdr")
    (tmp_path / "x.hdr").write_bytes(b"ENVI\nsamples = 3\n" + bytes(400))
    refused("not a readable NIfTI", read_volume, tmp_path / "x.hdr")
    # Write the header of a pair into a file that should contain both.
    refused("not a readable NIfTI", read_volume, written(tmp_path / "y.nii", header + values))
    (tmp_path / "x.img").unlink()
    refused("x.img", read_volume, tmp_path / "x.hdr")


@pytest.mark.parametrize("name, pack", [("x.mgh", None), ("x.mgz", None), ("x.mgz", "not")])
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.int32, np.float32])
def test_freesurfer(tmp_path, values, name, pack, dtype):
    path = tmp_path / name
    nibabel.save(nibabel.MGHImage(values.T.astype(dtype), AFFINE), path)
    if pack:
        path.write_bytes(gzip.decompress(path.read_bytes()))
    volume = reads(values, path)
    np.testing.assert_allclose(volume.index_to_world, AFFINE, atol=1e-4)
    assert volume.unit == "mm" and volume.patient
    frames = np.stack([values.T, values.T + 1], -1).astype(dtype)
    nibabel.save(nibabel.MGHImage(frames, AFFINE), path)
    assert probe(path).frames == 2
    reads(values + 1, path, frame=1)
    refused("FreeSurfer", read_volume, written(path, b"\0\0\0\2" + bytes(400)))


def afni_head(types=(1, 1), factors=(0, 0), order="LSB_FIRST"):
    """Returns the header of an AFNI dataset with the types and factors of its frames."""
    attributes = {
        "integer DATASET_RANK": (3, len(types)),
        "integer DATASET_DIMENSIONS": (6, 5, 4),
        "float DELTA": (1, 1, 1),
        "float IJK_TO_DICOM_REAL": (2, 0, 0, -90, 0, -2.5, 0, 126, 0, 0.5, 3, -72),
        "integer BRICK_TYPES": types,
        "float BRICK_FLOAT_FACS": factors,
    }
    text = ""
    for key, numbers in attributes.items():
        kind, name = key.split()
        text += f"type = {kind}-attribute\nname = {name}\ncount = {len(numbers)}\n"
        text += f" {' '.join(map(str, numbers))}\n\n"
    return f"{text}type = string-attribute\nname = BYTEORDER_STRING\ncount = 10\n'{order}~\n"


@pytest.mark.parametrize("order", ["LSB_FIRST", "MSB_FIRST"])
@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("factors", [(0, 0), (0, 0.5)])
def test_afni(tmp_path, shorts, order, packed, factors):
    """Checks axes, which are left, posterior, superior; a factor of 0 means no factor."""
    both = np.stack([shorts, shorts + 1]).astype("<i2" if order == "LSB_FIRST" else ">i2")
    brick = tmp_path / ("x+orig.BRIK.gz" if packed else "x+orig.BRIK")
    brick.write_bytes(gzip.compress(both.tobytes()) if packed else both.tobytes())
    head = written(tmp_path / "x+orig.HEAD", afni_head(factors=factors, order=order))
    for path in (head, brick):
        volume = reads((shorts + 1) * (factors[1] or 1), path, frame=1)
        np.testing.assert_allclose(volume.index_to_world, AFFINE)
        reads(shorts, path, frame=0)
        assert volume.unit == "mm" and volume.name == "x+orig"


def test_damaged_afni(tmp_path):
    head = tmp_path / "x.HEAD"
    for types, cut, sentence in (
        ((1, 3), 10**4, "nibabel cannot read it .*multiple data types"),
        ((1, 1), 300, "readable AFNI dataset"),
        ((1, 1), 10**4, "x.BRIK: .*6 x 5 x 4 x 2"),
    ):
        (tmp_path / "x.BRIK").write_bytes(bytes(100))
        refused(sentence, read_volume, written(head, afni_head(types)[:cut]))
    (tmp_path / "x.BRIK").unlink()
    refused("x.BRIK is missing", read_volume, head)


# Sample files of nibabel, with their numbers of frames.
FILES = {
    "test.mgz": 2,
    "example4d+orig.HEAD": 3,
    "example4d+orig.BRIK.gz": 3,
    "scaled+tlrc.HEAD": 1,
    "example_nifti2.nii.gz": 2,
    "anatomical.nii": 1,
    "functional.nii": 20,
    "tiny.mnc": 1,
    "small.mnc": 1,
    "minc2_4d.mnc": 2,
}


@pytest.mark.parametrize("name", FILES)
def test_real_files(name):
    """Compares with nibabel's values in single precision."""
    if not (DATA / name).exists():
        pytest.skip(f"nibabel's {name} is not here")
    if re.match("small|minc2", name):
        pytest.importorskip("h5py")
    frames = FILES[name]
    assert probe(DATA / name).frames == frames
    volume = read_volume(DATA / name, frame=frames - 1 if frames > 1 else None)
    image = nibabel.load(DATA / name)
    values, affine = image.get_fdata(), image.affine
    if name.endswith(".mnc"):
        # The last axis is the fastest one.
        values = values[-1] if frames > 1 else values
        affine = affine[:, [2, 1, 0, 3]]
    else:
        values = (values[..., -1] if values.ndim == 4 else values).T
    np.testing.assert_allclose(volume.values, values, rtol=1e-6)
    np.testing.assert_allclose(volume.index_to_world, affine)


def test_damaged_minc(tmp_path):
    data = (DATA / "tiny.mnc").read_bytes() if (DATA / "tiny.mnc").exists() else b""
    for content in (data[: len(data) // 2], b"no MINC"):
        refused("x.mnc: this .*MINC file", read_volume, written(tmp_path / "x.mnc", content))
