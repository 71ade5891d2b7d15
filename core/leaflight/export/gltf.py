# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit isosurfaces as glTF 2.0 in one binary file (.glb), for browsers and slides."""

import numpy as np
import pygltflib as gltf

from ..io.output import check_writable, replaced
from ..version import __version__
from ..volume.units import METERS

# The world's z axis points up, glTF's y axis does: a quarter turn about x.
_UP = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]
_SECONDS = 0.1
# In meters: views clip smaller ones, so that molecules and cells are as large as their numbers.
_SMALLEST = 1e-4


def write_glb(path, surfaces, exposure, seconds=_SECONDS):
    """Writes Surfaces, {isovalue: Surface}. Raises LeaflightError.

    Their coordinates are the world's; the root node takes them to meters, with y up.
    Vertices: POSITION, NORMAL, COLOR_0 (linear as glTF demands, 16 bits: radiance times the
    exposure, clamped to 0..1) and _RADIANCE (float, W/(m^2 sr), linear RGB). Their material is
    KHR_materials_unlit, for the light is in the colors. Several are the frames of an animation that
    shows each for so many seconds; a viewer that plays none shows the first.
    """
    check_writable(path, ".glb")
    file = _File()
    root = gltf.Node(
        name="Leaflight", rotation=_UP, scale=[_meters(surfaces.values())] * 3, children=[]
    )
    file.document.nodes.append(root)
    for frame, (isovalue, surface) in enumerate(surfaces.items()):
        mesh = file.add_mesh(f"isovalue {isovalue:g}", surface, exposure)
        root.children.append(len(file.document.nodes))
        hidden = None if frame == 0 else [0.0, 0.0, 0.0]
        file.document.nodes.append(
            gltf.Node(name=f"isovalue {isovalue:g}", mesh=mesh, scale=hidden)
        )
    if len(surfaces) > 1:
        file.animate(root.children, seconds)
    with replaced(path) as temporary:
        file.write(temporary)


class _File:
    """A document and the numbers that it refers to."""

    def __init__(self):
        self.blob = bytearray()
        self.document = gltf.GLTF2(
            asset=gltf.Asset(version="2.0", generator=f"Leaflight {__version__}"),
            scene=0,
            scenes=[gltf.Scene(nodes=[0])],
            extensionsUsed=["KHR_materials_unlit"],
            materials=[
                gltf.Material(
                    name="lit by the bake",
                    # For a viewer that does not know the extension: the least that it can add.
                    pbrMetallicRoughness=gltf.PbrMetallicRoughness(
                        metallicFactor=0.0, roughnessFactor=1.0
                    ),
                    extensions={"KHR_materials_unlit": {}},
                    doubleSided=True,
                )
            ],
        )

    def add_mesh(self, name, surface, exposure):
        linear = np.clip(surface.radiance * np.float32(exposure), 0.0, 1.0)
        colors = np.full((len(linear), 4), 65535, np.uint16)
        colors[:, :3] = np.rint(65535 * linear)
        attributes = gltf.Attributes(
            POSITION=self.add(surface.vertices, gltf.VEC3, bounds=True),
            NORMAL=self.add(_unit(surface.normals), gltf.VEC3),
            COLOR_0=self.add(colors, gltf.VEC4, normalized=True),
        )
        attributes._RADIANCE = self.add(surface.radiance, gltf.VEC3)
        corners = surface.triangles.astype(np.uint32).ravel()
        indices = self.add(corners, gltf.SCALAR, target=gltf.ELEMENT_ARRAY_BUFFER)
        primitive = gltf.Primitive(attributes=attributes, indices=indices, material=0)
        self.document.meshes.append(gltf.Mesh(name=name, primitives=[primitive]))
        return len(self.document.meshes) - 1

    def animate(self, nodes, seconds):
        """Shows the nodes one after the other, by a scale of one or nothing at all."""
        ends = seconds * np.arange(len(nodes) + 1, dtype=np.float32)
        animation = gltf.Animation(name="isovalues")
        for frame, node in enumerate(nodes):
            times, shown = [0.0], [float(frame == 0)]
            if frame > 0:
                times, shown = [0.0, ends[frame]], [0.0, 1.0]
            times, shown = [*times, ends[frame + 1]], [*shown, 0.0]
            if frame == len(nodes) - 1:
                # The last one stays until the animation begins anew.
                shown[-1] = 1.0
            scales = np.repeat(np.array(shown, np.float32)[:, None], 3, axis=1)
            sampler = gltf.AnimationSampler(
                input=self.add(np.array(times, np.float32), gltf.SCALAR, target=None, bounds=True),
                output=self.add(scales, gltf.VEC3, target=None),
                interpolation=gltf.ANIM_STEP,
            )
            target = gltf.AnimationChannelTarget(node=node, path="scale")
            animation.channels.append(gltf.AnimationChannel(sampler=frame, target=target))
            animation.samplers.append(sampler)
        self.document.animations.append(animation)

    def add(self, numbers, kind, target=gltf.ARRAY_BUFFER, normalized=None, bounds=False):
        """Appends an array and returns the number of its accessor."""
        types = {
            "float32": gltf.FLOAT,
            "uint16": gltf.UNSIGNED_SHORT,
            "uint32": gltf.UNSIGNED_INT,
        }
        numbers = np.ascontiguousarray(numbers)
        document, rows = self.document, numbers.reshape(len(numbers), -1)
        document.bufferViews.append(
            gltf.BufferView(
                buffer=0, byteOffset=len(self.blob), byteLength=numbers.nbytes, target=target
            )
        )
        document.accessors.append(
            gltf.Accessor(
                bufferView=len(document.bufferViews) - 1,
                componentType=types[numbers.dtype.name],
                count=len(numbers),
                type=kind,
                normalized=normalized,
                min=rows.min(axis=0).tolist() if bounds else None,
                max=rows.max(axis=0).tolist() if bounds else None,
            )
        )
        self.blob += numbers.tobytes()
        self.blob += bytes(-len(self.blob) % 4)
        return len(document.accessors) - 1

    def write(self, path):
        self.document.buffers.append(gltf.Buffer(byteLength=len(self.blob)))
        self.document.set_binary_blob(bytes(self.blob))
        self.document.save_binary(str(path))


def _meters(surfaces):
    """How many meters a unit of the world measures; 1 where nobody knows, or it is too small."""
    points = np.concatenate([surface.vertices for surface in surfaces])
    scale = METERS.get(next(iter(surfaces)).unit, 1.0)
    return scale if scale * float(np.ptp(points, axis=0).max()) >= _SMALLEST else 1.0


def _unit(normals):
    """glTF demands unit length; where a field is flat there is no direction."""
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(length > 0, normals / np.maximum(length, 1e-30), [0.0, 0.0, 1.0]).astype(
        np.float32
    )
