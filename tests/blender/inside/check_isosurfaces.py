# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks materials of isosurfaces: color ramp, emission, mirror and glass, caps."""

import bpy
import numpy as np
import pytest
from leaflight import LeaflightError, _core
from leaflight.scene.scene import is_color
from leaflight_addon.show import isosurfaces, surface_object
from leaflight_addon.stage import scene_export
from leaflight_addon.store import cache
from leaflight_addon.edit import looks
from tools import close, error_of, mesh_arrays


def _add_stop(obj, isovalue, color):
    stop = obj.leaflight.isosurface_stops.add()
    stop.isovalue, stop.color = isovalue, color


def _color_of_material(obj):
    return next(
        tuple(node.inputs[0].default_value[:3])
        for node in obj.data.materials[0].node_tree.nodes
        if node.type.startswith("BSDF")
    )


def check_one_albedo_or_a_ramp(bumps):
    settings = bumps.leaflight
    settings.isosurface_albedo = (0.3, 0.4, 0.5)
    close(isosurfaces.export_isosurfaces(bumps, False).albedo, (0.3, 0.4, 0.5), 1e-6)
    _add_stop(bumps, 80.0, (0.8, 0.4, 0.2))
    _add_stop(bumps, 40.0, (0.0, 0.2, 0.4))
    ramp = isosurfaces.export_isosurfaces(bumps, False).albedo
    assert [position for position, _ in ramp] == [40.0, 80.0]
    close(isosurfaces.colors(ramp), [(0.0, 0.2, 0.4), (0.8, 0.4, 0.2)], 1e-6)
    close(isosurfaces.albedo_at(bumps, 50.0), (0.2, 0.25, 0.35), 1e-6)
    close(isosurfaces.albedo_at(bumps, 200.0), (0.8, 0.4, 0.2), 1e-6)
    _add_stop(bumps, 40.0, (1, 1, 1))
    with pytest.raises(LeaflightError, match="isovalue 40"):
        isosurfaces.albedo_ramp(bumps)


def check_the_material_follows_the_ramp_without_being_built_anew(bumps):
    _add_stop(bumps, 40.0, (0.0, 0.2, 0.4))
    _add_stop(bumps, 80.0, (0.8, 0.4, 0.2))
    bumps.leaflight.isovalue = 50.0
    material = bumps.data.materials[0]
    nodes = [node.as_pointer() for node in material.node_tree.nodes]
    close(_color_of_material(bumps), (0.2, 0.25, 0.35), 1e-6)
    bumps.leaflight["isovalue"] = 60.0
    bumps.update_tag()
    bpy.context.view_layer.update()
    close(_color_of_material(bumps), (0.4, 0.3, 0.3), 1e-6)
    assert bumps.data.materials[0] == material
    assert [node.as_pointer() for node in material.node_tree.nodes] == nodes


def check_stops_are_added_and_removed_by_buttons(bumps):
    settings = bumps.leaflight
    settings.isosurface_albedo = (0.3, 0.4, 0.5)
    assert "no stop" in error_of(bpy.ops.leaflight.remove_stop)
    settings.isovalue = 60.0
    bpy.ops.leaflight.add_stop()
    assert "60" in error_of(bpy.ops.leaflight.add_stop)
    (stop,) = settings.isosurface_stops
    close([stop.isovalue, *stop.color], [60, 0.3, 0.4, 0.5], 1e-6)
    stop.color = (1, 0, 0)
    close(_color_of_material(bumps), (1, 0, 0), 1e-6)
    bpy.ops.leaflight.remove_stop()
    assert not settings.isosurface_stops
    close(_color_of_material(bumps), (0.3, 0.4, 0.5), 1e-6)


@pytest.mark.parametrize("preset", [*looks.LOOKS, *looks.MAPS])
def check_presets(bumps, preset):
    bumps.leaflight.isosurface_scattering = "MIRROR"
    _add_stop(bumps, 40.0, (0.0, 0.2, 0.4))
    bpy.ops.leaflight.isosurface_preset(preset=preset)
    expected = preset if preset in {"MIRROR", "GLASS"} else "DIFFUSE"
    assert bumps.leaflight.isosurface_scattering == expected
    described = isosurfaces.export_isosurfaces(bumps, False)
    assert (max(described.emission) > 0) == (preset == "GLOW")
    assert is_color(described.albedo) != (preset == "TISSUE" or preset in looks.MAPS)


@pytest.mark.parametrize("scattering, kind", [("MIRROR", "BSDF_GLOSSY"), ("GLASS", "BSDF_GLASS")])
def check_mirror_and_glass_stay_what_they_are_after_a_bake(boxed, scattering, kind):
    settings = boxed.leaflight
    settings.isosurface_scattering = scattering
    settings.light_walls = True
    settings.isosurface_ior = 1.3
    settings.isosurface_albedo = (0.9, 0.8, 0.7)
    bpy.ops.leaflight.bake()
    described = cache.bake_of(boxed).scene.isosurfaces[0]
    assert (described.scattering, described.ior) == (scattering.lower(), pytest.approx(1.3))
    assert mesh_arrays(boxed)[2] is None
    node = next(n for n in boxed.data.materials[0].node_tree.nodes if n.type == kind)
    close(node.inputs[0].default_value, (0.9, 0.8, 0.7, 1.0), 1e-6)
    assert next(s for s in node.inputs if s.identifier == "Roughness").default_value == 0.0


def check_glass_that_the_border_may_cut_open_is_warned_of(boxed):
    for capped, scattering, warned in (
        (False, "DIFFUSE", 0),
        (False, "GLASS", 1),
        (True, "GLASS", 0),
    ):
        boxed.leaflight.capped, boxed.leaflight.isosurface_scattering = capped, scattering
        warnings = scene_export.export_scene(bpy.context, boxed)[2]
        assert len(warnings) == warned and all(f'"{boxed.name}"' in text for text in warnings)


def check_isosurfaces_that_emit_need_no_light(boxed):
    bpy.data.objects.remove(bpy.data.objects["lamp"])
    boxed.leaflight.isosurface_emission = (1.0, 0.5, 0.25)
    boxed.leaflight.isosurface_emission_strength = 2.0
    bpy.ops.leaflight.bake()
    close(cache.bake_of(boxed).scene.isosurfaces[0].emission, (2.0, 1.0, 0.5), 1e-6)
    boxed.leaflight.isovalue = boxed.leaflight.low - 1.0
    emission = next(n for n in boxed.data.materials[0].node_tree.nodes if n.type == "EMISSION")
    close(emission.inputs[0].default_value[:3], (1.0, 0.5, 0.25), 1e-6)
    assert emission.inputs[1].default_value == pytest.approx(2.0)


def check_capped_isosurfaces_are_closed_and_lie_with_the_open_ones(bumps):
    open_vertices, open_triangles, _ = mesh_arrays(bumps)
    bumps.leaflight.capped = True
    vertices, triangles, _ = mesh_arrays(bumps)
    assert len(triangles) > len(open_triangles)
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    assert np.all(counts == 2)
    apart = np.linalg.norm(open_vertices[:50, None] - vertices[None], axis=-1).min(axis=1)
    assert apart.max() < 1e-4
    bumps.leaflight.capped = False
    np.testing.assert_array_equal(mesh_arrays(bumps)[0], open_vertices)


def check_a_bake_lights_only_what_is_capped_as_it_was(baked, uncut):
    assert mesh_arrays(baked)[2] is not None
    baked.leaflight.capped = True
    assert mesh_arrays(baked)[2] is None
    bpy.ops.leaflight.bake()
    _, _, radiance = mesh_arrays(baked)
    assert radiance is not None and radiance.max() > 0.01
    volume = cache.bake_of(baked).volume
    surface = _core.contour(volume.field(), baked.leaflight.isovalue)
    assert len(surface[0]) == len(radiance)
    baked.leaflight.capped = False
    assert mesh_arrays(baked)[2] is None


def check_isovalues_stay_those_of_the_data_when_capped(bumps):
    bumps.leaflight.capped = True
    bumps.leaflight.isovalue = -5.0
    assert "-5" in surface_object.problems[bumps.name]
