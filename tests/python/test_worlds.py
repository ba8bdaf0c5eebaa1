"""Worlds in Python do what they do in C++: the same bits, callbacks, settings, constraints."""

import concurrent.futures
import copy
import itertools
import json
import os
import pathlib
import pickle
import re
import threading
import time
import traceback
import unittest

import numpy

import souple

SOURCE = pathlib.Path(os.environ["SOUPLE_SOURCE"])


def small_world(**settings):
    world = souple.World(**{"threads": 1, **settings})
    cloth = world.add_cloth(souple.grid(32, 32, 1.0), souple.material.cotton)
    world.pin(cloth, souple.vertices([0, 31]))
    world.add_collider(souple.Sphere(center=(0, -0.5, 0), radius=0.3), friction=0.4)
    return world, cloth


class Bits(unittest.TestCase):
    def test_scenes_have_the_hashes_of_the_program(self):
        golden = json.loads((SOURCE / "tests/golden.json").read_text())
        for name in ("flag", "drop", "dominoes", "rope_bridge"):
            world = souple.build_world(souple.load_scene(SOURCE / f"scenes/{name}.json"))
            world.step(1 / 60)
            self.assertEqual(f"{world.hash():016x}", golden[name]["1"], name)
            for _ in range(29):
                world.step(1 / 60)
            self.assertEqual(f"{world.hash():016x}", golden[name]["30"], name)

    def test_a_pool_of_threads_gives_the_bits_of_one_after_the_other(self):
        def run(number):
            world, cloth = small_world(gravity=(0, -9.81 - 0.01 * number, 0))
            for _ in range(6):
                world.step(1 / 60)
            return world.hash()

        alone = [run(number) for number in range(64)]
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            self.assertEqual(list(pool.map(run, range(64))), alone)
        self.assertEqual(len(set(alone)), 64)

    def test_other_threads_run_during_a_step(self):
        world, _ = small_world(substeps=200)
        counted, stop = [0], threading.Event()

        def count():
            while not stop.is_set():
                counted[0] += 1
                time.sleep(0)

        thread = threading.Thread(target=count)
        thread.start()
        try:
            before = counted[0]
            world.step(1 / 60)
            self.assertGreater(counted[0], before)
        finally:
            stop.set()
            thread.join()

    def test_a_snapshot_continues_with_the_same_bits(self):
        world, _ = small_world()
        world.step(1 / 60)
        snapshot = world.snapshot()
        world.step(1 / 60)
        expected = world.hash()
        world.restore(snapshot)
        world.step(1 / 60)
        self.assertEqual(world.hash(), expected)
        with self.assertRaises(souple.Error):
            world.restore(snapshot[:100])


class Structs(unittest.TestCase):
    def test_keywords_have_the_defaults_of_cpp(self):
        material = souple.ClothMaterial()
        self.assertAlmostEqual(material.areal_density, 0.15, 6)
        self.assertIsNone(material.kinetic_friction)
        self.assertEqual(material.stretch, souple.StretchModel.springs)
        settings = souple.Settings(substeps=3, mode="xpbd", gravity=[0, -1, 0])
        self.assertEqual((settings.substeps, settings.mode, settings.gravity), (3, souple.Mode.xpbd, (0, -1, 0)))
        self.assertEqual(souple.Sphere((1, 2, 3), 4), souple.Sphere(center=(1, 2, 3), radius=4))

    def test_members_of_members_are_references(self):
        settings = souple.Settings()
        settings.wind.gust = 0.5
        self.assertEqual(settings.wind.gust, 0.5)
        hinge = souple.joint.Hinge(rotation=souple.joint.Axis(motor=souple.joint.Motor(target=1)))
        hinge.rotation.motor.target = 3
        self.assertEqual(hinge.rotation.motor.target, 3)

    def test_presets_are_copies(self):
        souple.material.cotton.friction = 9
        self.assertAlmostEqual(souple.material.cotton.friction, souple.ClothMaterial().friction, 6)
        changed = souple.material.cotton.replace(friction=0.1)
        self.assertAlmostEqual(changed.friction, 0.1, 6)
        self.assertEqual(changed.areal_density, souple.material.cotton.areal_density)

    def test_structs_copy_compare_print_and_pickle(self):
        for value in (souple.material.silk, souple.Settings(substeps=7), souple.ObjectOptions(stiffness_map=[1, 2]),
                      souple.Transform(translation=(1, 2, 3)), souple.grid(3, 3, 1.0)):
            for other in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
                self.assertEqual(value, other)
        self.assertNotEqual(souple.material.silk, souple.material.denim)
        world = souple.World()
        cloth = world.add_cloth(souple.grid(3, 3, 1.0))
        self.assertEqual(copy.deepcopy({"cloth": cloth}), {"cloth": cloth})
        mesh = souple.TriangleMesh(positions=[(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], faces=[[0, 1, 2, 3]], groups={"a": [1, 2]})
        self.assertEqual(mesh, copy.copy(mesh))
        self.assertNotEqual(mesh, mesh.replace(groups={"a": [1, 3]}))
        motor = souple.joint.Motor()
        self.assertEqual(pickle.loads(pickle.dumps(motor)), motor)
        self.assertIn("friction=0.4", repr(souple.ClothMaterial()))

    def test_every_name_has_words(self):
        missing = []
        for name in souple.__all__:
            value = getattr(souple, name)
            if not (getattr(value, "__doc__", "") or "").strip() and (callable(value)):
                missing.append(name)
            for member, function in vars(value).items() if isinstance(value, type) and value.__module__ == "souple" else ():
                if not member.startswith("_") and callable(function) and not (function.__doc__ or "").strip():
                    missing.append(f"{name}.{member}")
        self.assertEqual(missing, [])


def rows_below(page, head):
    """Cells of the table of docs/ that begins with the head."""
    lines = (SOURCE / "docs" / page).read_text().split(f"\n| {head} |")[1].split("\n")[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in itertools.takewhile(bool, lines)]


def numbers(cell):
    return [float(n) for n in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?", cell)]


class Manual(unittest.TestCase):
    PRESETS = {
        "cloth | kg/m^2": ["areal_density", "membrane_stiffness weft_stiffness", "shear_stiffness", "bending_stiffness",
                           "thickness", "friction"],
        "soft body | E [Pa]": ["young_modulus", "poisson_ratio", "density"],
        "rope | radius [mm]": ["radius", "young_modulus", "density", "bending_stiffness"],
        "grains | radius [mm]": ["radius", "density", "friction", "rolling_friction"],
        "fluid | kg/m^3": ["density", "viscosity"],
    }
    DEFAULTS = {
        ("fluids.md", "`FluidMaterial`, `material`"): souple.FluidMaterial,
        ("fluids.md", "`Settings::fluid`, `fluid` of a scene"): souple.FluidSettings,
        ("fluid-surface.md", "`Settings::fluid.foam`, `fluid.foam` of a scene"): souple.FoamParameters,
        ("fluid-surface.md", "`SurfaceOptions`, lengths in d"): souple.SurfaceOptions,
    }

    def test_presets_are_those_of_the_program(self):
        seen = []
        for head, columns in self.PRESETS.items():
            for name, *cells in rows_below("materials.md", head):
                seen.append(name)
                for cell, fields in zip(cells, columns):
                    for field, said in itertools.zip_longest(fields.split(), numbers(cell), fillvalue=0):
                        value = getattr(getattr(souple.material, name), field)
                        unit = 1000 if field in ("radius", "thickness") else 1
                        self.assertAlmostEqual(said, unit * value, delta=1e-3 * abs(said), msg=f"{name}, {field}")
        self.assertEqual(sorted(seen), sorted(souple.material.names()))

    def test_defaults_are_those_of_the_structs(self):
        for (page, head), struct in self.DEFAULTS.items():
            for names, default, *_ in rows_below(page, head):
                fields = [getattr(struct(), name) for name in re.findall(r"`(\w+)`", names)]
                values = [fields[0].low, fields[0].high] if hasattr(fields[0], "low") else fields
                for value, said in zip(values, numbers(default)):
                    if isinstance(value, (int, float)) and len(values) == len(numbers(default)):
                        with self.subTest(struct=struct.__name__, row=names):
                            self.assertAlmostEqual(said, value, delta=1e-6 * abs(value))


class Callbacks(unittest.TestCase):
    def test_stages_call_back(self):
        world, cloth = small_world(substeps=4)
        seen = []
        first = world.before("integrate", lambda w: seen.append(w.positions(cloth)[:, 1].min()))
        world.after(souple.Stage.broad_phase, lambda w: self.assertIs(w, world))
        world.step(1 / 60)
        self.assertEqual(len(seen), 4)
        world.remove(first)
        world.step(1 / 60)
        self.assertEqual(len(seen), 4)

    def test_a_force_field_lifts(self):
        world, cloth = small_world(gravity=(0, 0, 0))
        world.add_force_field(lambda x, v, mass, time: (0, 5 * mass, 0))
        for _ in range(10):
            world.step(1 / 60)
        self.assertGreater(world.center_of_mass(cloth)[1], 0.01)

    def test_targets_and_motions_move(self):
        world, cloth = small_world()
        start = world.positions(cloth)[5].astype(float)
        world.pin(cloth, souple.vertices([5]), lambda vertex, time: start + [0, time, 0])
        ball = world.add_collider(souple.Sphere(radius=0.1), motion=souple.ColliderMotion.callback(
            lambda time: souple.Transform(translation=(5 + time, 0, 0))))
        for _ in range(6):
            world.step(1 / 60)
        self.assertAlmostEqual(world.positions(cloth)[5, 1], 0.1, 5)
        self.assertAlmostEqual(world.collider_pose(ball).translation[0], 5.1, 5)

    def test_the_log_hears_warnings(self):
        heard = []
        world = souple.World(threads=1)
        world.set_log(lambda level, text: heard.append((level, text)))
        mesh = souple.grid(4, 4, 1.0)
        triangles = numpy.concatenate([mesh.triangles, [[0, 0, 1]]])
        world.add_cloth(souple.TriangleMesh(positions=mesh.positions, triangles=triangles))
        self.assertTrue(heard)

    def test_an_exception_is_raised_when_the_step_has_ended(self):
        world, cloth = small_world()

        def fail(w):
            raise KeyError("mine")

        callback = world.before(souple.Stage.solve, fail)
        names = []
        try:
            world.step(1 / 60)
        except KeyError as error:
            names = [frame.name for frame in traceback.extract_tb(error.__traceback__)]
        self.assertIn("fail", names)
        self.assertTrue(world.report().has(souple.Flag.callback_failed))
        self.assertAlmostEqual(world.time(), 1 / 60)
        world.remove(callback)
        world.step(1 / 60)

    def test_ctrl_c_in_a_callback_ends_the_loop(self):
        world, _ = small_world()

        def interrupt(w):
            raise KeyboardInterrupt

        world.before(souple.Stage.foam, interrupt)
        with self.assertRaises(KeyboardInterrupt):
            for _ in range(3):
                world.step(1 / 60)


class Constraints(unittest.TestCase):
    def test_a_function_keeps_a_vertex_above(self):
        world, cloth = small_world()
        particle = world.particle(cloth, 1023)
        kept = []

        def above(x, gradient):
            kept.append((x, gradient))
            gradient[0, 1] = 1
            return x[0, 1] + 0.2

        projector = souple.CustomProjector()
        projector.add([particle], above, sense="non_negative")
        world.add_projector(projector)
        for _ in range(60):
            world.step(1 / 60)
        self.assertGreater(world.positions(cloth)[1023, 1], -0.21)
        kept[0][0][:] = 0  # its own memory

    def test_arrays_of_distances_are_a_rigid_rod(self):
        world, cloth = small_world()
        ends = world.particles(cloth, [992, 1023])
        handle = world.add_projector(souple.SetProjector("distance", [ends], rest=[[(0, 0, 0), (0.5, 0, 0)]]))
        for _ in range(60):
            world.step(1 / 60)
        x = world.positions(cloth)
        self.assertAlmostEqual(numpy.linalg.norm(x[992] - x[1023]), 0.5, 2)
        world.remove(handle)

    def test_every_kind_of_the_catalogue_takes_its_arrays(self):
        corners = {1: [(0, 0, 0)], 2: [(0, 0, 0), (1, 0, 0)], 3: [(0, 0, 0), (1, 0, 0), (0, 0, 1)],
                   4: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]}
        for kind, (arity, rows, count, compliances, names) in souple.constraint_kinds().items():
            world, cloth = small_world()
            particles = world.particles(cloth, list(range(100, 100 + arity)))[None]
            try:
                constraints = souple.SetProjector(kind, particles, rest=[corners[arity]], compliance=1e-3)
            except souple.Error:
                constraints = souple.SetProjector(kind, particles, [0.1] * count, compliance=1e-3)
            world.add_projector(constraints)
            report = world.step(1 / 60)
            self.assertIn(kind, [k.kind for k in report.kinds])


if __name__ == "__main__":
    unittest.main()
