#!/usr/bin/env python3
"""Scenes far larger than any: test_large_scenes.py PROGRAM SOURCE_FOLDER. Standard library only."""

import os
import subprocess
import sys
import unittest

from cli_case import PROGRAM, Case


class LargeScenes(Case):
    def measured(self, *arguments, code=0):
        """(processor time outside the kernel [s], memory [MB], errors) of the program."""
        with open(self.folder / "errors", "w+") as errors:
            process = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=errors)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            errors.seek(0)
            said = errors.read()
        self.assertEqual(process.returncode, code, f"{arguments}\n{said}")
        return usage.ru_utime, usage.ru_maxrss / 1024, said

    def both(self, scene, code=0):
        """Measures check and one frame."""
        frame = ["run", scene, "--frames", "1", "--quiet", "--out", self.folder / "out"]
        return [self.measured(*command, code=code) for command in (["check", scene], frame)]

    def grid(self, side):
        """An obstacle of side x side vertices from an OBJ."""
        columns = [f"{0.01 * i:.2f} 0 " for i in range(side)]
        with open(self.folder / f"{side}.obj", "w") as file:
            for row in range(side):
                file.write("".join(f"v {x}{0.01 * row:.2f}\n" for x in columns))
            for row in range(side - 1):
                first = row * side
                file.write("".join(f"f {i} {i + 1} {i + side + 1} {i + side}\n" for i in range(first + 1, first + side)))
        obstacle = {"kind": "obstacle", "mesh": {"file": f"{side}.obj"}}
        return self.scene({"souple": 1, "frames": 1, "objects": [obstacle]}, f"{side}.json")

    def test_ten_million_vertices_take_time_and_memory_in_proportion(self):
        small, large = self.both(self.grid(1000)), self.both(self.grid(3163))
        for (tenth, tenth_memory, _), (time, memory, _) in zip(small, large):
            print(f"{time:.2f} s, {memory:.0f} MB; a tenth of it: {tenth:.2f} s, {tenth_memory:.0f} MB")
            self.assertLess(time, 15 * tenth)
            self.assertLess(memory, 12 * tenth_memory)

    def test_ten_thousand_objects_take_time_in_proportion_and_more_are_refused(self):
        def grains(count):
            objects = [{"kind": "grains", "points": [[0.1 * i, 1, 0]]} for i in range(count)]
            return self.scene({"souple": 1, "frames": 1, "objects": objects}, f"grains{count}.json")

        small, large = self.both(grains(1000)), self.both(grains(10000))
        for (tenth, _, _), (time, _, _) in zip(small, large):
            self.assertLess(time, 20 * tenth + 0.5)
        for time, _, said in self.both(grains(100000), code=2):
            self.assertIn("objects: expected a list of 0 to 10000 entries, found 100000", said)
            self.assertLess(time, 10)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
