# SPDX-License-Identifier: GPL-3.0-or-later
"""Displays a bake: as a picture, or as its web page in a notebook or a browser."""

import html
import sys
import tempfile
import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .._core import Progress
from ..bake.baked import Bake
from ..progress_bar import with_progress
from ..stills.drawn_color_bar import bar_of_bake, with_color_bar
from ..stills.first_view import default_isovalue_of
from ..stills.photograph import metered_stops, photographed
from ..stills.still import still
from .mesh_objects import needed
from .page import MOST_COARSER, export_page
from .page_size import estimated_bytes

if TYPE_CHECKING:
    from PIL.Image import Image

    from .notebook_widget import PageWidget

# Upper bound on the bytes of a page in a notebook, which stores it as text.
LARGEST_IN_A_NOTEBOOK = 20e6


def picture(
    bake: Bake, isovalue: float | None = None, color_bar: bool = False, **options: Any
) -> "Image":
    """Returns still() as an RGBA image of Pillow, with the exposure of the command and the page.

    isovalue: None is the default one.
    color_bar: True draws the color bar of a volume that another one colors.
    options: Options of still().
    Raises LeaflightError.
    """
    from PIL import Image

    isovalue = default_isovalue_of(bake) if isovalue is None else isovalue
    exposure = bake.scene.exposure * 2.0 ** metered_stops(bake, isovalue)
    bar = bar_of_bake(bake) if color_bar else None
    pixels = photographed(still(bake, isovalue, **options), exposure)
    return Image.fromarray(pixels if bar is None else with_color_bar(pixels, bar))


@with_progress("show")
def show(
    bake: Bake,
    isovalue: float | None = None,
    *,
    height: int = 600,
    coarser: int | None = None,
    progress: Progress | None = None,
) -> "Page":
    """Shows the web page of a Bake in the cell of a notebook, else in a browser.

    height: Height of the cell in pixels.
    coarser: As for export_page(). None is the finest page that suits a notebook.
    Returns a Page.
    """
    folder = Path(tempfile.mkdtemp(prefix="leaflight-"))
    page = Page(_exported(folder, bake, isovalue, coarser, progress), height)
    if "ipykernel" not in sys.modules:
        webbrowser.open(page.path.as_uri())
    return page


@with_progress("widget")
def widget(
    bake: Bake,
    isovalue: float | None = None,
    *,
    height: int = 600,
    coarser: int | None = None,
    progress: Progress | None = None,
) -> "PageWidget":
    """Returns the web page of a Bake as a widget of Jupyter, whose trait `isovalue` moves it.

    The slider of the page changes the trait, too. The arguments are those of show(). Raises
    LeaflightError without anywidget.
    """
    needed("anywidget")
    from .notebook_widget import PageWidget

    isovalue = default_isovalue_of(bake) if isovalue is None else isovalue
    with tempfile.TemporaryDirectory(prefix="leaflight-") as folder:
        path = _exported(Path(folder), bake, isovalue, coarser, progress)
        return PageWidget(bake, path.read_text(encoding="utf-8"), isovalue, height)


def _exported(
    folder: Path, bake: Bake, isovalue: float | None, coarser: int | None, progress: Progress | None
) -> Path:
    """Writes the web page, of a size that suits a notebook, into a folder. Returns its path."""
    if coarser is None:
        sizes = (estimated_bytes(bake, each) for each in range(MOST_COARSER + 1))
        coarser = next((k for k, n in enumerate(sizes) if n < LARGEST_IN_A_NOTEBOOK), MOST_COARSER)
    return export_page(bake, folder / "bake.html", isovalue, coarser=coarser, progress=progress)


@dataclass(frozen=True)
class Page:
    """A web page in a file, and as a cell of a notebook with a height in pixels."""

    path: Path
    height: int

    def _repr_html_(self) -> str:
        # Embed the page, because a notebook that is sent to others has no files beside it.
        text = html.escape(self.path.read_text(encoding="utf-8"))
        return (
            f'<iframe srcdoc="{text}" width="100%" height="{self.height}" frameborder="0" '
            "allowfullscreen></iframe>"
        )
