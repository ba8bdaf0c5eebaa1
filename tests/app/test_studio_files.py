#!/usr/bin/env python3
"""GLB and USDA of every shipped scene, compared with the run and read by programs of others: test_studio_files.py PROGRAM
SOURCE_FOLDER [unittest's arguments].

The Khronos validator and tinyusdz come from npm. Where they cannot be installed, the test says so and checks the rest."""

import json
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from cli_case import PROGRAM, SOURCE, Case
from studio_files import Run, compare_glb, compare_usda

PACKAGES = ["gltf-validator@2.0.0-dev.3.10", "tinyusdz@0.9.0-rc10"]
FRAMES = 2


def node_modules():
    """The folder of the packages, or None and the reason."""
    if not shutil.which("node") or not shutil.which("npm"):
        return None, "node or npm is not installed"
    folder = Path(PROGRAM).parent.parent / "npm_files"
    modules = folder / "node_modules"
    if all((modules / name.split("@")[0]).is_dir() for name in PACKAGES):
        return modules, ""
    try:
        subprocess.run(["npm", "install", "--prefix", folder, "--no-audit", "--no-fund", "--silent", *PACKAGES],
                       stdin=subprocess.DEVNULL, capture_output=True, timeout=60, check=True)
    except (subprocess.SubprocessError, OSError):
        return None, "npm cannot install gltf-validator and tinyusdz"
    return modules, ""


class EveryScene(Case):
    def convert(self, scene, layouts):
        """The files of the last frame."""
        self.souple("run", scene, "--frames", FRAMES, "--out", scene, "--quiet")
        run, files = Run(self.folder / scene, FRAMES), []
        for layout in layouts:
            out = self.folder / f"{scene}_{layout}"
            self.souple("convert", scene, "--write", "glb,usda", "--layout", layout, "--out", out, "--quiet")
            glb = out / f"{scene}.glb"
            if not glb.exists():
                glb = out / f"{scene}_{FRAMES:04}.glb"
            with self.subTest(scene=scene, layout=layout):
                compare_glb(glb, run)
                compare_usda(out / f"{scene}.usda", run)
            files += [glb, out / f"{scene}.usda"]
        return run, files

    def test_scenes(self):
        scenes = [scene["name"] for scene in json.loads(self.souple("list", "--json").stdout)]
        self.assertGreaterEqual(len(scenes), 36)
        modules, reason = node_modules()
        if modules is None:
            print(f"skipped, the Khronos validator and tinyusdz: {reason}")
        for number, scene in enumerate(scenes):
            layouts = ["auto", "frames"] if number % 4 == 0 else ["auto"]
            run, files = self.convert(scene, layouts)
            if modules is not None:
                self.check_with_others(modules, run, files)
            for path in [self.folder / scene, *(self.folder / f"{scene}_{layout}" for layout in layouts)]:
                shutil.rmtree(path)

    def check_with_others(self, modules, run, files):
        done = subprocess.run(["node", SOURCE / "tests/app/check_studio_files.mjs", modules], text=True, capture_output=True,
                              input=json.dumps([str(f) for f in files]), timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr[-2000:])
        results = json.loads(done.stdout)
        for file, result in zip(files, results):
            self.assertEqual((result["errors"], result["warnings"]), (0, 0), f"{file}: {result['messages']}")
        # tinyusdz sees the meshes of a stage, but no value clips.
        meshes = {name for name, o in run.objects.items() if o["mesh"]}
        self.assertEqual(set(results[1]["meshes"]), {name.replace("-", "_") for name in meshes}, files[1])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
