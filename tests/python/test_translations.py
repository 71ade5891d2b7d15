# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that texts of the add-on are constants that Blender looks up, or templates of iface_()."""

import ast
import re
import runpy
from pathlib import Path

import pytest
from leaflight.volume import examples

ADDON = Path(__file__).resolve().parents[2] / "addon" / "leaflight"
SOURCES = sorted(ADDON.rglob("*.py"))
LANGUAGES = [path for path in sorted((ADDON / "languages").glob("*.py")) if path.stem[0] != "_"]

# Names or positions of arguments that are texts, by method of Blender or of the add-on.
_TEXTS = {
    "label": "text",
    "prop": "text",
    "prop_enum": "text",
    "operator": "text",
    "operator_menu_enum": "text",
    "menu": "text",
    "popover": "text",
    "poll_message_set": 0,
    "needs": 1,
    "volume_needs": 1,
    "status_text_set": 0,
    "sentence": 2,
    "draw_wrapped": 1,
    "draw_progress": 2,
}
# A unit, as in "12 s", needs no translation.
_WORD = re.compile(r"[A-Za-z]{3}")


def shown_texts(tree):
    """Yields the expressions that a module gives to Blender as texts to show."""
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
        name = getattr(call.func, "attr", getattr(call.func, "id", ""))
        place = _TEXTS.get(name)
        if isinstance(place, int):
            yield from call.args[place : place + 1]
        elif place is not None:
            yield from (keyword.value for keyword in call.keywords if keyword.arg == place)


def values(tree, expression):
    """Yields the expression; for a name, the values that its module assigns to it."""
    yield expression
    for name in (node.id for node in ast.walk(expression) if isinstance(node, ast.Name)):
        for node in ast.walk(tree):
            if isinstance(node, (ast.Assign, ast.AugAssign)):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                if any(getattr(target, "id", None) == name for target in targets):
                    yield node.value


def untranslatable(expression):
    """Returns words of an expression that no catalog can hold, being built at run time."""
    if isinstance(expression, ast.Call):
        # The result of a function is checked elsewhere; the argument of iface_() must be constant.
        if getattr(expression.func, "id", "") == "iface_":
            return [] if isinstance(expression.args[0], ast.Constant) else ["iface_()"]
        return []
    if isinstance(expression, ast.JoinedStr):
        parts = [part.value for part in expression.values if isinstance(part, ast.Constant)]
        return [part for part in parts if _WORD.search(part)]
    if isinstance(expression, ast.BinOp):
        parts = [expression.left, expression.right]
        found = [p.value for p in parts if isinstance(p, ast.Constant) and isinstance(p.value, str)]
        return [part for part in found if _WORD.search(part)] + [
            word for part in parts for word in untranslatable(part)
        ]
    if isinstance(expression, ast.IfExp):
        return [*untranslatable(expression.body), *untranslatable(expression.orelse)]
    return []


def found_in(source):
    tree = ast.parse(source)
    return [
        (value.lineno, word)
        for text in shown_texts(tree)
        for value in values(tree, text)
        for word in untranslatable(value)
    ]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.name)
def test_labels_can_be_translated(path):
    assert not found_in(path.read_text())


@pytest.mark.parametrize(
    "label",
    [
        'layout.label(text=f"{n} frames")',
        'layout.operator("x", text="Bake " + name)',
        'layout.prop(settings, "frame", text="Frame %d" % n)',
        'text = f"About {n} seconds"\nsentence(context, layout, text)',
        'cls.poll_message_set(iface_(f"Frame {n}"))',
    ],
)
def test_a_label_that_cannot_is_found(label):
    assert found_in(label)


@pytest.mark.parametrize("path", LANGUAGES, ids=lambda path: path.stem)
def test_a_catalog_holds_messages_of_the_interface(path):
    others = [source for source in SOURCES if source.parent.name != "languages"]
    others.append(Path(examples.__file__))
    constants = {
        node.value
        for source in others
        for node in ast.walk(ast.parse(source.read_text()))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    messages = runpy.run_path(str(path))["MESSAGES"]
    assert len(messages) > 40 and not messages.keys() - constants
    for example in examples.EXAMPLES.values():
        assert {example.label, example.text} <= messages.keys()
    for english, other in messages.items():
        holes = [re.findall("%[a-z%]", text) for text in (english, other)]
        assert holes[0] == holes[1], english
