# SPDX-License-Identifier: GPL-3.0-or-later
"""Configuration of the documentation site for Sphinx; scripts/docs builds it."""

import sys
from pathlib import Path

import leaflight

sys.path.insert(0, str(Path(__file__).parent))

project = "Leaflight"
author = "The Leaflight authors"
release = version = leaflight.__version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinxarg.ext",
    "plain_docstrings",
]
exclude_patterns = ["*.py", "__pycache__"]
# Theme with a search, a dark style and a table of contents for each page.
html_theme = "furo"
html_title = f"Leaflight {release}"
html_show_copyright = False
# Depth of headings that links such as guide.md#install can reach.
myst_heading_anchors = 4
# Optional modules, which autodoc does not need.
autodoc_mock_imports = ["bpy", "pxr", "vtkmodules"]
autodoc_member_order = "bysource"
# Docstrings describe the types of parameters.
autodoc_typehints = "none"
napoleon_google_docstring = False
