"""Souple: position-based dynamics of cloth, soft bodies, ropes, rigid bodies, grains and fluids.

The names are those of C++; docs/python.md has what differs. Meters, kilograms, seconds; Y up, right-handed.
"""

import builtins as _builtins

from . import _souple, material
from ._souple import *
from ._souple import __version__, joint
from .constraints import SetProjector, constraint_kinds
from .scene import Scene, add_to_world, build_world, load_scene, parse_scene, save_scene

# `from souple import *` leaves Python's own functions, such as all(), as they are.
__all__ = [name for name in dir() if not name.startswith("_") and not hasattr(_builtins, name)] + ["__version__"]
