#!/usr/bin/env python3
"""Checks what each file may include: the floors of the architecture, and which outside library belongs where.

An include goes to a strictly lower floor or stays in its folder, and never in a circle. Three habits are refused as well:
`using namespace` in a header, std::to_string, and in the library the C library's elementary functions. Prints one line per violation and exits with 1 if there is any.
"""

import re

import checks

FLOORS = {
    "souple/math": 1,
    "souple/simd": 1.5, "souple/threads": 1.5,
    "souple/constraints": 2, "souple/state": 2, "souple/geometry": 2,
    "souple/solver": 3, "souple/multilevel": 3.4,
    "souple/collision": 4, "souple/broad_phase": 4.2, "souple/intersections": 4.4, "souple/contacts": 4.6,
    "souple/rigid": 4.7,
    "souple/objects": 4.8,
    "souple/fluid": 5,
    "souple/stages": 5.4, "souple/queries": 5.6, "souple/studies": 5.8,
    "souple/world": 6, "souple/surface": 6,
    "souple/files": 6.5, "souple/mesh_files": 6.7, "souple/io": 7, "render": 7,
    "souple/scene": 8,
    "souple/host": 8.5,
    "app": 9, "python": 9, "plugins": 9,
    "web": 9.5,
}
# Files that lie in souple/ itself.
SINGLE_FILES = {
    "souple/error.h": 0,
    "souple/assert.h": 0,
    "souple/version.h": 0,   # generated
    "souple/compiled_sets.h": 0,  # generated
    "souple/eigen.h": 7,     # optional adaptor
    "souple/souple.h": 8.5,  # everything, for users
}
# Code in a kernels folder is compiled for an instruction set or a device. It includes these and other kernels, nothing
# else. The headers named one by one are templates on the scalar, or small plain functions, of their folders.
KERNELS = "/kernels/"
KERNELS_MAY_INCLUDE = ("souple/math/", "souple/simd/instruction_sets.h", "souple/simd/pack.h", "souple/simd/registers.h",
                       "souple/constraints/", "souple/collision/nearest.h",
                       "souple/contacts/contact_law.h", "souple/fluid/smoothing_shape.h")
CONTAINERS = {"vector", "string", "map", "set", "unordered_map", "unordered_set", "deque", "list", "functional"}


def in_folder(path, *folders):
    return any(path.startswith(folder + "/") for folder in folders)


# (what is included, who may include it, the rule in words)
OUTSIDE = [
    (r"(unsupported/)?Eigen/", lambda p: p == "souple/eigen.h" or p.endswith(".cpp"), "Eigen only in .cpp files"),
    (r"nlohmann/", lambda p: p.endswith(".cpp") and in_folder(p, "souple/scene", "souple/io"),
     "nlohmann only in .cpp files of souple/scene and souple/io"),
    (r"fmt/", lambda p: p.endswith(".cpp") and in_folder(p, "souple", "render", "app", "web"),
     "fmt only in .cpp files of souple, render, app and web"),
    (r"CLI/", lambda p: p.endswith(".cpp") and in_folder(p, "app"), "CLI11 only in .cpp files of app"),
    (r"assimp/", lambda p: p.endswith(".cpp") and in_folder(p, "souple/mesh_files"),
     "assimp only in .cpp files of souple/mesh_files"),
    (r"openvdb/", lambda p: p == "app/vdb.cpp", "OpenVDB only in app/vdb.cpp"),
    (r"(GL|GLES\d?|GLFW|EGL|epoxy)/|imgui", lambda p: in_folder(p, "render", "app", "plugins"),
     "no renderer or window in the library"),
    (r"Python\.h|pybind11/", lambda p: in_folder(p, "python"), "no Python outside python"),
]

INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
USING_NAMESPACE = re.compile(r"^\s*using\s+namespace\b")
TO_STRING = re.compile(r"\bstd::to_string\b")
ELEMENTARY = re.compile(r"(?<!using )\bstd::(sin|cos|tan|asin|acos|atan2?|sinh|cosh|tanh|exp2?|expm1|log(2|10|1p)?|pow|cbrt|hypot)\(")


def is_kernel(path):
    """Whether a file is compiled for an instruction set. find_kernels chooses among them when the program runs."""
    return path.startswith("souple/") and KERNELS in path and "/find_kernels." not in path


def folder_of(path):
    """The architecture's folder a file belongs to, or None."""
    return next((folder for folder in FLOORS if path.startswith(folder + "/")), None)


def floor_of(path):
    folder = folder_of(path)
    return FLOORS[folder] if folder else SINGLE_FILES.get(path)


def check_own_include(path, target):
    if not (checks.ROOT / target).exists() and target not in ("souple/version.h", "souple/compiled_sets.h"):
        return f"no such file: {target}"
    here, there = floor_of(path), floor_of(target)
    if there is None:
        return f"{target} is on no floor: add its folder to script/check_floors.py"
    if here is None:
        return "this file is on no floor: add its folder to script/check_floors.py"
    if is_kernel(path) and not (target.startswith(KERNELS_MAY_INCLUDE) or is_kernel(target)):
        return f"a kernel includes {target}: only math, simd and constraints are allowed"
    same_folder = folder_of(path) is not None and folder_of(path) == folder_of(target)
    if not same_folder and there >= here:
        return f"floor {here} includes {target} on floor {there}: only lower floors or its own folder"
    return None


def check_outside_include(path, target):
    for pattern, allowed, rule in OUTSIDE:
        if re.match(pattern, target) and not allowed(path):
            return f"includes <{target}>: {rule}"
    if is_kernel(path) and target in CONTAINERS:
        return f"includes <{target}>: no containers in kernels"
    return None


def check_file(path, text, graph):
    problems = []
    for number, line in enumerate(text.splitlines(), 1):
        if path.endswith(".h") and USING_NAMESPACE.match(line):
            problems.append((number, "using namespace in a header"))
        if TO_STRING.search(line) and not in_folder(path, "plugins"):
            problems.append((number, "std::to_string writes 1e-9 as 0.000000: use fmt::format"))
        if ELEMENTARY.search(line) and in_folder(path, "souple"):
            problems.append((number, "results of the C library differ in the last bit: use souple/math/elementary.h"))
        match = INCLUDE.match(line)
        if not match:
            continue
        quote, target = match.groups()
        if target.startswith(("souple/", "render/", "app/", "python/", "plugins/", "web/")):
            graph.setdefault(path, []).append(target)
            problem = check_own_include(path, target)
        elif quote == '"':
            problem = f'includes "{target}": own files are named from the root, such as "souple/math/vec3.h"'
        else:
            problem = check_outside_include(path, target)
        if problem:
            problems.append((number, problem))
    return [f"{path}:{number}: {problem}" for number, problem in problems]


def find_circles(graph):
    """Each circle once, as the chain of files that closes it."""
    circles, done = [], set()

    def visit(path, chain):
        if path in chain:
            circles.append(" -> ".join(chain[chain.index(path):] + [path]))
            return
        if path in done:
            return
        for target in graph.get(path, []):
            visit(target, chain + [path])
        done.add(path)

    for path in sorted(graph):
        visit(path, [])
    return [f"includes go in a circle: {circle}" for circle in circles]


def main():
    files = checks.sources("souple", "render", "app", "python", "plugins", "web")
    graph = {}
    problems = [problem for path, text in files.items() for problem in check_file(path, text, graph)]
    checks.report(problems + find_circles(graph), f"{len(files)} files keep to their floors")


if __name__ == "__main__":
    main()
