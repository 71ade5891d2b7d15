# SPDX-License-Identifier: GPL-3.0-or-later
"""A Python state of ParaView that opens a .vti with its lit isosurface."""

from pathlib import Path

from ..bake.baked import Bake
from ..stills.first_view import camera_around_bake, default_isovalue_of

# A contour of the values, in the colors that hold the light: ParaView's own lights are off.
_STATE = """\
# The lit isosurface of {name} in ParaView: File > Load State, or pvpython SCRIPT.
# Then change the isovalue of the filter "Isosurface".
import os

from paraview.simple import *

folder = os.path.dirname(os.path.abspath(__file__)) if "__file__" in globals() else {folder}
image = XMLImageDataReader(registrationName="Volume", FileName=[os.path.join(folder, {name})])
isosurface = Contour(registrationName="Isosurface", Input=image)
isosurface.ContourBy = ["POINTS", "value"]
isosurface.Isosurfaces = [{isovalue!r}]
view = GetActiveViewOrCreate("RenderView")
shown = Show(isosurface, view)
ColorBy(shown, ("POINTS", "color"))
shown.MapScalars = 0
shown.Ambient, shown.Diffuse, shown.Specular = 1.0, 0.0, 0.0
Render()  # The first picture moves the camera.
view.CameraPosition = {camera.position}
view.CameraFocalPoint = view.CenterOfRotation = {camera.target}
view.CameraViewUp = {camera.up}
view.CameraViewAngle = {camera.angle}
Render()
"""


def state_path(path: Path) -> Path:
    """Returns the path of the state beside a .vti."""
    return path.with_name(f"{path.stem}_paraview.py")


def paraview_state(path: Path, bake: Bake, volume: int) -> str:
    """Returns the state for the .vti of a volume, with the camera of still()."""
    isovalue = default_isovalue_of(bake, volume)
    return _STATE.format(
        name=repr(path.name),
        folder=repr(str(path.resolve().parent)),
        isovalue=float(bake.isovalue_of(volume, isovalue)),
        camera=camera_around_bake(bake, isovalue=isovalue),
    )
