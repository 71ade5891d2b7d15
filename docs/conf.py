# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation site, by Sphinx: scripts/docs builds it."""

import leaflight

project = "Leaflight"
author = "The Leaflight authors"
release = version = leaflight.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinxarg.ext"]
exclude_patterns = ["conf.py"]
# Furo has a search, a dark style and a table of contents for each page.
html_theme = "furo"
html_title = f"Leaflight {release}"
html_show_copyright = False
# Links such as guide.md#install.
myst_heading_anchors = 4
# Modules that are imported only where they are used.
autodoc_mock_imports = ["bpy", "pxr", "pygltflib", "vtkmodules"]
autodoc_member_order = "bysource"
napoleon_google_docstring = False


def setup(app):
    # Before napoleon, whose listeners have the priority 500.
    app.connect("autodoc-process-docstring", _plain_text, priority=400)


def _plain_text(_app, _what, _name, _object, _options, lines):
    """Keeps the line breaks of a docstring that has no sections of NumPy's style."""
    if any(lines) and not any(line.strip().startswith("---") for line in lines):
        lines[:] = ["::", "", *(f"    {line}" for line in lines), ""]
