"""Writes the types of the compiled module: write_stubs.py FOLDER_OF_THE_PACKAGE, which gets _souple/*.pyi.

They come from the module itself. They consist of the signatures that pybind11 puts before each text, the members of
structs, and the keywords for members of options. Python's standard library only.
"""

import enum
import importlib
import inspect
import pathlib
import re
import sys
import types

HEADER = '''import enum
import os
from typing import Any, Callable, Dict, Iterable, List, Optional, Sequence, Tuple, Union, overload

import numpy
import numpy.typing

from souple._souple import joint as joint
'''
# Parameters that take functions, and those that are objects of any kind.
FUNCTIONS = {"callback", "field", "function", "log", "target", "path"}
OPTIONAL_FUNCTIONS = {"target", "log"}
VECTOR = re.compile(r"Tuple\[float(, float)+\]")


def split(text):
    """Arguments between commas that are in no bracket and no string."""
    parts, depth, start, quote = [], 0, 0, ""
    for i, c in enumerate(text):
        if quote:
            quote = "" if c == quote and text[i - 1] != "\\" else quote
        elif c in "'\"":
            quote = c
        elif c in "([{<":
            depth += 1
        elif c in ")]}>":
            depth -= 1
        elif c == "," and depth == 0:
            parts.append(text[start:i].strip())
            start = i + 1
    return [part for part in [*parts, text[start:].strip()] if part]


def returned(text):
    """A type as C++ returns it, in words of Python."""
    text = re.sub(r"souple\._souple\.|souple\.python\.", "", text.strip())
    text = re.sub(r"\b(handle|object)\b", "Any", text)
    text = re.sub(r"List\[(\w+)\[\d+\]\]", r"List[\1]", text)
    return re.sub(r"numpy\.ndarray\[numpy\.(\w+)\]|numpy\.ndarray",
                  lambda m: f"numpy.typing.NDArray[numpy.{m[1] or 'generic'}]" if m[1] else "numpy.typing.NDArray[Any]", text)


def taken(text, enums):
    """The type as an argument, which may be anything that converts to it."""
    text = returned(text)
    text = VECTOR.sub("Union[Sequence[float], numpy.typing.NDArray[Any]]", text)
    text = text.replace("numpy.typing.NDArray[Any]", "numpy.typing.ArrayLike") if text.startswith("numpy.") else text
    text = re.sub(r"^List\[", "Iterable[", text)
    text = text.replace("os.PathLike", "Union[str, bytes, os.PathLike[str], os.PathLike[bytes]]")
    return f"Union[{text}, str]" if text in enums else text


def literal(text):
    return text if re.fullmatch(r"-?[\d.]+(e-?\d+)?|None|True|False|'[^']*'", text) else "..."


class Stubs:
    def __init__(self, module):
        self.module = module
        self.enums = {name for name, value in vars(module).items() if isinstance(value, type) and issubclass(value, enum.Enum)}
        self.enums.add("joint.Motor.Target")

    def members(self, type_name):
        cls = getattr(self.module, type_name, None)
        return getattr(cls, "_member_types", {}) if cls else {}

    def argument(self, text, keywords):
        if text in ("self", "*args", "**kwargs"):
            return [text] if text != "**kwargs" or not keywords else []
        match = re.fullmatch(r"(\w+): (.*?)(?: = (.*))?", text, re.S)
        if not match:
            return [text]
        name, kind, default = match.groups()
        if name == "self":
            return ["self"]
        if kind == "object" and name in FUNCTIONS:
            kind = "Optional[Callable[..., Any]]" if name in OPTIONAL_FUNCTIONS else "Callable[..., Any]"
        else:
            kind = taken(kind, self.enums)
        return [f"{name}: {kind}" + (f" = {literal(default)}" if default is not None else "")]

    def keywords(self, arguments):
        """Names for **kwargs: the members of the options before it."""
        if arguments[-1:] != ["**kwargs"] or len(arguments) < 2:
            return []
        options = re.match(r"\w+: Optional\[souple\._souple\.(\w+)\]", arguments[-2])
        members = self.members(options[1]) if options else {}
        known = {argument.split(":")[0] for argument in arguments}
        return [f"{name}: {taken(kind, self.enums)} = ..." for name, kind in members.items() if name not in known]

    def signature(self, name, text):
        match = re.match(rf"{re.escape(name)}\((.*)\) -> (.+)$", text, re.S)
        if not match:
            return "(*args: Any, **kwargs: Any) -> Any"
        arguments = split(match[1])
        keywords = self.keywords(arguments)
        shown = [part for argument in arguments for part in self.argument(argument, keywords)]
        if keywords:
            shown += ["*", *keywords]
        return f"({', '.join(shown)}) -> {returned(match[2])}"

    def function(self, function, indent, name, static=False):
        doc = function.__doc__ or ""
        if "Overloaded function." in doc:
            parts = re.split(r"^\d+\. (?=\w+\()", doc.split("Overloaded function.", 1)[1], flags=re.M)[1:]
        else:
            parts = [doc]
        lines = []
        for part in parts:
            first, _, words = part.strip().partition("\n")
            if len(parts) > 1:
                lines.append(f"{indent}@overload")
            if static:
                lines.append(f"{indent}@staticmethod")
            lines += [f"{indent}def {name}{self.signature(name, first)}:", *text_of(words, indent + "    "), f"{indent}    ...", ""]
        return lines

    @staticmethod
    def attribute(name, kind, doc, indent):
        return [f"{indent}@property", f"{indent}def {name}(self) -> {returned(kind)}:", *text_of(doc or "", indent + "    "),
                f"{indent}    ..."]

    def struct(self, cls, path, indent):
        lines, members = [], cls._member_types
        made = "_souple" in (cls.__init__.__doc__ or "")
        for name, kind in members.items():
            prop = inspect.getattr_static(cls, name)
            lines += self.attribute(name, kind, prop.__doc__, indent)
            if made:
                lines += [f"{indent}@{name}.setter", f"{indent}def {name}(self, value: {taken(kind, self.enums)}) -> None: ..."]
        if made:
            arguments = ", ".join(f"{name}: {taken(kind, self.enums)} = ..." for name, kind in members.items())
            lines += [f"{indent}def __init__(self, {arguments}) -> None: ...",
                      f"{indent}def replace(self, *, {arguments}) -> {path}:",
                      f'{indent}    """A copy with other values for the members that are named."""', f"{indent}    ..."]
        return lines + [""]

    def cls(self, cls, path, indent=""):
        inner, name = indent + "    ", path.rpartition(".")[2]
        if issubclass(cls, enum.Enum):
            base = "enum.IntFlag" if issubclass(cls, enum.IntFlag) else "enum.IntEnum"
            lines = [f"{indent}class {name}({base}):", *text_of(cls.__doc__ or "", inner)]
            return lines + [f"{inner}{member} = {value.value}" for member, value in cls.__members__.items()] + [""]
        if issubclass(cls, Exception):
            return [f"{indent}class {name}({cls.__base__.__name__}):", *text_of(cls.__doc__ or "", inner), f"{inner}...", ""]
        lines = [f"{indent}class {name}:", *text_of(cls.__doc__ or "", inner)]
        members = getattr(cls, "_member_types", {})
        for key, value in sorted(vars(cls).items()):
            if isinstance(value, type):
                lines += self.cls(value, f"{path}.{key}", inner)
        if members:
            lines += self.struct(cls, path, inner)
        for key, value in vars(cls).items():
            hidden = key.startswith("_") and key not in ("__init__", "__len__", "__eq__", "__hash__", "__copy__", "__deepcopy__")
            if hidden or key in members or isinstance(value, type) or value is None or (members and key in ("__init__", "replace")):
                continue
            if isinstance(value, property):
                got = re.search(r"-> (.+)", value.fget.__doc__ or "")
                lines += self.attribute(key, got[1] if got else "Any", value.__doc__, inner)
            elif key == "__eq__":
                lines.append(f"{inner}def __eq__(self, other: Any) -> bool: ...")
            elif isinstance(value, staticmethod):
                lines += self.function(value.__func__, inner, key, static=True)
            elif callable(value) and not (key == "__init__" and "Initialize self" in (value.__doc__ or "")):
                lines += self.function(value, inner, key)
        if lines[-1].endswith(":"):
            lines.append(f"{inner}...")
        return lines + [""]

    def write(self, module, before=""):
        """`before`: what stands before the name of each class."""
        lines = [*text_of(f"{module.__doc__} Made by python/write_stubs.py.", ""), *HEADER.splitlines(), ""]
        for name, value in sorted(vars(module).items()):
            if isinstance(value, type):
                lines += self.cls(value, before + name)
            elif callable(value) and not name.startswith("__"):
                lines += self.function(value, "", name)
            elif name == "__version__":
                lines.append("__version__: str")
        return "\n".join(lines) + "\n"


def text_of(words, indent):
    words = words.strip().replace("\\", "\\\\").replace('"""', "'''")
    if not words:
        return []
    if words.endswith('"'):
        words += " "
    return [f'{indent}"""' + f"\n".join(line if i == 0 or not line else indent + line for i, line in enumerate(words.splitlines())) + '"""']


def main():
    package = pathlib.Path(sys.argv[1])
    # Without the package around it, which needs NumPy: pip builds where none is.
    parent = types.ModuleType("souple")
    parent.__path__ = [str(package)]
    sys.modules["souple"] = parent
    module = importlib.import_module("souple._souple")
    stubs = Stubs(module)
    (package / "_souple").mkdir(exist_ok=True)
    (package / "_souple" / "__init__.pyi").write_text(stubs.write(module), encoding="utf-8")
    (package / "_souple" / "joint.pyi").write_text(stubs.write(module.joint, "joint."), encoding="utf-8")


if __name__ == "__main__":
    main()
