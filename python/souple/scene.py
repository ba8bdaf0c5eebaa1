"""Scene files as dicts."""

import json
import os

from . import _souple


class Scene(dict):
    """A scene file as a dict of its keys (docs/scene-format.md), and the folder that its relative file names start from."""

    def __init__(self, keys=(), folder=".", source="scene"):
        super().__init__(keys)
        self.folder, self.source = os.fspath(folder), source

    def __repr__(self):
        return f"Scene({dict.__repr__(self)}, folder={self.folder!r}, source={self.source!r})"


def _texts(overrides):
    """Overrides as the program takes them, "path=value", from a list of such texts or a dict."""
    if not isinstance(overrides, dict):
        return [str(text) for text in overrides]
    return [f"{path}={_json(value)}" for path, value in overrides.items()]


def _json(value):
    try:
        return json.dumps(value, default=_number)
    except (TypeError, ValueError) as error:
        raise _souple.Error(f"scene: {error}; expected dicts, lists, numbers, texts, True, False or None") from None


def _number(value):
    """Converts NumPy's numbers; refuses other types that JSON does not know."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no place in a scene")


def _scene(parts):
    text, folder, source = parts
    return Scene(json.loads(text), folder, source)


def _parts(scene):
    if not isinstance(scene, dict):
        raise TypeError(f"expected a scene as a dict, found {type(scene).__name__}")
    return _json(scene), getattr(scene, "folder", "."), getattr(scene, "source", "scene")


def load_scene(file, overrides=()) -> Scene:
    """Reads a scene file. `overrides`: a dict such as {"objects.flag.material.friction": 0.1}, or a list of "path=value".
    Every object and collider of the result has a name. Throws Error: file, path inside it, the value, what was expected."""
    return _scene(_souple._load_scene(os.fspath(file), _texts(overrides)))


def parse_scene(scene, folder=None, source=None, overrides=()) -> Scene:
    """Checks a scene, a dict or JSON text, and returns it in normalized form: fixed order of keys, no defaults."""
    text, of_folder, of_source = (scene, ".", "scene") if isinstance(scene, str) else _parts(scene)
    return _scene(_souple._parse_scene(text, os.fspath(folder or of_folder), source or of_source, _texts(overrides)))


def save_scene(scene, file) -> None:
    """Checks a scene and writes it to a file, in normalized form."""
    text, _, _ = _souple._parse_scene(*_parts(scene), [])
    with open(file, "w", encoding="utf-8") as out:
        out.write(text)


def build_world(scene, log=None) -> _souple.World:
    """Reads the meshes of a scene, a dict, and builds a World. Repairs and warnings go to log(level, text)."""
    return _souple._build_world(*_parts(scene), log)


def add_to_world(scene, index, world) -> None:
    """Adds scene["objects"][index] to a world that has the objects before it."""
    _souple._add_to_world(*_parts(scene), index, world)
