# SPDX-License-Identifier: GPL-3.0-or-later
"""A Sphinx extension that turns plain docstrings into text with a table of parameters.

A line `name: text` or `name, name: text` describes parameters. Indented lines after it continue it.
napoleon converts docstrings with sections in NumPy's style.
"""

import inspect
import re
from typing import get_type_hints

_TABLE = (
    ".. list-table::",
    "   :header-rows: 1",
    "   :widths: auto",
    "",
    "   * - Parameter",
    "     - Type",
    "     - Description",
)


def setup(app):
    # Run before napoleon, whose listener has the priority 500.
    app.connect("autodoc-process-docstring", _process, priority=400)
    return {"parallel_read_safe": True}


def _process(_app, _what, _name, obj, _options, lines):
    if any(line.strip().startswith("---") for line in lines):
        return
    lines[:] = rewritten(lines, _parameters(obj))


def _parameters(obj):
    """Returns {name: type as text} of the parameters that a docstring may describe."""
    try:
        parameters = inspect.signature(obj).parameters.values()
    except (TypeError, ValueError):
        return {}
    types = {one.name: _type(one.annotation) for one in parameters}
    for one in parameters:
        # Add the options of a TypedDict.
        options = re.fullmatch(r"Unpack\[(\w+)\]", str(one.annotation))
        if options:
            function = inspect.unwrap(obj.__init__ if inspect.isclass(obj) else obj)
            hints = get_type_hints(function.__globals__[options[1]])
            types |= {name: _type(hint) for name, hint in hints.items()}
    return types


def _type(annotation):
    if annotation is inspect.Parameter.empty:
        return ""
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    if "_SupportsArray" in text:
        # NumPy's ArrayLike is a long union.
        return "ArrayLike | None" if "None" in text else "ArrayLike"
    return re.sub(r"(\w+\.)+(?=\w)", "", text)


def rewritten(lines, parameters):
    """Returns the lines of a docstring as reStructuredText.

    parameters: {name: type as text, or empty}, which the docstring may describe.
    """
    result, before = [], None
    for block in _blocks(lines, parameters):
        if isinstance(block, tuple):
            names, text = block
            if not isinstance(before, tuple):
                result += ["", *_TABLE]
            types = dict.fromkeys(parameters[name] for name in names if parameters[name])
            codes = [", ".join(f"``{each}``" for each in some) for some in (names, types)]
            result += [f"   * - {codes[0]}", f"     - {codes[1]}", f"     - {_escaped(text)}"]
        elif any(line.startswith(" ") for line in block):
            result += ["", "::", "", *(f"    {line}" for line in block), ""]
        else:
            result += ["", *map(_escaped, block), ""]
        before = block
    return [*result, ""]


def _blocks(lines, parameters):
    """Returns paragraphs, lists of lines, and descriptions of parameters, (names, text)."""
    blocks, paragraph = [], []
    for line in lines:
        names, text = _description(line, parameters)
        is_described = blocks and isinstance(blocks[-1], tuple) and not paragraph
        if names or not line.strip():
            blocks += [paragraph] if paragraph else []
            paragraph = []
            blocks += [(names, text)] if names else []
        elif is_described and line.startswith(" "):
            blocks[-1] = (blocks[-1][0], f"{blocks[-1][1]} {line.strip()}")
        else:
            paragraph.append(line)
    blocks += [paragraph] if paragraph else []
    return [one for block in blocks for one in _split(block, parameters)]


def _description(line, parameters):
    head, found, text = line.partition(": ")
    names = re.sub(r" \([^)]*\)", "", head).split(", ")
    if not found or not set(names) <= parameters.keys():
        return None, None
    values = re.findall(r"\([^)]*\)", head)
    return names, f"{' '.join(values)}: {text}" if values else text


def _split(block, parameters):
    """Splits a description that continues with other parameters: `a: text; b: text`."""
    if isinstance(block, list):
        return [block]
    names, text = block
    parts = re.split(r"[.;] ((?:\w+, )*\w+): ", text)
    blocks = [(names, parts[0])]
    for more, rest in zip(parts[1::2], parts[2::2]):
        more = more.split(", ")
        if set(more) <= parameters.keys():
            blocks.append((more, rest))
        else:
            last, before = blocks[-1]
            blocks[-1] = (last, f"{before}; {', '.join(more)}: {rest}")
    return blocks


def _escaped(text):
    """Escapes markup that plain text does not mean; `code` stays code."""
    parts = text.split("`")
    if len(parts) % 2 == 0:
        return re.sub(r"([*|`\\]|_\b)", r"\\\1", text)
    plain = [re.sub(r"([*|\\]|_(?!\w))", r"\\\1", part) for part in parts[::2]]
    code = [f"``{part}``" for part in parts[1::2]]
    return "".join(a + b for a, b in zip(plain, [*code, ""]))
