#!/usr/bin/env python3
"""Writes the seed files of every format: small, valid, and between them every feature that the readers know."""
import pathlib
import struct

here = pathlib.Path(__file__).resolve().parent


def write(name, data):
    path = here / name
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(data if isinstance(data, bytes) else data.encode())


square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
write("obj/square.obj", "# a square\nmtllib none.mtl\n" + square + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\ns 1\n"
      "o sheet\ng left right\nf 1/1/1 2/2/1 3/3/1\nusemtl silk\ng right\nf -4//1 3//-1 \\\n 4//1\n")
write("obj/colours.obj", "v 0 0 0 1 0.5 0\r\nv 1e-3 0 0 0 0 1\r\nv 1 1 +2.5\r\nv .5 1 0 1\r\nf 1 2 3 4\r\np 1 2\r\nl 1 3\r\n")

positions = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
elements = ("comment mine\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\nproperty float t\n"
            "element extra 1\nproperty list uchar short a\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n")
write("ply/ascii.ply", "ply\nformat ascii 1.0\n" + elements +
      "".join(f"{x} {y} {z} 255 0 51 0.5 0.25\n" for x, y, z in positions) + "2 1 2\n3 0 1 2\n4 0 1 2 3\n")
for order, mark in (("little", "<"), ("big", ">")):
    body = b"".join(struct.pack(mark + "ffd3Bff", x, y, z, 255, 0, 51, 0.5, 0.25) for x, y, z in positions)
    body += struct.pack(mark + "Bhh", 2, 1, 2) + struct.pack(mark + "B3i", 3, 0, 1, 2) + struct.pack(mark + "B4i", 4, 0, 1, 2, 3)
    write(f"ply/{order}.ply", f"ply\nformat binary_{order}_endian 1.0\n{elements}".encode() + body)

facet = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1.5 0\n endloop\nendfacet\n"
write("stl/ascii.stl", "solid one\n" + facet + facet + "endsolid one\nsolid two\n" + facet + "endsolid two\n")
write("stl/binary.stl", b"solid binary".ljust(80) + struct.pack("<I", 2) + 2 * struct.pack("<12fH", *range(12), 0))

names = "$PhysicalNames\n2\n3 1 \"body\"\n2 5 \"clamp\"\n$EndPhysicalNames\n"
write("msh/version2.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + names +
      "$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n7 1 1 1\n$EndNodes\n"
      "$Elements\n3\n1 2 2 5 1 10 20 30\n2 4 2 1 1 10 20 30 40\n3 4 2 9 1 20 7 40 30\n$EndElements\n")
write("msh/version4.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" + names +
      "$Entities\n1 0 1 2\n1 0 0 0 0\n3 0 0 0 1 1 0 1 5 0\n1 0 0 0 1 1 1 1 1 1 3\n2 0 0 0 1 1 1 0 0\n$EndEntities\n"
      "$Nodes\n2 5 7 40\n2 3 0 3\n10\n20\n30\n0 0 0\n1 0 0\n0 1 0\n3 1 0 2\n40\n7\n0 0 1\n1 1 1\n$EndNodes\n"
      "$Elements\n3 3 1 3\n2 3 2 1\n1 10 20 30\n3 1 4 1\n2 10 20 30 40\n3 2 4 1\n3 20 7 40 30\n$EndElements\n")

write("tetgen/one.txt", "# nodes\n5 3 1 0\n1 0 0 0 7\n2 1 0 0 7 # second\n3 0 1 0 7\n4 0 0 1 7\n5 1 1 1 7\n--- ele ---\n"
      "2 4 1\n1 1 2 3 4 5\n2 2 5 4 3 6\n")
write("tetgen/zero.txt", "4 3 0 1\n0 0 0 0 1\n1 1 0 0 1\n2 0 1 0 1\n3 0 0 1 1\n--- ele ---\n1 4 0\n0 0 1 2 3\n")

points = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1]
start = "# vtk DataFile Version 5.1\ntitle\n{}\nDATASET UNSTRUCTURED_GRID\n"
write("vtk/classic.vtk", start.format("ASCII") + "FIELD FieldData 1\ntime 1 1 double\n0.5\nPOINTS 5 double\n" +
      " ".join(map(str, points)) + "\nMETADATA\nINFORMATION 0\n\nCELLS 3 14\n3 0 1 2\n4 0 1 2 3\n4 1 4 3 2\n"
      "CELL_TYPES 3\n5\n10\n10\nPOINT_DATA 5\n")
write("vtk/offsets.vtk", start.format("ASCII") + "POINTS 5 float\n" + " ".join(map(str, points)) +
      "\nCELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 1 4 3 2\nCELL_TYPES 2\n10 10\n")
write("vtk/binary.vtk", start.format("BINARY").encode() + b"POINTS 5 float\n" + struct.pack(">15f", *points) +
      b"\nCELLS 2 10\n" + struct.pack(">10i", 4, 0, 1, 2, 3, 4, 1, 4, 3, 2) + b"\nCELL_TYPES 2\n" + struct.pack(">2i", 10, 10) + b"\n")

frames = [[i + f for i in range(9)] for f in range(3)]
write("pc2/three.pc2", b"POINTCACHE2\0" + struct.pack("<iiffi", 1, 3, 1, 1, 3) + b"".join(struct.pack("<9f", *f) for f in frames))
write("pc2/one.pc2", b"POINTCACHE2\0" + struct.pack("<iiffi", 1, 1, 0, 0.5, 1) + struct.pack("<3f", 1, 2, 3))
write("mdd/three.mdd", struct.pack(">ii3f", 3, 3, 0, 0.04, 0.08) + b"".join(struct.pack(">9f", *f) for f in frames))
write("mdd/one.mdd", struct.pack(">iif3f", 1, 1, 0, 1, 2, 3))


def fnv1a64(data):
    value = 0xcbf29ce484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001b3 % 2**64
    return value


def block(data):
    return struct.pack("<Q", len(data)) + data


def checkpoint(frame, scene, caches, state):
    payload = struct.pack("<Q", frame) + block(scene) + struct.pack("<Q", len(caches))
    payload += b"".join(block(path) + struct.pack("<Q", frames) for path, frames in caches) + block(state)
    header = struct.pack("<8sII16sQQQ", b"SOUPLECK", 1, 0, b"0.1.0", len(payload), fnv1a64(payload), 0)
    return header + struct.pack("<Q", fnv1a64(header)) + payload


write("checkpoint/full.bin", checkpoint(7, b'{"souple": 1}', [(b"cloth.pc2", 7), (b"cloth.mdd", 7)], bytes(range(24))))
write("checkpoint/empty.bin", checkpoint(0, b"", [], b""))

write("manifest/full.json", """{
"souple_run": 1,
"version": "0.1.0",
"complete": true,
"frame_rate": 24.0,
"frames": 3,
"scene": {"souple":1,"objects":[{"name":"drapé","kind":"cloth"}],"gravity":[0.0,-9.81,0.0]},
"settings": {"threads":2},
"objects": [
  {"name":"drapé","kind":"cloth","files":[{"format":"obj","path":"a/cloth.obj","frames":0},{"format":"pc2","path":"cloth.pc2","frames":3}],"topology":{"points":4,"triangles":2}},
  {"name":"sand","kind":"grains","files":[],"topology":{"points":9,"triangles":0}}
],
"notes": ["sand is \\"grainy\\""],
"reports": [
  {"frame":1,"time":0.041,"values":{"contacts":12.0,"largest_strain":null},"flags":[]},
  {"frame":3,"time":0.125,"values":{"residual.distance":1e-300},"flags":["strain"]}
],
"timings": [{"frame":1,"milliseconds":{"solve":1.25}},{"frame":3,"milliseconds":{"solve":1.5}}]
}
""")
write("manifest/empty.json", """{"souple_run":1,"version":"","complete":false,"frame_rate":60,"frames":0,"scene":null,
"settings":null,"objects":[],"notes":[],"reports":[],"timings":[]}
""")

scenes = here.parents[2] / "scenes"
for name in ("balloon", "everything_together", "stiff_boxes", "tablecloth"):
    write(f"scene/{name}.json", (scenes / f"{name}.json").read_bytes())
write("scene/words.json", """{
 "souple": 1, "frame_rate": 50, "frames": 100, "substeps": 7, "iterations": 3, "mode": "pbd",
 "integrator": "implicit_euler", "gravity": [0, -1.62, 0.5], "seed": 9007199254740991, "drag": 0.25, "measure_residuals": false,
 "camera": {"from": [2, 1.5, 3], "to": [0, 0.5, 0], "fov": 35},
 "wind": {"velocity": [2, 0, -1], "gust": 0.3, "gust_period": 4, "air_density": 1.1},
 "objects": [
  {"name": "flag", "kind": "cloth", "mesh": {"grid": {"columns": 80, "rows": 48, "size": 2.0, "diagonals": "one_way"}},
   "transform": {"translate": [0, 2, 0], "rotate": [90, 0, 0], "scale": 1.5}, "velocity": [1, 2, 3], "angular_velocity": [4, 5, 6],
   "pressure": -20, "enclosed_volume": {"factor": 1.5, "compliance": 1e-6}, "tethers": {"slack": 0.1},
   "material": {"preset": "silk", "areal_density": 0.08, "stretch": "membrane", "bending": "dihedral"},
   "pins": [{"in_box": [[-1.01, 1, -1], [-0.99, 3, 1]]}, {"nearest": [1, 2, 3], "about": [0, 1, 0], "loop": true,
             "keyframes": [{"time": 0}, {"time": 1, "translate": [1, 0, 0], "rotate": [0, 90, 0]}]}],
   "attachments": [{"vertices": [3, 1], "compliance": 0.001}]},
  {"name": "bar", "kind": "soft_body", "mesh": {"tet_bar": {"cells": [3, 2, 1], "size": [3, 2, 1]}},
   "material": {"young_modulus": 6e4, "poisson_ratio": 0.3, "model": "shape_matching"}},
  {"kind": "soft_body", "mesh": {"sphere": {"radius": 0.5, "subdivisions": 2}}, "lattice": {"cell_size": 0.1}},
  {"name": "line", "kind": "rope", "points": [[0, 1, 0], [1, 1, 0]], "segments": 40, "material": {"preset": "nylon", "radius": 0.006}},
  {"kind": "grains", "box": {"lo": [0, 0, 0], "hi": [1, 2, 3], "spacing": 0.3, "jitter": 0.5}}
 ],
 "colliders": [
  {"name": "floor", "shape": {"plane": {"normal": [0, 2, 0], "offset": 1}}, "friction": 0.75, "restitution": 0.5},
  {"shape": {"capsule": {"radius": 0.1, "half_height": 2, "center": [1, 0, 0]}},
   "keyframes": [{"time": 0, "translate": [0, 0.3, 0]}, {"time": 1}], "loop": true}],
 "pairs": [{"between": ["flag", "floor"], "friction": 0, "restitution": 1}],
 "connections": [{"from": {"object": "flag", "vertices": [0]}, "to": {"object": "line", "all": true}, "pairing": "nearest", "rest_length": 0, "compliance": 0.5}]
}
""")
