#!/usr/bin/env python3
"""What scripts and presets promise: test_scripts.py SOURCE_FOLDER. Standard library only."""

import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

SOURCE = pathlib.Path(sys.argv[1])


class Bootstrap(unittest.TestCase):
    def installed(self, *arguments):
        """What script/bootstrap asks a machine without any package to install."""
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {"dpkg-query": "exit 1", "apt-get": f'echo "$@" >> {folder}/asked',
                               "sudo": 'exec "$@"'}.items():
                program = pathlib.Path(folder, name)
                program.write_text(f"#!/bin/sh\n{text}\n")
                program.chmod(0o755)
            subprocess.run([SOURCE / "script/bootstrap", *arguments], check=True, capture_output=True,
                           env=dict(os.environ, PATH=f"{folder}:{os.environ['PATH']}"))
            return pathlib.Path(folder, "asked").read_text().split()

    def test_a_build_can_make_films(self):
        self.assertIn("ffmpeg", self.installed("--build"))
        self.assertNotIn("libgtest-dev", self.installed("--build"))
        self.assertIn("ffmpeg", self.installed("--test"))


class Gallery(unittest.TestCase):
    """script/gallery --check in a copy of the tree finds what is older than its scene, changed or missing."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name)
        for part in "scenes", "docs":
            shutil.copytree(SOURCE / part, self.tree / part)
        (self.tree / "script").mkdir()
        for file in "script/gallery", "README.md":
            shutil.copy(SOURCE / file, self.tree / file)

    def complaints(self):
        done = subprocess.run([sys.executable, "-B", self.tree / "script/gallery", "--check"], capture_output=True, text=True)
        return set(done.stderr.splitlines())

    def test_changes_are_found(self):
        before = self.complaints()
        pictures = self.tree / "docs/pictures/gallery"
        with (self.tree / "scenes/flag.json").open("a") as scene:
            scene.write("\n")
        with (self.tree / "scenes/meshes/duck.obj").open("a") as mesh:
            mesh.write("\n")
        with (pictures / "sheet.png").open("ab") as picture:
            picture.write(b"!")
        (pictures / "display_plain.png").unlink()
        (pictures / "left_over.webp").write_bytes(bytes(12_000_000))
        readme = self.tree / "README.md"
        readme.write_text(readme.read_text().replace("souple view brick_wall", "souple view brick"))
        after = self.complaints()
        found = "\n".join(sorted(after))
        for words in ("constraints_color.png: its scene changed", "display_lattice.png: its scene changed",
                      "sheet.png: the file itself changed", "display_plain.png: is missing",
                      "left_over.webp: is not in script/gallery", "docs/pictures: has", "README.md: its gallery is not"):
            self.assertIn(words, found)
        self.assertNotIn("display_contacts.png", "\n".join(after - before), "the tablecloth has not changed")


def png(shades):
    """A gray picture one pixel high."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(shades), 1, 8, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(b"\0" + bytes(shades))) + chunk(b"IEND", b""))


@unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg reads the pictures")
class GalleryMeasure(unittest.TestCase):
    """script/gallery --measure, with a program that writes a given picture and says how much of it the subject fills."""

    def measured(self, scene, shades, width, height):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "picture.png").write_bytes(png(shades))
            program = pathlib.Path(folder, "souple")
            program.write_text('#!/bin/sh\nwhile [ $# -gt 1 ]; do [ "$1" = --out ] && out=$2; shift; done\n'
                               f'cp {folder}/picture.png "$out"; echo "the subject fills {width} % of the width, '
                               f'{height} % of the height"\n')
            program.chmod(0o755)
            return subprocess.run([sys.executable, "-B", SOURCE / "script/gallery", "--measure", "--program", program, scene],
                                  capture_output=True, text=True)

    def test_a_full_picture_with_black_and_white_passes(self):
        done = self.measured("flag", [0, 128, 255], 35, 60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("flag: frame 160: 35 % of the width, 60 % of the height", done.stdout)

    def test_each_bound_is_reported(self):
        for shades, width, height, miss in (([0, 255], 34, 60, "fills less than 35 %"), ([0, 255], 60, 34, "fills less than 35 %"),
                                            ([11, 255], 60, 60, "has no blacks"), ([0, 244], 60, 60, "has no whites")):
            with self.subTest(shades=shades, width=width, height=height):
                done = self.measured("flag", shades, width, height)
                self.assertEqual(done.returncode, 1)
                self.assertEqual([miss in line for line in done.stderr.splitlines()], [True], done.stderr)


class Presets(unittest.TestCase):
    def setUp(self):
        presets = json.loads((SOURCE / "CMakePresets.json").read_text())["configurePresets"]
        self.presets = {preset["name"]: preset for preset in presets}

    def variables(self, name):
        preset = self.presets[name]
        inherited = self.variables(preset["inherits"]) if "inherits" in preset else {}
        return {**inherited, **preset.get("cacheVariables", {})}

    def test_a_warning_fails_no_build_of_a_user(self):
        self.assertNotEqual(self.variables("release").get("SOUPLE_WARNINGS_AS_ERRORS", "OFF"), "ON")
        self.assertNotIn("AS_ERRORS", (SOURCE / "script/demo").read_text())

    def test_a_warning_fails_ours(self):
        for name in "debug", "asan", "tsan", "clang":
            self.assertEqual(self.variables(name)["SOUPLE_WARNINGS_AS_ERRORS"], "ON", name)
        self.assertIn("SOUPLE_WARNINGS_AS_ERRORS=ON", (SOURCE / ".ci/run").read_text())
        self.assertIn("cmake --preset clang", (SOURCE / "script/lint").read_text())

    def test_script_test_makes_warnings_errors_in_ci(self):
        for ci, wanted in {"true": "ON", "": "OFF"}.items():
            with tempfile.TemporaryDirectory() as folder:
                for name, text in {"cmake": f'echo "$@" >> {folder}/asked', "ctest": "exit 0", "dpkg-query": "echo installed"}.items():
                    program = pathlib.Path(folder, name)
                    program.write_text(f"#!/bin/sh\n{text}\n")
                    program.chmod(0o755)
                subprocess.run([SOURCE / "script/test"], check=True, capture_output=True,
                               env=dict(os.environ, CI=ci, PATH=f"{folder}:{os.environ['PATH']}"))
                self.assertIn(f"SOUPLE_WARNINGS_AS_ERRORS={wanted}", pathlib.Path(folder, "asked").read_text())


class Demo(unittest.TestCase):
    def test_the_picture_comes_before_the_rest_is_built(self):
        """With programs that only write down what they are asked for."""
        with tempfile.TemporaryDirectory() as folder:
            tree = pathlib.Path(folder, "tree")
            (tree / "script").mkdir(parents=True)
            (tree / "script/demo").write_text((SOURCE / "script/demo").read_text())
            log = f'echo "$(basename "$0") $@" >> {folder}/asked'
            programs = {tree / "script/bootstrap": log, pathlib.Path(folder, "cmake"): log,
                        tree / "build/release/bin/souple":
                            f'{log}; [ "$1" != info ] || printf "pictures: yes\\nfilms: yes\\n"; mkdir -p out/demo; '
                            "touch out/demo/run.json out/demo/demo.png"}
            for path, text in programs.items():
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(f"#!/bin/sh\n{text}\n")
                path.chmod(0o755)
            (tree / "script/demo").chmod(0o755)
            subprocess.run([tree / "script/demo"], check=True, capture_output=True,
                           env=dict(os.environ, PATH=f"{folder}:{os.environ['PATH']}"))
            asked = pathlib.Path(folder, "asked").read_text().split("\n")
            at = {word: next(i for i, line in enumerate(asked) if word in line)
                  for word in ("SETS=scalar", "demo.png", "SETS=all", "demo.mp4")}
            self.assertEqual(sorted(at, key=at.get), ["SETS=scalar", "demo.png", "SETS=all", "demo.mp4"], asked)
            self.assertIn("SOUPLE_WITH_VIEWER=OFF", asked[at["SETS=scalar"]])
            self.assertIn("SOUPLE_WITH_VIEWER=AUTO", asked[at["SETS=all"]])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
