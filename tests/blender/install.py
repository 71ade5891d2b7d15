# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --background --python install.py -- ZIP: installs the package as a user does.

Blender reports "Installed" even if the wheels do not fit its Python, and then cannot enable the
extension. Therefore this checks the result.
"""

import sys
from pathlib import Path

import addon_utils
import bpy

package = sys.argv[-1]
if bpy.app.version >= (4, 2, 0):
    name = "bl_ext.user_default.leaflight"
    directory, file = Path(package).parent, Path(package).name
    bpy.ops.extensions.package_install_files(
        directory=str(directory),
        files=[{"name": file}],
        repo="user_default",
        enable_on_install=True,
    )
else:
    name = "leaflight_addon"
    bpy.ops.preferences.addon_install(filepath=package)
    bpy.ops.preferences.addon_enable(module=name)
if addon_utils.check(name) != (True, True) or not hasattr(bpy.types.Object, "leaflight"):
    sys.exit(f"{package} is installed, but {name} is not enabled.")

import leaflight  # noqa: E402

user = Path(bpy.utils.resource_path("USER"))
for module in (sys.modules[name], leaflight, leaflight._core):
    path = Path(module.__file__).resolve()
    if user.resolve() not in path.parents:
        sys.exit(f"{module.__name__} is not what was installed: it comes from {path}.")
    print(f"{module.__name__}: {path.relative_to(user.resolve())}")
bpy.ops.wm.save_userpref()
