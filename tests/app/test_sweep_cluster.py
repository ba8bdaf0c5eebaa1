#!/usr/bin/env python3
"""Sweeps on clusters of this machine: test_sweep_cluster.py PROGRAM SOURCE_FOLDER [unittest's arguments].

A Dask scheduler with two workers, one of which is killed. Where python3-distributed is not installed, the exit
code is 77 and CTest skips the test."""

import csv
import signal
import socket
import subprocess
import sys
import time
import unittest

from cli_case import PROGRAM, SMALL, SOURCE, Case

SKIPPED = 77


def python_with_distributed():
    """Debian's package serves Debian's Python, which need not be the one that runs this."""
    for python in sys.executable, "/usr/bin/python3":
        found = subprocess.run([python, "-c", "import distributed"], capture_output=True, check=False)
        if found.returncode == 0:
            return python
    return None


class Cluster(Case):
    def setUp(self):
        super().setUp()
        self.environment["SOUPLE_PROGRAM"] = PROGRAM

    def begin(self, module, *arguments):
        log = open(self.folder / f"{module}{time.monotonic_ns()}.log", "w")
        self.addCleanup(log.close)
        process = subprocess.Popen([PYTHON, "-m", f"distributed.cli.{module}", *arguments, "--no-dashboard"],
                                   cwd=self.folder, env=self.environment, stdout=log, stderr=log)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def results(self, folder):
        return list((self.folder / folder).glob("*/result.json"))

    def rows(self, folder):
        with open(self.folder / folder / "table.csv", newline="", encoding="utf-8") as file:
            return [{key: value for key, value in row.items() if key != "seconds"} for row in csv.DictReader(file)]

    def test_a_worker_is_killed(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        address = f"tcp://127.0.0.1:{port}"
        self.begin("dask_scheduler", "--host", "127.0.0.1", "--port", str(port))
        workers = [self.begin("dask_worker", address, "--nthreads", "1", "--no-nanny", "--host", "127.0.0.1")
                   for _ in range(2)]
        scene = self.scene(dict(SMALL, frames=100, substeps=30))
        sweep = [scene, "--set", "objects.flag.material.bending_stiffness=1e-6:1e-4:log8", "--set",
                 "wind.velocity.0=0:10:3", "--no-sheet"]
        client = subprocess.Popen([PYTHON, "-B", SOURCE / "python/souple/sweep.py", "--cluster", address, *sweep,
                                   "--out", "cluster"], cwd=self.folder, env=self.environment, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True)
        for _ in range(6000):
            if len(self.results("cluster")) >= 6 or client.poll() is not None:
                break
            time.sleep(0.01)
        workers[0].send_signal(signal.SIGKILL)
        self.assertLess(len(self.results("cluster")), 24)
        out, error = client.communicate(timeout=120)
        self.assertEqual(client.returncode, 0, out + error)
        self.assertIn("24 runs, in cluster/table.csv", out)
        self.souple("sweep", *sweep, "--out", "local")
        rows = self.rows("cluster")
        self.assertEqual([int(row["run"]) for row in rows], list(range(1, 25)))
        self.assertEqual(rows, self.rows("local"))

    def test_bad_input(self):
        def said(*arguments):
            done = subprocess.run([PYTHON, "-B", SOURCE / "python/souple/sweep.py", *arguments], cwd=self.folder,
                                  env=self.environment, capture_output=True, text=True, timeout=60)
            self.assertNotEqual(done.returncode, 0)
            self.assertNotIn("Traceback", done.stderr)
            return done.stderr

        scene = self.scene(SMALL)
        nowhere = ["--cluster", "tcp://127.0.0.1:1"]
        self.assertIn("expected --out DIR", said(*nowhere, scene, "--set", "drag=1,2"))
        self.assertIn("expected A:B:N", said(*nowhere, scene, "--set", "drag=1:2", "--out", "out"))
        self.assertIn("--only has no meaning", said(*nowhere, scene, "--set", "drag=1,2", "--out", "out", "--only", "1"))


if __name__ == "__main__":
    PYTHON = python_with_distributed()
    if PYTHON is None:
        print("skipped: the Debian package python3-distributed is not installed")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
