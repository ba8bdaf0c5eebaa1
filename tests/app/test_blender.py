#!/usr/bin/env python3
"""What Blender makes of Souple's files: test_blender.py PROGRAM SOURCE_FOLDER [unittest's arguments].

Blender runs without a window. Where it is not installed, the exit code is 77 and CTest skips the test."""

import array
import base64
import json
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = str(Path(sys.argv[1]).resolve()) if len(sys.argv) > 2 else ""
SOURCE = Path(sys.argv[2]).resolve() if len(sys.argv) > 2 else Path()
BLENDER = shutil.which("blender")
SKIPPED = 77
TOLERANCE = 1e-6  # m


def pc2_frames(path):
    data = path.read_bytes()
    points, samples = struct.unpack_from("<i", data, 16)[0], struct.unpack_from("<i", data, 28)[0]
    frames = [array.array("f", data[32 + 12 * points * k:32 + 12 * points * (k + 1)]) for k in range(samples)]
    return points, frames


def ply_points(path):
    """x, y, z of a binary PLY whose other properties are floats too."""
    data = path.read_bytes()
    head, body = data.split(b"end_header\n", 1)
    count = int(re.search(rb"element vertex (\d+)", head).group(1))
    width = head.count(b"property float")
    values = array.array("f", body[:4 * width * count])
    return [c for i in range(count) for c in values[width * i:width * i + 3]]


def obj_points(path):
    return [float(c) for line in path.read_text().splitlines() if line.startswith("v ") for c in line.split()[1:4]]


def unpacked(text):
    return array.array("f", base64.b64decode(text))


def z_up(y_up):
    """Souple's axes in Blender's: (x, y, z) becomes (x, -z, y)."""
    return [c for i in range(0, len(y_up), 3) for c in (y_up[i], -y_up[i + 2], y_up[i + 1])]


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="souple-blender-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def souple(self, *arguments, code=0):
        done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def blender(self, jobs):
        (self.folder / "jobs.json").write_text(json.dumps(jobs))
        done = subprocess.run([BLENDER, "--background", "--factory-startup", "--python-exit-code", "1", "--python",
                               str(SOURCE / "tests/app/blender_import.py"), "--", str(self.folder / "jobs.json"),
                               str(self.folder / "results.json")],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600)
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
        (self.folder / "scene.json").write_text(json.dumps(scene))
        return "scene.json"


class EveryScene(Case):
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


if __name__ == "__main__":
    if BLENDER is None:
        print("skipped: blender is not installed")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
