#!/usr/bin/env python3
"""The manual's C++ compiles, and its commands exist: test_snippets.py SOURCE_FOLDER INCLUDES COMPILER [PROGRAM].

Each ```cpp block of README and docs/ with a main function is compiled as it stands; one without is compiled inside what
CONTEXT gives for it. Each line of a ```sh block, and each command of the gallery's tables, is run with small numbers in place
of large ones, or its script is checked to exist. SOUPLE_QUARTER=0 to 3 runs every fourth of the gallery's commands only.
Standard library only.
"""

import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(sys.argv[1])
INCLUDES = re.split(r"\\?;", sys.argv[2])
COMPILER = sys.argv[3]
PROGRAM = sys.argv[4] if len(sys.argv) > 4 and sys.argv[4].startswith("/") else None
PAGES = ["README.md", *sorted(str(path.relative_to(SOURCE)) for path in SOURCE.glob("docs/*.md"))]

# (page, a word of the block): what stands before it, and whether the block is inside a function.
CONTEXT = {
    ("docs/collisions.md", "set_collide"):
        "#include <souple/souple.h>\nusing namespace souple;\n"
        "void snippet(World& world, const TriangleMesh& mesh, ObjectId veil) {\n",
    ("docs/embedding.md", "session.post"):
        "#include <souple/host/session.h>\nvoid snippet(souple::host::Session& session, souple::host::Handle cloth) {\n",
    ("docs/rigid-bodies.md", "add_rigid_body"):
        "#include <souple/mesh_files/mesh_file.h>\n#include <souple/souple.h>\nusing namespace souple;\n"
        "void snippet(World& world) {\n",
    ("docs/rigid-bodies.md", "set_kinematic"):
        "#include <souple/souple.h>\nusing namespace souple;\n"
        "void snippet(World& world, ObjectId crate, ObjectId bone, const std::vector<PoseKey>& keys) {\n",
    ("docs/joints.md", "joint::Hinge"):
        "#include <souple/souple.h>\nusing namespace souple;\n"
        "void snippet(World& world, ObjectId post, ObjectId door) {\n",
    ("docs/attachments.md", "add_tie"):
        "#include <souple/souple.h>\nusing namespace souple;\n"
        "void snippet(World& world, ObjectId rope, ObjectId crate, ObjectId ball, ObjectId sleeve, ObjectId shirt, ObjectId bead) {\n",
    ("docs/fluids.md", "FluidSurface"):
        "#include <souple/souple.h>\n#include <souple/threads/threads.h>\n#include <souple/surface/fluid_surface.h>\n"
        "void snippet(souple::World& world, souple::ObjectId water) {\n",
}
# Beginnings of lines that are not run: why.
NOT_RUN = {
    "script/": "builds or measures for minutes; the script must exist",
    "cmake": "builds; tests/package configures, builds and installs",
    "souple view": "needs a screen; tests/app/test_view_window.py opens it",
    "build/release/bin/souple view": "the same",
    "souple bench cloth --strain": "searches for minutes; tests/app/test_bench.py runs it small",
    "dask-scheduler": "needs a cluster; tests/app/test_sweep_cluster.py starts one",
    "SOUPLE_PROGRAM=": "the same",
    "python3 -m souple.sweep": "the same",
    "sbatch": "the same",
    "bash job.sh": "the same",
}
# Numbers of the manual's commands that take long, and what the test runs instead.
SMALLER = [(r"--frames \d+-\d+/\d+", "--frames 1-3/2"), (r"--frames \d+-\d+", "--frames 1-2"), (r"--frames \d+", "--frames 2"),
           (r"--size \d+x\d+", "--size 64x36"), (r"--samples \d+", "--samples 1"), (r"--sheet \d+x\d+", "--sheet 2x1")]


def blocks(language):
    for page in PAGES:
        for found in re.finditer(rf"^```{language}\n(.*?)^```$", (SOURCE / page).read_text(), re.M | re.S):
            yield page, found[1]


class Snippets(unittest.TestCase):
    def test_each_compiles(self):
        used = set()
        for page, text in blocks("cpp"):
            with self.subTest(page=page, begins=text.split("\n")[0]), tempfile.TemporaryDirectory() as folder:
                if not re.search(r"^int main\(", text, re.M):
                    key = next((k for k in CONTEXT if k[0] == page and k[1] in text), None)
                    self.assertIsNotNone(key, f"{page} shows a part of a program: give its context in CONTEXT")
                    used.add(key)
                    text = CONTEXT[key] + text + "}\n"
                file = pathlib.Path(folder, "snippet.cpp")
                file.write_text(text)
                standard = "c++17" if "session.h" in text else "c++20"
                done = subprocess.run([COMPILER, f"-std={standard}", "-fsyntax-only", "-Wall", "-Wno-unused-variable",
                                       *(f"-I{path}" for path in INCLUDES), str(file)], capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, f"{page}:\n{text}\n{done.stderr}")
        self.assertEqual(used, set(CONTEXT), "a context whose block is gone")


class Commands(unittest.TestCase):
    def lines(self):
        for page, text in blocks("sh"):
            for line in text.replace("\\\n", " ").split("\n"):
                line = re.sub(r"\s+#.*", "", line).strip()
                if line:
                    yield page, line
        shown = {}  # the first page that shows each command of the gallery
        for page in PAGES:
            for line in re.findall(r"<code>(souple [^<]*)</code>", (SOURCE / page).read_text()):
                shown.setdefault(line, page)
        self.assertGreater(len(shown), 60, "the gallery's tables show two commands for each scene")
        quarter = os.environ.get("SOUPLE_QUARTER")
        yield from ((page, line) for number, (line, page) in enumerate(shown.items())
                    if quarter is None or number // 2 % 4 == int(quarter) or not line.startswith("souple render"))

    def test_each_script_exists(self):
        for page, line in self.lines():
            word = line.split()[0]
            if word.startswith("script/"):
                with self.subTest(page=page, line=line):
                    self.assertTrue(os.access(SOURCE / word, os.X_OK), f"{page}: {word} is no program")

    def test_each_command_runs(self):
        if PROGRAM is None:
            self.skipTest("built without the program")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        work = pathlib.Path(folder.name)
        (work / "bin").mkdir()
        (work / "bin/souple").symlink_to(PROGRAM)
        (work / "build/release/bin").mkdir(parents=True)
        (work / "build/release/bin/souple").symlink_to(PROGRAM)
        (work / "my").mkdir()
        scene = (SOURCE / "scenes/flag.json").read_text()
        for name in "my_scene.json", "my/scene.json":
            (work / name).write_text(scene)
        pool = next(text for page, text in json_blocks() if page == "docs/fluids.md" and '"raft"' in text)
        (work / "pool.json").write_text(pool)
        environment = dict(os.environ, PATH=f"{work}/bin:{os.environ['PATH']}")
        self.run_in(work, environment, "souple run dam_break --frames 2 --quiet --out out/dam", "setup")
        self.run_in(work, environment, "souple run flag --frames 3 --quiet --out out/flag", "setup")
        for page, line in self.lines():
            if not any(line.startswith(words) for words in NOT_RUN):
                with self.subTest(page=page, line=line):
                    self.run_in(work, environment, line, page)

    def run_in(self, work, environment, line, page):
        for part in line.split("&&"):
            part = part.strip()
            for pattern, small in SMALLER:
                changed = re.sub(pattern, small, part)
                if changed != part:
                    part = changed
                    break
            part = " ".join(re.sub(pattern, small, part) for part in [part] for pattern, small in SMALLER[3:4])
            part = re.sub(SMALLER[4][0], SMALLER[4][1], part)
            words = shlex.split(part.split(">")[0])
            command = words[1] if len(words) > 1 else ""
            if command == "run" and "--frames" not in words:
                words += ["--frames", "3"]
            if command == "render" and "--size" not in words:
                words += ["--size", "64x36"]
            if command == "render" and "--samples" not in words:
                words += ["--samples", "1"]
            if command == "render" and "out/" not in words[2] and "--frames" not in words and "--sheet" not in words:
                words += ["--frames", "2"]
            if command == "sweep":
                words += ["--frames", "2", "--no-sheet"]
            if command == "bench":
                words += ["--size", "10", "--runs", "2"]
            done = subprocess.run(words, cwd=work, env=environment, capture_output=True, text=True, timeout=60,
                                  stdin=subprocess.DEVNULL)
            self.assertEqual(done.returncode, 0, f"{page}: {' '.join(words)}\n{done.stdout}{done.stderr}")
            if ">" in part:
                (work / part.split(">")[1].strip()).write_text(done.stdout)


def json_blocks():
    yield from blocks("json")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
