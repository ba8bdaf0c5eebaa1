#!/usr/bin/env python3
"""Tests of `souple bench` and `souple info --memory`: test_bench.py PROGRAM SOURCE_FOLDER [unittest's arguments]."""

import json
import sys
import unittest

from cli_case import Case

NAMES = {"cloth": 12, "cloth-dihedral": 12, "cloth-isometric": 12, "cloth-membrane": 12, "tets": 100, "cloths": 2,
         "cubes": 2, "heap": 12}


class Bench(Case):
    def bench(self, *arguments):
        warm_up = [] if "--warm-up" in arguments else ["--warm-up", 1]
        return json.loads(self.souple("bench", *arguments, *warm_up, "--json", "--runs", 4).stdout)

    def test_lists_what_there_is(self):
        listed = self.souple("bench").stdout.splitlines()
        self.assertEqual([line.split()[0] for line in listed], [*NAMES, "dam-break"])

    def test_every_benchmark_says_everything(self):
        for name, size in NAMES.items():
            result = self.bench(name, "--size", size)
            self.assertEqual((result["name"], result["size"], result["threads"]), (name, size, 1))
            for key in ("particles", "constraints", "ms_per_step", "constraints_per_second", "max_strain"):
                self.assertGreater(result[key], -1e-9, f"{name}: {key}")
            self.assertGreater(result["constraints"], 0)
            self.assertRegex(result["hash"], "^[0-9a-f]{16}$")
            self.assertIn("solve", result["ms_per_stage"])
            self.assertTrue(result["projections_per_second"], name)
            whole = result["constraints"] * result["substeps"] * result["iterations"] / result["ms_per_step"] * 1e3
            self.assertAlmostEqual(result["constraints_per_second"] / whole, 1, places=3)
            parts = sum(result["ms_per_stage"].values())
            self.assertGreater(parts, 0.5 * result["ms_per_step"], name)

    def test_dam_break(self):
        result = self.bench("dam-break", "--size", 2000)
        self.assertLess(abs(result["particles"] - 2000), 200)
        self.assertGreater(result["ms_per_stage"]["fluids"], 0)
        self.assertLess(result["density_error"], 0.01)
        for threads in (1, 8):
            self.assertEqual(self.bench("dam-break", "--size", 2000, "--threads", threads)["hash"], result["hash"])

    def test_kinds_and_counts_are_those_of_the_meshes(self):
        n = 12
        edges, inner = 3 * n * n - 4 * n + 1, 3 * n * n - 8 * n + 5  # 119201 and 118405 at 200
        cloth = self.bench("cloth", "--size", n)
        self.assertEqual(cloth["constraints"], edges + inner)
        self.assertEqual(list(cloth["projections_per_second"]), ["distance"])
        dihedral = self.bench("cloth-dihedral", "--size", n)
        self.assertEqual(dihedral["constraints"], edges + inner + (n - 1) ** 2)
        self.assertEqual(set(dihedral["projections_per_second"]), {"distance", "dihedral_bending"})

    def test_results_depend_on_no_thread_and_no_instruction_set(self):
        for name, size in ("cloth", 30), ("cloth-membrane", 20), ("tets", 500):
            reference = self.bench(name, "--size", size)["hash"]
            for threads in 2, 3:
                self.assertEqual(self.bench(name, "--size", size, "--threads", threads)["hash"], reference)
            self.environment["SOUPLE_SIMD"] = "scalar"
            self.assertEqual(self.bench(name, "--size", size)["hash"], reference)
            del self.environment["SOUPLE_SIMD"]

    def test_measuring_changes_nothing(self):
        """The hash depends on the steps alone, not on how long the projections were timed."""
        once, twice = self.bench("cloth", "--size", 20), self.bench("cloth", "--size", 20, "--residual", 0.05)
        self.assertEqual(once["hash"], twice["hash"])

    def test_more_substeps_stretch_less(self):
        few, many = (self.bench("cloth", "--size", 20, "--substeps", n, "--warm-up", 30,
                           "--solver", "gauss_seidel")["max_strain"] for n in (2, 30))
        self.assertLess(many, 0.5 * few)

    def test_time_to_a_residual(self):
        result = self.bench("cloth", "--size", 16, "--residual", 0.02, "--solver", "gauss_seidel")["residual"]
        self.assertTrue(result["reached"])
        self.assertGreater(result["ms"], 0)
        self.assertGreater(result["start"], 0.08)
        iterations = [point["iterations"] for point in result["curve"]]
        self.assertEqual(iterations, sorted(set(iterations)))
        self.assertLessEqual(result["iterations"], iterations[-1])
        self.assertLess(result["curve"][-1]["mean_strain"], 0.02)
        self.assertGreater(result["curve"][0]["mean_strain"], 0.02)

    def test_energy_of_sweeps(self):
        """A sweep of Jacobi lowers 1/2 sum C^2; one of Gauss-Seidel stretches neighbors first."""
        def energies(solver):
            result = self.bench("cloth", "--size", 16, "--residual", 0.02, "--solver", solver)["residual"]
            last = result["curve"][-1]  # equal links: the energy follows the root mean square of the strain
            rms = [(point["energy"] / last["energy"], (point["rms_strain"] / last["rms_strain"]) ** 2)
                   for point in result["curve"]]
            for energy, squared in rms:
                self.assertLess(abs(energy / squared - 1), 0.5)
            return [result["start_energy"], *(point["energy"] for point in result["curve"])]
        jacobi, gauss_seidel = energies("jacobi"), energies("gauss_seidel")
        self.assertEqual(jacobi, sorted(jacobi, reverse=True))
        self.assertEqual(jacobi[0], gauss_seidel[0])
        self.assertGreater(gauss_seidel[1], gauss_seidel[0])
        self.assertLess(gauss_seidel[-1], 0.1 * gauss_seidel[0])

    def test_compare(self):
        before = self.folder / "before.json"
        result = self.bench("cloth", "--size", 10)
        result["ms_per_step"] *= 3
        before.write_text(json.dumps(result))
        faster = self.bench("cloth", "--size", 10, "--compare", before)["faster"]
        self.assertGreater(faster["ms_per_step"], 1)
        self.assertIn("distance", faster["projections_per_second"])
        text = self.souple("bench", "cloth", "--size", 11, "--runs", 3, "--compare", before).stdout
        self.assertIn("size: 11, was 10", text)
        self.assertRegex(text, r"ms_per_step +[0-9.]+ +[0-9.]+x")

    def test_bad_input_is_one_line(self):
        wrong = self.scene([1], "wrong.json")
        for arguments, words in ((["clth"], 'did you mean "cloth"'), (["dambreak"], 'did you mean "dam-break"'),
                                 (["hepa"], 'did you mean "heap"'),
                                 (["xyzzyxyzzy"], "heap, dam-break"), (["cloth", "--size", "1"], "--size 1"),
                                 (["cloth", "--solver", "gauss"], "gauss_seidel"),
                                 (["cloth", "--residual", "2"], "--residual"), (["cloth", "--runs", "0"], "--runs 0"),
                                 (["cloth", "--relaxation", "3"], "relaxation"), (["cloth", "--threads", "x"], "x"),
                                 (["tets", "--size", "100", "--residual", "0.01"], "not a cloth"),
                                 (["cloth", "--size", "9", "--compare", wrong], "wrong.json"),
                                 (["cloth", "--compare", "missing.json"], "missing.json")):
            done = self.souple("bench", *arguments, code=2)
            self.assertEqual(done.stdout, "")
            self.assert_one_line(done.stderr)
            self.assertIn(words, done.stderr)


class Memory(Case):
    def test_parts_add_up(self):
        lines = self.souple("info", "--memory", "flag").stdout.splitlines()
        particles = int(lines[0].split()[0])
        number = {line[:40].strip(): int(line[40:].split()[0]) for line in lines[2:]}
        parts = {line[:40].strip(): int(line[40:].split()[0]) for line in lines[2:] if line.startswith("  ")}
        self.assertEqual(number["total"], sum(parts.values()))
        self.assertEqual(number["simulation"] + number["objects"], number["total"])
        self.assertGreaterEqual(parts["particles"], 4 * 16 * particles)
        self.assertIn("distance", parts)

    def test_bad_scene(self):
        self.assert_one_line(self.souple("info", "--memory", "nothing", code=2).stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
