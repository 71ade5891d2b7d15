# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit isosurfaces as Universal Scene Description (.usda, .usdc, .usd)."""

import errno
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdShade, Vt

from ..arrays import Array
from ..bake.baked import Surface
from ..io.output import check_writable, replaced
from ..paths import AnyPath
from ..scene.volume_texture import identifiers
from ..volume.units import METERS

SUFFIXES = (".usda", ".usdc", ".usd")
# Names of primvars with another meaning.
_TAKEN = ("displaycolor", "displayopacity", "normals", "radiance", "st", "widths")
_FRAMES_PER_SECOND = 24.0


def write_usd(path: AnyPath, surfaces: Mapping[float, Surface], exposure: float) -> None:
    """Writes Surfaces, {isovalue: Surface}, in world coordinates, z up. Raises LeaflightError.

    metersPerUnit is that of the world, 1 if unknown. The mesh is /Leaflight/isosurface, with
    points, normals, primvars and the attribute isovalue. The primvar displayColor is linear RGB:
    radiance times the exposure, not clamped. The primvar radiance is linear RGB in W/(m^2 sr). The
    values of volumes that color the surface are primvars by their names, NaN where there are none.
    The material emits displayColor and reflects nothing. Several isovalues are time samples from
    frame 1 on, 24 per second.
    """
    path = Path(path)
    check_writable(path, path.suffix.lower() if path.suffix.lower() in SUFFIXES else SUFFIXES[0])
    with replaced(path) as temporary:
        stage = Usd.Stage.CreateNew(str(temporary))
        UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
        unit = next(iter(surfaces.values())).unit
        UsdGeom.SetStageMetersPerUnit(stage, METERS.get(unit, 1.0))
        root = UsdGeom.Xform.Define(stage, "/Leaflight")
        stage.SetDefaultPrim(root.GetPrim())
        mesh = UsdGeom.Mesh.Define(stage, "/Leaflight/isosurface")
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        mesh.CreateDoubleSidedAttr(True)
        _fill(mesh, surfaces, exposure)
        material = _glowing(stage)
        UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
        if len(surfaces) > 1:
            stage.SetTimeCodesPerSecond(_FRAMES_PER_SECOND)
            stage.SetStartTimeCode(1)
            stage.SetEndTimeCode(len(surfaces))
        try:
            stage.GetRootLayer().Save()
        except Tf.ErrorException:
            # The message has a line for each block that could not be written.
            raise OSError(errno.EIO, "it could not be written to its end") from None
        del stage


def _fill(mesh: UsdGeom.Mesh, surfaces: Mapping[float, Surface], exposure: float) -> None:
    primvars = UsdGeom.PrimvarsAPI(mesh)
    colors, radiances = (
        primvars.CreatePrimvar(name, Sdf.ValueTypeNames.Color3fArray, UsdGeom.Tokens.vertex)
        for name in ("displayColor", "radiance")
    )
    isovalues = mesh.GetPrim().CreateAttribute("isovalue", Sdf.ValueTypeNames.Double)
    mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    for frame, (isovalue, surface) in enumerate(surfaces.items(), start=1):
        time = Usd.TimeCode(frame) if len(surfaces) > 1 else Usd.TimeCode.Default()
        triangles = surface.triangles
        low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
        counts = np.full(len(triangles), 3, np.int32)
        corners = np.ascontiguousarray(triangles, np.int32).ravel()
        mesh.GetPointsAttr().Set(_vectors(surface.vertices), time)
        mesh.GetNormalsAttr().Set(_vectors(surface.normals), time)
        mesh.GetFaceVertexCountsAttr().Set(Vt.IntArray.FromNumpy(counts), time)
        mesh.GetFaceVertexIndicesAttr().Set(Vt.IntArray.FromNumpy(corners), time)
        mesh.GetExtentAttr().Set(_vectors(np.stack([low, high])), time)
        colors.Set(_vectors(surface.radiance * np.float32(exposure)), time)
        radiances.Set(_vectors(surface.radiance), time)
        for name, values in identifiers(surface.values, _TAKEN).items():
            primvar = primvars.CreatePrimvar(
                name, Sdf.ValueTypeNames.FloatArray, UsdGeom.Tokens.vertex
            )
            primvar.Set(Vt.FloatArray.FromNumpy(values), time)
        isovalues.Set(float(isovalue), time)


def _vectors(rows: Array) -> Vt.Vec3fArray:
    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(rows, np.float32))


def _glowing(stage: Usd.Stage) -> UsdShade.Material:
    """Returns a material that emits the mesh's color and reflects nothing."""
    material = UsdShade.Material.Define(stage, "/Leaflight/lit")
    reader = UsdShade.Shader.Define(stage, "/Leaflight/lit/color")
    reader.CreateIdAttr("UsdPrimvarReader_float3")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("displayColor")
    surface = UsdShade.Shader.Define(stage, "/Leaflight/lit/surface")
    surface.CreateIdAttr("UsdPreviewSurface")
    black = Gf.Vec3f(0.0)
    surface.CreateInput("useSpecularWorkflow", Sdf.ValueTypeNames.Int).Set(1)
    surface.CreateInput("specularColor", Sdf.ValueTypeNames.Color3f).Set(black)
    surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(black)
    surface.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(1.0)
    surface.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f).ConnectToSource(
        reader.CreateOutput("result", Sdf.ValueTypeNames.Float3)
    )
    output = surface.CreateOutput("surface", Sdf.ValueTypeNames.Token)
    material.CreateSurfaceOutput().ConnectToSource(output)
    return material
