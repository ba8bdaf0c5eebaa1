#!/usr/bin/env python3
"""Blender's reading of Souple's files: test_blender.py PROGRAM SOURCE_FOLDER [unittest's arguments].

Blender runs without a window. Where it is not installed, the exit code is 77 and CTest skips the test."""

import array
import base64
import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import unittest

from cli_case import SOURCE, Case
from studio_files import Glb, Run, ply_frame

BLENDER = shutil.which("blender")
SKIPPED = 77
TOLERANCE = 1e-6  # m


def pc2_frames(path):
    data = path.read_bytes()
    points, samples = struct.unpack_from("<i", data, 16)[0], struct.unpack_from("<i", data, 28)[0]
    frames = [array.array("f", data[32 + 12 * points * k:32 + 12 * points * (k + 1)]) for k in range(samples)]
    return points, frames


def ply_points(path):
    return [c for row in ply_frame(path) for c in row[:3]]


def obj_points(path):
    return [float(c) for line in path.read_text().splitlines() if line.startswith("v ") for c in line.split()[1:4]]


def unpacked(text):
    return array.array("f", base64.b64decode(text))


def z_up(y_up):
    """Souple's axes in Blender's: (x, y, z) becomes (x, -z, y)."""
    return [c for i in range(0, len(y_up), 3) for c in (y_up[i], -y_up[i + 2], y_up[i + 1])]


class BlenderCase(Case):
    def blender(self, jobs):
        (self.folder / "jobs.json").write_text(json.dumps(jobs))
        done = subprocess.run([BLENDER, "--background", "--factory-startup", "--python-exit-code", "1", "--python",
                               str(SOURCE / "tests/app/blender_import.py"), "--", str(self.folder / "jobs.json"),
                               str(self.folder / "results.json")],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600,
                              # Blender finds its Python's packages by the first python3 of the path.
                              env=dict(os.environ, PATH="/usr/bin:/bin"))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        results = json.loads((self.folder / "results.json").read_text())
        for job, result in zip(jobs, results):
            self.assertNotIn("error", result, f"{job}\n{done.stdout[-3000:]}")
        return results

    def assert_close(self, found, expected, what):
        self.assertEqual(len(found), len(expected), what)
        worst = max((abs(a - b) for a, b in zip(found, expected)), default=0)
        self.assertLessEqual(worst, TOLERANCE, what)

    def write_scene(self, scene):
        return self.scene(scene, "scene.json")


class EveryScene(BlenderCase):
    """Three frames of every object of every shipped scene: imported as OBJ by both importers, moved by PC2 and MDD."""

    FRAMES = 3

    def jobs_of(self, out):
        """Jobs, and what each should show: per frame the coordinates in Souple's axes."""
        jobs, truths = [], []
        for item in json.loads((out / "run.json").read_text())["objects"]:
            files = {(f["format"], f["frames"] > 0): f for f in item["files"]}
            rest = files.get(("obj", False))
            if rest is None:
                ply = files[("ply", True)]
                if item["topology"]["points"] == 0:
                    continue  # emitters fill it later
                jobs.append({"kind": "import", "importer": "ply", "file": str(out / ply["path"])})
                truths.append([ply_points(out / ply["path"])])
                continue
            points, frames = pc2_frames(out / files[("pc2", True)]["path"])
            self.assertEqual(points, item["topology"]["points"], item["name"])
            for importer in "obj", "legacy obj":
                for cache in "pc2", "mdd":
                    jobs.append({"kind": "import", "importer": importer, "file": str(out / rest["path"]),
                                 "cache": str(out / files[(cache, True)]["path"]), "format": cache.upper(),
                                 "frames": list(range(1, self.FRAMES + 1))})
                    truths.append(frames)
        return jobs, truths

    def test_scenes(self):
        scenes = json.loads(self.souple("list", "--json").stdout)
        self.assertGreaterEqual(len(scenes), 28)
        jobs, truths, kinds = [], [], set()
        for scene in scenes:
            out = self.folder / scene["name"]
            self.souple("run", scene["name"], "--frames", self.FRAMES, "--write", "pc2,mdd", "--out", out, "--quiet")
            kinds |= {item["kind"] for item in json.loads((out / "run.json").read_text())["objects"]}
            more_jobs, more_truths = self.jobs_of(out)
            jobs += more_jobs
            truths += more_truths
        self.assertLessEqual({"cloth", "soft_body", "rope", "grains", "obstacle", "fluid"}, kinds)
        for job, truth, result in zip(jobs, truths, self.blender(jobs)):
            what = f"{job['importer']} of {job['file']}, {job.get('cache')}"
            for frame, expected in zip(result["frames"], truth):
                self.assert_close(unpacked(frame["local"]), expected, what)
                if job["importer"] != "ply":
                    self.assert_close(unpacked(frame["world"]), z_up(expected), what)


class BelowAParent(BlenderCase):
    """GLB of `souple convert`, and OBJ with PC2, in scenes of 24 and 60 frames a second. Objects are below an empty
    that is moved, turned and scaled."""

    SCENE = {"souple": 1, "frames": 4, "substeps": 4, "objects": [
        {"name": "flag", "kind": "cloth", "mesh": {"grid": {"columns": 9, "rows": 7, "size": 1}}, "color": "#ff0000",
         "pins": [{"vertices": [0, 8]}]},
        {"name": "rope", "kind": "rope", "points": [[1, 2, 0], [2, 2, 0]], "segments": 6, "pins": [{"vertices": [0]}]},
        {"name": "sand", "kind": "grains", "grid": {"counts": [3, 3, 3]}, "transform": {"translate": [0, 2, 0]}},
        {"name": "crate", "kind": "rigid_body", "mesh": {"box": {"size": [1, 1, 1]}},
         "transform": {"translate": [3, 2, 0]}, "angular_velocity": [1, 2, 3]},
        {"name": "jelly", "kind": "soft_body", "mesh": {"tet_bar": {"cells": [3, 3, 4], "size": [0.3, 0.3, 0.4]}},
         "transform": {"translate": [-2, 2, 0], "rotate": [10, 20, 30]}, "pins": [{"vertices": [0]}]}]}
    PARENT = {"location": [1, -2, 3], "rotation": [0.5, 1, -0.7], "scale": [2, 2, 0.5]}

    @staticmethod
    def placed(matrix, points):
        """Points in Souple's axes, flat, where the parent puts them."""
        local = z_up(points)
        return [sum(row[k] * x for k, x in enumerate(local[i:i + 3])) + row[3]
                for i in range(0, len(local), 3) for row in matrix[:3]]

    def test_pc2(self):
        jobs, truths = [], []
        for rate in 24, 60:
            out = self.folder / f"at{rate}"
            self.souple("run", self.write_scene(dict(self.SCENE, frame_rate=rate)), "--out", out, "--quiet")
            for name in "flag", "rope", "jelly", "crate":
                points, frames = pc2_frames(out / f"{name}.pc2")
                self.assertEqual(points, len(obj_points(out / f"{name}.obj")) // 3)
                jobs.append({"kind": "import", "importer": "obj", "file": str(out / f"{name}.obj"), "fps": rate,
                             "cache": str(out / f"{name}.pc2"), "format": "PC2", "frames": [1, 2, 4], **self.PARENT})
                truths.append([frames[k - 1] for k in (1, 2, 4)])
        self.assertLess(len(truths[2][0]) // 3, 4 * 4 * 5)  # without the vertices inside the bar
        for job, truth, result in zip(jobs, truths, self.blender(jobs)):
            for expected, frame in zip(truth, result["frames"]):
                worst = max(abs(a - b) for a, b in zip(unpacked(frame["world"]), self.placed(result["matrix"], expected)))
                self.assertLess(worst, TOLERANCE, job["file"])

    def test_glb(self):
        jobs, runs = [], []
        for rate in 24, 60:
            out = self.folder / f"at{rate}"
            self.souple("run", self.write_scene(dict(self.SCENE, frame_rate=rate)), "--out", out, "--quiet")
            for layout in "one", "frames":
                self.souple("convert", out, "--write", "glb", "--layout", layout, "--out", f"{out}_{layout}", "--quiet")
                file = f"at{rate}.glb" if layout == "one" else f"at{rate}_0004.glb"
                jobs.append({"kind": "glb", "file": str(self.folder / f"at{rate}_{layout}" / file), "fps": rate, **self.PARENT,
                             "frames": [1, 2, 4] if layout == "one" else [4]})
                runs.append(out)
        for job, out, result in zip(jobs, runs, self.blender(jobs)):
            self.assertEqual(sorted(result["objects"]), ["crate", "flag", "jelly", "rope", "sand"])
            self.check_objects(job, out, result)

    def check_objects(self, job, out, result):
        nodes, matrix = Glb(job["file"]).nodes(), result["matrix"]
        for name, found in result["objects"].items():
            primitive, = nodes[name]["primitives"]
            used = sorted(set(primitive["indices"] or range(len(primitive["attributes"]["POSITION"]))))
            source = primitive["attributes"].get("_SOUPLE_VERTEX", range(len(primitive["attributes"]["POSITION"])))
            for number, frame in zip(job["frames"], found["frames"]):
                truth = Run(out, number).objects[name]["positions"]
                world = self.placed(matrix, [c for v in used for c in truth[int(source[v])]])
                self.assertEqual(len(unpacked(frame["world"])), len(world), (job, name))
                worst = max(abs(a - b) for a, b in zip(unpacked(frame["world"]), world))
                self.assertLess(worst, TOLERANCE, (job, name, number))
        self.assertEqual([re.sub(r"\.\d+$", "", result["objects"][n]["materials"][0]) for n in ("flag", "crate")],
                         ["flag", "crate"])
        self.assertEqual((result["objects"]["flag"]["polygons"], result["objects"]["flag"]["uvs"]), (96, 1))
        self.assertEqual((result["objects"]["rope"]["edges"], result["objects"]["sand"]["polygons"]), (6, 0))


class Appearance(BlenderCase):
    """Materials, smooth and sharp edges and normals of a file are those of the object that comes back."""

    MODEL = """
import bpy
bpy.ops.mesh.primitive_monkey_add(size=1)
head = bpy.context.object
head.data.materials.append(bpy.data.materials.new("Red"))
head.data.materials.append(bpy.data.materials.new("Blue cloth"))
for number, polygon in enumerate(head.data.polygons):
    polygon.material_index = number % 2
    polygon.use_smooth = number % 3 != 0
bpy.ops.wm.obj_export(filepath={file!r}, export_smooth_groups=True)
"""

    def test_survives(self):
        model = str(self.folder / "head.obj")
        self.blender([{"kind": "script", "script": self.MODEL.format(file=model)}])
        scene = self.write_scene({"souple": 1, "frames": 3, "objects": [
            {"name": "head", "kind": "obstacle", "mesh": {"file": "head.obj"}}]})
        self.souple("run", scene, "--out", "out", "--write", "pc2,obj")
        files = [model, self.folder / "out/head.obj", self.folder / "out/head_0002.obj"]
        before, after, frame = self.blender(
            [{"kind": "import", "importer": "obj", "file": str(f), "normals": True} for f in files])
        for key in "materials", "material_of", "smooth", "custom_normals", "polygons", "sharp":
            if key == "materials":
                self.assertEqual([re.sub(r"\.\d+$", "", m) for m in before[key]],
                                 [re.sub(r"\.\d+$", "", m) for m in after[key]])
                continue
            self.assertEqual(before[key], after[key], key)
        self.assertEqual(len(set(before["material_of"])), 2)
        self.assertIn(True, before["smooth"])
        worst = max(abs(a - b) for x, y in zip(before["normals"], after["normals"]) for a, b in zip(x, y))
        self.assertLess(worst, 1e-3)
        # The frames have no normals of their own; Blender finds them from the smoothing groups.
        self.assertEqual((frame["smooth"], frame["material_of"]), (before["smooth"], before["material_of"]))


class OriginalObject(BlenderCase):
    """The cache on the object that was exported: Forward Z, Up -Y, Frame Start 1, location and rotation cleared."""

    def test_cache_fits(self):
        # As a soft body, the head is filled in spite of its open eyes.
        for kind in "cloth", "soft_body":
            self.compare(kind)

    def compare(self, kind):
        model = str(self.folder / "head.obj")
        self.blender([{"kind": "original", "file": model}])
        scene = self.write_scene({"souple": 1, "frames": 3, "objects": [
            {"name": "head", "kind": kind, "mesh": {"file": "head.obj"}, "velocity": [1, 2, 3]}]})
        if kind == "soft_body":
            self.assertIn("Closed 4 holes (", self.souple("check", scene).stdout)
        self.souple("run", scene, "--out", "out", "--write", "pc2,mdd")
        points, frames = pc2_frames(self.folder / "out/head.pc2")
        results = self.blender([{"kind": "original", "file": str(self.folder / "again.obj"), "format": cache.upper(),
                                 "cache": str(self.folder / "out" / f"head.{cache}"), "frames": [1, 2, 3],
                                 "settings": {"forward_axis": "POS_Z", "up_axis": "NEG_Y"}}
                                for cache in ("pc2", "mdd")])
        for result in results:
            self.assertEqual(result["vertices"], points)
            for frame, expected in zip(result["frames"], frames):
                self.assert_close(unpacked(frame["world"]), z_up(expected), "on the original")


class UnitsAndNames(BlenderCase):
    """FBX in centimeters, with Y or Z up, STL and PLY with Z up, and one object of a file of two."""

    MODEL = """
import bpy
bpy.ops.mesh.primitive_cube_add(size=1)
body = bpy.context.object
body.name = "Body"
body.scale = (0.5, 0.3, 1.8)
bpy.ops.object.transform_apply(scale=True)
bpy.ops.mesh.primitive_cube_add(size=1, location=(3, 0, 0))
bpy.context.object.name = "Shirt"
bpy.ops.wm.obj_export(filepath={folder!r} + "/two.obj")
bpy.ops.export_scene.fbx(filepath={folder!r} + "/two.fbx")
bpy.ops.export_scene.fbx(filepath={folder!r} + "/z_up.fbx", axis_forward="Y", axis_up="Z")
try:
    bpy.ops.export_scene.gltf(filepath={folder!r} + "/two.glb")
except RuntimeError:
    pass  # needs numpy, which Debian's Blender only recommends
bpy.data.objects.remove(bpy.data.objects["Shirt"])
bpy.ops.export_mesh.stl(filepath={folder!r} + "/one.stl")
bpy.ops.export_mesh.ply(filepath={folder!r} + "/one.ply")
"""

    def test_sizes(self):
        self.blender([{"kind": "script", "script": self.MODEL.format(folder=str(self.folder))}])
        has_assimp = "through assimp: yes" in self.souple("info").stdout
        meshes = [{"file": "two.obj", "node": "Body"}, {"file": "one.stl", "up": "z"}, {"file": "one.ply", "up": "z"}]
        if has_assimp:
            meshes += [{"file": name, "node": "Body"} for name in ("two.fbx", "z_up.fbx", "two.glb")
                       if (self.folder / name).exists()]
        for mesh in meshes:
            out = self.souple("check", self.write_scene({"souple": 1, "objects": [
                {"name": "body", "kind": "obstacle", "mesh": mesh}]})).stdout
            self.assertIn(", 12 triangles, 0.5 x 1.8 x 0.3 m", out, mesh)
        out = self.souple("check", self.write_scene({"souple": 1, "objects": [
            {"name": "both", "kind": "obstacle", "mesh": {"file": "two.obj"}}]})).stdout
        self.assertIn(", 24 triangles, 3.75 x 1.8 x 1 m", out)


class VertexPaint(BlenderCase):
    """White vertices are pinned, black ones free."""

    MODEL = """
import bpy
bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=1)
mesh = bpy.context.object.data
colors = mesh.color_attributes.new("weights", "FLOAT_COLOR", "POINT")
for vertex in mesh.vertices:
    white = 1.0 if vertex.co.y > 0.49 else 0.0
    colors.data[vertex.index].color = (white, white, white, 1)
bpy.ops.wm.obj_export(filepath={file!r}, export_colors=True)
"""

    def test_pins(self):
        self.blender([{"kind": "script", "script": self.MODEL.format(file=str(self.folder / "sheet.obj"))}])
        out = self.souple("check", self.write_scene({"souple": 1, "objects": [
            {"name": "sheet", "kind": "cloth", "mesh": {"file": "sheet.obj"},
             "maps": {"pin_weight": {"color": "red"}}}]})).stdout
        self.assertIn("81 vertices, 128 triangles, 9 pinned", out)


class Character(BlenderCase):
    """docs/blender.md, "Dress a character": the page's scene, with a body and a skirt that Blender animates."""

    MODEL = """
import addon_utils
import bpy
scene = bpy.context.scene
scene.frame_start, scene.frame_end = 1, 13
addon_utils.enable("io_shape_mdd")

def walk(name):
    obj = bpy.context.object
    obj.name = name
    bpy.ops.object.transform_apply(location=True)
    obj.keyframe_insert("location", frame=1)
    obj.location = (0.2, 0, 0)
    obj.keyframe_insert("location", frame=13)
    scene.frame_set(1)
    bpy.ops.wm.obj_export(filepath=f"{folder}/{{name}}.obj", export_selected_objects=True)
    bpy.ops.wm.obj_export(filepath=f"{folder}/{{name}}_walk.obj", export_selected_objects=True, export_animation=True,
                          start_frame=1, end_frame=13)
    bpy.ops.export_shape.mdd(filepath=f"{folder}/{{name}}.mdd", fps=24, frame_start=1, frame_end=13,
                             use_rest_frame=False)

bpy.ops.mesh.primitive_cylinder_add(radius=0.15, depth=1.2, vertices=24, location=(0, 0, 0.6))
walk("body")
bpy.ops.mesh.primitive_cone_add(radius1=0.35, radius2=0.17, depth=0.5, vertices=24, end_fill_type="NOTHING",
                                location=(0, 0, 0.75))
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.select_all(action="SELECT")
bpy.ops.mesh.subdivide(number_cuts=5)
bpy.ops.object.mode_set(mode="OBJECT")
walk("skirt")
"""

    def page_scene(self):
        page = (SOURCE / "docs/blender.md").read_text().split("## Dress a character")[1]
        return json.loads(re.search(r"```json\n(.*?)```", page, re.DOTALL)[1])

    def test_walks(self):
        model = self.MODEL.format(folder=self.folder)
        self.blender([{"kind": "script", "script": model}])
        scene = self.write_scene(self.page_scene())
        checked = self.souple("check", scene).stdout
        self.assertNotIn("first frame", checked)
        self.assertRegex(checked, r"skirt: cloth, .* pinned")
        done = self.souple("run", scene, "--out", "out", "--write", "pc2,obj")
        self.assertLess(float(re.search(r"largest strain ([\d.e+]+) %", done.stdout)[1]), 30, done.stdout)
        body = obj_points(self.folder / "out/body_0012.obj")
        self.assert_close(body[0::3], [x + 0.2 for x in obj_points(self.folder / "body.obj")[0::3]], "body")
        # Frame 12 of the run is Blender's frame 13, on the object that was exported.
        shown, = self.blender([{"kind": "scripted", "script": model, "cache": str(self.folder / "out/skirt.pc2"),
                                "format": "PC2", "frame_start": 2, "frames": [13],
                                "settings": {"forward_axis": "POS_Z", "up_axis": "NEG_Y"}}])
        skirt = obj_points(self.folder / "out/skirt_0012.obj")
        self.assert_close(unpacked(shown["frames"][0]["world"]), z_up(skirt), "skirt")
        self.assertLess(abs(sum(skirt[0::3]) / (len(skirt) / 3) - 0.2), 0.1)

    def test_other_axes_are_named(self):
        self.blender([{"kind": "script", "script": self.MODEL.format(folder=self.folder)}])
        scene = self.page_scene()
        del scene["objects"][0]["sequence"]["up"]
        name = self.write_scene(scene)
        remark = 'the first frame of body.mdd is the mesh rotated by 90 degrees; add "up": "z" to the sequence'
        self.assertIn(remark, self.souple("check", name).stdout)
        scene["frames"] = 1
        self.assertIn(remark, self.souple("run", self.write_scene(scene)).stderr)

    def test_sequence_of_obj_files(self):
        self.blender([{"kind": "script", "script": self.MODEL.format(folder=self.folder)}])
        scene = self.page_scene()
        ends = []
        for names in None, ("body_walk1.obj", "skirt_walk1.obj"):
            if names:
                scene["objects"][0]["sequence"] = {"file": names[0], "frame_rate": 24}
                scene["objects"][1]["pins"][0]["sequence"] = {"file": names[1], "frame_rate": 24}
            done = self.souple("run", self.write_scene(scene), "--out", "out", "--write", "obj")
            self.assertNotIn("first frame", done.stderr)
            ends.append(obj_points(self.folder / "out/body_0012.obj"))
        self.assert_close(ends[0], ends[1], "MDD and OBJ files")


class Rig(BlenderCase):
    """docs/files.md, "Characters from glTF": a skin of three bones below a moving parent, as Blender evaluates and exports it."""

    MODEL = """
import json
import bpy
try:
    import numpy
    numpy.bool = bool  # Debian's numpy is newer than Blender's exporter
except ImportError:
    pass
scene = bpy.context.scene
scene.render.fps, scene.frame_start, scene.frame_end = 24, 1, 25
bones = bpy.data.armatures.new("Rig")
rig = bpy.data.objects.new("Rig", bones)
scene.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
for i in range(3):
    bone = bones.edit_bones.new(f"b{i}")
    bone.head, bone.tail, bone.parent = (0, 0, i), (0, 0.05 * i, i + 1), bones.edit_bones.get(f"b{i - 1}")
bpy.ops.object.mode_set(mode="OBJECT")
rig.location, rig.rotation_euler, rig.scale = (1, 2, 0.5), (0.3, -0.2, 0.9), (1.5, 1.5, 1.5)
bpy.ops.mesh.primitive_cylinder_add(vertices=12, radius=0.3, depth=3, location=(0, 0, 1.5))
body = bpy.context.object
body.name = "Body"
bpy.ops.object.transform_apply(location=True)
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.select_all(action="SELECT")
bpy.ops.mesh.subdivide(number_cuts=4)
bpy.ops.object.mode_set(mode="OBJECT")
for i in range(3):
    group = body.vertex_groups.new(name=f"b{i}")
    for v in body.data.vertices:
        group.add([v.index], max(0, 1 - abs(v.co.z - (i + 0.5))), "REPLACE")
body.parent = rig
body.modifiers.new("Rig", "ARMATURE").object = rig
for frame, angle in ((1, 0), (9, 0.6), (17, -0.5), (25, 0.1)):
    for i in range(3):
        bone = rig.pose.bones[f"b{i}"]
        bone.rotation_mode = "XYZ"
        bone.rotation_euler, bone.location = (angle * (i + 1) / 2, angle * 0.3, angle * 0.7 * i), (0.05 * angle, 0.1 * angle, 0)
        bone.keyframe_insert("rotation_euler", frame=frame)
        bone.keyframe_insert("location", frame=frame)
    rig.location.y = 2 + angle
    rig.keyframe_insert("location", frame=frame)
bpy.ops.export_scene.gltf(filepath=FOLDER + "/rig.glb", export_frame_range=True)
bpy.ops.export_scene.fbx(filepath=FOLDER + "/rig.fbx", add_leaf_bones=False, bake_anim_simplify_factor=0)
shown = {}
for frame in (2, 13, 25):
    scene.frame_set(frame)
    mesh = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
    shown[frame] = [tuple(mesh.matrix_world @ v.co) for v in mesh.to_mesh().vertices]
json.dump(shown, open(FOLDER + "/shown.json", "w"))
"""

    # File: tolerance [m], and Blender's frame at its time 0. FBX holds degrees and centimeters as Blender rounds them.
    FILES = {"rig.glb": (5e-6, 0), "rig.fbx": (5e-5, 1)}

    def test_skin(self):
        if "through assimp: yes" not in self.souple("info").stdout:
            self.skipTest("built without assimp")
        self.blender([{"kind": "script", "script": self.MODEL.replace("FOLDER", repr(str(self.folder)))}])
        shown = json.loads((self.folder / "shown.json").read_text())
        for name, (tolerance, first) in self.FILES.items():
            with self.subTest(file=name):
                self.souple("run", self.write_scene({"souple": 1, "frame_rate": 24, "frames": 25, "objects": [
                    {"name": "body", "kind": "obstacle", "mesh": {"file": name, "node": "Body"},
                     "sequence": {"file": name, "frame_rate": 24}}]}), "--out", "out", "--write", "obj")
                for frame, expected in shown.items():
                    found = z_up(obj_points(self.folder / f"out/body_{int(frame) - first:04}.obj"))
                    points = [found[i:i + 3] for i in range(0, len(found), 3)]
                    worst = max(min(math.dist(p, x) for p in points) for x in expected)
                    self.assertLess(worst, tolerance, f"frame {frame}")


if __name__ == "__main__":
    if BLENDER is None:
        print("skipped: blender is not installed")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
