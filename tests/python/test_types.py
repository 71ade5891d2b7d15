# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that Bake declares, for type checkers, the methods that higher packages add."""

import ast
import inspect

import leaflight
import pytest

(_CLASS,) = (
    node
    for node in ast.parse(inspect.getsource(leaflight.Bake)).body
    if isinstance(node, ast.ClassDef)
)
(_BLOCK,) = (node for node in _CLASS.body if isinstance(node, ast.If))
DECLARED = {node.name: node.args for node in _BLOCK.body if isinstance(node, ast.FunctionDef)}


def test_all_are_declared():
    assert set(DECLARED) == {"moved", "export_page", "show", "still"}


@pytest.mark.parametrize("name", DECLARED)
def test_declarations_are_those_of_the_functions(name):
    declared, real = DECLARED[name], inspect.signature(getattr(leaflight.Bake, name)).parameters
    names = [one.arg for one in (*declared.args, *declared.kwonlyargs)]
    names += [declared.kwarg.arg] if declared.kwarg else []
    assert names[1:] == list(real)[1:]
    defaults = [*declared.defaults, *filter(None, declared.kw_defaults)]
    assert [ast.literal_eval(one) for one in defaults] == [
        one.default for one in real.values() if one.default is not one.empty
    ]
