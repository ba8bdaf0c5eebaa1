#!/usr/bin/env python3
"""Tests of the souple program: test_cli.py PROGRAM SOURCE_FOLDER [unittest's arguments]."""

import contextlib
import json
import os
import pty
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = str(Path(sys.argv[1]).resolve()) if len(sys.argv) > 2 else ""
SOURCE = Path(sys.argv[2]).resolve() if len(sys.argv) > 2 else Path()

SMALL = {
    "souple": 1,
    "frames": 20,
    "substeps": 4,
    "objects": [
        {"name": "flag", "kind": "cloth", "mesh": {"grid": {"columns": 8, "rows": 6, "size": 1}},
         "transform": {"translate": [0, 1, 0]}, "pins": [{"vertices": [0, 7]}]},
        {"name": "sand", "kind": "grains", "grid": {"counts": [3, 3, 3], "jitter": 0.3},
         "transform": {"translate": [0, 2, 0]}},
    ],
    "colliders": [{"name": "floor", "shape": {"plane": {}}}],
    "wind": {"velocity": [2, 0, 0], "gust": 0.5},
}

# A block of water collapses beside a tap that starts to drip after a few frames.
WATER = {
    "souple": 1,
    "frames": 24,
    "substeps": 4,
    "objects": [
        SMALL["objects"][0],
        {"name": "block", "kind": "fluid", "box": {"lo": [-0.2, 0, -0.1], "hi": [0, 0.3, 0.1]},
         "material": {"preset": "water", "spacing": 0.05}},
        {"name": "tap", "kind": "fluid", "points": [], "max_particles": 200,
         "material": {"preset": "oil", "spacing": 0.05},
         "emitters": [{"position": [0.5, 0.6, 0], "direction": [0, -1, 0], "radius": 0.06, "speed": 2,
                       "start": 0.1}]},
    ],
    "colliders": [{"name": "floor", "shape": {"plane": {}}}],
}

# Explicit integration of a strong drag: speeds grow sixteenfold each substep.
EXPLODING = dict(SMALL, drag=10000, integrator="explicit_euler", frames=60)


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="souple-test-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.environment = {k: v for k, v in os.environ.items()
                            if k not in ("SOUPLE_SCENES", "SOUPLE_THREADS")}

    def scene(self, description, name="small.json"):
        path = self.folder / name
        path.write_text(description if isinstance(description, str) else json.dumps(description))
        return str(path)

    def souple(self, *arguments, code=0):
        done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, env=self.environment,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def limited(self, megabytes, *arguments):
        """Runs the program with a limit of its address space. Its return code is not checked."""
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        return subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, env=self.environment,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120,
                              preexec_fn=limit)

    def skip_sanitizers(self, why):
        """Skips the test where the program was built with a sanitizer: no such program starts in 4 GB."""
        if self.limited(4096, "--version").returncode != 0:
            self.skipTest(f"the program has a sanitizer, and {why}")

    def assert_one_line(self, text):
        self.assertEqual(text.count("\n"), 1, text)

    def names(self):
        return sorted(str(p.relative_to(self.folder)) for p in self.folder.rglob("*"))

    def contents(self, folder):
        """A run's files: bytes by name; run.json without its last part, the timings."""
        result = {}
        for path in sorted((self.folder / folder).rglob("*")):
            data = path.read_bytes()
            if path.name == "run.json":
                data = data.split(b'"timings"')[0]
            result[str(path.relative_to(self.folder / folder))] = data
        self.assertTrue(result, f"nothing in {folder}")
        return result

    def assert_same_contents(self, one, other):
        a, b = self.contents(one), self.contents(other)
        self.assertEqual(sorted(a), sorted(b))
        for name in a:
            self.assertTrue(a[name] == b[name], f"{name} differs between {one} and {other}")


class Talking(Case):
    def test_help_everywhere(self):
        for command in [], ["run"], ["render"], ["list"], ["check"], ["info"]:
            out = self.souple(*command, "--help").stdout
            self.assertIn("Usage", out)
            self.assertIn("Example", out)
        self.assertIn("Exit codes", self.souple("--help").stdout)
        for flag in ["--frames", "--out", "--write", "--threads", "--substeps", "--iterations", "--set", "--resume",
                     "--checkpoint-every", "--surface", "--picture", "--quiet", "--fps"]:
            self.assertIn(flag, self.souple("run", "--help").stdout)

    def test_version(self):
        self.assertRegex(self.souple("--version").stdout, r"^souple \d+\.\d+\.\d+\n$")

    def test_list(self):
        plain = self.souple("list").stdout
        scenes = json.loads(self.souple("list", "--json").stdout)
        self.assertGreaterEqual(len(scenes), 10)
        for scene in scenes:
            self.assertIn(scene["name"], plain)
            self.assertTrue(Path(scene["file"]).is_file())
            self.assertTrue(scene["description"])
            self.assertNotIn("(broken)", scene["description"])
        self.assertEqual([s["name"] for s in scenes], sorted(s["name"] for s in scenes))

    def test_scenes_of_ones_own(self):
        self.scene(dict(SMALL, description="mine"), "mine.json")
        self.environment["SOUPLE_SCENES"] = str(self.folder)
        self.assertRegex(self.souple("list").stdout, r"mine +mine\n")
        self.assertIn("the scene is valid", self.souple("check", "mine").stdout)

    def test_check(self):
        out = self.souple("check", self.scene(SMALL)).stdout
        self.assertIn("flag: cloth, 48 vertices, 70 triangles, 2 pinned", out)
        self.assertIn("sand: grains, 27 vertices", out)
        self.assertIn("floor: plane", out)
        self.assertEqual(self.names(), ["small.json"])

    def test_check_prints_sizes(self):
        scene = dict(SMALL, objects=SMALL["objects"] + [
            {"name": "ball", "kind": "soft_body", "mesh": {"sphere": {"radius": 0.5}},
             "material": {"density": 1000}, "lattice": {"cell_size": 0.2}},
            {"name": "bar", "kind": "soft_body",
             "mesh": {"tet_bar": {"cells": [2, 2, 2], "size": [0.2, 0.3, 0.4]}}}])
        out = self.souple("check", self.scene(scene)).stdout
        self.assertRegex(out, r"flag: cloth, .*, 1 x 0 x 0\.714 m, [\d.]+ kg")
        # A ball of 20 * 4^3 triangles encloses a little less than 4/3 pi 0.5^3 = 0.5236 m^3.
        found = re.search(r"ball: soft_body, .*lattice of (\d+) tets and (\d+) particles with cells of 0\.2 m, "
                          r"1 x 1 x 1 m, (5\d\d\.?\d*) kg", out)
        self.assertTrue(found, out)
        # Twelve tets a cube, and a layer around the ball.
        self.assertGreater(int(found[1]), 12 * 0.5236 / 0.2**3)
        self.assertGreater(float(found[3]), 515)
        self.assertRegex(out, r"bar: soft_body, .*, 40 tets, 0\.2 x 0\.3 x 0\.4 m")
        self.assertRegex(out, r"total: \d+ particles, [\d.]+ kg")

    def test_check_prints_sizes_of_colliders(self):
        shapes = [{"plane": {"normal": [0, 2, 0]}}, {"sphere": {"radius": 0.25}},
                  {"box": {"half_extents": [0.5, 1, 1.5]}}, {"capsule": {"radius": 0.1, "half_height": 0.4}},
                  {"cylinder": {"radius": 0.1, "half_height": 0.4}},
                  {"signed_distance_field": {"mesh": {"box": {"size": [0.2, 0.4, 0.6]}}, "spacing": 0.05}}]
        colliders = [{"name": f"c{i}", "shape": shape} for i, shape in enumerate(shapes)]
        colliders[0]["transform"] = {"rotate": [0, 0, 90]}
        colliders[1]["keyframes"] = [{"time": 0}, {"time": 1, "translate": [1, 0, 0]}]
        out = self.souple("check", self.scene({"souple": 1, "colliders": colliders})).stdout
        self.assertIn("colliders:\n  c0: plane, normal (-1, 0, 0)\n"
                      "  c1: sphere, radius 0.25 m, moving\n"
                      "  c2: box, 1 x 2 x 3 m\n"
                      "  c3: capsule, radius 0.1 m, length 1 m with its caps\n"
                      "  c4: cylinder, radius 0.1 m, length 0.8 m\n"
                      "  c5: signed_distance_field, 12 triangles, 0.2 x 0.4 x 0.6 m, spacing 0.05 m\n", out)

    def test_check_and_run_remark_on_a_huge_mesh(self):
        self.scene("v 0 0 0\nv 180 0 0\nv 0 60 0\nf 1 2 3\n", "big.obj")
        scene = self.scene({"souple": 1, "frames": 1,
                            "objects": [{"name": "man", "kind": "obstacle", "mesh": {"file": "big.obj"}}]})
        remark = 'man: is 180 m large; if it should not be, set "scale" of its mesh'
        self.assertIn(remark, self.souple("check", scene).stdout)
        self.assertIn("souple: " + remark, self.souple("run", scene).stderr)
        self.assertEqual(self.souple("run", scene, "--quiet").stderr, "")

    def test_check_every_shipped_scene(self):
        for scene in json.loads(self.souple("list", "--json").stdout):
            self.assertIn("the scene is valid", self.souple("check", scene["name"]).stdout)

    def test_info(self):
        out = self.souple("info").stdout
        for word in ["souple ", "compiler:", "assimp", "folders of scenes:", "threads: ", "oneTBB: "]:
            self.assertIn(word, out)

    def test_documents(self):
        self.assertEqual(self.souple("info", "--schema").stdout, (SOURCE / "docs/scene.schema.json").read_text())
        self.assertEqual(self.souple("info", "--scene-format").stdout, (SOURCE / "docs/scene-format.md").read_text())


class BadInput(Case):
    def refused(self, *arguments):
        before = self.names()
        done = self.souple(*arguments, code=2)
        self.assertEqual(self.names(), before, "something was left behind")
        self.assertEqual(done.stdout, "")
        return done.stderr

    def test_threads_of_the_environment(self):
        scene = self.scene(SMALL)
        self.environment["SOUPLE_THREADS"] = "3"
        self.assertIn("threads: 3;", self.souple("info").stdout)
        for bad in "0", "two", "2.5", "1025", "-1", "2 ":
            self.environment["SOUPLE_THREADS"] = bad
            said = self.refused("run", scene, "--out", "out")
            self.assert_one_line(said)
            self.assertIn(f"SOUPLE_THREADS is '{bad}'", said)
        self.souple("run", scene, "--out", "out", "--threads", "2")

    def test_flags(self):
        scene = self.scene(SMALL)
        self.assertIn("--frame", self.refused("run", scene, "--frame", "3"))
        self.refused("run", scene, "--frames", "many")
        self.refused("run", scene, "--frames", "-1")
        self.refused("run", scene, "--threads", "0")
        self.refused("run", scene, "--threads", "1025")
        self.assertIn("pc2", self.refused("run", scene, "--write", "pc3"))
        self.refused()
        self.refused("simulate", scene)
        self.refused("run", scene, "other")
        self.assertIn("SCENE", self.refused("run"))

    def test_slips_of_the_hand(self):
        for arguments, said in (
            ([], "expected a command: run, "),
            (["runn", "flag"], "runn: there is no such command"),
            (["--nope"], "--nope: there is no such option"),
            (["run", "flag", "--writ", "pc2"], "--writ: there is no such option"),
            (["list", "x"], "x: unexpected argument"),
            (["run", "flag", ""], ": unexpected argument"),
            (["run", "flag", "--frames", "-3"], "--frames = -3: expected a whole number"),
            (["run", "--resume", "nowhere"], "nowhere: no such folder"),
        ):
            result = subprocess.run([PROGRAM, *arguments], cwd=self.folder, capture_output=True, text=True,
                                    timeout=60, check=False)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertTrue(result.stderr.startswith("souple: " + said), result.stderr)
            self.assertEqual(os.listdir(self.folder), [])

    def test_unknown_scene(self):
        said = self.refused("run", "flga")
        self.assertIn('did you mean "flag"', said)
        self.assert_one_line(said)
        self.assertIn("no such file", self.refused("run", "no/such.json"))
        self.assertIn("no such file", self.refused("check", "such.json"))

    def test_mistake_in_a_scene(self):
        wrong = json.loads(json.dumps(SMALL))
        wrong["objects"][0]["material"] = {"densty": 0.3}
        for command in "run", "check":
            said = self.refused(command, self.scene(wrong))
            self.assert_one_line(said)
            self.assertIn("small.json: objects[0].material.densty: ", said)
            self.assertIn('did you mean "areal_density"', said)

    def test_mistake_that_only_building_finds(self):
        wrong = json.loads(json.dumps(SMALL))
        wrong["objects"][0]["pins"] = [{"vertices": [4711]}]
        said = self.refused("run", self.scene(wrong))
        self.assertIn("small.json: objects[0].pins[0]: ", said)
        self.assertIn("4711", said)
        self.assert_one_line(said)

    def test_damaged_mesh(self):
        (self.folder / "bad.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 x 0\nf 1 2 3\n")
        wrong = json.loads(json.dumps(SMALL))
        wrong["objects"][0]["mesh"] = {"file": "bad.obj"}
        said = self.refused("run", self.scene(wrong))
        self.assertIn("small.json: objects[0]", said)
        self.assertIn("bad.obj:3", said)
        self.assert_one_line(said)

    def test_set(self):
        scene = self.scene(SMALL)
        self.assertIn("substeps: expected a whole number", self.refused("run", scene, "--set", "substeps=0"))
        self.assertIn("substeps: expected a whole number", self.refused("run", scene, "--substeps", "0"))
        self.assertIn('did you mean "flag"', self.refused("run", scene, "--set", "objects.flga.velocity=[0,0,0]"))
        self.assertIn("PATH=VALUE", self.refused("run", scene, "--set", "substeps"))

    def test_out_is_a_file(self):
        scene = self.scene(SMALL)
        (self.folder / "file").write_text("mine")
        self.assertIn("file", self.refused("run", scene, "--out", "file"))
        self.assertEqual((self.folder / "file").read_text(), "mine")

    def test_resume(self):
        scene = self.scene(SMALL)
        (self.folder / "empty").mkdir()
        self.assertIn("no checkpoint", self.refused("run", "--resume", "empty"))
        self.assertIn("--resume", self.refused("run", scene, "--resume", "nowhere"))
        self.assertIn("--resume", self.refused("run", "--resume", "nowhere", "--set", "substeps=3"))
        (self.folder / "damaged").mkdir()
        (self.folder / "damaged/checkpoint.souple").write_bytes(b"not a checkpoint")
        self.assertIn("checkpoint.souple", self.refused("run", "--resume", "damaged"))


class Running(Case):
    def test_summary_in_a_pipe(self):
        done = self.souple("run", self.scene(SMALL), "--out", "out")
        self.assert_one_line(done.stdout)
        self.assertIn("small: 20 frames in ", done.stdout)
        self.assertIn("ms/frame", done.stdout)
        self.assertRegex(done.stdout, r"largest strain (\d+(\.\d+)?|less than 0\.01) %, in")
        self.assertNotIn("\r", done.stdout + done.stderr)
        self.assertNotIn("left", done.stderr)

    def test_quiet(self):
        done = self.souple("run", self.scene(SMALL), "--out", "out", "--quiet")
        self.assertEqual(done.stdout + done.stderr, "")

    def test_progress_on_a_terminal(self):
        try:
            main, other = pty.openpty()
        except OSError as error:  # a chroot without /dev/pts
            self.skipTest(f"no pseudo terminal here: {error}")
        run = subprocess.Popen([PROGRAM, "run", self.scene(SMALL), "--out", "out", "--frames", "100000"],
                               cwd=self.folder, stdout=subprocess.DEVNULL, stderr=other, env=self.environment)
        os.close(other)
        seen, stopped = b"", False
        while True:
            try:
                data = os.read(main, 4096)
            except OSError:
                break
            if not data:
                break
            seen += data
            if seen.count(b" left") >= 2 and not stopped:
                run.send_signal(signal.SIGTERM)
                stopped = True
        os.close(main)
        self.assertEqual(run.wait(60), 130)
        self.assertRegex(seen.decode(), r"small: frame \d+ of 100000, [\d.]+ ms/frame, .* left")

    def test_default_folder(self):
        self.souple("run", self.scene(SMALL), "--frames", "2")
        self.assertTrue((self.folder / "out/small/run.json").is_file())
        self.assertTrue((self.folder / "out/small/flag.pc2").is_file())
        self.assertFalse([n for n in self.names() if n.endswith(".part") or "checkpoint" in n])

    def test_formats(self):
        self.souple("run", self.scene(SMALL), "--frames", "3", "--out", "out", "--write", "pc2,mdd,obj,ply")
        names = self.names()
        for name in ["flag.obj", "flag.pc2", "flag.mdd", "flag_0001.obj", "flag_0003.obj", "sand_0003.ply"]:
            self.assertIn("out/" + name, names)
        self.assertNotIn("out/flag_0004.obj", names)

    def test_second_run_removes_the_files_of_the_first(self):
        scene = self.scene(SMALL)
        self.souple("run", scene, "--frames", "5", "--out", "out", "--write", "pc2,obj")
        (self.folder / "out/picture.png").write_text("mine")
        self.souple("run", scene, "--frames", "3", "--out", "out")
        self.souple("run", scene, "--frames", "3", "--out", "fresh")
        self.assertEqual(self.contents("out"), {**self.contents("fresh"), "picture.png": b"mine"})

    def test_frames_per_second(self):
        scene = self.scene(dict(SMALL, substeps=2))
        self.souple("run", scene, "--out", "a", "--fps", "24")
        manifest = json.loads((self.folder / "a/run.json").read_text())
        # 20 frames of 1/60 s are 8 of 1/24; 2 substeps of 1/120 s are 5.
        self.assertEqual((manifest["frame_rate"], manifest["frames"], manifest["scene"]["substeps"]), (24, 8, 5))
        self.souple("run", scene, "--out", "b", "--set", "frame_rate=24", "--frames", "8", "--substeps", "5")
        self.assertEqual(self.contents("a"), self.contents("b"))
        self.souple("run", scene, "--out", "c", "--fps", "30", "--frames", "3", "--substeps", "7")
        manifest = json.loads((self.folder / "c/run.json").read_text())
        self.assertEqual((manifest["frames"], manifest["scene"]["substeps"]), (3, 7))
        for wrong in "0", "-24", "nan":
            self.assertIn("--fps", self.souple("run", scene, "--fps", wrong, code=2).stderr)

    def test_settings_reach_the_manifest(self):
        self.souple("run", self.scene(SMALL), "--out", "out", "--frames", "5", "--substeps", "3", "--threads", "4",
                    "--set", "objects.flag.material.bending_stiffness=0.125", "--set", "iterations=2")
        manifest = json.loads((self.folder / "out/run.json").read_text())
        scene = manifest["scene"]
        scene = json.loads(scene) if isinstance(scene, str) else scene
        self.assertEqual((scene["frames"], scene["substeps"], scene["iterations"]), (5, 3, 2))
        self.assertEqual(scene["objects"][0]["material"]["bending_stiffness"], 0.125)
        self.assertEqual(manifest["frames"], 5)

    def test_threads_change_nothing(self):
        scene = self.scene(SMALL)
        for threads in "1", "3":
            self.souple("run", scene, "--out", "run" + threads, "--threads", threads)
        self.assertEqual(self.contents("run1"), self.contents("run3"))

    def test_settings_change_the_result(self):
        scene = self.scene(SMALL)
        self.souple("run", scene, "--out", "a")
        self.souple("run", scene, "--out", "b", "--set", "gravity=[0,-1,0]")
        self.assertNotEqual(self.contents("a")["flag.pc2"], self.contents("b")["flag.pc2"])

    def test_twice_the_same_bytes(self):
        scene = self.scene(SMALL)
        self.souple("run", scene, "--out", "a", "--write", "pc2,obj")
        self.souple("run", scene, "--out", "b", "--write", "pc2,obj")
        self.assert_same_contents("a", "b")

    def test_simulation_that_goes_bad(self):
        done = self.souple("run", self.scene(EXPLODING), "--out", "out", code=3)
        self.assertRegex(done.stderr, r'diverged in frame \d+: object "\w+", particle \d+')
        self.assert_one_line(done.stderr)
        self.assertFalse([n for n in self.names() if n.endswith(".part")])


class Surface(Case):
    SAND = dict(SMALL, objects=[SMALL["objects"][1]], frames=4)

    def setUp(self):
        super().setUp()
        self.souple("run", self.scene(self.SAND), "--out", "out")

    def test_writes_a_mesh_a_frame(self):
        said = self.souple("surface", "out").stdout
        self.assertRegex(said, r"out_surface: about [\d.]+ [kM]B in 4 frames, about \d+ s\n")
        self.assertRegex(said, r"out_surface: 4 frames, \d+ triangles and [\d.]+ ms each\n")
        self.assertEqual(sorted(p.name for p in (self.folder / "out_surface").iterdir()),
                         ["run.json", *(f"sand_000{i}.obj" for i in range(1, 5))])
        lines = (self.folder / "out_surface/sand_0001.obj").read_text().splitlines()
        counts = [sum(line.startswith(kind) for line in lines) for kind in ("v ", "vn ", "f ")]
        self.assertEqual(counts[0], counts[1])
        self.assertGreater(counts[2], 20)
        sides = {}
        for line in lines:
            if line.startswith("f "):
                corners = [int(word.split("//")[0]) for word in line.split()[1:]]
                for a, b in zip(corners, corners[1:] + corners[:1]):
                    sides[a, b] = sides.get((a, b), 0) + 1
        self.assertTrue(all(n == 1 and (b, a) in sides for (a, b), n in sides.items()))  # closed

    def test_threads_and_instruction_sets_change_nothing(self):
        self.souple("surface", "out", "--out", "one", "--threads", 1)
        self.souple("surface", "out", "--out", "three", "--threads", 3)
        self.assert_same_contents("one", "three")
        self.environment["SOUPLE_SIMD"] = "scalar"
        self.souple("surface", "out", "--out", "scalar")
        self.assert_same_contents("one", "scalar")

    def test_options(self):
        for particles in "ply", "vtk", "bgeo":
            self.souple("surface", "out/run.json", "--out", particles, "--format", "ply", "--particles", particles,
                        "--method", "isotropic", "--smoothing", 2, "--cell", 0.005, "--object", "sand", "--quiet")
            self.assertTrue((self.folder / particles / "sand_0004.ply").is_file())
            self.assertTrue((self.folder / particles / f"sand_particles_0004.{particles}").is_file())
        # The output is itself a folder that commands read.
        again = self.souple("surface", "ply", "--spacing", 0.02, "--out", "again", "--quiet").stdout
        self.assertEqual(again, "")

    def test_volumes(self):
        if "OpenVDB: yes" not in self.souple("info").stdout:
            error = self.souple("surface", "out", "--format", "vdb", code=2).stderr
            self.assert_one_line(error)
            self.assertRegex(error, "libopenvdb-dev libboost-dev.*SOUPLE_WITH_VDB")
            self.assertFalse((self.folder / "out_surface").exists())
            return
        self.souple("surface", "out", "--format", "vdb", "--threads", 1, "--particles", "vtk")
        volumes = [f"sand_000{i}.vdb" for i in range(1, 5)]
        names = sorted(p.name for p in (self.folder / "out_surface").iterdir())
        self.assertEqual(names, sorted(["run.json", *volumes, *(f"sand_particles_000{i}.vtk" for i in range(1, 5))]))
        for name in volumes:
            data = (self.folder / "out_surface" / name).read_bytes()
            self.assertEqual(data[:8], b" BDV\0\0\0\0")  # the format's magic number
            self.assertIn(b"level set", data)
        self.souple("surface", "out", "--format", "vdb", "--threads", 3, "--out", "again", "--particles", "vtk")
        self.assert_same_contents("out_surface", "again")
        manifest = json.loads((self.folder / "out_surface/run.json").read_text())
        self.assertEqual(manifest["objects"][0]["files"], [{"format": "vdb", "path": "sand_0001.vdb", "frames": 4}])
        error = self.souple("surface", "out_surface", code=2).stderr  # no frame to play back
        self.assert_one_line(error)
        self.assertIn("--format obj", error)

    def test_bad_input_is_one_line(self):
        self.souple("run", self.scene(dict(SMALL, objects=SMALL["objects"][:1], frames=1)), "--out", "cloth")
        (self.folder / "file").write_text("")
        for arguments, words in ((["nowhere"], "nowhere"), (["cloth"], "neither fluids nor grains"),
                                 (["out", "--method", "isotropc"], 'did you mean "isotropic"'),
                                 (["out", "--format", "stl"], "obj, ply, vdb"), (["out", "--particles", "vdb"], "bgeo"),
                                 (["out", "--object", "snad"], 'did you mean "sand"'),
                                 (["out", "--spacing", "0"], "--spacing"), (["out", "--cell", "-1"], "--cell"),
                                 (["out", "--cell", "1e-9"], "cell"), (["out", "--out", "out"], "is the input folder"),
                                 (["out", "--out", "file"], "file")):
            error = self.souple("surface", *arguments, code=2).stderr
            self.assert_one_line(error)
            self.assertIn(words, error)
        self.assertFalse((self.folder / "out_surface").exists())

    def test_interrupt(self):
        self.souple("run", self.scene(dict(self.SAND, frames=600)), "--out", "long")
        work = subprocess.Popen([PROGRAM, "surface", "long", "--cell", "0.001"], cwd=self.folder, env=self.environment,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(2000):
            if (self.folder / "long_surface/sand_0002.obj").exists() or work.poll() is not None:
                break
            time.sleep(0.005)
        work.send_signal(signal.SIGINT)
        out, error = work.communicate(timeout=60)
        self.assertEqual(work.returncode, 130, out + error)
        self.assertRegex(error, r"interrupted after frame \d+ of 600; long_surface holds these frames\n")
        manifest = json.loads((self.folder / "long_surface/run.json").read_text())
        self.assertFalse(manifest["complete"])
        files = len(list((self.folder / "long_surface").glob("sand_*.obj")))
        self.assertEqual(manifest["frames"], files)
        self.assertFalse([n for n in self.names() if n.endswith(".part")])


class SurfaceOfARun(Case):
    def test_is_what_surface_makes_of_its_folder(self):
        scene = self.scene(WATER)
        for method in "anisotropic", "isotropic":
            said = self.souple("run", scene, "--out", method, "--surface", method).stdout
            self.assertRegex(said, rf"{method}_surface: 24 frames, \d+ triangles and [\d.]+ ms each\n")
            self.souple("surface", method, "--method", method, "--out", "afterwards")
            self.assert_same_contents(method + "_surface", "afterwards")
            shutil.rmtree(self.folder / "afterwards")
        files = sorted(p.name for p in (self.folder / "anisotropic_surface").iterdir())
        self.assertEqual(sum(name.startswith("block_") for name in files), 24)
        self.assertTrue(3 < sum(name.startswith("tap_") for name in files) < 20, files)
        manifest = json.loads((self.folder / "anisotropic_surface/run.json").read_text())
        self.assertTrue(manifest["complete"])
        one, other = self.contents("anisotropic_surface"), self.contents("isotropic_surface")
        self.assertNotEqual(one["block_0024.obj"], other["block_0024.obj"])

    def test_a_shorter_run_leaves_nothing_of_a_longer_one(self):
        scene = self.scene(WATER)
        self.souple("run", scene, "--out", "out", "--surface", "anisotropic")
        self.souple("run", scene, "--out", "out", "--surface", "anisotropic", "--frames", 5)
        self.souple("surface", "out", "--out", "afterwards")
        self.assertEqual([name for name in self.contents("out_surface") if name.startswith("block_")],
                         [f"block_{i:04}.obj" for i in range(1, 6)])
        self.assertEqual(self.contents("out_surface")["run.json"], self.contents("afterwards")["run.json"])

    def test_needs_something_to_mesh(self):
        scene = self.scene(dict(SMALL, objects=SMALL["objects"][:1]))
        for arguments, said in (([scene, "--surface", "anisotropic"], "has neither fluids nor grains"),
                                ([self.scene(WATER, "water.json"), "--surface", "isotropc"],
                                 '--surface "isotropc": expected one of anisotropic, isotropic')):
            error = self.souple("run", *arguments, "--out", "out", code=2).stderr
            self.assert_one_line(error)
            self.assertIn(said, error)
        self.assertEqual(self.names(), ["small.json", "water.json"])

    def test_when_the_simulation_goes_bad(self):
        bad = dict(WATER, drag=10000, integrator="explicit_euler", frames=60)
        self.souple("run", self.scene(bad), "--out", "out", "--surface", "anisotropic", code=3)
        self.souple("surface", "out", "--out", "afterwards")
        self.assert_same_contents("out_surface", "afterwards")


# A wide tap: every frame needs more memory than the one before.
FLOOD = {
    "souple": 1,
    "frames": 8,
    "substeps": 1,
    "objects": [
        SMALL["objects"][0],
        {"name": "tap", "kind": "fluid", "points": [], "max_particles": 40000,
         "material": {"preset": "water", "spacing": 0.02},
         "emitters": [{"position": [0, 2, 0], "direction": [0, -1, 0], "radius": 0.25, "speed": 8}]},
    ],
}


class OutOfMemory(Case):
    """Limits of the address space and of threads: one line and exit code 2, whatever runs out."""

    def least(self):
        """The least limit in MB with which the program can start. Skips a program with a sanitizer."""
        self.skip_sanitizers("its shadow memory exceeds any limit")
        return next(m for m in range(20, 4096, 10) if self.limited(m, "--version").returncode == 0)

    def assert_ends(self, done):
        """Returns whether the command succeeded; otherwise the memory did not suffice, and one line says so."""
        if done.returncode == 0:
            return True
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assert_one_line(done.stderr)
        self.assertRegex(done.stderr, "^souple: (out of memory|the system refuses to start a thread)")
        return False

    def assert_whole(self, frames):
        """The caches in out/ hold exactly these frames."""
        out = self.folder / "out"
        self.assertEqual(list(out.glob("*.part")), [])
        self.assertEqual(json.loads((out / "run.json").read_text())["frames"], frames)
        points = len(list(out.glob("tap_*.ply")))
        self.assertEqual(points, frames)
        if frames > 0:
            header = (out / "flag.pc2").read_bytes()[:32]
            self.assertEqual(int.from_bytes(header[28:32], "little"), frames)

    def test_a_run_ends_in_one_line_and_its_frames_are_whole(self):
        scene = self.scene(FLOOD)
        least = self.least()
        codes, cut_short = set(), 0
        for threads in (1, 2):
            for more in range(10, 170, 20):
                shutil.rmtree(self.folder / "out", ignore_errors=True)
                done = self.limited(least + more, "run", scene, "--out", "out", "--threads", threads, "--quiet")
                codes.add(done.returncode)
                if self.assert_ends(done):
                    self.assert_whole(FLOOD["frames"])
                    continue
                frame = re.search("in frame ([0-9]+) of 8; the frames before it are in out", done.stderr)
                if frame:
                    self.assert_whole(int(frame[1]) - 1)
                    cut_short += int(frame[1]) > 1
        self.assertEqual(codes, {0, 2})
        self.assertGreater(cut_short, 0, "no run ended after its first frame: the test tests nothing")

    def test_check_and_surface_end_in_one_line(self):
        least = self.least()
        self.souple("run", self.scene(dict(FLOOD, frames=3)), "--out", "out", "--quiet")
        fine = self.scene({"souple": 1, "frames": 1, "objects": [
            {"name": "sheet", "kind": "cloth", "mesh": {"grid": {"columns": 300, "rows": 300, "size": 1}}}]},
            "fine.json")
        for threads in ("1", "2"):
            self.environment["SOUPLE_THREADS"] = threads
            for arguments in (("check", fine), ("surface", "out", "--out", "meshes", "--quiet")):
                codes = [self.limited(least + more, *arguments) for more in (0, 10, 20, 40, 80, 400)]
                self.assertEqual([self.assert_ends(done) for done in codes][-1], True, arguments)
                self.assertEqual(codes[0].returncode, 2, arguments)

    def test_fewer_threads_or_one_line_where_the_system_refuses_threads(self):
        if os.getuid() != 0:
            self.skipTest("a limit of threads that others do not count in needs another user")
        self.least()
        self.folder.chmod(0o777)
        self.scene(SMALL)
        user = 61234  # has no processes
        self.environment["HOME"] = str(self.folder)

        def limited(threads):
            def limit():
                resource.setrlimit(resource.RLIMIT_NPROC, (threads, threads))
                os.setgid(user)
                os.setuid(user)

            return subprocess.run([PROGRAM, "run", "small.json", "--frames", "2", "--threads", "8", "--quiet",
                                   "--out", "out"], cwd=self.folder, env=self.environment,
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120,
                                  preexec_fn=limit)

        if limited(100).returncode != 0:
            self.skipTest("another user may not run the program where it lies")
        codes = []
        for threads in (1, 2, 3, 5, 8):
            done = limited(threads)
            codes.append(done.returncode)
            self.assert_ends(done)
        self.assertEqual(codes[-1], 0)


class WritingErrors(Case):
    """Output that cannot be written: exit code 1 and one line."""

    def refused(self, command):
        done = subprocess.run(["bash", "-c", command, PROGRAM], cwd=self.folder, env=self.environment,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 1, f"{command}\n{done.stdout}\n{done.stderr}")
        self.assert_one_line(done.stderr)
        return done.stderr

    def test_standard_output_on_a_full_disk(self):
        scene = self.scene(SMALL)
        for arguments in ("list", "list --json", f"check {scene}", "info", "info --schema", "--help", "--version",
                          f"run {scene} --out out"):
            self.assertIn("standard output cannot be written: No space left",
                          self.refused(f'"$0" {arguments} > /dev/full'))

    def test_folders_that_cannot_be(self):
        scene = self.scene(SMALL)
        (self.folder / "loop").symlink_to("loop")
        for name, reason in (("loop", ""), ("n" * 256, "File name too long")):
            for out in (name, f"{name}/inner"):
                said = self.refused(f'"$0" run {scene} --out {out}')
                self.assertIn(f"{out}: cannot be an output folder: ", said)
                self.assertIn(reason, said)
                self.assertNotIn("filesystem error", said)

    def test_folders_of_surfaces_that_cannot_be(self):
        self.souple("run", self.scene(dict(WATER, frames=2)), "--out", "out")
        (self.folder / "loop").symlink_to("loop")
        for out in "loop", "loop/inner", "n" * 256:
            self.assertIn(f"{out}: cannot be an output folder: ", self.refused(f'"$0" surface out --out {out}'))
        (self.folder / "run_surface").symlink_to("run_surface")
        self.assertIn("run_surface: cannot be an output folder: ",
                      self.refused('"$0" run small.json --out run --surface anisotropic'))

    def test_too_few_open_files_leave_no_file(self):
        self.skip_sanitizers("its check of virtual tables opens files itself")
        many = dict(SMALL, objects=[dict(SMALL["objects"][0], name=f"flag{i}") for i in range(40)])
        said = self.refused(f'ulimit -n 32; exec "$0" run {self.scene(many)} --out out --threads 1 --write pc2,mdd')
        self.assertIn("Too many open files", said)
        self.assertEqual([n for n in self.names() if n.startswith("out/") and not n.endswith(".lock")], [])


class FullDisk(Case):
    """A disk that fills up in the middle of a run: exit code 1, and run.json says what the caches hold."""

    # Little but the report of each frame: run.json is larger than the caches.
    LONG = dict(SMALL, frames=400)

    def on_small_disk(self, kilobytes, *arguments):
        """Runs the program on a disk of that size, as disk/out; what it leaves lies in out/."""
        shutil.rmtree(self.folder / "out", ignore_errors=True)
        (self.folder / "disk").mkdir(exist_ok=True)
        command = (f'mount -t tmpfs -o size={kilobytes}k none disk || exit 77\n"$0" "$@"; code=$?\n'
                   "for made in disk/*; do cp -r $made .; done; exit $code")
        done = subprocess.run(["unshare", "-rm", "bash", "-c", command, PROGRAM, *map(str, arguments)],
                              cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=120)
        if done.returncode == 77 or "unshare" in done.stderr:
            self.skipTest("a file system of its own cannot be mounted here")
        return done

    def assert_described(self, name="out"):
        """Caches are complete files, and run.json counts their frames. Returns the number of frames."""
        out = self.folder / name
        self.assertEqual(list(out.glob("*.part")), [])
        manifest = json.loads((out / "run.json").read_text())
        frames = manifest["frames"]
        self.assertEqual(len(manifest["reports"]), frames)
        for file in out.glob("*.pc2"):
            self.assertEqual(int.from_bytes(file.read_bytes()[28:32], "little"), frames, file)
        for file in out.glob("*.mdd"):
            self.assertEqual(int.from_bytes(file.read_bytes()[:4], "big"), frames, file)
        for listed in manifest["objects"]:
            for file in listed["files"]:
                self.assertTrue((out / file["path"]).is_file(), file)
        return frames

    def test_the_manifest_of_a_run_describes_its_caches(self):
        for formats in ("pc2", "mdd", "pc2,ply"):
            scene = self.scene(self.LONG)
            whole = self.souple("run", scene, "--out", "whole", "--write", formats)
            size = sum(f.stat().st_size for f in (self.folder / "whole").iterdir())
            for part in (0.3, 0.55, 0.8):
                done = self.on_small_disk(int(part * size / 1000), "run", scene, "--out", "disk/out", "--write", formats)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assert_one_line(done.stderr)
                self.assertIn("No space left on device", done.stderr)
                frames = self.assert_described()
                self.assertGreater(frames, 400 * part / 4)
                self.assertLess(frames, 400)
                self.souple("surface", "out", "--out", "meshes")  # other commands read what is left

    def test_the_manifest_of_surfaces_describes_its_meshes(self):
        """Of `run --surface`, whose frames stop at the same one, and of `surface`."""
        scene = self.scene(WATER)
        self.souple("run", scene, "--out", "whole", "--surface", "anisotropic")
        shutil.copytree(self.folder / "whole", self.folder / "source")
        size = sum(f.stat().st_size for f in self.folder.glob("whole*/*"))
        meshes = sum(f.stat().st_size for f in self.folder.glob("whole_surface/*"))
        for command, name, kilobytes in (
                (["run", scene, "--out", "disk/out", "--surface", "anisotropic"], "out_surface", 0.5 * size / 1000),
                (["surface", "source", "--out", "disk/out"], "out", 0.5 * meshes / 1000)):
            done = self.on_small_disk(int(kilobytes), *command)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("No space left on device", done.stderr)
            frames = self.assert_described(name)
            self.assertTrue(3 < frames < WATER["frames"], frames)
            self.assertEqual(len(list((self.folder / name).glob("block_*.obj"))), frames)
            if name == "out_surface":
                self.assertLessEqual(self.assert_described("out") - frames, 1)
                self.souple("surface", "out", "--out", "again")
                made, again = self.contents("out_surface"), self.contents("again")
                self.assertEqual({n: made[n] for n in made if n != "run.json"},
                                 {n: again[n] for n in again if n in made and n != "run.json"})

class Stopping(Case):
    def start(self, scene, *arguments):
        return subprocess.Popen([PROGRAM, "run", scene, *map(str, arguments)], cwd=self.folder,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=self.environment)

    def wait_for(self, condition):
        for _ in range(2000):
            if condition():
                return
            time.sleep(0.005)
        self.fail("nothing happened for ten seconds")

    def written(self, folder):
        """Size in bytes of the cache so far, under its final or its temporary name; a run may rename it meanwhile."""
        size = 0
        for file in (self.folder / folder).glob("flag.pc2*"):
            with contextlib.suppress(FileNotFoundError):
                size += file.stat().st_size
        return size

    def growing(self, folder):
        """True once the run has written a few frames."""
        return self.written(folder) > 3000

    def test_a_second_run_into_the_folder_is_refused(self):
        first = self.start("flag", "--frames", 3000, "--write", "pc2", "--out", "busy")
        self.wait_for(lambda: self.growing("busy"))
        (self.folder / "alias").symlink_to("busy")
        for arguments in (["run", "flag", "--out", "busy"], ["run", "drop", "--out", "alias"],
                          ["run", "--resume", "busy"]):
            second = self.souple(*arguments, code=2)
            self.assertIn("another souple is writing there", second.stderr)
        first.kill()
        first.communicate()
        # A killed run leaves no lock behind, and a finished one no file.
        self.souple("run", "flag", "--frames", 2, "--out", "busy")
        self.assertEqual([], list((self.folder / "busy").glob(".*")))

    def stopped(self, scene, folder, how, *arguments):
        run = self.start(scene, "--out", folder, *arguments)
        self.wait_for(lambda: self.growing(folder) or run.poll() is not None)
        run.send_signal(how)
        out, error = run.communicate(timeout=60)
        return run.returncode, out, error

    def test_interrupt_and_resume(self):
        scene = self.scene(dict(SMALL, frames=3000, substeps=20))
        self.souple("run", scene, "--out", "whole", "--write", "pc2,mdd")
        for how in signal.SIGINT, signal.SIGTERM, signal.SIGHUP:
            folder = f"stopped{int(how)}"
            code, out, error = self.stopped(scene, folder, how, "--write", "pc2,mdd")
            self.assertEqual(code, 130, out + error)
            self.assertRegex(error, rf"interrupted after frame \d+ of 3000; resume with: souple run --resume {folder}\n")
            self.assertTrue((self.folder / folder / "checkpoint.souple").is_file())
            self.assertFalse([n for n in self.names() if n.endswith(".part")])
            self.souple("run", "--resume", folder)
            self.assert_same_contents("whole", folder)

    def test_interrupted_where_no_checkpoint_can_be_written(self):
        scene = self.scene(dict(WATER, frames=3000))
        run = self.start(scene, "--out", "out", "--surface", "anisotropic")
        self.wait_for(lambda: self.growing("out") or run.poll() is not None)
        (self.folder / "out/checkpoint.souple.part").mkdir()
        run.send_signal(signal.SIGINT)
        out, error = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 1, out + error)
        self.assert_one_line(error)
        self.assertIn("checkpoint.souple.part", error)
        frames = int.from_bytes((self.folder / "out/flag.pc2").read_bytes()[28:32], "little")
        for folder in "out", "out_surface":
            self.assertEqual(json.loads((self.folder / folder / "run.json").read_text())["frames"], frames)

    def test_signals_that_were_ignored_stay_ignored(self):
        scene = self.scene(dict(SMALL, frames=600, substeps=20))
        for how in signal.SIGINT, signal.SIGHUP:
            before = signal.signal(how, signal.SIG_IGN)  # as nohup does, and shells in the background
            try:
                code, out, error = self.stopped(scene, f"kept{int(how)}", how)
            finally:
                signal.signal(how, before)
            self.assertEqual(code, 0, out + error)

    def test_limit_of_file_sizes_is_a_failed_write(self):
        scene = self.scene(dict(SMALL, frames=600))
        command = f'ulimit -f 8; exec "{PROGRAM}" run {scene} --out limited'
        run = subprocess.run(["bash", "-c", command], cwd=self.folder, capture_output=True, text=True, timeout=60,
                             env=self.environment)
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        self.assertIn("souple: ", run.stderr)

    def test_resume_writes_a_missing_rest_mesh_again(self):
        scene = self.scene(dict(SMALL, frames=3000, substeps=20))
        code, out, error = self.stopped(scene, "out", signal.SIGINT)
        self.assertEqual(code, 130, out + error)
        mesh = (self.folder / "out/flag.obj").read_bytes()
        for name in "flag", "sand":
            (self.folder / f"out/{name}.obj").unlink()
        said = self.souple("run", "--resume", "out").stderr
        for name in "flag", "sand":
            self.assertIn(f"{name}: its rest mesh was missing", said)
        self.assertEqual((self.folder / "out/flag.obj").read_bytes(), mesh)
        self.assertTrue((self.folder / "out/sand.obj").exists())

    def test_interrupted_twice(self):
        scene = self.scene(dict(SMALL, frames=4000, substeps=20))
        self.souple("run", scene, "--out", "whole")
        self.assertEqual(self.stopped(scene, "out", signal.SIGINT)[0], 130)
        again = subprocess.Popen([PROGRAM, "run", "--resume", "out"], cwd=self.folder, stderr=subprocess.PIPE,
                                 stdout=subprocess.PIPE, text=True, env=self.environment)
        size = self.written("out")
        self.wait_for(lambda: self.written("out") > size + 3000 or again.poll() is not None)
        again.send_signal(signal.SIGINT)
        again.communicate(timeout=60)
        self.assertEqual(again.returncode, 130)
        self.souple("run", "--resume", "out")
        self.assert_same_contents("whole", "out")

    def test_killed_and_resumed_from_a_regular_checkpoint(self):
        scene = self.scene(dict(SMALL, frames=2000, substeps=20))
        self.souple("run", scene, "--out", "whole", "--checkpoint-every", 50)
        run = self.start(scene, "--out", "out", "--checkpoint-every", 50)
        self.wait_for(lambda: (self.folder / "out/checkpoint.souple").exists() or run.poll() is not None)
        run.send_signal(signal.SIGKILL)
        run.communicate()
        self.assertEqual(run.returncode, -signal.SIGKILL)
        self.souple("run", "--resume", "out")
        self.assert_same_contents("whole", "out")

    def test_surface_goes_on_with_the_run(self):
        scene = self.scene(dict(WATER, frames=80))
        self.souple("run", scene, "--out", "whole", "--surface", "anisotropic")
        run = self.start(scene, "--out", "out", "--surface", "anisotropic")
        drop = self.folder / "out_surface/tap_0012.obj"  # more particles than at the start
        self.wait_for(lambda: drop.exists() or run.poll() is not None)
        run.send_signal(signal.SIGINT)
        out, error = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 130, out + error)
        self.souple("surface", "out", "--out", "so_far")  # complete files, and a run.json that lists them
        self.assert_same_contents("out_surface", "so_far")
        self.assertFalse(json.loads((self.folder / "out_surface/run.json").read_text())["complete"])
        self.assertIn("--surface", self.souple("run", "--resume", "out", "--surface", "isotropic", code=2).stderr)
        first = self.folder / "out_surface/block_0001.obj"
        kept = first.read_bytes()
        first.unlink()
        self.assertIn("lacks meshes of \"block\"", self.souple("run", "--resume", "out", code=2).stderr)
        first.write_bytes(kept)
        self.souple("run", "--resume", "out")
        self.assert_same_contents("whole", "out")
        self.assert_same_contents("whole_surface", "out_surface")

    def test_surface_of_a_killed_run(self):
        scene = self.scene(dict(WATER, frames=80))
        arguments = ["--surface", "anisotropic", "--checkpoint-every", 7]
        self.souple("run", scene, "--out", "whole", *arguments)
        run = self.start(scene, "--out", "out", *arguments)
        mesh = self.folder / "out_surface/block_0010.obj"
        self.wait_for(lambda: mesh.exists() or run.poll() is not None)
        run.send_signal(signal.SIGKILL)
        run.communicate()
        self.assertEqual(run.returncode, -signal.SIGKILL)
        self.souple("run", "--resume", "out")
        self.assert_same_contents("whole", "out")
        self.assert_same_contents("whole_surface", "out_surface")

    def test_resume_with_more_frames(self):
        scene = self.scene(dict(SMALL, frames=3000, substeps=20))
        self.assertEqual(self.stopped(scene, "out", signal.SIGINT)[0], 130)
        self.souple("run", "--resume", "out", "--frames", 3100)
        self.souple("run", scene, "--out", "whole", "--frames", 3100)
        self.assert_same_contents("whole", "out")

    def test_fewer_frames_than_there_are(self):
        scene = self.scene(dict(SMALL, frames=3000, substeps=20))
        self.assertEqual(self.stopped(scene, "out", signal.SIGINT)[0], 130)
        self.assertIn("--frames 1", self.souple("run", "--resume", "out", "--frames", 1, code=2).stderr)
        self.souple("run", "--resume", "out")  # no frame is missing

    def test_second_interrupt_ends_at_once(self):
        heavy = json.loads(json.dumps(SMALL))
        heavy["frames"] = 100000
        heavy["substeps"] = 10000
        heavy["objects"][0]["mesh"]["grid"] = {"columns": 60, "rows": 60, "size": 1}
        run = self.start(self.scene(heavy), "--out", "out")
        self.wait_for(lambda: (self.folder / "out").exists())
        run.send_signal(signal.SIGINT)
        time.sleep(0.2)
        self.assertIsNone(run.poll(), "a frame of this scene takes seconds")
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=5)
        self.assertEqual(run.returncode, -signal.SIGINT)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
