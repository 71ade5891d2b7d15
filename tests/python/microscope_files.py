# SPDX-License-Identifier: GPL-3.0-or-later
"""Small microscope files: CZI by Zeiss' library, LIF and ND2 by hand, because no library writes
them.

The voxels are 0.5 x 0.25 x 2 micrometers large, those of ND2 0.5 x 0.5 x 2.
"""

import struct
import sys
from importlib import import_module

import numpy as np
import pytest
from leaflight.io import reader_process


def needs(package):
    if not reader_process.has_package(package):
        pytest.skip(f"{package} is not installed")


STEPS = {"X": 0.5e-6, "Y": 0.25e-6, "Z": 2e-6}


def czi(path, pixels, scenes=1, without=(), names=(), colors=()):
    """Writes a CZI file. pixels: [t, c, z, y, x], or with red, green and blue; without: (t, c, z)
    of planes to leave out; names, colors: of the channels.
    """
    library = _of_zeiss()
    shown = {
        number: library.ChannelDisplaySettingsDataClass(
            True, library.TintingMode.Color, library.Rgb8Color(*np.uint8(color)), 0.0, 1.0
        )
        for number, color in enumerate(colors)
    }
    with library.create_czi(str(path)) as file:
        for scene in range(scenes):
            for t, c, z in np.ndindex(pixels.shape[:3]):
                if (t, c, z) not in without:
                    plane = pixels[t, c, z] // (scene + 1)
                    plane = plane[..., ::-1] if plane.ndim == 3 else plane[..., None]
                    # Put the scenes side by side.
                    file.write(
                        np.ascontiguousarray(plane),
                        plane={"T": t, "C": c, "Z": z},
                        location=(scene * 100, 0),
                        **({"scene": scene} if scenes > 1 else {}),
                    )
        sizes = {f"scale_{axis.lower()}": step for axis, step in STEPS.items()}
        described = {"channel_names": dict(enumerate(names)), "display_settings": shown}
        file.write_metadata("x", **sizes, **described)


def _of_zeiss():
    """Returns Zeiss' library, which normally only the process that reads files can import."""
    path = sys.path[:]
    sys.path.extend(reader_process.PACKAGES)
    try:
        return import_module("pylibCZIrw.czi")
    finally:
        sys.path[:] = path


_LIF_AXES = {"X": 1, "Y": 2, "Z": 3, "T": 4, "M": 10}


def lif(path, images, names=(), tables=()):
    """Writes a LIF file. images: {name: (axes, slowest first, such as "TZCYX", pixels)}; names,
    tables: dyes and lookup tables of the channels.
    """
    described, blocks = [], []
    for k, (name, (axes, pixels)) in enumerate(images.items()):
        steps = dict(zip(axes, pixels.strides))
        counts = dict(zip(axes, pixels.shape))
        channels = "".join(
            f'<ChannelDescription DataType="0" ChannelTag="0" Resolution="{8 * pixels.itemsize}" '
            f'NameOfMeasuredQuantity="" Min="0" Max="1" Unit="" IsLUTInverted="0" '
            f'LUTName="{tables[c] if tables else "Gray"}" '
            f'BytesInc="{c * steps.get("C", 0)}" BitInc="0">{_dye(names, c)}</ChannelDescription>'
            for c in range(counts.get("C", 1))
        )
        dimensions = "".join(
            f'<DimensionDescription DimID="{_LIF_AXES[axis]}" NumberOfElements="{counts[axis]}" '
            f'Origin="0" Length="{(counts[axis] - 1) * STEPS.get(axis, 1)!r}" Unit="m" '
            f'BitInc="0" BytesInc="{steps[axis]}"/>'
            for axis in reversed(axes)
            if axis != "C"
        )
        described.append(
            f'<Element Name="{name}" UniqueID="u{k}"><Data><Image><ImageDescription><Channels>'
            f"{channels}</Channels><Dimensions>{dimensions}</Dimensions></ImageDescription></Image>"
            f'</Data><Memory Size="{pixels.nbytes}" MemoryBlockID="MemBlock_{k}"/></Element>'
        )
        text = f"MemBlock_{k}".encode("utf-16-le")
        head = struct.pack("<BQBI", 0x2A, pixels.nbytes, 0x2A, len(text) // 2) + text
        blocks.append(struct.pack("<II", 0x70, len(head)) + head + pixels.tobytes())
    xml = (
        '<LMSDataContainerHeader Version="2"><Element Name="x"><Children>'
        f"{''.join(described)}</Children></Element></LMSDataContainerHeader>"
    ).encode("utf-16-le")
    head = struct.pack("<BI", 0x2A, len(xml) // 2) + xml
    path.write_bytes(struct.pack("<II", 0x70, len(head)) + head + b"".join(blocks))


def _dye(names, channel):
    """Returns the property of a channel with its name."""
    if not names:
        return ""
    return f"<ChannelProperty><Key>DyeName</Key><Value>{names[channel]}</Value></ChannelProperty>"


_LOOPS = {"T": 1, "P": 2, "Z": 4}


def nd2(path, axes, pixels, without=(), names=(), colors=()):
    """Writes an ND2 file. axes: such as "TPZYXC", where Y, X and C are pixels; without: frames to
    leave out; names, colors: of the channels.
    """
    outer = axes[:-3]
    height, width, channels = pixels.shape[-3:]
    frames = pixels.reshape(-1, height, width, channels)
    attributes = {
        "uiWidth": width,
        "uiWidthBytes": width * channels * pixels.itemsize,
        "uiHeight": height,
        "uiComp": channels,
        "uiBpcInMemory": 8 * pixels.itemsize,
        "uiBpcSignificant": 8 * pixels.itemsize,
        "uiSequenceCount": len(frames),
        "eCompression": 2,
    }
    probe = {"pFluorescentProbe": {"m_ExcitationSpectrum": {"uiCount": 0}}}
    planes = {f"a{c}": {"uiCompCount": 1, **probe} for c in range(channels)}
    for name, color, plane in zip(names, colors, planes.values()):
        red, green, blue = color
        plane |= {"sDescription": name, "uiColor": red | green << 8 | blue << 16}
    picture = {
        "sPicturePlanes": {"uiCount": channels, "sPlaneNew": planes},
        "dCalibration": STEPS["X"] * 1e6,
        "bCalibrated": True,
    }
    chunks = {
        "ImageAttributesLV!": _level({"SLxImageAttributes": attributes}),
        "ImageMetadataSeqLV|0!": _level({"SLxPictureMetadata": picture}),
    }
    loops = {}
    for axis, count in reversed(list(zip(outer, pixels.shape))):
        parameters = {"uiCount": count, "dZStep": STEPS["Z"] * 1e6}
        parameters |= dict.fromkeys(("dStart", "dPeriod", "dDuration", "dAvgPeriodDiff"), 1.0)
        parameters |= dict.fromkeys(("dMinPeriodDiff", "dMaxPeriodDiff"), 1.0)
        if axis == "P":
            point = {"dPosX": 0.0, "dPosY": 0.0, "dPosZ": 0.0}
            parameters["Points"] = {f"i{k:010}": point for k in range(count)}
        inner = {"ppNextLevelEx": {"i0000000000": loops}} if loops else {}
        loops = {"eType": _LOOPS[axis], "uLoopPars": parameters, **inner}
    if loops:
        chunks["ImageMetadataLV!"] = _level({"SLxExperiment": loops})
    for k, frame in enumerate(frames):
        if k not in without:
            chunks[f"ImageDataSeq|{k}!"] = bytes(8) + frame.tobytes()
    path.write_bytes(_nd2_file(chunks))


def _nd2_file(chunks):
    magic = 0x0ABECEDA
    signature = b"ND2 FILE SIGNATURE CHUNK NAME01!"
    data = struct.pack("<IIQ", magic, 32, 64) + signature + b"Ver3.0".ljust(64, b"\0")
    places = b""
    for name, content in chunks.items():
        # Frames start at a fixed distance after their chunk's header, after their time.
        head = struct.pack("<IIQ", magic, 4088 - 16, len(content))
        places += name.encode() + struct.pack("<QQ", len(data), len(content))
        data += (head + name.encode()).ljust(4088, b"\0") + content
    places += b"ND2 CHUNK MAP SIGNATURE 0000001!" + bytes(16)
    at = len(data)
    name = b"ND2 FILEMAP SIGNATURE NAME 0001!"
    data += struct.pack("<IIQ", magic, len(name), len(places)) + name + places
    return data + b"ND2 CHUNK MAP SIGNATURE 0000001!" + struct.pack("<Q", at)


def _level(items):
    """Returns a dictionary in Nikon's binary format."""
    data = b""
    for name, value in items.items():
        kind, content = _variant(value)
        text = (name + "\0").encode("utf-16-le")
        head = struct.pack("<BB", kind, len(text) // 2) + text
        if isinstance(value, dict):
            size = len(head) + 12 + len(content)
            content = struct.pack("<IQ", len(value), size) + content + bytes(8 * len(value))
        data += head + content
    return data


def _variant(value):
    if isinstance(value, dict):
        return 11, _level(value)
    if isinstance(value, bool):
        return 1, struct.pack("<B", value)
    if isinstance(value, int):
        return 3, struct.pack("<I", value)
    if isinstance(value, float):
        return 6, struct.pack("<d", value)
    return 8, (value + "\0").encode("utf-16-le")
