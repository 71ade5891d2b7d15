# SPDX-License-Identifier: GPL-3.0-or-later
"""Export of the node trees of materials to the bake."""

from dataclasses import dataclass, field, replace

import bpy
import numpy as np
from leaflight import LeaflightError

from .. import versions
from . import nodes

# Color in which Cycles renders a mesh without a material.
DEFAULT_ALBEDO = (0.8, 0.8, 0.8)

# Inputs of the Principled BSDF that stop the bake, and those that it leaves out with a warning.
_FORBIDDEN = ("Subsurface", "Subsurface Weight", "Transmission Roughness")
_GLOSSY = ("Specular", "Specular IOR Level", "Sheen", "Sheen Weight", "Clearcoat", "Coat Weight")
_COATS = _GLOSSY[2:]
_ROUGH_DIFFUSE = ("Diffuse Roughness",)
_FILM = ("Thin Film Thickness",)


@dataclass(frozen=True)
class Picture:
    """An image on a UV map, "" being the active one; uv_matrix (4, 4) maps its coordinates."""

    image: bpy.types.Image
    uv_map: str
    uv_matrix: np.ndarray
    repeats: bool


@dataclass(frozen=True)
class Surface:
    """How a material scatters and emits light, in the terms of leaflight.scene.Mesh."""

    albedo: tuple = (0.0, 0.0, 0.0)
    scattering: str = "diffuse"
    ior: float = 1.5
    emission: tuple = (0.0, 0.0, 0.0)
    picture: Picture = None
    warnings: list = field(default_factory=list)


def surface_of(owner, material):
    """Returns the Surface of a material, or of None, on the object `owner`.

    Raises LeaflightError.
    """
    if material is None:
        return Surface(DEFAULT_ALBEDO)
    tree = versions.node_tree(material)
    if tree is None:
        return Surface(tuple(material.diffuse_color[:3]))
    what = f'Material "{material.name}" of "{owner}"'
    shader = nodes.shader(what, tree)
    return Surface() if shader is None else _surface(what, shader)


def _surface(what, shader):
    kinds = {
        "BSDF_DIFFUSE": _diffuse,
        "BSDF_PRINCIPLED": _principled,
        "BSDF_GLOSSY": _glossy,
        "BSDF_ANISOTROPIC": _glossy,
        "BSDF_GLASS": _glass,
        "EMISSION": _emission,
        "ADD_SHADER": _sum,
    }
    if shader.type not in kinds:
        raise LeaflightError(
            f"{what} ends in a {shader.bl_label} node, but the bake models Diffuse, Principled, "
            "Glossy, Glass and Emission: change it, or disable the object in renders."
        )
    surface = kinds[shader.type](what, shader)
    normal = nodes.socket(shader, "Normal")
    if normal is not None and nodes.source(normal):
        surface.warnings.append(
            f"{what} is baked without its bump or normal map: disconnect it for a match"
        )
    return surface


def _diffuse(what, shader):
    albedo, picture = _textured(what, nodes.socket(shader, "Color"))
    warnings = []
    if nodes.number(shader, "Roughness") > 0:
        warnings.append(f"{what} is baked with roughness 0: set it to zero for a match")
    return Surface(albedo, picture=picture, warnings=warnings)


def _principled(what, shader):
    for identifier in _FORBIDDEN:
        if nodes.number(shader, identifier) > 0:
            raise LeaflightError(
                f"{what} has {identifier} above zero, which the bake cannot model: set it to zero."
            )
    if nodes.number(shader, "Alpha", 1.0) < 1:
        raise LeaflightError(f"{what} is transparent, which the bake cannot model: set Alpha to 1.")
    metallic = nodes.number(shader, "Metallic")
    transmission = max(
        nodes.number(shader, "Transmission"), nodes.number(shader, "Transmission Weight")
    )
    base = nodes.socket(shader, "Base Color")
    left_out: tuple[str, ...] = _GLOSSY + _ROUGH_DIFFUSE + _FILM
    if metallic == 0 and transmission == 0:
        albedo, picture = _textured(what, base)
        surface = Surface(albedo, picture=picture)
        if not versions.principled_is_lambertian(shader):
            surface.warnings.append(
                f"{what} is baked as if its diffuse Roughness were 0.5, unlike in this Blender: "
                "set it to 0.5, or use a Diffuse BSDF for a match"
            )
    elif metallic == 1 or (metallic == 0 and transmission == 1):
        # A metal's transmission has no effect, and glass has no additional specular layer.
        left_out = _COATS + _FILM
        kind = "mirror" if metallic == 1 else "glass"
        _check_polished(what, shader, kind)
        color = nodes.color(what, base)
        surface = _metal(what, shader, color) if metallic == 1 else _clear(what, shader, color)
    else:
        name, value = ("Metallic", metallic) if metallic > 0 else ("Transmission", transmission)
        found = f"{value:g}" if np.isfinite(value) else "from other nodes"
        raise LeaflightError(
            f"{what} has {name} {found}, but the bake models diffuse surfaces (0), and mirrors or "
            "glass (1 with Roughness 0): set it to 0 or 1."
        )
    surface.warnings.extend(_left_out(what, shader, left_out))
    return replace(surface, emission=_principled_emission(what, shader))


def _metal(what, shader, color):
    warnings = []
    if versions.principled_metal_edges(shader, color):
        warnings.append(
            f"{what} is baked in one color, but a Principled metal has another at grazing angles: "
            "use a Glossy BSDF for a match"
        )
    return Surface(color, "mirror", warnings=warnings)


def _clear(what, shader, color):
    if nodes.number(shader, "Thin Wall"):
        raise LeaflightError(
            f"{what} has Thin Wall, but the bake models solid glass: turn it off and give the "
            "object thickness."
        )
    warnings = []
    if min(color) < 1:
        warnings.append(
            f"{what} is baked as glass with colored reflections, unlike a Principled one: use a "
            "Glass BSDF for a match"
        )
    passing = versions.principled_glass_color(color)
    return Surface(passing, "glass", nodes.constant(what, shader, "IOR", 1.5), warnings=warnings)


def _left_out(what, shader, identifiers):
    """Returns a list with a sentence on the parts of a shader that the bake leaves out, if any."""
    found = [name for name in identifiers if nodes.number(shader, name) > 0]
    if not found:
        return []
    return [f"{what} is baked without its {' and '.join(found)}: set it to zero for a match"]


def _principled_emission(what, shader):
    end = nodes.socket(shader, "Emission") or nodes.socket(shader, "Emission Color")
    strength = nodes.constant(what, shader, "Emission Strength", 1.0)
    if end is None or strength == 0:
        return (0.0, 0.0, 0.0)
    return _radiance(what, nodes.color(what, end), strength)


def _glossy(what, shader):
    _check_polished(what, shader, "mirror")
    return Surface(nodes.color(what, nodes.socket(shader, "Color")), "mirror")


def _glass(what, shader):
    _check_polished(what, shader, "glass")
    color = nodes.color(what, nodes.socket(shader, "Color"))
    warnings = _left_out(what, shader, _FILM)
    return Surface(color, "glass", nodes.constant(what, shader, "IOR", 1.5), warnings=warnings)


def _emission(what, shader):
    color = nodes.color(what, nodes.socket(shader, "Color"))
    return Surface(emission=_radiance(what, color, nodes.constant(what, shader, "Strength")))


def _sum(what, shader):
    """Returns the Surface of an Add Shader. The bake models at most one reflecting part."""
    parts = [nodes.source(end) for end in shader.inputs]
    surfaces = [_surface(what, part) for part in parts if part is not None]
    reflecting = [
        s for s in surfaces if max(s.albedo) > 0 or s.picture or s.scattering != "diffuse"
    ]
    if len(reflecting) > 1:
        raise LeaflightError(
            f"{what} adds two reflecting shaders, but the bake models one with an Emission: "
            "choose one of them."
        )
    base = reflecting[0] if reflecting else Surface()
    emission = np.sum([s.emission for s in surfaces], axis=0) if surfaces else np.zeros(3)
    warnings = [warning for s in surfaces for warning in s.warnings]
    return replace(base, emission=tuple(float(x) for x in emission), warnings=warnings)


def _radiance(what, color, strength):
    radiance = tuple(float(strength * x) for x in color)
    if min(radiance) < 0:
        raise LeaflightError(f"{what} emits negative light: make its strength zero or positive.")
    return radiance


def _check_polished(what, shader, kind):
    # Up to Blender 3.6 the distribution "Sharp" ignores the roughness.
    roughness = nodes.number(shader, "Roughness")
    if getattr(shader, "distribution", "") == "SHARP" or roughness == 0:
        return
    found = f"roughness {roughness:.3g}" if np.isfinite(roughness) else "a textured roughness"
    raise LeaflightError(
        f"{what} is {kind} with {found}, but the bake models polished {kind}: set Roughness to 0, "
        "or make the material diffuse."
    )


def _textured(what, end):
    """Returns (albedo, Picture or None) of a socket that an image may feed."""
    node = nodes.source(end)
    if node is None:
        return nodes.color(what, end), None
    if node.type != "TEX_IMAGE" or nodes.source_socket(end).identifier != "Color":
        raise LeaflightError(
            f"{what} has a {node.bl_label} node in its color, but the bake models one color or an "
            "Image Texture: bake the nodes to an image, or choose a color."
        )
    return (1.0, 1.0, 1.0), _picture(what, node)


def _picture(what, node):
    if node.projection != "FLAT":
        raise LeaflightError(
            f"{what} uses the projection {node.projection.title()}, but the bake models UV maps: "
            "set the projection to Flat."
        )
    uv_map, matrix = _uv_map(what, nodes.socket(node, "Vector"))
    return Picture(node.image, uv_map, matrix, node.extension == "REPEAT")


def _uv_map(what, end):
    """Returns (name, matrix) of the UV map that feeds a socket, perhaps through Mapping nodes."""
    node = nodes.source(end)
    if node is None:
        return "", np.eye(4)
    if node.type == "MAPPING":
        uv_map, before = _uv_map(what, nodes.socket(node, "Vector"))
        return uv_map, nodes.mapping(what, node) @ before
    if node.type == "UVMAP" and not node.from_instancer:
        return node.uv_map, np.eye(4)
    if node.type == "TEX_COORD" and nodes.source_socket(end).identifier == "UV":
        return "", np.eye(4)
    raise LeaflightError(
        f"{what} uses a {node.bl_label} node for its image, but the bake models UV maps: use a UV "
        "Map node."
    )
