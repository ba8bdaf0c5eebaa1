#!/usr/bin/env python3
"""Tests of `souple run`. test_cli_run.py PROGRAM SOURCE_FOLDER [unittest's arguments]."""

import json
import os
import pty
import re
import signal
import subprocess
import sys
import unittest

from cli_case import EXPLODING, PROGRAM, SMALL, Case


class Running(Case):
    def test_summary_in_a_pipe(self):
        done = self.souple("run", self.scene(SMALL), "--out", "out")
        self.assert_one_line(done.stdout)
        self.assertIn("small: 20 frames in ", done.stdout)
        self.assertIn("ms/frame", done.stdout)
        self.assertRegex(done.stdout, r"largest strain (\d+(\.\d+)?|less than 0\.01) %, in")
        self.assertNotIn("\r", done.stdout + done.stderr)
        self.assertNotIn("left", done.stderr)

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

    def test_twice_the_same_bytes_with_any_number_of_threads(self):
        scene = self.scene(SMALL)
        self.souple("run", scene, "--out", "a", "--write", "pc2,obj", "--threads", 1)
        done = self.souple("run", scene, "--write", "pc2,obj", "--threads", 3, "--quiet")
        self.assertEqual(done.stdout + done.stderr, "")
        self.assertFalse([n for n in self.names() if n.endswith(".part") or "checkpoint" in n])
        self.assert_same_contents("a", "out/small")

    def test_what_flies_farther_than_floats_reach_is_flagged(self):
        grains = {"name": "sand", "kind": "grains", "points": [[0, 0, 0]], "velocity": [1e5, 0, 0]}
        scene = self.scene({"souple": 1, "frames": 1200, "frame_rate": 0.1, "substeps": 1, "gravity": [0, 0, 0],
                            "objects": [grains]})
        said = self.souple("run", scene, "--out", "out").stderr
        # A frame takes 10 s: 1e9 m are passed after a thousand.
        frames = re.search(r"in (\d+) frames: an object is farther than 1e9 m from the origin", said)
        self.assertTrue(frames, said)
        self.assertAlmostEqual(int(frames[1]), 200, delta=2)
        reports = json.loads((self.folder / "out/run.json").read_text())["reports"]
        self.assertEqual([r["frame"] for r in reports if "out_of_range" in r["flags"]],
                         list(range(1201 - int(frames[1]), 1201)))

    def test_simulation_that_goes_bad(self):
        done = self.souple("run", self.scene(EXPLODING), "--out", "out", code=3)
        self.assertRegex(done.stderr, r'diverged in frame \d+: object "\w+", particle \d+')
        self.assert_one_line(done.stderr)
        self.assertFalse([n for n in self.names() if n.endswith(".part")])

    def test_a_refused_step_is_no_frame(self):
        self.souple("run", "flag", "--out", "out", "--frames", 2)
        before = self.contents("out")
        for command in ("run", "check"):
            done = self.souple(command, "flag", "--set", "solver=dense", *(["--out", "out"] if command == "run" else []),
                               code=2)
            self.assertIn("the solver dense takes at most", done.stderr)
            self.assert_one_line(done.stderr)
        self.assertEqual(self.contents("out"), before)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
