#!/usr/bin/env python3
"""Tests of the souple program without memory, disk or permission. test_cli_faults.py PROGRAM SOURCE_FOLDER
[unittest's arguments].
"""

import json
import os
import re
import resource
import shutil
import subprocess
import sys
import unittest

from cli_case import PROGRAM, SMALL, WATER, Case

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

    limit = None

    def least(self):
        """The least limit in MB with which the program can start. Skips a program with a sanitizer."""
        self.skip_sanitizers("its shadow memory exceeds any limit")
        if OutOfMemory.limit is None:
            OutOfMemory.limit = next(m for m in range(20, 4096, 10) if self.limited(m, "--version").returncode == 0)
        return OutOfMemory.limit

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
        for threads in (1, 2):
            cut_short = 0
            for more in range(0, 400, 5):  # MB, until the run has all it needs, which depends on the system's allocator
                shutil.rmtree(self.folder / "out", ignore_errors=True)
                done = self.limited(least + more, "run", scene, "--out", "out", "--threads", threads, "--quiet")
                if self.assert_ends(done):
                    self.assert_whole(FLOOD["frames"])
                    break
                frame = re.search("in frame ([0-9]+) of 8; the frames before it are in out", done.stderr)
                if frame:
                    self.assert_whole(int(frame[1]) - 1)
                    cut_short += int(frame[1]) > 1
            self.assertEqual(done.returncode, 0, done.stderr)
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
                codes = [self.limited(least + more, *arguments) for more in (0, 20, 80, 400)]
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

            return self.command(PROGRAM, "run", "small.json", "--frames", "2", "--threads", "8", "--quiet", "--out", "out",
                                preexec_fn=limit)

        try:
            limited(100).check_returncode()
        except (PermissionError, subprocess.CalledProcessError):
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
        done = self.command("bash", "-c", command, PROGRAM)
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

    def test_links_under_temporary_names_are_not_followed(self):
        victim = self.folder / "victim"
        victim.write_text("of somebody else")
        for part in "flag.pc2.part", "flag.mdd.part", "flag.obj.part", "run.json.part", "checkpoint.souple.part":
            out = self.folder / part
            out.mkdir()
            (out / part).symlink_to(victim)
            self.souple("run", self.scene(SMALL), "--out", out, "--frames", 2, "--write", "pc2,mdd",
                        "--checkpoint-every", 1)
            self.assertEqual(victim.read_text(), "of somebody else", part)
            self.assertFalse([n for n in out.iterdir() if n.is_symlink()])

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
        script = (f'mount -t tmpfs -o size={kilobytes}k none disk || exit 77\n"$0" "$@"; code=$?\n'
                  "for made in disk/*; do cp -r $made .; done; exit $code")
        done = self.command("unshare", "-rm", "bash", "-c", script, PROGRAM, *arguments)
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
        for formats, parts in (("pc2,mdd", (0.3, 0.8)), ("pc2,ply", (0.55,))):
            scene = self.scene(self.LONG)
            whole = self.souple("run", scene, "--out", "whole", "--write", formats)
            size = sum(f.stat().st_size for f in (self.folder / "whole").iterdir())
            for part in parts:
                done = self.on_small_disk(int(part * size / 1000), "run", scene, "--out", "disk/out", "--write", formats)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assert_one_line(done.stderr)
                self.assertIn("No space left on device", done.stderr)
                frames = self.assert_described()
                self.assertGreater(frames, 400 * part / 4)
                self.assertLess(frames, 400)
                self.souple("surface", "out", "--out", "meshes")  # other commands read what is left

    def test_the_manifest_of_surfaces_describes_its_meshes(self):
        """Covers `run --surface`, whose frames stop at the same one, and `surface`."""
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


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
