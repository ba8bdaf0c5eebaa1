"""Scenes that the tests of the souple program share, and a case with a folder of its own that runs the program."""

import json
import os
import resource
import shutil
import signal
import struct
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


def png_size(path):
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and data[-8:-4] == b"IEND", f"{path} is no whole PNG"
    return struct.unpack(">II", data[16:24])


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="souple-test-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.environment = {**os.environ, "SOUPLE_THREADS": "1"}
        self.environment.pop("SOUPLE_SCENES", None)

    def scene(self, description, name="small.json"):
        path = self.folder / name
        path.write_text(description if isinstance(description, str) else json.dumps(description))
        return str(path)

    def command(self, *words, **options):
        """Runs a command in the folder. Its return code is not checked."""
        return subprocess.run([*map(str, words)], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=120, **options)

    def souple(self, *arguments, code=0):
        done = self.command(PROGRAM, *arguments)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def start(self, *arguments):
        """The program in the background, until the test ends at the latest."""
        process = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, env=self.environment,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for cleanup in process.stdout.close, process.stderr.close, process.wait, process.kill:
            self.addCleanup(cleanup)
        return process

    def wait_for(self, condition, process):
        """Returns when it holds, or when the process has ended."""
        for _ in range(6000):
            if condition() or process.poll() is not None:
                return
            time.sleep(0.005)
        self.fail("nothing happened for thirty seconds")

    def stop(self, process, how=signal.SIGINT, code=130):
        """Sends a signal and waits for the end. Returns what was printed, and the errors."""
        process.send_signal(how)
        out, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, code, out + error)
        return out, error

    def limited(self, megabytes, *arguments):
        """Runs the program with a limit of its address space. Its return code is not checked."""
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        return self.command(PROGRAM, *arguments, preexec_fn=limit)

    def has_sanitizer(self):
        """Whether the program was built with one: no such program starts in 4 GB."""
        return self.limited(4096, "--version").returncode != 0

    def skip_sanitizers(self, why):
        if self.has_sanitizer():
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
