#!/usr/bin/env python3
"""Tests of `souple sweep`. test_sweep.py PROGRAM SOURCE_FOLDER [unittest's arguments]."""

import csv
import json
import signal
import subprocess
import sys
import unittest

from cli_case import PROGRAM, SMALL, Case

GRAVITY = "gravity=[0,-9.81,0],[0,-5,0],[0,-1,0]"


class SweepCase(Case):
    def rows(self, folder):
        """The table's rows; that of JSON has the same runs and hashes."""
        with open(self.folder / folder / "table.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        others = json.loads((self.folder / folder / "table.json").read_text())
        self.assertEqual([(int(r["run"]), r["hash"]) for r in rows], [(r["run"], r["hash"]) for r in others])
        return rows

    def without_times(self, folder):
        return [{key: value for key, value in row.items() if key != "seconds"} for row in self.rows(folder)]

    def results(self, folder):
        return list((self.folder / folder).glob("*/result.json"))

    def wait_for_results(self, folder, count, process):
        self.wait_for(lambda: len(self.results(folder)) >= count, process)


class Values(SweepCase):
    def listed(self, *settings):
        arguments = [word for setting in settings for word in ("--set", setting)]
        lines = self.souple("sweep", self.scene(SMALL), *arguments, "--dry-run").stdout.splitlines()
        self.assertEqual([line.split("  ", 1)[0] for line in lines], [f"{n:04}" for n in range(1, len(lines) + 1)])
        self.assertEqual(self.names(), ["small.json"])
        return [line.split("  ", 1)[1] for line in lines]

    def test_ranges_and_lists(self):
        self.assertEqual(self.listed("substeps=2:8:4"), [f"substeps={n}" for n in (2, 4, 6, 8)])
        self.assertEqual(self.listed("drag=0.1:0.7:3"), ["drag=0.1", "drag=0.4", "drag=0.7"])
        path = "objects.flag.material.bending_stiffness"
        self.assertEqual(self.listed(path + "=1e-6:1e-4:log3"), [path + "=" + v for v in ("1e-06", "1e-05", "0.0001")])
        self.assertEqual(self.listed("wind.velocity.0=4:-4:3"), [f"wind.velocity.0={v}" for v in (4, 0, -4)])
        self.assertEqual(self.listed("mode=xpbd,pbd"), ["mode=xpbd", "mode=pbd"])
        self.assertEqual(self.listed(GRAVITY)[1], "gravity=[0,-5,0]")

    def test_combinations(self):
        self.assertEqual(self.listed("substeps=2,3", "drag=0.5", "iterations=1,2"),
                         [f"substeps={a} iterations={b}" for a in (2, 3) for b in (1, 2)])

    def test_bad_input(self):
        scene = self.scene(SMALL)
        for settings, words in [
                (["substeps"], "expected PATH=VALUES"), (["substeps=4"], "expected a --set with several values"),
                ([], "expected a --set with several values"), (["drag=0:1"], "expected A:B:N"),
                (["drag=0:1:x"], "a number of values from 2"), (["drag=0:1:1"], "a number of values from 2"),
                (["drag=0:1:log3"], "without zero"), (["drag=1:1:3"], "two different numbers"),
                (["drag=1,,2"], "is empty"), (["drag=1,1"], "twice"), (["drag=1,2", "drag=3"], "set twice"),
                (["drag=1:2:1000", "substeps=1,2", "seed=1:900:900"], "more than 100000"),
                (["drag=1,-2"], "run 2 (drag=-2): "), (["drog=1,2"], "did you mean \"drag\"?"),
                (["substeps=1:2:3"], "run 2 (substeps=1.5): ")]:
            arguments = [word for setting in settings for word in ("--set", setting)]
            said = self.souple("sweep", scene, *arguments, "--out", "out", code=2).stderr
            self.assert_one_line(said)
            self.assertIn(words, said)
        self.assertIn("--only 3", self.souple("sweep", scene, "--set", "drag=1,2", "--only", 3, code=2).stderr)
        self.souple("sweep", scene, "--set", "drag=1,2", "--only", 1, "--table", code=2)
        self.souple("sweep", scene, "--set", "drag=1,2", "--jobs", 0, code=2)
        self.assertFalse((self.folder / "out").exists() and self.results("out"))


class Sweeping(SweepCase):
    SMALL_SWEEP = ["--set", "objects.flag.material.bending_stiffness=1e-6:1e-4:log2", "--set", "wind.velocity.0=0:10:2",
                   "--no-sheet"]

    def test_runs_are_those_of_souple_run(self):
        scene = self.scene(SMALL)
        said = self.souple("sweep", scene, *self.SMALL_SWEEP, "--write", "pc2", "--frames", 5, "--out", "out").stdout
        self.assert_one_line(said)
        self.assertIn("small: 4 runs in ", said)
        for number, row in enumerate(self.rows("out"), 1):
            self.assertEqual((int(row["run"]), row["status"], row["frames"], row["error"]), (number, "finished", "5", ""))
            settings = [f"{path}={row[path]}" for path in
                        ("objects.flag.material.bending_stiffness", "wind.velocity.0")]
            self.souple("run", scene, "--set", settings[0], "--set", settings[1], "--frames", 5, "--out", "alone")
            files = self.contents(f"out/{number:04}")
            del files["result.json"]
            self.assertEqual(files, self.contents("alone"))
            reports = json.loads((self.folder / "alone/run.json").read_text())["reports"]
            self.assertEqual(float(row["largest_strain"]), max(r["values"]["largest_strain"] for r in reports))
            self.assertEqual(float(row["contacts"]), reports[-1]["values"]["contacts"])
        self.assertEqual(len({row["hash"] for row in self.rows("out")}), 4)
        self.assertFalse([n for n in self.names() if n.endswith((".part", ".lock"))])

    def test_default_folder(self):
        self.souple("sweep", self.scene(SMALL), "--set", "substeps=1,2", "--frames", 1, "--no-sheet", "--quiet")
        self.assertEqual(len(self.rows("out/small_sweep")), 2)

    def test_killed_twice(self):
        scene = self.scene(dict(SMALL, frames=30, substeps=10))
        sweep = [scene, "--set", "objects.flag.material.bending_stiffness=1e-6:1e-4:log8", "--set",
                 "wind.velocity.0=0:10:3", "--no-sheet"]
        self.souple("sweep", *sweep, "--out", "whole")
        whole = self.without_times("whole")
        self.assertEqual([int(row["run"]) for row in whole], list(range(1, 25)))
        times = {}
        for count in 5, 12:
            process = self.start("sweep", *sweep, "--out", "out")
            self.wait_for_results("out", count, process)
            self.stop(process, signal.SIGKILL, -signal.SIGKILL)
            for file in self.results("out"):
                times.setdefault(file, file.stat().st_mtime_ns)
            self.assertLess(len(times), 24)
        self.souple("sweep", *sweep, "--out", "out")
        self.assertEqual(self.without_times("out"), whole)
        for file, when in times.items():
            self.assertEqual(file.stat().st_mtime_ns, when, f"{file} was done and is done again")

    def test_interrupted(self):
        scene = self.scene(dict(SMALL, frames=100, substeps=20))
        sweep = [scene, "--set", "drag=1:3:9", "--no-sheet", "--out", "out"]
        process = self.start("sweep", *sweep)
        self.wait_for_results("out", 2, process)
        self.assertIn("the same command does the runs that are missing", self.stop(process, signal.SIGTERM)[1])
        states = [row["status"] for row in self.rows("out")]
        self.assertIn("missing", states)
        self.assertEqual(states.count("finished"), len(self.results("out")))
        self.assertFalse([n for n in self.names() if n.endswith(".part")])
        self.souple("sweep", *sweep)
        self.assertEqual({row["status"] for row in self.rows("out")}, {"finished"})

    def test_two_at_once(self):
        scene = self.scene(dict(SMALL, frames=30))
        sweep = [scene, "--set", "drag=1:3:6", "--no-sheet", "--out", "out", "--jobs", 2]
        processes = [self.start("sweep", *sweep) for _ in range(2)]
        for process in processes:
            out, error = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 0, out + error)
            self.assertIn("6 runs in", out)
        self.assertEqual([row["status"] for row in self.rows("out")], ["finished"] * 6)

    def test_runs_that_diverge_or_fail_are_rows(self):
        # Explicit integration of a strong drag diverges; a mesh without a triangle cannot be built.
        scene = self.scene(dict(SMALL, integrator="explicit_euler", frames=60))
        said = self.souple("sweep", scene, "--set", "drag=0,10000,1", "--no-sheet", "--out", "out", code=3)
        self.assertRegex(said.stderr, r"run 2 \(drag=10000\): .*diverged in frame \d+")
        self.assertIn("3 runs, 1 diverged", said.stdout)
        rows = self.rows("out")
        self.assertEqual([row["status"] for row in rows], ["finished", "diverged", "finished"])
        self.assertIn("diverged in frame", rows[1]["error"])
        self.souple("sweep", scene, "--set", "drag=0,10000,1", "--no-sheet", "--out", "out", code=3)
        (self.folder / "bad.obj").write_text("v 0 0 0\n")
        (self.folder / "good.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")
        scene = self.scene({"souple": 1, "frames": 2, "objects": [{"name": "a", "kind": "cloth", "mesh": {"file": "good.obj"}}]})
        sweep = [scene, "--set", "objects.a.mesh.file=good.obj,bad.obj", "--no-sheet", "--out", "meshes"]
        self.souple("sweep", *sweep, code=2)
        rows = self.rows("meshes")
        self.assertEqual([row["status"] for row in rows], ["finished", "failed"])
        self.assertIn("no area", rows[1]["error"])
        (self.folder / "bad.obj").write_text((self.folder / "good.obj").read_text())
        self.souple("sweep", *sweep)  # what failed is tried again
        self.assertEqual([row["status"] for row in self.rows("meshes")], ["finished"] * 2)

    def test_another_sweep_is_refused(self):
        scene = self.scene(SMALL)
        self.souple("sweep", scene, "--set", "drag=1,2", "--frames", 1, "--no-sheet", "--out", "out")
        table = (self.folder / "out/table.csv").read_bytes()
        for arguments, words in [(["--set", "drag=1,3", "--frames", 1], "other settings"),
                                 (["--set", "drag=1,2", "--frames", 2], "other settings"),
                                 (["--set", "drag=1,2", "--frames", 1, "--write", "obj"], "other caches")]:
            said = self.souple("sweep", scene, *arguments, "--no-sheet", "--out", "out", code=2).stderr
            self.assert_one_line(said)
            self.assertIn(words, said)
        self.scene(dict(SMALL, gravity=[0, -1, 0]))
        said = self.souple("sweep", scene, "--set", "drag=1,2", "--frames", 1, "--out", "out", code=2).stderr
        self.assertIn("a scene file that has changed since", said)
        manifest = self.folder / "out/sweep.json"
        manifest.write_text(manifest.read_text().replace('"version": "', '"version": "9'))
        self.scene(SMALL)
        said = self.souple("sweep", scene, "--set", "drag=1,2", "--frames", 1, "--out", "out", code=2).stderr
        self.assertIn("another version of souple", said)
        self.assertEqual((self.folder / "out/table.csv").read_bytes(), table)

    def test_damaged_results_are_done_again(self):
        sweep = [self.scene(SMALL), "--set", "drag=1,2,3", "--frames", 3, "--no-sheet", "--out", "out"]
        self.souple("sweep", *sweep)
        before = self.without_times("out")
        (self.folder / "out/0001/result.json").write_text("{")
        (self.folder / "out/0002/result.json").write_text('{"sweep": 1, "frames": 1e300}')
        (self.folder / "out/0003/result.json").unlink()
        self.souple("sweep", *sweep)
        self.assertEqual(self.without_times("out"), before)

    def test_full_disk_ends_the_sweep(self):
        command = f'ulimit -f 4; exec "{PROGRAM}" sweep {self.scene(SMALL)} --set drag=1:2:9 --write pc2 --out out'
        run = self.command("bash", "-c", command)
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        self.assertIn("souple: ", run.stderr)


class Parts(SweepCase):
    SWEEP = ["--set", "drag=1,2,3", "--frames", "3", "--no-sheet", "--out", "with space"]

    def test_single_runs_and_table(self):
        scene = self.scene(SMALL)
        self.souple("sweep", scene, *self.SWEEP, "--only", 2)
        self.assertFalse((self.folder / "with space/table.csv").exists())
        self.assertIn("3 runs, 2 missing, in", self.souple("sweep", scene, *self.SWEEP, "--table").stdout)
        self.assertEqual([row["status"] for row in self.rows("with space")], ["missing", "finished", "missing"])
        before = self.results("with space")[0].stat().st_mtime_ns
        self.souple("sweep", scene, *self.SWEEP, "--only", 2)
        self.assertEqual(self.results("with space")[0].stat().st_mtime_ns, before)

    def test_slurm_script(self):
        scene = self.scene(SMALL)
        self.souple("sweep", scene, *self.SWEEP, "--slurm", "job.sh")
        script = (self.folder / "job.sh").read_text()
        self.assertTrue(script.startswith("#!/bin/bash\n"))
        self.assertIn("\n#SBATCH --array=1-3\n", script)
        options = [line for line in script.splitlines() if line.startswith("#SBATCH")]
        self.assertLess(script.index(options[-1]), script.index("\ncd "), "sbatch reads no option after a command")
        for task in 3, 1, 2, 2:
            environment = dict(self.environment, SLURM_ARRAY_TASK_ID=str(task))
            subprocess.run(["bash", self.folder / "job.sh"], cwd="/", env=environment, check=True, timeout=60)
        subprocess.run(["bash", self.folder / "job.sh", "--table"], cwd="/", check=True, timeout=60,
                       stdout=subprocess.DEVNULL)
        gathered = self.without_times("with space")
        self.souple("sweep", scene, *self.SWEEP[:-1], "local")
        self.assertEqual(gathered, self.without_times("local"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
