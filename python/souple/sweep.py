#!/usr/bin/env python3
"""`souple sweep` on a Dask cluster:

    python3 -m souple.sweep --cluster tcp://HOST:8786 SCENE --set substeps=5:20:4 --out DIR

Each run is a task, `souple sweep ... --only N`. Clients and workers share DIR under one path and have the same version of
the program `souple`: SOUPLE_PROGRAM, else the one on PATH. Needs Debian's python3-distributed; without --cluster it starts
`souple sweep` on this machine. A run whose worker dies is done again; a run that is done is not.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

FINAL = ("finished", "diverged")


def find_program():
    program = os.environ.get("SOUPLE_PROGRAM") or shutil.which("souple")
    if not program or not shutil.which(program):
        sys.exit(f"souple.sweep: no program {program or 'souple'}: install it, or set SOUPLE_PROGRAM to its path")
    return str(Path(shutil.which(program)).resolve())


def do_run(program, arguments, folder, run):
    """On a worker: simulates a run. Returns the exit code and the messages of the program."""
    import os
    import shutil
    import subprocess

    own = os.environ.get("SOUPLE_PROGRAM") or (program if os.path.exists(program) else shutil.which("souple"))
    if not own:
        return 127, "this worker has no program souple: set SOUPLE_PROGRAM to its path"
    done = subprocess.run([own, "sweep", *arguments, "--only", str(run)], cwd=folder, stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)
    return done.returncode, done.stderr.strip()


class Sweep:
    """A sweep's command on this machine."""

    def __init__(self, arguments, out, quiet):
        self.program, self.out, self.quiet = find_program(), Path(out), quiet
        self.arguments = [*arguments, "--out", out]

    def souple(self, *parts):
        """Runs a part of the command; ends with its message where it fails. Codes 2 and 3 of a table tell of runs."""
        done = subprocess.run([self.program, "sweep", *self.arguments, *parts], stdin=subprocess.DEVNULL,
                              capture_output=True, text=True)
        if done.returncode not in ((0, 2, 3) if "--table" in parts and not done.stderr else (0,)):
            sys.stderr.write(done.stderr)
            sys.exit(done.returncode)
        return done

    def gather(self):
        """Writes the table; returns its rows, the program's line about it, and its exit code."""
        done = self.souple("--table")
        return json.loads((self.out / "table.json").read_text(encoding="utf-8")), done.stdout, done.returncode

    def on_cluster(self, client, tries):
        """Simulates what is missing. Returns an exit code."""
        from distributed import as_completed

        rows, _, _ = self.gather()
        left = {row["run"]: tries for row in rows if row["status"] not in FINAL}
        run_of = {}

        def submit(run):
            left[run] -= 1
            future = client.submit(do_run, self.program, self.arguments, os.getcwd(), run, pure=False)
            run_of[future.key] = run
            return future

        futures = as_completed([submit(run) for run in left])
        for future in futures:
            run, problem = run_of[future.key], self.problem_of(future)
            if problem and left[run] > 0:
                futures.add(submit(run))
            elif problem:
                print(f"souple.sweep: run {run}: {problem}", file=sys.stderr)
        rows, line, code = self.gather()
        if not self.quiet:
            sys.stdout.write(line)
        return code or any(row["status"] == "missing" for row in rows)

    @staticmethod
    def problem_of(future):
        """Why a task has to be repeated: its worker died, or was interrupted, or could not write. Else nothing."""
        if future.status != "finished":
            return f"its worker failed: {future.exception()!r}"
        code, messages = future.result()
        if code in (0, 2, 3):  # with a result; messages of 2 and 3 are in the table
            return None
        return messages or f"exit code {code}"


def main():
    parser = argparse.ArgumentParser(prog="python3 -m souple.sweep", description=__doc__.split("\n", 1)[0],
                                     epilog="All other arguments are those of `souple sweep`, see its --help.",
                                     allow_abbrev=False)
    parser.add_argument("--cluster", metavar="tcp://HOST:PORT", help="address of a Dask scheduler")
    parser.add_argument("--out", metavar="DIR", help="the folder to write to, shared by all workers")
    parser.add_argument("--tries", type=int, default=3, help="how often a run is started whose worker dies [3]")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    options, arguments = parser.parse_known_args()
    if not options.cluster:
        program = find_program()
        out = ["--out", options.out] if options.out else []
        os.execv(program, [program, "sweep", *arguments, *out, *(["--quiet"] if options.quiet else [])])
    if not options.out:
        parser.error("expected --out DIR, a folder that all workers share")
    if options.tries < 1:
        parser.error("--tries: expected a number above 0")
    for part in ("--only", "--table", "--dry-run", "--slurm", "--jobs"):
        if any(argument.split("=")[0] == part for argument in arguments):
            parser.error(f"{part} has no meaning with --cluster; omit one of the two")
    try:
        from distributed import Client
    except ImportError:
        sys.exit("souple.sweep: --cluster needs the Debian package python3-distributed")
    sweep = Sweep(arguments, options.out, options.quiet)
    sweep.souple("--dry-run")  # an invalid command ends here
    try:
        client = Client(options.cluster, timeout=10)
    except (OSError, TimeoutError, ValueError) as error:
        sys.exit(f"souple.sweep: no scheduler at {options.cluster}: {error}; start one with dask-scheduler")
    if not client.scheduler_info()["workers"]:
        print("souple.sweep: the cluster has no worker yet; start some with dask-worker", file=sys.stderr)
    with client:
        sys.exit(int(sweep.on_cluster(client, options.tries)))


if __name__ == "__main__":
    main()
