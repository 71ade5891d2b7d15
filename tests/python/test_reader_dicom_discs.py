# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests DICOM in folders: CDs, nested folders, and files that are not slices of the series."""

import os
import re

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written

pytest.importorskip("pydicom")
from dicom_files import uid, write_disc, write_series, write_slice  # noqa: E402

COLOR = {"SamplesPerPixel": 3, "PhotometricInterpretation": "RGB", "PlanarConfiguration": 0}
COLOR |= {"Columns": 6}


@pytest.fixture
def study(tmp_path, values):
    """Writes two series in separate folders, each with a picture that is another series."""
    folder = tmp_path / "study"
    tags = {"StudyDate": "20240131"}
    write_series(folder / "a" / "head", values, **tags)
    neck = {"series": uid("neck"), "SeriesNumber": 4, "SeriesDescription": "Neck", **tags}
    write_series(folder / "b", values + 1, **neck)
    scout = {"SeriesNumber": 1, "SeriesDescription": "Scout", **tags}
    write_slice(folder / "b" / "scout", values[0], 0, uid("scout"), **scout)
    pixels = np.zeros((5, 18))
    write_slice(folder / "b" / "report", pixels, 0, uid("color"), **COLOR, **tags)
    (folder / "b" / "notes.txt").write_text("no slice")
    return folder


def test_nested_folders(study, values):
    stored = probe(study)
    assert stored.datasets == ("3 Head CT", "4 Neck CT")
    assert stored.notes == (
        "1 color picture is left out.",
        "These are left out, because each is a single slice: 1 Scout CT.",
    )
    for name in ("4 Neck CT", "4", "Neck", "4 Neck"):
        reads(values + 1, study, dataset=name)
    reads(values, study / "a")
    reads(values + 1, study / "b")
    refused("3 Head CT, 4 Neck CT", read_volume, study)


def test_slices_of_a_folder_count_before_those_within(study, values):
    write_series(study, values + 2)
    reads(values + 2, study)


def test_series_of_one_name(tmp_path, values):
    for k, date in enumerate(["20240131", "20240201", "20240201"]):
        tags = {"series": uid(f"{k}"), "StudyInstanceUID": uid(f"of {k}"), "StudyDate": date}
        write_series(tmp_path / str(k), values + k, **tags)
    assert probe(tmp_path).datasets == (
        "3 Head CT (2024-01-31)",
        "3 Head CT (2024-02-01)",
        "3 Head CT (2024-02-01) (2)",
    )
    reads(values + 1, tmp_path, dataset="3 Head CT (2024-02-01)")


@pytest.fixture
def disc(tmp_path, values):
    return write_disc(tmp_path, values)


def test_a_disc(disc, values):
    for path in (disc, disc / "DICOMDIR"):
        volume = reads(values, path)
        assert volume.notes == () and volume.name == "disc"
    # Rename files as other systems show them; the list itself may have any name.
    for path in sorted(disc.rglob("*"), reverse=True):
        if path.name != "DICOMDIR":
            path.rename(path.with_name(path.name.lower() + ";1" * path.is_file()))
    (disc / "DICOMDIR").rename(disc / "dicomdir")
    reads(values, disc / "dicomdir")
    reads(values, disc)
    (disc / "dicomdir").rename(disc / "list.dcm")
    reads(values, disc / "list.dcm")


def test_a_disc_that_lacks_files(disc, values):
    slices = sorted(path for path in disc.rglob("*") if path.is_file() and path.name != "DICOMDIR")
    slices[-1].unlink()
    volume = reads(values[:3], disc)
    assert volume.notes == ("The DICOMDIR lists 1 more file, which is missing.",)
    for path in slices[:-1]:
        path.unlink()
    refused("4 files", read_volume, disc / "DICOMDIR")


def test_records_of_a_disc_in_a_circle(disc, values):
    """Checks that reading ends. pydicom follows the records without end before version 3.0."""
    data = bytearray((disc / "DICOMDIR").read_bytes())
    tag = b"\x04\x00\x00\x14UL\x04\x00"  # offset of the next record
    first = data.index(b"\xfe\xff\x00\xe0")
    places = [match.end() for match in re.finditer(re.escape(tag), bytes(data))]
    for place in places:
        data[place : place + 4] = first.to_bytes(4, "little")
    written(disc / "DICOMDIR", data)
    assert len(places) >= len(values)
    reads(values, disc / "DICOMDIR")


def test_a_list_leads_nowhere_else(disc, values):
    """Checks that files outside the list's folder are never read."""
    data = (disc / "DICOMDIR").read_bytes()
    name = rb"PT000000\ST000000\SE000000\IM"
    (disc / "PT000000").rename(disc / "PT00000000")
    assert data.count(name) == 4
    (disc.parent / "inner").mkdir()
    path = disc.parent / "inner" / "DICOMDIR"
    path.write_bytes(data.replace(name, rb"..\disc\PT000000".ljust(len(name) - 3, b"0") + rb"\IM"))
    refused("and all are missing", read_volume, path)


def test_files_beside_slices(tmp_path, values):
    folder = write_series(tmp_path / "scan", values)
    (folder / "._IM0001").write_bytes(b"\0\5\x16\7" + bytes(200))
    (folder / ".DS_Store").write_bytes(bytes(200))
    (folder / "broken").write_bytes(bytes(128) + b"DICM" + b"\2\0\0\0UL\4\0\x10")
    (folder / "cut").write_bytes((folder / "IM0003").read_bytes()[:-70])
    volume = reads(values, folder)
    assert volume.notes == (
        "These are left out, because they are damaged or hold no pixels: cut, broken.",
    )
    reads(values, folder / "IM0001")


def test_folders_of_no_volume(tmp_path, values):
    for k in range(2):
        write_slice(tmp_path / f"{k}", np.zeros((5, 18)), k, **COLOR)
    refused("2 DICOM pictures .*colors", read_volume, tmp_path)
    for k in range(2):
        write_slice(tmp_path / f"{k}", values[k], k, uid(f"{k}"))
    refused("2 series .*single", read_volume, tmp_path)
    refused("only one slice", read_volume, tmp_path / "0")


def test_folders_without_end(study, monkeypatch):
    from leaflight.io.readers.dicom import series

    monkeypatch.setattr(series, "MOST_FILES", 5)
    (study / "a" / "again").symlink_to(study)
    if hasattr(os, "mkfifo"):
        os.mkfifo(study / "a" / "pipe")
    refused("5 files", read_volume, study)
    monkeypatch.setattr(series, "MOST_FILES", 11)
    assert len(probe(study).datasets) == 2
