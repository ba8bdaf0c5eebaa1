#!/usr/bin/env python3
"""`souple convert`: what its files hold, compared with the run, and what it says of bad input: test_cli_convert.py PROGRAM
SOURCE_FOLDER [unittest's arguments]."""

import itertools
import math
import resource
import shutil
import struct
import sys
import unittest

from cli_case import PROGRAM, SMALL, WATER, Case
from studio_files import Glb, Run, at, compare_glb, compare_usda, stage_metadata, usda

# A box of quads whose UVs have seams, with two materials and a group.
BOX = """mtllib box.mtl
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
vt 0 0
vt 0.25 0
vt 0.25 0.75
vt 0 0.75
g sides
usemtl Red
f 5/1 6/2 7/3 8/4
f 2/1 1/2 4/3 3/4
f 6/1 2/2 3/3 7/4
f 1/1 5/2 8/3 4/4
g top
usemtl Blue
f 8/1 7/2 3/3 4/4
g sides
f 1/1 2/2 6/3 5/4
"""

# Every kind of object but fluids, and names that are no identifiers.
MIXED = {
    "souple": 1, "frame_rate": 24, "frames": 4, "substeps": 4,
    "objects": [
        dict(SMALL["objects"][0], color="#ff8000"),
        SMALL["objects"][1],
        {"name": "a-rope-1", "kind": "rope", "points": [[1, 2, 0], [2, 2, 0]], "segments": 6,
         "pins": [{"vertices": [0]}]},
        {"name": "box", "kind": "rigid_body", "mesh": {"file": "box.obj"},
         "transform": {"translate": [0, 5, 0], "scale": 0.1}},
        {"name": "7stone", "kind": "obstacle", "mesh": {"box": {"size": [1, 1, 1]}},
         "transform": {"translate": [3, 0, 0]}},
        {"name": "jelly", "kind": "soft_body", "mesh": {"sphere": {"radius": 0.2, "subdivisions": 2}},
         "transform": {"translate": [-2, 3, 0]}},
    ],
}


class ConvertCase(Case):
    def run_of(self, description, *arguments):
        (self.folder / "box.obj").write_text(BOX)
        (self.folder / "box.mtl").write_text("newmtl Red\nKd 0.75 0.25 0\nd 0.5\nillum 2\n")
        self.souple("run", self.scene(description), "--out", "out", "--quiet", *arguments)
        return self.folder / "out"

    def convert(self, *arguments, code=0):
        return self.souple("convert", "out", *arguments, code=code)


class ConvertMixed(ConvertCase):
    def test_clip(self):
        out = self.run_of(MIXED)
        said = self.convert("--write", "glb,usda").stdout
        self.assertRegex(said, r"out_converted: out.glb, an animation of 4 frames, about [\d.]+ .?B\n")
        self.assertRegex(said, r"out_converted: out.usda, 4 frames, about [\d.]+ .?B\n")
        self.assertEqual([n for n in self.names() if n.startswith("out_converted/")],
                         ["out_converted/out.glb", "out_converted/out.usda"])
        run = Run(out, 4)
        glb = compare_glb(self.folder / "out_converted/out.glb", run)
        nodes = glb.nodes()
        for k, (time, _) in enumerate(nodes["flag"]["frames"]):
            self.assertAlmostEqual(time, (k + 1) / 24, places=6)
        red, green, blue, _ = nodes["flag"]["primitives"][0]["material"]["pbrMetallicRoughness"]["baseColorFactor"]
        self.assertAlmostEqual(red, 1, places=3)
        self.assertAlmostEqual(green, 0.2159, places=3)
        self.assertEqual(blue, 0)
        self.assertEqual([p["material"]["name"] for p in nodes["box"]["primitives"]], ["Red", "Blue"])
        red, blue = (p["material"] for p in nodes["box"]["primitives"])
        self.assertEqual((red["pbrMetallicRoughness"]["baseColorFactor"], red["alphaMode"]), ([0.75, 0.25, 0, 0.5], "BLEND"))
        self.assertNotIn("alphaMode", blue)  # its file does not define it
        self.assertGreater(len(nodes["box"]["primitives"][0]["attributes"]["POSITION"]), 8)
        self.assertNotIn("NORMAL", nodes["box"]["primitives"][0]["attributes"])
        self.assertIn("NORMAL", nodes["jelly"]["primitives"][0]["attributes"])
        self.assertEqual(nodes["sand"]["primitives"][0]["attributes"]["_RADIUS"][0], struct_float(0.01))
        # An obstacle at rest has no animation.
        self.assertEqual(len(nodes["7stone"]["frames"]), 1)

    def test_a_clip_moves_pins(self):
        """A clip that was written is read: a cloth whose vertices all follow it is where the run's cloth was."""
        out = self.run_of(MIXED)
        self.convert("--write", "glb")
        clip = {"file": "out_converted/out.glb", "frame_rate": 24}
        scene = self.scene({"souple": 1, "frame_rate": 24, "frames": 4, "objects": [
            {"name": "flag", "kind": "cloth", "mesh": {"file": "out_converted/out.glb", "node": "flag"},
             "pins": [{"all": True, "sequence": clip}]},
            {"name": "jelly", "kind": "obstacle", "mesh": {"file": "out_converted/out.glb", "node": "jelly"}, "sequence": clip}]})
        self.souple("run", scene, "--out", "again", "--quiet")
        for frame in 2, 4:
            first, again = Run(out, frame), Run(self.folder / "again", frame)
            for name in "flag", "jelly":
                found, expected = again.objects[name]["positions"], first.objects[name]["positions"]
                worst = max(min(math.dist(x, y) for y in found) for x in expected)
                self.assertLess(worst, 2e-6, f"{name}, frame {frame}")

    def test_stage(self):
        out = self.run_of(MIXED)
        self.convert("--write", "usda", "--out", "usd", "--quiet")
        path = self.folder / "usd/out.usda"
        meta = stage_metadata(path)
        self.assertEqual((meta["metersPerUnit"], meta["upAxis"], meta["timeCodesPerSecond"], meta["startTimeCode"],
                          meta["endTimeCode"]), ("1", '"Y"', "24", "1", "4"))
        for frame in 1, 4:
            prims = compare_usda(path, Run(out, frame))
        self.assertEqual(prims["out/a_rope_1"]["curveVertexCounts"], [7])
        self.assertEqual(prims["out/sand"]["(type)"], "PointInstancer")
        self.assertEqual(prims["out/sand/Grain"]["radius"], 0.01)
        self.assertIn('displayName = "7stone"', prims["out/_7stone"]["(text)"])
        self.assertEqual(prims["out/box/Red"]["indices"], [0, 1, 2, 3])
        self.assertEqual(prims["out/box/top"]["indices"], [4])
        self.assertEqual(prims["out/Materials/box_Red/Shader"]["inputs:diffuseColor"], (0.75, 0.25, 0))
        self.assertNotIsInstance(prims["out/_7stone"]["points"], dict)
        # Velocities are displacements between frames; the first frame has those until the second.
        flag = prims["out/flag"]
        for frame, (a, b) in {1: (1, 2), 2: (1, 2), 4: (3, 4)}.items():
            for x, y, v in zip(flag["points"][a], flag["points"][b], at(flag["velocities"], frame)):
                for i in range(3):
                    self.assertAlmostEqual((y[i] - x[i]) * 24, v[i], places=4)

    def test_file_per_frame(self):
        out = self.run_of(MIXED)
        self.convert("--write", "usda,glb")
        said = self.convert("--write", "glb,usda", "--layout", "frames").stdout
        self.assertIn("out_0001.glb, ..., a file for each of 4 frames", said)
        self.assertIn("a value clip for each of 4 frames", said)
        written = [n.removeprefix("out_converted/") for n in self.names() if n.startswith("out_converted/")]
        self.assertEqual(written, sorted([f"out_000{k}.glb" for k in (1, 2, 3, 4)] + ["out.usda", "out_clips", "out_manifest.usda"]
                                         + [f"out_clips/out_000{k}.usda" for k in (1, 2, 3, 4)]))
        for frame in 1, 4:
            run = Run(out, frame)
            glb = compare_glb(self.folder / f"out_converted/out_000{frame}.glb", run)
            self.assertEqual(glb.json["scenes"][0]["extras"]["frame"], frame)
            self.assertIn("_VELOCITY", glb.nodes()["flag"]["primitives"][0]["attributes"])
            compare_usda(self.folder / "out_converted/out.usda", run)
        clip = usda(self.folder / "out_converted/out_clips/out_0003.usda")
        self.assertEqual(list(clip["out/flag"]["points"]), [3.0])
        declared = usda(self.folder / "out_converted/out_manifest.usda")
        self.assertEqual(list(declared), list(clip))
        # One file replaces the many.
        self.convert("--write", "glb,usda", "--layout", "one")
        written = [n.removeprefix("out_converted/") for n in self.names() if n.startswith("out_converted/")]
        self.assertEqual(written, ["out.glb", "out.usda"])


class ConvertParticles(ConvertCase):
    def test_water(self):
        out = self.run_of(WATER, "--frames", "12")
        self.convert("--write", "glb,usda")
        for frame in 1, 12:
            run = Run(out, frame)
            glb = compare_glb(self.folder / f"out_converted/out_{frame:04}.glb", run)
            prims = compare_usda(self.folder / "out_converted/out.usda", run)
            block = glb.nodes()["block"]["primitives"][0]["attributes"]
            for found in block["_VELOCITY"], at(prims["out/block"]["velocities"], frame):
                for v, w in zip(found, run.objects["block"]["velocities"]):
                    for a, b in zip(v, w):
                        self.assertAlmostEqual(a, b, places=4)
            self.assertAlmostEqual(block["_RADIUS"][0], 0.025)
        # The tap drips later; its points are more and more.
        tap = prims["out/tap"]["points"]
        self.assertEqual(tap[1.0], [])
        self.assertGreater(len(tap[12.0]), 0)
        self.assertIn("--layout one: out has objects whose points or triangles change",
                      self.convert("--write", "glb", "--layout", "one", code=2).stderr)

    def test_foam(self):
        # Water thrown at a wall.
        out = self.run_of({"souple": 1, "frames": 12, "substeps": 4, "objects": [
            {"name": "water", "kind": "fluid", "box": {"lo": [-0.25, 0, -0.15], "hi": [0.15, 0.2, 0.15]},
             "material": {"spacing": 0.05, "foam": 1}, "velocity": [4, 0, 0]}], "colliders": [
            {"name": "floor", "shape": {"plane": {}}},
            {"name": "wall", "shape": {"plane": {"normal": [-1, 0, 0], "offset": -0.3}}}]})
        self.convert("--write", "glb,usda", "--quiet")
        run = Run(out, 12)
        kinds = run.objects["foam"]["kinds"]
        self.assertGreater(len(set(kinds)), 1)
        foam = compare_glb(self.folder / "out_converted/out_0012.glb", run).nodes()["foam"]["primitives"][0]
        self.assertEqual(foam["attributes"]["_FOAM_KIND"], kinds)
        prims = compare_usda(self.folder / "out_converted/out.usda", run)
        self.assertEqual(prims["out/foam"]["protoIndices"][12.0], kinds)
        self.assertEqual(prims["out/foam"]["prototypes"], "[</out/foam/Spray>, </out/foam/Foam>, </out/foam/Bubble>]")

    def test_surfaces_with_changing_triangles(self):
        self.run_of(WATER, "--frames", "6", "--surface", "isotropic")
        self.souple("convert", "out_surface", "--write", "glb,usda", "--quiet")
        folder = self.folder / "out_surface_converted"
        first, last = (Glb(folder / f"out_surface_000{k}.glb").nodes()["block"] for k in (1, 6))
        self.assertNotEqual(first["primitives"][0]["indices"], last["primitives"][0]["indices"])
        prim = usda(folder / "out_surface.usda")["out_surface/block"]
        for frame in range(1, 7):
            corners = at(prim["faceVertexIndices"], frame)
            self.assertEqual(sum(at(prim["faceVertexCounts"], frame)), len(corners))
            self.assertLess(max(corners), len(at(prim["points"], frame)))

    def test_surfaces_have_velocities(self):
        """A block of water that flies sideways without gravity: so does each vertex of its surface."""
        self.run_of({"souple": 1, "frames": 3, "substeps": 4, "gravity": [0, 0, 0], "objects": [
            {"name": "water", "kind": "fluid", "box": {"lo": [0, 0, 0], "hi": [0.3, 0.3, 0.3]},
             "material": {"spacing": 0.05}, "velocity": [2, 0, 1]}]})
        self.souple("surface", "out", "--format", "ply", "--quiet")
        self.souple("convert", "out_surface", "--write", "glb,usda", "--quiet")
        folder = self.folder / "out_surface_converted"
        shown = Glb(folder / "out_surface_0003.glb").nodes()["water"]["primitives"][0]["attributes"]
        prim = usda(folder / "out_surface.usda")["out_surface/water"]
        for points, velocities in ((shown["POSITION"], shown["_VELOCITY"]), (at(prim["points"], 3), at(prim["velocities"], 3))):
            self.assertEqual(len(points), len(velocities))
            self.assertGreater(len(points), 100)
            for velocity in velocities:
                self.assertLess(math.dist(velocity, (2, 0, 1)), 0.1)


class ConvertBadInput(ConvertCase):
    def says(self, code, text, *arguments):
        done = self.souple("convert", *arguments, code=code)
        self.assertIn(text, done.stderr)
        self.assert_one_line(done.stderr)

    def test_sentences(self):
        self.says(2, "there is no such folder; expected the folder of a run", "nowhere", "--write", "glb")
        (self.folder / "empty").mkdir()
        self.says(2, "the folder has no run.json; expected the folder of a run", "empty", "--write", "glb")
        self.run_of(dict(SMALL, frames=2))
        self.says(2, "--write is needed: expected glb, usda, or both", "out")
        self.says(2, '--write "gltf": expected one of glb, usda', "out", "--write", "gltf")
        self.says(2, '--layout "many": expected one of auto, one, frames', "out", "--write", "glb", "--layout", "many")
        manifest = self.folder / "out/run.json"
        whole = manifest.read_text()
        manifest.write_text(whole.replace('"frames": 2', '"frames": 0'))
        (self.folder / "out/flag.pc2").unlink()
        done = self.souple("convert", "out", "--write", "glb", code=2)
        self.assert_one_line(done.stderr)
        self.assertFalse((self.folder / "out_converted").exists())

    def test_unfinished_run(self):
        out = self.run_of(dict(SMALL, frames=3))
        manifest = out / "run.json"
        manifest.write_text(manifest.read_text().replace('"complete": true', '"complete": false', 1))
        self.assertIn("out: is not finished; its 3 frames so far are converted", self.convert("--write", "glb").stdout)
        compare_glb(self.folder / "out_converted/out.glb", Run(out, 3))

    def test_full_disk(self):
        self.run_of(dict(SMALL, frames=8))
        for form, layout in itertools.product(("glb", "usda"), ("one", "frames")):
            def limit():
                resource.setrlimit(resource.RLIMIT_FSIZE, (2500, 2500))
            done = self.command(PROGRAM, "convert", "out", "--write", form, "--layout", layout, preexec_fn=limit)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assert_one_line(done.stderr)
            self.assertEqual([p for p in (self.folder / "out_converted").rglob("*") if p.is_file()], [])
            shutil.rmtree(self.folder / "out_converted")


def struct_float(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
