#!/usr/bin/env python3
"""Tests of `souple surface` and `run --surface`. test_cli_surface.py PROGRAM SOURCE_FOLDER [unittest's arguments]."""

import json
import shutil
import sys
import unittest

from cli_case import SMALL, WATER, Case


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
        work = self.start("surface", "long", "--cell", "0.001")
        self.wait_for((self.folder / "long_surface/sand_0002.obj").exists, work)
        error = self.stop(work)[1]
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


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
