# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests an exported USD file with Blender's own importer, if there is one."""

import leaflight
import numpy as np
import pytest

IMPORT = """
import bpy, numpy as np, sys
source, results = sys.argv[-2:]
if not bpy.app.build_options.usd:
    print("no importer")
else:
    before = set(bpy.data.objects)
    bpy.ops.wm.usd_import(filepath=source)
    bpy.context.view_layer.update()
    (one,) = [obj for obj in set(bpy.data.objects) - before if obj.type == "MESH"]
    mesh, matrix = one.data, np.array(one.matrix_world)
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", places)
    places = places.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    attribute = mesh.color_attributes[0]
    colors = np.empty(4 * len(attribute.data), np.float32)
    attribute.data.foreach_get("color", colors)
    vertices = np.arange(len(mesh.vertices), dtype=np.int32)
    if attribute.domain == "CORNER":
        vertices = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", vertices)
    np.savez(results, places=places, colors=colors.reshape(-1, 4), vertices=vertices)
"""


def test_colors_and_places_arrive(blender, tmp_path):
    pytest.importorskip("pxr", reason="usd-core of PyPI is not installed")
    bake = leaflight.bake(leaflight.bump_box(24), error=20.0)
    leaflight.export(bake, tmp_path / "box.usdc", [47.0])
    script, results = tmp_path / "import.py", tmp_path / "found.npz"
    script.write_text(IMPORT)
    output = blender.run("--python", script, "--", tmp_path / "box.usdc", results)
    if "no importer" in output:
        pytest.skip("this Blender has no importer of USD")
    found, surface = np.load(results), bake.surface(47.0)
    np.testing.assert_allclose(found["places"], surface.vertices, atol=1e-5)
    expected = surface.radiance * bake.scene.exposure
    assert expected.max() > 0.2
    # Some versions store eight bits of sRGB.
    within = np.clip(expected, 0, 1)[found["vertices"]]
    np.testing.assert_allclose(np.clip(found["colors"][:, :3], 0, 1), within, atol=0.01)
