#!/usr/bin/env python3
"""Tests of stopped runs: signals, locks, resume. test_cli_stop.py PROGRAM SOURCE_FOLDER [unittest's arguments]."""

import contextlib
import json
import shutil
import signal
import sys
import time
import unittest

from cli_case import PROGRAM, SMALL, WATER, Case


class Stopping(Case):
    def setUp(self):
        super().setUp()
        # Frames that take long enough for a signal to come before the last one.
        self.slow_frames = dict(SMALL, substeps=5 if self.has_sanitizer() else 20)

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
        first = self.start("run", "flag", "--frames", 3000, "--write", "pc2", "--out", "busy")
        self.wait_for(lambda: self.growing("busy"), first)
        (self.folder / "alias").symlink_to("busy")
        for arguments in (["run", "flag", "--out", "busy"], ["run", "drop", "--out", "alias"],
                          ["run", "--resume", "busy"]):
            second = self.souple(*arguments, code=2)
            self.assertIn("another souple is writing there", second.stderr)
        self.stop(first, signal.SIGKILL, -signal.SIGKILL)
        self.assertEqual([], list((self.folder / "busy").glob(".*.lock")))
        # A killed run leaves no lock behind, and a finished one no file.
        self.souple("run", "flag", "--frames", 2, "--out", "busy")
        self.assertEqual([], list((self.folder / "busy").glob(".*")))

    def test_interrupts_and_resumes(self):
        """By each signal in turn; the last resume runs more frames, and writes rest meshes that were deleted."""
        scene = self.scene(dict(self.slow_frames, frames=1500))
        self.souple("run", scene, "--out", "whole", "--write", "pc2,mdd", "--frames", 1600)
        run = self.start("run", scene, "--out", "out", "--write", "pc2,mdd")
        ways = signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGXCPU, signal.SIGHUP
        for how in ways:
            size = self.written("out")
            self.wait_for(lambda: self.written("out") > size + 3000, run)
            error = self.stop(run, how)[1]
            self.assertRegex(error, r"interrupted after frame \d+ of 1500; resume with: souple run --resume out\n")
            self.assertTrue((self.folder / "out/checkpoint.souple").is_file())
            self.assertFalse([n for n in self.names() if n.endswith(".part")])
            self.assertIn("--frames 1", self.souple("run", "--resume", "out", "--frames", 1, code=2).stderr)
            if how == ways[-1]:
                break
            run = self.start("run", "--resume", "out")
        for name in "flag", "sand":
            (self.folder / f"out/{name}.obj").unlink()
        said = self.souple("run", "--resume", "out", "--frames", 1600).stderr
        for name in "flag", "sand":
            self.assertIn(f"{name}: its rest mesh was missing", said)
        whole, out = self.contents("whole"), self.contents("out")
        self.assertEqual(sorted(whole), sorted(out))
        differ = [name for name in whole if whole[name] != out[name]]
        self.assertEqual(differ, ["run.json", "sand.obj"])  # its notes, and where the grains were by then

    def test_interrupted_where_no_checkpoint_can_be_written(self):
        scene = self.scene(dict(WATER, frames=3000))
        run = self.start("run", scene, "--out", "out", "--surface", "anisotropic")
        self.wait_for(lambda: self.growing("out"), run)
        (self.folder / "out/checkpoint.souple.part").mkdir()
        error = self.stop(run, code=1)[1]
        self.assert_one_line(error)
        self.assertIn("checkpoint.souple.part", error)
        frames = int.from_bytes((self.folder / "out/flag.pc2").read_bytes()[28:32], "little")
        for folder in "out", "out_surface":
            self.assertEqual(json.loads((self.folder / folder / "run.json").read_text())["frames"], frames)

    def test_signals_that_were_ignored_stay_ignored(self):
        scene = self.scene(dict(self.slow_frames, frames=600))
        for how in signal.SIGINT, signal.SIGHUP:
            before = signal.signal(how, signal.SIG_IGN)  # as nohup does, and shells in the background
            try:
                run = self.start("run", scene, "--out", f"kept{int(how)}")
            finally:
                signal.signal(how, before)
            self.wait_for(lambda: self.growing(f"kept{int(how)}"), run)
            self.stop(run, how, 0)

    def test_limit_of_file_sizes_is_a_failed_write(self):
        scene = self.scene(dict(SMALL, frames=600))
        command = f'ulimit -f 8; exec "{PROGRAM}" run {scene} --out limited'
        run = self.command("bash", "-c", command)
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        self.assertIn("souple: ", run.stderr)

    def test_killed_and_resumed_from_a_regular_checkpoint(self):
        scene = self.scene(dict(self.slow_frames, frames=1000))
        self.souple("run", scene, "--out", "whole", "--checkpoint-every", 50)
        run = self.start("run", scene, "--out", "out", "--checkpoint-every", 50)
        self.wait_for(lambda: (self.folder / "out/checkpoint.souple").exists(), run)
        self.stop(run, signal.SIGKILL, -signal.SIGKILL)
        shutil.copytree(self.folder / "out", self.folder / "anew")
        self.souple("run", "--resume", "out")
        self.assert_same_contents("whole", "out")
        # A run that begins anew takes the earlier one's checkpoint away: nobody resumes that one by mistake.
        run = self.start("run", scene, "--out", "anew")
        self.wait_for(lambda: not (self.folder / "anew/checkpoint.souple").exists(), run)
        self.stop(run, signal.SIGKILL, -signal.SIGKILL)

    def test_surface_goes_on_with_the_run(self):
        """After it was killed, and after an interrupt."""
        scene = self.scene(dict(WATER, frames=80))
        arguments = ["--surface", "anisotropic", "--checkpoint-every", 7]
        self.souple("run", scene, "--out", "whole", *arguments)
        run = self.start("run", scene, "--out", "out", *arguments)
        mesh = self.folder / "out_surface/block_0010.obj"
        self.wait_for(lambda: mesh.exists(), run)
        self.stop(run, signal.SIGKILL, -signal.SIGKILL)
        run = self.start("run", "--resume", "out")
        drop = self.folder / "out_surface/tap_0016.obj"  # more particles than at the start
        self.wait_for(lambda: drop.exists(), run)
        self.stop(run)
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

    def test_second_interrupt_ends_at_once(self):
        heavy = json.loads(json.dumps(SMALL))
        heavy["frames"] = 100000
        heavy["substeps"] = 10000
        heavy["objects"][0]["mesh"]["grid"] = {"columns": 60, "rows": 60, "size": 1}
        run = self.start("run", self.scene(heavy), "--out", "out")
        # The folder is there before interrupts are watched, its files come after.
        self.wait_for(lambda: list((self.folder / "out").glob("*.obj")), run)
        run.send_signal(signal.SIGINT)
        time.sleep(0.2)
        self.assertIsNone(run.poll(), "a frame of this scene takes seconds")
        self.stop(run, code=-signal.SIGINT)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
