# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender, for scripts/messages: writes the template of the add-on's messages."""

import ast
import importlib.util
import sys
from pathlib import Path

import bpy

ADDON = "leaflight_addon"

# Later versions renamed the module, with an underscore.
_NAMES = ("_bl_i18n_utils", "bl_i18n_utils")
_package = next(name for name in _NAMES if importlib.util.find_spec(name))
extract = importlib.import_module(f"{_package}.bl_extract_messages")
utils = importlib.import_module(f"{_package}.utils")
settings = importlib.import_module(f"{_package}.settings").I18nSettings()
# Without this setting it would search Blender's source.
settings.PRESETS_DIR = str(Path(bpy.utils.system_resource("SCRIPTS")) / "presets")


def main():
    messages = utils.I18nMessages(uid=settings.PARSER_TEMPLATE_ID, settings=settings)
    found, reports, addon = messages.msgs, extract._gen_reports(None), sys.modules[ADDON]

    def add(text, place, context="*"):
        extract.process_msg(found, context, text, place, reports, None, settings)

    for base in (bpy.types.Operator, bpy.types.Panel, bpy.types.Menu, bpy.types.PropertyGroup):
        for cls in base.__subclasses__():
            if cls.__module__.startswith(ADDON) and cls.is_registered:
                add_class(add, cls, "Operator" if base == bpy.types.Operator else "*")
    extract.dump_py_messages(found, reports, {addon}, settings, addons_only=True)
    for path in sorted(Path(addon.__file__).parent.rglob("*.py")):
        for text, line in why_grayed(path):
            add(text, f"{ADDON}/{path.name}:{line}")
    messages.unescape()
    messages.write("PO", sys.argv[-1])
    print(f"{sys.argv[-1]}: {len(found) - 1} messages")


def add_class(add, cls, context):
    """Adds the texts of a class; Blender's extractor overlooks the operators of add-ons."""
    place = f"bpy.types.{cls.__name__}"
    add(getattr(cls, "bl_label", ""), place, context)
    add(getattr(cls, "bl_description", ""), place)
    rna = cls.bl_rna
    if context == "Operator":
        group, name = cls.bl_idname.split(".")
        rna = getattr(getattr(bpy.ops, group), name).get_rna_type()
    for prop in rna.properties:
        if prop.identifier in bpy.types.PropertyGroup.bl_rna.properties or prop.is_hidden:
            continue
        for owner in (prop, *getattr(prop, "enum_items", ())):
            add(owner.name, f"{place}.{prop.identifier}")
            add(owner.description, f"{place}.{prop.identifier}")


def why_grayed(path):
    """Yields (text, line) of each reason of an operator; Blender's extractor overlooks these."""
    for node in ast.walk(ast.parse(path.read_text())):
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        place = {"poll_message_set": 0, "needs": 1}.get(name)
        if place is not None and isinstance(node.args[place], ast.Constant):
            yield node.args[place].value, node.lineno


main()
