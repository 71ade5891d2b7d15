# SPDX-License-Identifier: GPL-3.0-or-later
"""Translations of the interface, through Blender's message catalogs.

Blender itself translates constant names, descriptions and labels. A label with numbers is made from
a template that iface_() translates. scripts/messages lists all messages.
"""

import textwrap

import bpy

from .languages import german

# Blender's extractor of messages needs this name.
iface_ = bpy.app.translations.pgettext_iface

# Contexts of messages in Blender. The labels of operators have a separate one.
_CONTEXTS = ("*", "Operator")
# Catalogs by language. Blender names languages with and without a country.
CATALOGS = {"de_DE": german.MESSAGES, "de": german.MESSAGES}


def draw_wrapped(layout, text, width, icon="NONE"):
    """Draws a translated text in lines of at most `width` letters, because labels do not wrap."""
    for line in textwrap.wrap(text, width):
        layout.label(text=line, icon=icon, translate=False)
        icon = "BLANK1" if icon != "NONE" else icon


def register():
    catalogs = {
        language: {
            (context, english): word for english, word in messages.items() for context in _CONTEXTS
        }
        for language, messages in CATALOGS.items()
    }
    bpy.app.translations.register(__package__, catalogs)


def unregister():
    bpy.app.translations.unregister(__package__)
