# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests Zarr 2 by zarr, Zarr 3 by tensorstore, and a shard made by hand."""

import base64
import gzip
import json
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused

VALUES = np.random.default_rng(3).integers(0, 60000, (5, 6, 7)).astype(np.uint16)
LITTLE = {"name": "bytes", "configuration": {"endian": "little"}}
SCALE = {"type": "scale", "scale": [4.0, 2.0, 1.0]}


ROOT = Path(__file__).resolve().parents[2]
# Python with tensorstore (scripts/test-tools.txt), an independent implementation of Zarr.
WRITER = ROOT / "build" / "tools-venv" / "bin" / "python"
WRITE = """
import json, sys
import numpy as np
import tensorstore
array, path, metadata = sys.argv[1:]
store = {"driver": "file", "path": path}
spec = {"driver": "zarr3", "kvstore": store, "metadata": json.loads(metadata)}
tensorstore.open(spec, create=True).result().write(np.load(array)).result()
"""


def write_3(path, values, *codecs, chunks=(2, 3, 4)):
    metadata = {
        "shape": values.shape,
        "data_type": values.dtype.name,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": chunks}},
        "codecs": list(codecs),
    }
    array = path.parent / "values.npy"
    np.save(array, values)
    if not WRITER.exists():
        pytest.skip("scripts/setup --tests has not made build/tools-venv")
    subprocess.run([WRITER, "-c", WRITE, array, path, json.dumps(metadata)], check=True)
    return path


def sharded(chunks=(2, 3, 4)):
    configuration = {"chunk_shape": chunks, "codecs": [LITTLE, {"name": "zstd"}]}
    return {"name": "sharding_indexed", "configuration": configuration}


def write_group_3(path, axes="zyx"):
    """Writes OME-Zarr 0.5 metadata for the array "0"."""
    axes = [{"name": axis, "type": "space", "unit": "micrometer"} for axis in axes]
    datasets = [{"path": "0", "coordinateTransformations": [SCALE]}]
    ome = {"version": "0.5", "multiscales": [{"axes": axes, "datasets": datasets}]}
    path.mkdir(exist_ok=True)
    header = {"zarr_format": 3, "node_type": "group", "attributes": {"ome": ome}}
    (path / "zarr.json").write_text(json.dumps(header))
    return path


@pytest.mark.parametrize(
    "codecs",
    [
        (LITTLE,),
        ({"name": "bytes", "configuration": {"endian": "big"}}, {"name": "gzip"}),
        (LITTLE, {"name": "blosc", "configuration": {"cname": "lz4"}}, {"name": "crc32c"}),
        ({"name": "transpose", "configuration": {"order": [2, 0, 1]}}, LITTLE, {"name": "zstd"}),
    ],
)
def test_codecs_of_zarr_3(tmp_path, codecs):
    reads(VALUES, write_3(tmp_path / "x.zarr", VALUES, *codecs))


def test_ome_zarr_of_shards(tmp_path):
    """Checks OME-Zarr 0.5 with shards; a slab reads parts of them."""
    path = write_group_3(tmp_path / "x.ome.zarr")
    write_3(path / "0", VALUES, sharded(), chunks=(4, 6, 8))
    stored = probe(path)
    assert (stored.dims, stored.voxel_size, stored.unit) == ((7, 6, 5), (1, 2, 4), "µm")
    reads(VALUES, path)
    other = write_group_3(tmp_path / "y.ome.zarr", axes="xzy")
    write_3(other / "0", VALUES, sharded(), chunks=(4, 6, 8))
    reads(VALUES.transpose(1, 2, 0), other)


def test_a_shard_that_is_made_by_hand(tmp_path):
    """Checks the specification: compressed chunks, then the positions and sizes of all."""
    path = tmp_path / "x.zarr"
    (path / "c" / "0" / "0").mkdir(parents=True)
    shard = {
        "chunk_shape": [2, 6, 7],
        "codecs": [LITTLE, {"name": "gzip", "configuration": {"level": 1}}],
        "index_codecs": [LITTLE],
    }
    header = {
        "zarr_format": 3,
        "node_type": "array",
        "shape": [4, 6, 7],
        "data_type": "uint16",
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [6, 6, 7]}},
        "chunk_key_encoding": {"name": "default"},
        "fill_value": 9,
        "codecs": [{"name": "sharding_indexed", "configuration": shard}],
    }
    (path / "zarr.json").write_text(json.dumps(header))
    first = gzip.compress(VALUES[:2].astype("<u2").tobytes())
    absent = (2**64 - 1, 2**64 - 1)
    index = struct.pack("<6Q", 0, len(first), *absent, *absent)
    (path / "c" / "0" / "0" / "0").write_bytes(first + index)
    values = read_volume(path).values
    np.testing.assert_array_equal(values[:2], VALUES[:2])
    assert values.shape == (4, 6, 7) and (values[2:] == 9).all()
    (path / "c" / "0" / "0" / "0").write_bytes(first[:-9] + index)
    refused("x.zarr: .*damaged", read_volume, path)


@pytest.mark.parametrize(
    "kind, fill, about, missing",
    [
        # xarray encodes floating-point codes: base64 of a double.
        ("float32", base64.b64encode(struct.pack("<d", -9.0)).decode(), {}, -9),
        ("int16", -9, {"add_offset": 1.0}, -9),
        ("int16", None, {"add_offset": 1.0}, None),
    ],
)
def test_missing_data_of_xarray_in_zarr_3(tmp_path, kind, fill, about, missing):
    """Checks that the value of absent chunks is no code for missing data there."""
    stored = np.array([0, -9, 5, 6] * 6, kind).reshape(2, 3, 4)
    path = tmp_path / "x.zarr"
    (path / "c" / "0" / "0").mkdir(parents=True)
    header = {
        "zarr_format": 3,
        "node_type": "array",
        "shape": stored.shape,
        "data_type": kind,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": stored.shape}},
        "chunk_key_encoding": {"name": "default"},
        "fill_value": 0,
        "codecs": [LITTLE],
        "attributes": about if fill is None else {"_FillValue": fill, **about},
    }
    (path / "zarr.json").write_text(json.dumps(header))
    (path / "c" / "0" / "0" / "0").write_bytes(stored.tobytes())
    reads(np.where(stored == missing, np.nan, stored + about.get("add_offset", 0)), path)


def _zarr_2(path, **options):
    zarr = pytest.importorskip("zarr")
    if int(zarr.__version__.partition(".")[0]) > 2:
        pytest.skip("zarr 3 writes other options")
    about = {"shape": VALUES.shape, "dtype": VALUES.dtype, "chunks": (2, 3, 4), **options}
    array = zarr.open(str(path), mode="w", **about)
    array[:] = VALUES
    return path


def test_packings_of_zarr_2(tmp_path):
    codecs = pytest.importorskip("numcodecs")
    for name in ("Blosc", "Zstd", "Zlib", "GZip", "BZ2", "LZ4", "LZMA"):
        path = _zarr_2(tmp_path / "x.zarr", compressor=getattr(codecs, name)())
        np.testing.assert_array_equal(read_volume(path).values, VALUES, name)
    filters = [codecs.Delta("u2"), codecs.FixedScaleOffset(0, 1, "u2", "u4")]
    path = _zarr_2(tmp_path / "x.zarr", compressor=None, filters=filters)
    reads(VALUES, path)
    path = _zarr_2(tmp_path / "y.zarr", order="F", dimension_separator="/")
    reads(VALUES, path)
    # Voxels of absent chunks have the fill value.
    (tmp_path / "y.zarr" / "1" / "0" / "0").unlink()
    _change(tmp_path / "y.zarr" / ".zarray", fill_value=7)
    values = read_volume(path).values
    assert (values == 7).sum() >= 24 and (values != VALUES).sum() <= 24
    _change(tmp_path / "y.zarr" / ".zarray", compressor={"id": "pressed"})
    refused("codec pressed", read_volume, path)


def _change(path, **changes):
    header = json.loads(path.read_text())
    path.write_text(json.dumps({**header, **changes}))


def test_bad_headers(tmp_path):
    path = write_group_3(tmp_path / "x.zarr")
    refused("0: .*Zarr array or group", probe, path)
    write_group_3(path / "0")
    refused("0: .*not a Zarr array", probe, path)
    ome = json.loads((path / "zarr.json").read_text())["attributes"]["ome"]
    ome["multiscales"][0]["datasets"][0]["path"] = "../y.zarr"
    _change(path / "zarr.json", attributes={"ome": ome})
    refused("'../y.zarr' outside this folder", probe, path)
    write_3(tmp_path / "y.zarr", VALUES, sharded(), chunks=(4, 6, 8))
    for kind in ("string", "complex64", "r24", {"name": "struct"}):
        _change(tmp_path / "y.zarr" / "zarr.json", data_type=kind)
        refused("y.zarr: the values (are|have) .* convert", probe, tmp_path / "y.zarr")
    _change(tmp_path / "y.zarr" / "zarr.json", data_type="uint16", shape=[0, 6, 7])
    refused("0 x 6 x 7", probe, tmp_path / "y.zarr")
    (tmp_path / "y.zarr" / "zarr.json").write_text("[")
    refused("y.zarr: .*OME-Zarr", probe, tmp_path / "y.zarr")
