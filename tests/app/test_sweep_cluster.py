#!/usr/bin/env python3
"""Sweeps on clusters of this machine: test_sweep_cluster.py PROGRAM SOURCE_FOLDER [unittest's arguments].

A Dask scheduler with two workers, one of which is killed; Slurm with one node, started by an ordinary user. Where Debian's
python3-distributed or slurm-wlm is not installed, the exit code is 77 and CTest skips the test."""

import getpass
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
import unittest

from cli_case import PROGRAM, SMALL, SOURCE
from test_sweep import SweepCase

SKIPPED = 77
# Without munge and without accounting; ports and paths follow.
SLURM = """ClusterName=test
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SwitchType=switch/none
MpiDefault=none
SchedulerParameters=sched_interval=1,batch_sched_delay=0
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def python_with_distributed():
    """Debian's package serves Debian's Python, which need not be the one that runs this."""
    for python in sys.executable, "/usr/bin/python3":
        found = subprocess.run([python, "-c", "import distributed"], capture_output=True, check=False)
        if found.returncode == 0:
            return python
    return None


def free_port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


class ClusterCase(SweepCase):
    def begin(self, *command):
        log = open(self.folder / f"{time.monotonic_ns()}.log", "w")
        self.addCleanup(log.close)
        process = subprocess.Popen(command, cwd=self.folder, env=self.environment, stdout=log, stderr=log)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        process.terminate()
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


class Dask(ClusterCase):
    @classmethod
    def setUpClass(cls):
        cls.python = python_with_distributed()
        if not cls.python:
            raise unittest.SkipTest("the Debian package python3-distributed is not installed")

    def setUp(self):
        super().setUp()
        self.environment["SOUPLE_PROGRAM"] = PROGRAM

    def begin_dask(self, module, *arguments):
        return self.begin(self.python, "-m", f"distributed.cli.{module}", *arguments, "--no-dashboard")

    def client_until(self, count, address, sweep):
        """Begins the sweep, or continues it, until there are so many results."""
        client = subprocess.Popen([self.python, "-B", SOURCE / "python/souple/sweep.py", "--cluster", address, *sweep,
                                   "--out", "cluster"], cwd=self.folder, env=self.environment, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True)
        self.wait_for_results("cluster", count, client)
        self.assertLess(len(self.results("cluster")), 24)
        return client

    def test_client_is_killed_twice_and_a_worker_once(self):
        port = free_port()
        address = f"tcp://127.0.0.1:{port}"
        self.begin_dask("dask_scheduler", "--host", "127.0.0.1", "--port", str(port))
        workers = [self.begin_dask("dask_worker", address, "--nthreads", "1", "--no-nanny", "--host", "127.0.0.1")
                   for _ in range(2)]
        scene = self.scene(dict(SMALL, frames=60, substeps=20))
        sweep = [scene, "--set", "objects.flag.material.bending_stiffness=1e-6:1e-4:log8", "--set",
                 "wind.velocity.0=0:10:3", "--no-sheet"]
        for count in 3, 7:
            client = self.client_until(count, address, sweep)
            client.kill()
            client.communicate()
        times = {file: file.stat().st_mtime_ns for file in self.results("cluster")}
        client = self.client_until(11, address, sweep)
        workers[0].send_signal(signal.SIGKILL)
        out, error = client.communicate(timeout=120)
        self.assertEqual(client.returncode, 0, out + error)
        self.assertIn("24 runs, in cluster/table.csv", out)
        for file, when in times.items():
            self.assertEqual(file.stat().st_mtime_ns, when, f"{file} was done and is done again")
        self.souple("sweep", *sweep, "--out", "local")
        rows = self.without_times("cluster")
        self.assertEqual([int(row["run"]) for row in rows], list(range(1, 25)))
        self.assertEqual(rows, self.without_times("local"))

    def test_bad_input(self):
        def said(*arguments):
            done = subprocess.run([self.python, "-B", SOURCE / "python/souple/sweep.py", *arguments], cwd=self.folder,
                                  env=self.environment, capture_output=True, text=True, timeout=60)
            self.assertNotEqual(done.returncode, 0)
            self.assertNotIn("Traceback", done.stderr)
            return done.stderr

        scene = self.scene(SMALL)
        nowhere = ["--cluster", "tcp://127.0.0.1:1"]
        self.assertIn("expected --out DIR", said(*nowhere, scene, "--set", "drag=1,2"))
        self.assertIn("expected A:B:N", said(*nowhere, scene, "--set", "drag=1:2", "--out", "out"))
        self.assertIn("--only has no meaning", said(*nowhere, scene, "--set", "drag=1,2", "--out", "out", "--only", "1"))


class Slurm(ClusterCase):
    @classmethod
    def setUpClass(cls):
        cls.daemons = [shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin") for name in ("slurmctld", "slurmd")]
        if None in cls.daemons or not shutil.which("sbatch"):
            raise unittest.SkipTest("the Debian package slurm-wlm is not installed")

    def said(self, *command):
        return subprocess.run([*map(str, command)], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60).stdout

    def wait_until(self, condition):
        for _ in range(400):
            if condition():
                return
            time.sleep(0.1)
        logs = "\n".join(file.read_text(errors="replace") for file in self.folder.glob("*.log"))
        self.fail("nothing happened for forty seconds\n" + logs)

    def start_node(self):
        host, user, here = socket.gethostname().split(".")[0], getpass.getuser(), self.folder
        (here / "slurm.conf").write_text(
            SLURM + f"SlurmctldHost={host}(127.0.0.1)\nSlurmUser={user}\nSlurmdUser={user}\n"
            f"SlurmctldPort={free_port()}\nSlurmdPort={free_port()}\nStateSaveLocation={here}\nSlurmdSpoolDir={here}/spool\n"
            f"SlurmctldPidFile={here}/controller.pid\nSlurmdPidFile={here}/node.pid\n"
            f"SlurmctldLogFile={here}/controller.log\nSlurmdLogFile={here}/node.log\n"
            f"NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN\n")
        self.environment["SLURM_CONF"] = str(here / "slurm.conf")
        self.begin(self.daemons[0], "-D")
        self.begin(self.daemons[1], "-D", "-N", host)
        self.wait_until(lambda: "idle" in self.said("sinfo", "--noheader"))

    def test_array_job(self):
        self.start_node()
        sweep = [self.scene(SMALL), "--set", "drag=0:2:6", "--no-sheet"]
        self.souple("sweep", *sweep, "--out", "cluster", "--slurm", "job.sh")
        self.assertIn("to start at", self.said("sbatch", "--test-only", "job.sh"))
        self.assertIn("Submitted batch job", self.said("sbatch", "job.sh"))
        self.wait_until(lambda: not self.said("squeue", "--noheader"))
        self.assertIn("6 runs, in", self.said("bash", "job.sh", "--table"))
        self.souple("sweep", *sweep, "--out", "local")
        self.assertEqual(self.without_times("cluster"), self.without_times("local"))


if __name__ == "__main__":
    ended = unittest.main(argv=[sys.argv[0], *sys.argv[3:]], exit=False).result
    if ended.skipped and not ended.testsRun:
        print(f"skipped: {ended.skipped[0][1]}")
        sys.exit(SKIPPED)
    sys.exit(not ended.wasSuccessful())
