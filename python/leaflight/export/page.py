# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a bake as a web page in one file, which shows every isosurface with its light."""

import base64
import html
import json
from pathlib import Path
from typing import TypedDict

import leaflight._core as _core

from .._core import LeaflightError
from ..bake.baked import Bake
from ..io.images import png_bytes
from ..io.output import check_writable, replaced, replaced_together
from ..paths import AnyPath
from ..progress_bar import with_progress
from ..stills.first_view import default_isovalue_of
from ..stills.photograph import photographed
from ..stills.still import check_diffuse, still
from .light_bricks import LARGEST_SIDE
from .page_data import EVERY, page_data
from .page_size import estimated_bytes, read_template
from .page_volume import dims_of, texels_of

# Places in the template for the page's data, its first picture and its permissions.
_DATA, _POSTER = "<!--leaflight:data-->", "leaflight-poster"
_POLICY = "leaflight-connect-src"
# Size of the picture that is shown while the data load.
POSTER_SIZE = (480, 320)
# Upper bound on the bytes of one script element with data. Browsers read them one by one.
PART_BYTES = 3 << 19

# Largest page that browsers open reliably.
LARGEST_BYTES = 200e6
MOST_COARSER = 3


class PageOptions(TypedDict, total=False):
    """The options of a page that export() takes, too."""

    coarser: int
    embed: bool
    lengths: tuple[float, str] | None


@with_progress("export")
def export_page(
    bake: Bake,
    path: AnyPath,
    isovalue: float | None = None,
    *,
    coarser: int = 0,
    embed: bool = False,
    lengths: tuple[float, str] | None = None,
    progress: _core.Progress | None = None,
) -> Path:
    """Writes a Bake as a web page, an .html that needs no server and loads nothing else.

    isovalue: Common isovalue that is shown at first. None is the default one.
    coarser: Number of times that voxels and texels are halved along each axis, 0 to 3.
    embed: True writes a folder for an iframe, named as path without its suffix. Its index.html
        fetches bake.bin beside it, and so needs a server.
    lengths: Length of a unit of the world, and its unit, if they differ from those of the bake.
    Returns the path of the file, or of index.html. Raises Cancelled, and LeaflightError. If the
    page would be too large, the error names the coarser level that fits.
    """
    path = Path(path)
    isovalue = default_isovalue_of(bake) if isovalue is None else isovalue
    check_writable(path, ".html")
    check_diffuse(bake)
    bake.check_isovalue(isovalue)
    template = read_template(path)
    _check_size(path, bake, coarser)
    progress = progress or _core.Progress()
    data = page_data(bake, isovalue, coarser, progress)
    if lengths is not None:
        data.header["unitLength"], data.header["unit"] = lengths
    header = _script("application/json", json.dumps(data.header), "leaflight-header")
    title = html.escape(f"{data.header['title']} - Leaflight")
    template = template.replace("<title></title>", f"<title>{title}</title>", 1)
    template = template.replace(_POSTER, _poster(path, bake, isovalue, data.header["stops"]), 1)
    if embed:
        page = template.replace(_POLICY, "'self'", 1).replace(_DATA, header, 1)
        return _write_folder(path.with_suffix(""), page, data.body)
    parts = (
        data.body[first : first + PART_BYTES] for first in range(0, len(data.body), PART_BYTES)
    )
    texts = (base64.b64encode(part).decode("ascii") for part in parts)
    scripts = "\n".join(_script("text/plain", text) for text in texts)
    body = f'<div id="leaflight-body" hidden>\n{scripts}\n</div>'
    page = template.replace(_POLICY, "'none'", 1).replace(_DATA, header + body, 1)
    with replaced(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path


def _check_size(path: Path, bake: Bake, coarser: int) -> None:
    if not 0 <= coarser <= MOST_COARSER:
        raise LeaflightError(f"{path}: choose 0 to {MOST_COARSER} for coarser, not {coarser}.")
    why = _too_large(bake, coarser)
    if why is None:
        return
    more = range(coarser + 1, MOST_COARSER + 1)
    fitting = [
        each for each in more if min(dims_of(bake, 0, each)) > 1 and not _too_large(bake, each)
    ]
    if not fitting:
        raise LeaflightError(f"{path}: the page would {why}; crop the volume or downsample it.")
    size = estimated_bytes(bake, fitting[0]) / 1e6
    raise LeaflightError(
        f"{path}: the page would {why}; with coarser={fitting[0]}, {EVERY[fitting[0]]} voxel "
        f"along each axis, it takes about {size:.0f} MB."
    )


def _too_large(bake: Bake, coarser: int) -> str | None:
    """Returns the limit of browsers that the page exceeds, as the end of a sentence, or None."""
    for number in range(len(bake.volumes)):
        side = max(*dims_of(bake, number, coarser), *texels_of(bake, number, coarser))
        if side > LARGEST_SIDE:
            return f"have {side} voxels or texels along an axis, above the limit of {LARGEST_SIDE}"
    size = estimated_bytes(bake, coarser)
    return f"take about {size / 1e6:.0f} MB" if size > LARGEST_BYTES else None


def _poster(path: Path, bake: Bake, isovalue: float, stops: float) -> str:
    """Returns the first view as a data URL."""
    picture = still(bake, isovalue, size=POSTER_SIZE)
    pixels = photographed(picture, bake.scene.exposure * 2.0**stops)
    return "data:image/png;base64," + base64.b64encode(png_bytes(path, pixels)).decode("ascii")


def _script(kind: str, text: str, name: str | None = None) -> str:
    # An end tag within a script element would end it.
    safe = text.replace("</", "<\\/")
    identity = f'id="{name}" ' if name else ""
    return f'<script {identity}type="{kind}">{safe}</script>\n'


def _write_folder(folder: Path, page: str, body: bytearray) -> Path:
    """Writes both files of the folder, or neither."""
    index, data = folder / "index.html", folder / "bake.bin"
    new = not folder.exists()
    try:
        folder.mkdir(exist_ok=True)
        others = {item.name for item in folder.iterdir()} - {index.name, data.name}
    except OSError as error:
        raise LeaflightError(f"{folder}: cannot write it: {error.strerror}.") from None
    # Remove hidden parts, which a killed run left.
    if any(not name.startswith(".leaflight-part-") for name in others):
        raise LeaflightError(f"{folder}: this folder holds other files; choose another name.")
    try:
        with replaced_together(index, data) as (index_file, data_file):
            index_file.write_text(page, encoding="utf-8")
            data_file.write_bytes(body)
    except LeaflightError:
        if new:
            folder.rmdir()
        raise
    return index
