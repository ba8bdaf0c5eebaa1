"""Reads GLB and USDA, as `souple convert` writes them, and compares them with the run that they were made of. It checks what
the formats demand of every file: alignment, bounds of accessors, indices in range."""

import array
import ast
import json
import re
import struct
from pathlib import Path

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


class Glb:
    def __init__(self, path):
        data = Path(path).read_bytes()
        magic, version, size, json_size, kind = struct.unpack_from("<4sIII4s", data)
        check(magic == b"glTF" and version == 2 and size == len(data) and kind == b"JSON", "header")
        check(json_size % 4 == 0 and size % 4 == 0, "chunks are padded")
        self.json = json.loads(data[20:20 + json_size])
        self.data = b""
        if size > 20 + json_size:
            bin_size, kind = struct.unpack_from("<I4s", data, 20 + json_size)
            check(kind == b"BIN\0" and bin_size % 4 == 0, "binary chunk")
            self.data = data[28 + json_size:]
            check(len(self.data) == bin_size, "the binary chunk ends the file")
            buffer = self.json["buffers"][0]["byteLength"]
            check(buffer <= bin_size < buffer + 4, "length of the buffer")
        self.read = [self._accessor(a) for a in self.json.get("accessors", [])]

    def _accessor(self, accessor):
        width = COMPONENTS[accessor["type"]]
        code = {5126: "f", 5125: "I"}[accessor["componentType"]]
        count = accessor["count"]
        check(count >= 1, "accessors are not empty")
        if "bufferView" not in accessor:
            values = array.array(code, bytes(4 * width * count))
        else:
            view = self.json["bufferViews"][accessor["bufferView"]]
            check(view["byteOffset"] % 4 == 0 and view["byteLength"] == 4 * width * count, "bufferView")
            check(view["byteOffset"] + view["byteLength"] <= len(self.data), "bufferView lies in the buffer")
            values = array.array(code, self.data[view["byteOffset"]:view["byteOffset"] + view["byteLength"]])
        if "min" in accessor:
            for i in range(width):
                check(min(values[i::width]) == accessor["min"][i] and max(values[i::width]) == accessor["max"][i],
                      "bounds of an accessor")
        if width == 1:
            return list(values)
        return [tuple(values[i:i + width]) for i in range(0, len(values), width)]

    def nodes(self):
        """By name: primitives with the values of their attributes, and per frame the positions."""
        result = {}
        for index, node in enumerate(self.json.get("nodes", [])):
            mesh = self.json["meshes"][node["mesh"]]
            check(node["name"] not in result, "names differ")
            result[node["name"]] = {"primitives": [self._primitive(p) for p in mesh["primitives"]],
                                    "frames": self._frames(index, mesh)}
        return result

    def _primitive(self, primitive):
        attributes = {name: self.read[a] for name, a in primitive["attributes"].items()}
        count = len(attributes["POSITION"])
        for values in attributes.values():
            check(len(values) == count, "attributes have as many values")
        bounds = self.json["accessors"][primitive["attributes"]["POSITION"]]
        check("min" in bounds and "max" in bounds, "positions have bounds")
        for n in attributes.get("NORMAL", []):
            check(abs(sum(c * c for c in n) - 1) < 1e-4, "normals are unit vectors")
        indices = self.read[primitive["indices"]] if "indices" in primitive else None
        if indices:
            check(max(indices) < count and len(indices) % 3 == 0, "indices")
        for target in primitive.get("targets", []):
            for accessor in target.values():
                check(len(self.read[accessor]) == count, "targets have as many values")
            check("min" in self.json["accessors"][target["POSITION"]], "targets have bounds")
        material = self.json["materials"][primitive["material"]]
        return {"mode": primitive["mode"], "attributes": attributes, "indices": indices, "material": material}

    def _frames(self, node, mesh):
        """Seconds and positions of each key of the animation."""
        base = self.read[mesh["primitives"][0]["attributes"]["POSITION"]]
        channels = [c for a in self.json.get("animations", []) for c in a["channels"] if c["target"]["node"] == node]
        if not channels:
            return [(None, base)]
        sampler = self.json["animations"][0]["samplers"][channels[0]["sampler"]]
        times, weights = self.read[sampler["input"]], self.read[sampler["output"]]
        check(all(a < b for a, b in zip(times, times[1:])), "times ascend")
        targets = mesh["primitives"][0]["targets"]
        check(len(weights) == len(times) * len(targets), "a weight per key and target")
        check(all(p["targets"] == targets for p in mesh["primitives"]), "primitives share targets")
        frames = []
        for k, time in enumerate(times):
            shown = [(t, w) for t, w in zip(targets, weights[k * len(targets):(k + 1) * len(targets)]) if w]
            positions = base
            for target, weight in shown:
                positions = [tuple(a + weight * b for a, b in zip(x, d))
                             for x, d in zip(positions, self.read[target["POSITION"]])]
            frames.append((time, positions))
        return frames


def check(condition, what):
    if not condition:
        raise AssertionError(what)


def usda(path):
    """Prims by path: attributes by name. An attribute with time samples is a dict by time code. Metadata is in "(text)"."""
    prims, stack, samples = {}, [], None
    text = Path(path).read_text()
    check(text.startswith("#usda 1.0\n"), "header")
    lines = iter(text.splitlines())
    pending = None
    for line in lines:
        word = line.strip()
        head = re.match(r'(def|over) ?(\w*) "([^"]+)"( \()?$', word)
        if head:
            pending = {"(type)": head[2]}
            if head[4]:
                block = []
                for inner in lines:
                    if inner.strip() == ")":
                        break
                    block.append(inner)
                pending["(text)"] = "\n".join(block)
            prims["/".join([p for p, _ in stack] + [head[3]])] = pending
            name = head[3]
        elif word == "{" and pending is not None:
            stack.append((name, pending))
            pending = None
        elif word == "}" and samples is not None:
            samples = None
        elif word == "}":
            stack.pop()
        elif samples is not None:
            time, value = word.rstrip(",").split(": ", 1)
            check(float(time) not in samples, "one sample per time code")
            samples[float(time)] = parsed(value)
        elif " = " in word and stack:
            declaration, value = word.split(" = ", 1)
            attribute = declaration.split()[-1]
            if value == "{":
                samples = stack[-1][1].setdefault(attribute.removesuffix(".timeSamples"), {})
            else:
                stack[-1][1][attribute] = parsed(value.removesuffix(" ("))
    check(not stack, "braces")
    return prims


def stage_metadata(path):
    head = Path(path).read_text().split("\n)\n", 1)[0]
    return dict(re.findall(r"^    (\w+) = (.+)$", head, re.M))


def parsed(value):
    try:
        return ast.literal_eval(value)
    except (ValueError, SyntaxError):
        return value


def at(value, frame):
    """The value of an attribute at a time code with a sample, or between two that are equal."""
    if not isinstance(value, dict):
        return value
    if frame in value:
        return value[frame]
    before, after = max(t for t in value if t < frame), min(t for t in value if t > frame)
    check(value[before] == value[after], "no sample where the value changes")
    return value[before]


def pc2_frame(path, frame):
    data = Path(path).read_bytes()
    points = struct.unpack_from("<i", data, 16)[0]
    values = array.array("f", data[32 + 12 * points * (frame - 1):32 + 12 * points * frame])
    return [tuple(values[i:i + 3]) for i in range(0, len(values), 3)]


def ply_frame(path):
    head, body = Path(path).read_bytes().split(b"end_header\n", 1)
    count = int(re.search(rb"element vertex (\d+)", head)[1])
    row = "<" + "".join({b"float": "f", b"uchar": "B"}[kind] for kind in re.findall(rb"property (float|uchar) \w+", head))
    size = struct.calcsize(row)
    return [struct.unpack_from(row, body, size * i) for i in range(count)]


class Obj:
    def __init__(self, path):
        self.uvs, self.faces, self.face_uvs, self.materials = [], [], [], []
        material = None
        for line in Path(path).read_text().splitlines():
            words = line.split()
            if line.startswith("vt "):
                self.uvs.append(tuple(map(float, words[1:3])))
            elif line.startswith("usemtl "):
                material = words[1]
            elif line.startswith("f "):
                corners = [w.split("/") for w in words[1:]]
                self.faces.append([int(c[0]) - 1 for c in corners])
                self.face_uvs.append([self.uvs[int(c[1]) - 1] if len(c) > 1 and c[1] else None for c in corners])
                self.materials.append(material)

    def triangles(self):
        """Corners of the triangles as (vertex, UV), in sorted order."""
        result = []
        for face, uvs in zip(self.faces, self.face_uvs):
            corners = list(zip(face, uvs))
            result += [(corners[0], a, b) for a, b in zip(corners[1:], corners[2:])]
        return sorted(result)


class Run:
    """Contents of a run's folder for each object in one frame."""

    def __init__(self, folder, frame):
        self.folder, self.frame = Path(folder), frame
        self.manifest = json.loads((self.folder / "run.json").read_text())
        self.objects = {o["name"]: self._object(o) for o in self.manifest["objects"]}

    def _object(self, item):
        files = {(f["format"], f["frames"] > 0): f for f in item["files"]}
        result = {"kind": item["kind"], "mesh": None}
        if ("pc2", True) in files:
            result["positions"] = pc2_frame(self.folder / files[("pc2", True)]["path"], self.frame)
            if item["topology"]["triangles"] > 0:
                result["mesh"] = Obj(self.folder / files[("obj", False)]["path"])
        else:
            first = files[("ply", True)]["path"]
            rows = ply_frame(self.folder / re.sub(r"\d+(?=\.ply$)", lambda m: f"{self.frame:0{len(m[0])}}", first))
            result["positions"] = [row[:3] for row in rows]
            result["velocities"] = [row[3:6] for row in rows]
            result["kinds"] = [row[6] for row in rows if len(row) > 6]
        return result

    def size(self, positions):
        spans = [max(c) - min(c) for c in zip(*positions)]
        return max(spans, default=0) or 1


def compare_points(found, expected, size, what):
    check(len(found) == len(expected), f"{what}: {len(found)} points, expected {len(expected)}")
    worst = max((abs(a - b) for x, y in zip(found, expected) for a, b in zip(x, y)), default=0)
    check(worst <= 1e-6 * size, f"{what}: positions differ by {worst} m in {size} m")


def compare_glb(path, run, frame=None):
    """The frame of the run that a .glb shows: the only one, or the last of its animation."""
    glb = Glb(path)
    nodes = glb.nodes()
    present = {name: o for name, o in run.objects.items() if o["positions"]}
    check(sorted(nodes) == sorted(present), f"objects {sorted(nodes)}, expected {sorted(present)}")
    for name, expected in present.items():
        node = nodes[name]
        attributes = node["primitives"][0]["attributes"]
        shown = node["frames"][-1][1]
        source = [int(i) for i in attributes.get("_SOUPLE_VERTEX", range(len(shown)))]
        check(sorted(set(source)) == list(range(len(expected["positions"]))), f"{name}: all vertices are there")
        truth = expected["positions"]
        # Sums of two floats are exact to the digits of the larger one.
        size = max(run.size(truth), max(abs(c) for x in truth for c in x))
        compare_points(shown, [truth[i] for i in source], size, name)
        if expected["mesh"] is None:
            check(node["primitives"][0]["mode"] == (3 if expected["kind"] == "rope" and len(truth) > 1 else 0), name)
            continue
        uvs = attributes.get("TEXCOORD_0")
        triangles = []
        for primitive in node["primitives"]:
            check(primitive["mode"] == 4, name)
            i = primitive["indices"]
            triangles += [tuple((source[v], uvs and (uvs[v][0], 1 - uvs[v][1])) for v in i[k:k + 3])
                          for k in range(0, len(i), 3)]
        compare_triangles(triangles, expected["mesh"].triangles(), name)
    return glb


def compare_triangles(found, expected, name):
    found = sorted(found, key=lambda t: [c[0] for c in t])
    expected = sorted(expected, key=lambda t: [c[0] for c in t])
    check([[c[0] for c in t] for t in found] == [[c[0] for c in t] for t in expected], f"{name}: triangles differ")
    for a, b in zip(found, expected):
        for (_, uv), (_, other) in zip(a, b):
            if other is not None:
                check(max(abs(uv[0] - other[0]), abs(uv[1] - other[1])) <= 1e-6, f"{name}: UVs differ")


def compare_usda(path, run):
    """A stage, or what a clip's file adds to it, in the run's frame."""
    path, frame = Path(path), run.frame
    prims = usda(path)
    root = next(iter(prims))
    clips = re.search(r"assetPaths = \[(.*)\]", prims[root].get("(text)", ""))
    if clips:
        clip = path.parent / re.findall(r"@\./(.*?)@", clips[1])[frame - 1]
        for prim, attributes in usda(clip).items():
            prims[prim].update({k: v for k, v in attributes.items() if not k.startswith("(")})
    for name, expected in run.objects.items():
        prim = prims[root + "/" + re.sub(r"^(?=\d)", "_", re.sub(r"\W", "_", name, flags=re.A))]
        points = at(prim["positions" if "positions" in prim else "points"], frame)
        size = run.size(expected["positions"])
        points = [tuple(array.array("f", x)) for x in points]  # texts are the shortest that read back to the float
        compare_points(points, expected["positions"], size, name)
        if points:
            lo, hi = [array.array("f", x) for x in at(prim["extent"], frame)]
            check(all(l <= c <= h for x in points for l, c, h in zip(lo, x, hi)), f"{name}: extent")
        if "velocities" in prim:
            check(len(at(prim["velocities"], frame)) == len(points), f"{name}: velocities")
        if expected["mesh"]:
            check(prim["(type)"] == "Mesh", name)
            compare_mesh(prim, frame, expected["mesh"], name)
    return prims


def compare_mesh(prim, frame, mesh, name):
    corners = iter(at(prim["faceVertexIndices"], frame))
    faces = [[next(corners) for _ in range(count)] for count in at(prim["faceVertexCounts"], frame)]
    check(faces == mesh.faces, f"{name}: faces differ")
    if not mesh.uvs:
        return
    indices = iter(prim["primvars:st:indices"]) if "primvars:st:indices" in prim else None
    for face, uvs in zip(faces, mesh.face_uvs):
        found = [prim["primvars:st"][next(indices) if indices else v] for v in face]
        for uv, other in zip(found, uvs):
            check(other is None or max(abs(a - b) for a, b in zip(uv, other)) <= 1e-6, f"{name}: UVs differ")
