"""The types that editors and mypy see are those of the module."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["SOUPLE_SOURCE"])
PACKAGE = pathlib.Path(os.environ["PYTHONPATH"].split(os.pathsep)[0]) / "souple"


@unittest.skipUnless(shutil.which("mypy") and shutil.which("stubtest"), "mypy is not installed")
class Stubs(unittest.TestCase):
    def run_tool(self, *command, **options):
        with tempfile.TemporaryDirectory() as folder:
            # The package is found in the folder of this one, not in that of another version that is installed.
            environment = {**os.environ, "MYPYPATH": str(PACKAGE.parent), "MYPY_CACHE_DIR": folder}
            return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=240, **options)

    def test_stubtest_finds_no_difference(self):
        result = self.run_tool("stubtest", "souple._souple", "--ignore-missing-stub", "--concise")
        # Differences of all classes of pybind11: a metaclass, and a constructor that refuses where the module has none.
        of_pybind11 = re.compile(r"souple\._souple[\w.]+ is inconsistent, (metaclass differs|stub does not have \*args argument.*)")
        lines = [line for line in result.stdout.splitlines() if not of_pybind11.fullmatch(line)]
        self.assertEqual(lines, [], result.stdout[-2000:] + result.stderr)
        self.assertIn("metaclass", result.stdout)

    def test_stubs_and_examples_are_typed(self):
        examples = sorted(str(path) for path in (SOURCE / "python/examples").glob("*.py"))
        result = self.run_tool("mypy", "--python-executable", sys.executable, "--check-untyped-defs", "--scripts-are-modules", "--ignore-missing-imports", *examples)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_a_wrong_call_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "wrong.py"
            file.write_text("import souple\n\nworld = souple.World(substeps=10)\n"
                            "cloth = world.add_cloth(souple.grid(4, 4, 1.0), souple.material.cotton)\n"
                            "world.step('fast')\nworld.pin(cloth, 3)\nsouple.World(substep=10)\n"
                            "world.step(1 / 60).milisecond\n")
            result = self.run_tool("mypy", "--python-executable", sys.executable, str(file))
            lines = [line.split(":")[1] for line in result.stdout.splitlines() if ": error:" in line]
            self.assertEqual(lines, ["5", "6", "7", "8"], result.stdout + result.stderr)


if __name__ == "__main__":
    unittest.main()
