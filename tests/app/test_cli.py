#!/usr/bin/env python3
"""Tests of the souple program: what it says, and what it refuses. test_cli.py PROGRAM SOURCE_FOLDER [unittest's arguments]."""

import json
import re
import sys
import unittest
from pathlib import Path

from cli_case import SMALL, SOURCE, Case


class Talking(Case):
    def test_help_everywhere(self):
        for command in [], ["run"], ["render"], ["list"], ["check"], ["info"], ["surface"], ["convert"]:
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
        for bad in "0", "two", "1025":
            self.environment["SOUPLE_THREADS"] = bad
            said = self.refused("run", scene, "--out", "out")
            self.assert_one_line(said)
            self.assertIn(f"SOUPLE_THREADS is '{bad}'", said)
        self.souple("run", scene, "--out", "out", "--threads", "2")

    def test_slips_of_the_hand(self):
        for arguments, said in (
            ([], "expected a command: run, "),
            (["runn", "flag"], "runn: there is no such command"),
            (["--nope"], "--nope: there is no such option"),
            (["run"], "SCENE"),
            (["run", "flag", "--writ", "pc2"], "--writ: there is no such option"),
            (["run", "flag", "--write", "pc3"], "pc2"),
            (["list", "x"], "x: unexpected argument"),
            (["run", "flag", ""], ": unexpected argument"),
            (["run", "flag", "--frames", "-3"], "--frames = -3: expected a whole number"),
            (["run", "flag", "--frames", "many"], "--frames"),
            (["run", "flag", "--threads", "1025"], "--threads"),
            (["run", "--resume", "nowhere"], "nowhere: no such folder"),
        ):
            refused = self.refused(*arguments)
            self.assert_one_line(refused)
            self.assertTrue(refused.startswith("souple: "), refused)
            self.assertIn(said, refused)

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

    def test_a_mesh_that_is_a_link_elsewhere_is_not_quoted(self):
        secret = self.folder / "secret"
        secret.write_text("root:x:0:0:root:/root:/bin/bash\n")
        scenes = self.folder / "scenes"
        scenes.mkdir()
        (scenes / "elsewhere.obj").symlink_to(secret)
        (scenes / "own.obj").write_text(secret.read_text())
        for mesh in "elsewhere.obj", "own.obj":
            scene = dict(SMALL, objects=[{"name": "a", "kind": "cloth", "mesh": {"file": mesh}}])
            said = self.refused("check", self.scene(scene, "scenes/a.json"))
            self.assertIn(mesh, said)
            self.assertNotIn("/root", said)
            self.assertEqual("root" in said, mesh == "own.obj", said)

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


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
