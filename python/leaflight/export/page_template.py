# SPDX-License-Identifier: GPL-3.0-or-later
"""The web page without a bake. web/bundle.mjs builds it as a part of the package."""

from pathlib import Path

from .._core import LeaflightError
from ..paths import AnyPath

TEMPLATE = Path(__file__).parent.parent / "page" / "page.html"


def read_template(path: AnyPath) -> str:
    """Returns the page without a bake. Raises LeaflightError for path if it is missing."""
    try:
        return TEMPLATE.read_text(encoding="utf-8")
    except OSError:
        raise LeaflightError(
            f"{path}: this installation was built without Node, so it cannot write web pages: "
            "install a wheel of Leaflight, or build it with scripts/setup."
        ) from None


def template_bytes() -> int:
    """Returns the size of the page without a bake, 0 if the package has none."""
    return TEMPLATE.stat().st_size if TEMPLATE.exists() else 0
