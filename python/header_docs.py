#!/usr/bin/env python3
"""Collects the comments of C++'s public headers for Python's docstrings.

header_docs.py OUTPUT.cpp HEADER... writes a source that defines doc() of python/docs.h. It is a table of the comments
(`///` before a declaration, `///<` behind it) by the declaration's name, such as "World.step" or
"ClothMaterial.friction".
"""

import re
import sys

SCOPE = re.compile(r"^\s*(?:template\s*<.*>\s*)?(?:struct|class|enum class|enum)\s+(?:\[\[\w+\]\]\s*)?(\w+)[^;()]*\{")
NAMESPACE = re.compile(r"^\s*(?:inline\s+)?namespace\s+([\w:]*)\s*\{")
FUNCTION = re.compile(r"([A-Za-z_]\w*)\s*\(")
MEMBER = re.compile(r"(\w+)\s*(?:\[[^\]]*\])?\s*(?:=[^,;]*|\{[^;]*\})?\s*(?=[,;])")
# Docs of declarations whose names say it all in C++.
MORE = {
    "Box": "A box whose sides are parallel to the axes of its frame.",
    "CacheFormat": "Format of a cache of positions.",
    "ColliderOptions": "What a collider is like.",
    "ContactPhase": "Whether two bodies began to touch, still do, or no longer do.",
    "DebugParticle": "A particle, for World.debug_draw.",
    "GrainsMaterial": "Balls that roll, such as sand.",
    "KindReport": "The constraints of one kind after a step.",
    "LogLevel": "How serious a line of the log is.",
    "MemoryPart": "Heap memory for one purpose.",
    "MemoryReport.total": "The sum of all parts [bytes].",
    "MeshReport.is_clean": "Whether nothing was found that a simulation would suffer from.",
    "ObjectKind": "Kind of an object.",
    "RecorderOptions": "What a Recorder writes.",
    "RopeMaterial": "A rope. SI units.",
    "SoftBodyMaterial": "A soft solid. SI units.",
    "SolverSettings": "The solver of the constraints, and its numbers.",
    "Sphere": "All points within a radius of the center.",
    "StepReport.has": "Whether the step set this flag.",
    "StepReport.ok": "Whether the outcome is `done`: the world is dt later.",
    "StepReport.total_milliseconds": "The sum of the stages [ms].",
    "Transform.direction": "The direction, rotated.",
    "Transform.point": "The point, scaled, then rotated, then translated.",
    "World.add_cloth": "Makes a cloth of a surface: one particle per vertex, its triangles stretch and bend.",
    "World.add_grains": "Makes grains: balls with these centers [m].",
    "World.closest_point": "The nearest point on the surface of all objects and colliders that the filter lets through.",
    "from_euler_xyz": "The rotation about the fixed axes X, then Y, then Z [radians].",
    "TetStatistics": "Size of the tet mesh of a soft body; zeros for other kinds.",
}
KEYWORDS = {"if", "for", "while", "return", "requires", "decltype", "explicit", "constexpr", "noexcept", "operator", "sizeof"}


def without_strings(line):
    return re.sub(r'"(\\.|[^"\\])*"', '""', line)


def names_of(code, scope):
    """The functions or members that a declaration declares."""
    code = re.sub(r"<[^<>;]*>", "", re.sub(r"<[^<>;]*>", "", code)).strip()
    if not code or code.startswith(("#", "using", "friend", "//", "}", "return", "static_assert", "extern template")):
        return []
    match = FUNCTION.search(code)
    if match and match.group(1) not in KEYWORDS:
        before = code[:match.start()]
        is_function = before.strip() or match.group(1) == scope
        if is_function and "=" not in before:
            return [match.group(1)] if match.group(1) != scope else ["__init__"]
    if not code.endswith(";"):
        return []
    code = re.sub(r"\{[^{}]*\}", "", re.sub(r"\([^()]*\)", "", code))
    return [m.group(1) for m in MEMBER.finditer(code)]


class Collector:
    def __init__(self):
        self.docs = {}
        self.stack = []  # (name of the scope or "", depth of braces outside it)

    def path(self, name):
        return ".".join([scope for scope, _ in self.stack if scope] + [name])

    def add(self, name, text):
        text = " ".join(text.split()) if "|" not in text else text
        if not text:
            return
        known = self.docs.setdefault(self.path(name), [])
        if text not in known:
            known.append(text)

    def read(self, path):
        self.stack, depth, comment, code = [], 0, [], ""
        for line in open(path, encoding="utf-8"):
            line = line.rstrip()
            bare = line.strip()
            if bare.startswith("///<"):  # continues the one before
                continue
            if bare.startswith("///"):
                comment.append(bare[3:].strip() if not bare.startswith("/// |") else bare[4:])
                continue
            if bare.startswith("//") or not bare:
                if not bare:
                    comment = comment if code else []
                continue
            text, _, behind = without_strings(line).partition("///<")
            text = text.partition("//")[0]
            scope = SCOPE.match(text) if not code else None
            namespace = NAMESPACE.match(text)
            code += " " + text.strip()
            owner = next((name for name, _ in reversed(self.stack) if name), "")
            if scope:
                self.add(scope.group(1), "\n".join(comment))
                if "}" not in text:
                    self.stack.append((scope.group(1), depth))
                comment, code = [], ""
            elif namespace:
                inner = namespace.group(1).split("::")[-1]
                self.stack.append((inner if inner in ("joint", "material", "host") else "", depth))
                code = ""
            elif text.rstrip().endswith((";", "{", "}", ",")) and code.count("(") == code.count(")"):
                enumerator = re.match(r"^\s*(\w+)\s*(?:=[^,]*)?,?\s*$", text)
                names = [enumerator.group(1)] if enumerator and owner else names_of(code, owner)
                for name in names:
                    self.add(name, "\n".join(comment) + " " + behind.strip())
                if text.rstrip().endswith(","):
                    comment = []
                comment, code = [], ""
            depth += text.count("{") - text.count("}")
            while self.stack and depth <= self.stack[-1][1]:
                self.stack.pop()


def literal(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def main():
    output, headers = sys.argv[1], sys.argv[2:]
    collector = Collector()
    for header in headers:
        collector.read(header)
    for name, text in MORE.items():
        collector.docs.setdefault(name, [text])
    rows = "\n".join(f"    {{{literal(name)}, {literal(chr(10).join(texts))}}},"
                     for name, texts in sorted(collector.docs.items()))
    with open(output, "w", encoding="utf-8") as file:
        file.write(f"""// Generated by header_docs.py from the headers.
#include "python/docs.h"

#include <algorithm>
#include <iterator>

namespace souple::python {{
namespace {{

struct Row {{
  std::string_view name;
  const char* text;
}};
constexpr Row rows[] = {{
{rows}
}};

}}  // namespace

const char* doc(std::string_view name) {{
  if (name.ends_with('_')) name.remove_suffix(1);  // except_: "except" is a word of Python
  const Row* const row = std::lower_bound(std::begin(rows), std::end(rows), name,
                                          [](const Row& a, std::string_view b) {{ return a.name < b; }});
  return row != std::end(rows) && row->name == name ? row->text : "";
}}

}}  // namespace souple::python
""")


if __name__ == "__main__":
    main()
