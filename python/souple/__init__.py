"""Souple: position-based dynamics of cloth, soft bodies, ropes, rigid bodies, grains and fluids.

The names are those of C++; docs/python.md has what differs. Meters, kilograms, seconds; Y up, right-handed.
"""

from . import _souple, material
from ._souple import *
from ._souple import __version__, joint
from .constraints import SetProjector, constraint_kinds
from .scene import Scene, add_to_world, build_world, load_scene, parse_scene, save_scene

__all__ = [name for name in dir() if not name.startswith("_")] + ["__version__"]
