# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that read node trees.

They find nodes by type and sockets by identifier, which are the same in every language.
"""

import math

import mathutils
import numpy as np
from leaflight import LeaflightError


def linked(tree, identifier):
    """Returns the node that feeds a socket of the output that Cycles renders, or None."""
    output = tree.get_output_node("CYCLES")
    return source(socket(output, identifier)) if output else None


def source(end):
    """Returns the node that feeds a socket, through reroutes, or None."""
    link = _link(end)
    return link.from_node if link else None


def source_socket(end):
    """Returns the output that feeds a socket, through reroutes, or None."""
    link = _link(end)
    return link.from_socket if link else None


def _link(end):
    while end is not None and end.is_linked:
        link = end.links[0]
        if link.from_node.type != "REROUTE":
            return link
        end = link.from_node.inputs[0]
    return None


def socket(node, identifier):
    return next((s for s in node.inputs if s.identifier == identifier), None)


def number(node, identifier, absent=0.0):
    """Returns the number at a socket, or infinity if other nodes feed the socket."""
    end = socket(node, identifier)
    if end is None:
        return absent
    return np.inf if source(end) else end.default_value


def constant(what, node, identifier, absent=0.0):
    """Returns the number at a socket. Raises LeaflightError if other nodes feed it."""
    value = number(node, identifier, absent)
    if not np.isfinite(value):
        other = source(socket(node, identifier))
        raise LeaflightError(
            f"{what} has a {other.bl_label} node in its {identifier}, which the bake cannot model: "
            "disconnect it."
        )
    return value


def shader(what, tree):
    """Returns the node of a tree's surface, or None. Raises LeaflightError for a volume shader."""
    if linked(tree, "Volume") is not None:
        raise LeaflightError(
            f"{what} has a volume shader, which the bake cannot model: disconnect it."
        )
    return linked(tree, "Surface")


def color(what, end):
    """Returns the color (r, g, b) at a socket. Raises LeaflightError if other nodes feed it."""
    if source(end):
        raise LeaflightError(
            f"{what} has a textured {end.name.lower()}, which the bake does not model there: "
            "disconnect its nodes and choose a color."
        )
    return tuple(float(x) for x in end.default_value[:3])


def mapping(what, node):
    """Returns the matrix (4, 4) that a Mapping node applies to points. Raises LeaflightError."""
    values = {}
    for identifier in ("Location", "Rotation", "Scale"):
        end = socket(node, identifier)
        if source(end):
            raise LeaflightError(
                f"{what} has a Mapping node whose {identifier} comes from other nodes, which the "
                "bake cannot model: disconnect them."
            )
        values[identifier] = tuple(end.default_value)
    rotation = mathutils.Euler(values["Rotation"], "XYZ").to_matrix().to_4x4()
    matrix = np.array(rotation, np.float64) @ np.diag([*values["Scale"], 1.0])
    if node.vector_type in {"POINT", "TEXTURE"}:
        matrix[:3, 3] = values["Location"]
    if node.vector_type == "TEXTURE":
        if not all(abs(x) > 0 for x in values["Scale"]):
            raise LeaflightError(f"{what} has a Mapping node of zero scale: choose another scale.")
        return np.linalg.inv(matrix)
    if node.vector_type == "NORMAL":
        raise LeaflightError(
            f"{what} has a Mapping node of type Normal, which the bake cannot model: set its type "
            "to Point."
        )
    return matrix


def is_rotation(matrix):
    """True if a matrix (4, 4) rotates and neither moves, scales nor mirrors."""
    turn = matrix[:3, :3]
    return (
        np.allclose(matrix[:3, 3], 0.0, atol=1e-6)
        and np.allclose(turn @ turn.T, np.eye(3), atol=1e-5)
        and math.isclose(np.linalg.det(turn), 1.0, abs_tol=1e-4)
    )
