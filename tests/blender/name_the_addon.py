# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --python name_the_addon.py --python SCRIPT: lets a script import the installed add-on as
leaflight_addon, the name of its legacy package, and the modules of window/.
"""

import importlib
import pkgutil
import sys
from pathlib import Path

import addon_utils

names = ("leaflight_addon", "bl_ext.user_default.leaflight")
(name,) = (name for name in names if addon_utils.check(name)[1])
addon = sys.modules[name]
sys.modules["leaflight_addon"] = addon
for part in pkgutil.walk_packages(addon.__path__, f"{name}."):
    alias = part.name.replace(name, "leaflight_addon", 1)
    sys.modules[alias] = importlib.import_module(part.name)
sys.path.insert(0, str(Path(__file__).resolve().with_name("window")))
