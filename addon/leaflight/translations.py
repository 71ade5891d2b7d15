# SPDX-License-Identifier: GPL-3.0-or-later
"""The words of the interface in other languages, through Blender's own message catalogs.

Blender looks up names, descriptions and labels by itself where they are constants. A label with
numbers in it is made of a template that iface_() translates. validation/messages lists all of them.
"""

import textwrap

import bpy

from .languages import german

# Blender's extractor of messages finds it by this name.
iface_ = bpy.app.translations.pgettext_iface

# Blender looks a message up in one of these contexts: the label of an operator in its own.
_CONTEXTS = ("*", "Operator")
# Blender names the languages of its catalogs with and without a country.
CATALOGS = {"de_DE": german.MESSAGES, "de": german.MESSAGES}


def draw_wrapped(layout, text, width, icon="NONE"):
    """A text that is translated already, in lines of so many letters; labels do not wrap."""
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
