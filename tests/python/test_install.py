"""`pip install .` without network in a fresh environment, with the library of the build tree; then every example runs."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["SOUPLE_SOURCE"])


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.room = pathlib.Path(cls.folder.name)
        cls.python = str(cls.room / "venv/bin/python")
        subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", cls.room / "venv"], check=True)
        cls.environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV")}
        cls.run_python("-m", "pip", "install", "--no-index", "--quiet", "--disable-pip-version-check", str(SOURCE))

    @classmethod
    def run_python(cls, *arguments, code=0):
        result = subprocess.run([cls.python, *arguments], cwd=cls.room, env=cls.environment, capture_output=True, text=True, timeout=240)
        if result.returncode != code:
            raise AssertionError(f"{arguments}: exit code {result.returncode}\n{result.stdout}\n{result.stderr}")
        return result.stdout

    def test_the_package_is_that_of_the_environment(self):
        where = self.run_python("-c", "import souple; print(souple.__file__)")
        self.assertIn(str(self.room / "venv"), where)
        files = self.run_python("-m", "pip", "show", "--files", "souple")
        for name in ("_souple.", "py.typed", "scene.py", "LICENSE"):
            self.assertIn(name, files)

    def test_every_example_runs(self):
        examples = sorted((SOURCE / "python/examples").glob("*.py"))
        self.assertEqual(len(examples), 5)
        for example in examples:
            print(example.name, self.run_python(str(example)), sep="\n")
        for made in ("out/run.json", "out/cloth.pc2", "water.ply"):
            self.assertTrue((self.room / made).stat().st_size > 0, made)

    def test_the_readme_shows_hello(self):
        hello = (SOURCE / "python/examples/hello.py").read_text().split("\n\n", 1)[1]
        self.assertIn(f"```python\n{hello}```", (SOURCE / "README.md").read_text())


if __name__ == "__main__":
    unittest.main()
