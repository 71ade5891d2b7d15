# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation site, by Sphinx: scripts/docs builds it.

Sphinx and not MkDocs, since its autodoc reads the docstrings by importing the package; MkDocs needs
a plugin for that, of which Debian has no part that reads Python.
"""

import leaflight

project = "Leaflight"
author = "The Leaflight authors"
release = version = leaflight.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc"]
exclude_patterns = ["conf.py"]
html_title = f"Leaflight {release}"
html_theme = "alabaster"
html_theme_options = {
    "description": "Global illumination for every isosurface of a volume",
    "fixed_sidebar": True,
    "page_width": "1100px",
}
html_sidebars = {"**": ["about.html", "navigation.html", "searchbox.html"]}
html_show_copyright = False
# Links such as guide.md#installing.
myst_heading_anchors = 4
# What is imported only where it is used.
autodoc_mock_imports = ["bpy", "pxr", "pygltflib", "vtkmodules"]
autodoc_member_order = "bysource"


def setup(app):
    app.connect("autodoc-process-docstring", _as_it_stands)


def _as_it_stands(_app, _what, _name, _object, _options, lines):
    """Our docstrings are plain text, whose line breaks and indentation mean something."""
    if any(lines):
        lines[:] = ["::", "", *(f"    {line}" for line in lines), ""]
