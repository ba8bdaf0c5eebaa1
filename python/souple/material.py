"""Named materials: cotton, silk, denim, rubber, jelly, nylon, steel_wire, sand, water, oil, honey.

Each use gives a copy: souple.material.cotton.replace(friction=0.1) is another material.
"""

from typing import Any, List

from . import _souple


def names() -> List[str]:
    """Names of the presets of all kinds."""
    return _souple._material_names()


def __getattr__(name: str) -> Any:
    found = None if name.startswith("__") else _souple._material_preset(name)
    if found is None:
        raise AttributeError(f"no material is called {name!r}; known: {', '.join(names())}")
    return found


def __dir__():
    return ["names", *names()]
