"""Arrays are views of the world's own data that outlive it; arrays of any layout go in; the costs are bounded."""

import gc
import os
import subprocess
import sys
import time
import unittest

import numpy

import souple


def hanging(size=16, **settings):
    world = souple.World(threads=1, **settings)
    cloth = world.add_cloth(souple.grid(size, size, 1.0))
    world.pin(cloth, souple.vertices([0]))
    return world, cloth


def least_seconds(function, tries):
    times = []
    for _ in range(tries):
        start = time.process_time()  # of this process: other work on the machine does not count
        function()
        times.append(time.process_time() - start)
    return min(times)


class Views(unittest.TestCase):
    def test_positions_are_a_read_only_view_at_a_constant_address(self):
        world, cloth = hanging()
        x = world.positions(cloth)
        self.assertEqual((x.shape, x.dtype), ((256, 3), numpy.float32))
        self.assertFalse(x.flags.writeable)
        with self.assertRaises(ValueError):
            x[0] = 0
        with self.assertRaises(ValueError):
            x.flags.writeable = True
        before = x.copy()
        world.step(1 / 60)
        again = world.positions(cloth)
        self.assertEqual(x.ctypes.data, again.ctypes.data)
        self.assertFalse(numpy.array_equal(x, before))
        self.assertTrue(world.is_current(x))
        self.assertTrue(world.is_current(x[3:5, 1]))

    def test_a_view_outlives_its_object_and_its_world(self):
        world, cloth = hanging()
        world.step(1 / 60)
        x, v, n = world.positions(cloth), world.velocities(cloth), world.normals(cloth)
        copies = x.copy(), v.copy(), n.copy()
        world.remove(cloth)
        self.assertFalse(world.is_current(x))
        other = world.add_cloth(souple.grid(16, 16, 3.0))
        world.positions(other)
        for now, then in zip((x, v, n), copies):
            numpy.testing.assert_array_equal(now, then)
        del world
        gc.collect()
        numpy.testing.assert_array_equal(x, copies[0])

    def test_a_fluid_that_grows_leaves_an_array_as_it_was(self):
        world = souple.World(threads=1)
        water = world.add_fluid([], souple.material.water, max_particles=500)
        world.add_emitter(water, radius=0.05, speed=2)
        for _ in range(10):
            world.step(1 / 60)
        x = world.positions(water)
        count, then = len(x), x.copy()
        self.assertGreater(count, 0)
        for _ in range(10):
            world.step(1 / 60)
        self.assertGreater(len(world.positions(water)), count)
        self.assertFalse(world.is_current(x))
        numpy.testing.assert_array_equal(x, then)

    def test_is_current_refuses_other_arrays(self):
        world, cloth = hanging()
        other, _ = hanging()
        self.assertFalse(other.is_current(world.positions(cloth)))
        for array in (numpy.zeros((256, 3)), world.positions(cloth).copy()):
            with self.assertRaisesRegex(souple.Error, "expected an array that positions"):
                world.is_current(array)


class Inputs(unittest.TestCase):
    def test_any_layout_and_safe_type_is_taken(self):
        world, cloth = hanging()
        wanted = world.positions(cloth).copy() + numpy.float32(0.25)
        wide = numpy.zeros((256, 6))
        wide[:, ::2] = wanted
        for given in (wanted, wanted.astype(float), numpy.asfortranarray(wanted), wide[:, ::2], wanted.tolist(),
                      wanted.astype(">f4"), wanted[::-1][::-1], [tuple(row) for row in wanted]):
            world.set_positions(cloth, numpy.zeros((256, 3)) + [[0, 9, 0]])
            world.set_positions(cloth, given)
            numpy.testing.assert_array_equal(world.positions(cloth), wanted)
        world.set_positions(cloth, numpy.zeros((256, 3), dtype=int))
        self.assertEqual(abs(world.positions(cloth)).max(), 0)

    def test_other_arrays_are_refused_in_words(self):
        world, cloth = hanging()
        for given, words in ((numpy.zeros((256, 2)), "shape"), (numpy.zeros(768), "shape"), (numpy.zeros((256, 3), complex), "complex"),
                             (numpy.zeros((255, 3)), "256"), (numpy.full((256, 3), numpy.nan), "finite"),
                             (numpy.zeros((256, 3), "U4"), "numbers"), ([[1, 2, 3], [4]], "numbers")):
            with self.assertRaisesRegex(souple.Error, words):
                world.set_positions(cloth, given)
        for given in (None, 5, "abc", object(), {}):
            with self.assertRaises((TypeError, souple.Error)):
                world.set_positions(cloth, given)
        for given in ([-1], [1.5], [2**32], ["a"], [[1]]):
            with self.assertRaises(souple.Error):
                souple.vertices(given)

    def test_a_list_of_the_own_positions_changes_nothing(self):
        world, cloth = hanging()
        world.set_positions(cloth, world.positions(cloth))
        world.step(1 / 60)


@unittest.skipIf("LD_PRELOAD" in os.environ, "a sanitizer is loaded")
class Costs(unittest.TestCase):
    def test_importing_takes_a_third_of_a_second(self):
        code = "import numpy, time; t = time.process_time(); import souple; print(time.process_time() - t)"
        times = [float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)
                 for _ in range(5)]
        print(f"import: {min(times):.3f} s")
        self.assertLess(min(times), 0.3)

    def test_a_million_positions_cost_microseconds(self):
        world = souple.World()
        grains = world.add_grains(numpy.mgrid[0:100, 0:100, 0:100].reshape(3, -1).T * 0.05, souple.material.sand)
        x = world.positions(grains)
        self.assertEqual(len(x), 1_000_000)
        seconds = least_seconds(lambda: world.positions(grains), 1000)
        print(f"positions: {seconds * 1e6:.2f} us")
        self.assertLess(seconds, 5e-6)
        refresh = []
        for _ in range(5):
            world.set_wind_exposure(grains, 1)
            world.teleport(grains, souple.Transform(translation=(0.1, 0, 0)))
            start = time.perf_counter()
            again = world.positions(grains)
            refresh.append(time.perf_counter() - start)
        print(f"refresh: {min(refresh) * 1e3:.2f} ms")
        self.assertEqual(again.ctypes.data, x.ctypes.data)
        self.assertLess(min(refresh), 0.05)

    def test_a_step_costs_microseconds_over_that_of_cpp(self):
        world = souple.World(threads=1)
        empty = least_seconds(lambda: world.step(1 / 60), 500)
        print(f"step of an empty world: {empty * 1e6:.1f} us")
        self.assertLess(empty, 200e-6)


if __name__ == "__main__":
    unittest.main()
