"""Wrong types, shapes, numbers, stale handles, other threads and callbacks: an exception in words, never a crash.

Calls every function of every class with hostile arguments. A crash ends the process, and the test fails.
"""

import gc
import os
import pathlib
import random
import subprocess
import sys
import threading
import time
import unittest

import numpy

import souple


def full_world():
    """One object of each kind, a collider, a joint, a tie, a fluid with an emitter and a drain, and stale handles."""
    world = souple.World(substeps=2, threads=1)
    cloth = world.add_cloth(souple.grid(5, 5, 0.5))
    body = world.add_soft_body(souple.tet_bar(2, 1, 1, (0.2, 0.1, 0.1)), transform=souple.Transform((2, 0, 0)))
    rope = world.add_rope([(4, 0, 0), (5, 0, 0)], 8)
    grains = world.add_grains([(6, 0, 0), (6.1, 0, 0)])
    box = world.add_rigid_body(souple.Box(half_extents=(0.1, 0.1, 0.1)), transform=souple.Transform((8, 0, 0)))
    wall = world.add_obstacle(souple.box((0.2, 0.2, 0.2)), transform=souple.Transform((10, 0, 0)))
    water = world.add_fluid(souple.fill((12, 0, 0), (12.2, 0.2, 0.2), 0.05), souple.FluidMaterial(spacing=0.05), max_particles=200)
    ball = world.add_collider(souple.Sphere(center=(0, -2, 0)))
    joint = world.add_joint(box, None, souple.joint.Hinge())
    tie = world.add_tie(rope, None, point=(4, 0, 0))
    emitter, drain = world.add_emitter(water, position=(12, 1, 0)), world.add_drain(shape=souple.Box())
    attached = world.attach(cloth, souple.vertices([3]))
    callback, field = world.before("solve", lambda w: None), world.add_force_field(lambda *a: (0, 0, 0))
    stale = world.add_cloth(souple.grid(2, 2, 1.0))
    world.remove(stale)
    stale_collider = world.add_collider(souple.Plane(offset=-50))
    world.remove(stale_collider)
    handles = [cloth, body, rope, grains, box, wall, water, ball, joint, tie, emitter, drain, attached, callback, field, stale,
               stale_collider]
    return world, handles


HOSTILE = [None, True, 0, -1, 2**31, 2**40, 1e300, float("nan"), float("inf"), "", "cotton", "no such name", b"bytes", [], {}, (),
           [1, 2], (1, 2, 3), [0, 1e39, 0], (float("nan"), 0, 0), [[1, 2, 3]], [[1, 2], [3]], object(), len, type,
           numpy.zeros((0, 3)), numpy.zeros((25, 3)), numpy.full((25, 3), numpy.nan), numpy.zeros((3, 3), complex),
           numpy.array(["a"]), numpy.arange(4), numpy.uint32([99999]), lambda *a: None, lambda *a: (0, 0, 0), lambda *a: 1 / 0]


def structs():
    return [souple.grid(3, 3, 1.0), souple.TriangleMesh(), souple.TriangleMesh(positions=[(0, 0, 0)], triangles=[(0, 1, 2)]),
            souple.TriangleMesh(positions=numpy.full((3, 3), numpy.nan), triangles=[(0, 1, 2)]), souple.TetMesh(),
            souple.TetMesh(positions=[(0, 0, 0)], tets=[(0, 1, 2, 3)]), souple.ClothMaterial(areal_density=float("nan")),
            souple.ClothMaterial(), souple.RopeMaterial(radius=-1), souple.FluidMaterial(spacing=0), souple.SoftBodyMaterial(),
            souple.Sphere(radius=-1), souple.Plane(normal=(0, 0, 0)), souple.Box(), souple.Transform(scale=0),
            souple.Transform(rotation=(0, 0, 0, 0)), souple.Transform((float("nan"), 0, 0)), souple.all(), souple.vertices([99]),
            souple.vertices([]), souple.group("no"), souple.in_box((0, 0, 0), (-1, 0, 0)), souple.Settings(substeps=0),
            souple.Settings(gravity=(float("nan"), 0, 0)), souple.ObjectOptions(name="a/b"), souple.ColliderMotion(),
            souple.ColliderOptions(friction=-1), souple.joint.Hinge(), souple.joint.Distance(shortest=2, longest=1),
            souple.joint.Pulley(), souple.Emitter(radius=-1), souple.Drain(), souple.QueryFilter(), souple.TieOptions(),
            souple.SurfacePoint(), souple.Stage.solve, souple.Flag.non_finite, souple.Wind(gust=9), souple.SurfaceOptions(),
            souple.SetProjector("distance", [[0, 99999]], [1]), souple.CustomProjector()]


ALLOWED = (souple.Error, AttributeError, TypeError, ValueError, ArithmeticError, RuntimeError, OverflowError, MemoryError)
LEFT_OUT = {"__init_subclass__", "__subclasshook__", "__new__", "__class__", "__dir__", "__sizeof__", "__reduce_ex__"}


class EveryFunction(unittest.TestCase):
    def call(self, function, *args, **kwargs):
        try:
            function(*args, **kwargs)
        except ALLOWED as error:
            self.assertTrue(str(error).strip(), f"{function}{args} raised {type(error).__name__} without words")

    def test_of_world_takes_hostile_arguments(self):
        numbers = random.Random(1)
        world, handles = full_world()
        methods = [name for name in dir(souple.World) if not name.startswith("_")]
        pool = HOSTILE + structs()
        for name in methods:
            for _ in range(120):
                if not world.objects() or numbers.random() < 0.01:
                    world, handles = full_world()
                count = numbers.choice([0, 1, 1, 2, 2, 3, 4])
                args = [numbers.choice(handles if numbers.random() < 0.4 else pool) for _ in range(count)]
                if name == "step":
                    args = [numbers.choice([0, -1, float("nan"), "a", None, 1e-3, float("inf")])]
                if name in ("add_fluid", "time_projections", "time_solve") and any(isinstance(a, (int, float)) and abs(a) > 100 for a in args):
                    continue
                self.call(getattr(world, name), *args)
            self.call(world.step, 1 / 60)

    def test_of_the_module_takes_hostile_arguments(self):
        numbers = random.Random(2)
        world, handles = full_world()
        small = [h for h in HOSTILE if not (isinstance(h, (int, float)) and not isinstance(h, bool) and abs(h) > 100)]
        for name in souple.__all__:
            function = getattr(souple, name)
            if not callable(function) or name in ("render", "write_png", "save_scene", "Recorder"):
                continue
            for _ in range(60):
                args = [numbers.choice(small + handles + [world]) for _ in range(numbers.choice([0, 1, 2, 3]))]
                self.call(function, *args)
                self.call(function, **{numbers.choice(["radius", "center", "threads", "kind", "nothing"]): numbers.choice(small)})

    def test_members_of_structs_take_hostile_values(self):
        for struct in structs():
            for member in dir(type(struct)):
                if isinstance(getattr(type(struct), member), property):
                    for value in HOSTILE:
                        self.call(setattr, struct, member, value)
                        repr(struct)

    def test_an_unknown_keyword_names_the_nearest(self):
        for function in (lambda: souple.ClothMaterial(fricton=1), lambda: souple.World(substep=3),
                         lambda: souple.World().add_collider(souple.Sphere(), fiction=1)):
            with self.assertRaisesRegex(TypeError, "did you mean '(friction|substeps)'"):
                function()

    def test_wrong_types_are_named(self):
        with self.assertRaisesRegex(TypeError, r"ClothMaterial.friction: expected float, found 'rough'"):
            souple.ClothMaterial(friction="rough")
        with self.assertRaisesRegex(TypeError, r"World: gravity: expected Tuple\[float, float, float\], found 9.81"):
            souple.World(gravity=9.81)
        with self.assertRaisesRegex(TypeError, "expected Mode, found 'fast'"):
            souple.Settings(mode="fast")

    def test_handles_of_removed_things_are_refused(self):
        world, handles = full_world()
        stale = handles[-2]
        for name in ("positions", "velocities", "normals", "triangles", "mesh", "name", "kind", "total_mass", "remove"):
            with self.assertRaises(souple.Error):
                getattr(world, name)(stale)

    def test_none_is_no_object(self):
        """Functions called through their class, as map() calls them, and Recorder's world."""
        with self.assertRaises(TypeError):
            souple.Recorder(None, "out")
        for name in souple.__all__:
            made = getattr(souple, name)
            if not isinstance(made, type) or issubclass(made, (BaseException, dict)):
                continue
            for member in set(vars(made)) - LEFT_OUT - {"__init__"}:
                value = vars(made)[member]
                for function in (value.fget, value.fset) if isinstance(value, property) else [value]:
                    if callable(function):
                        self.call(function, None)
                        self.call(function, None, None)

    def test_an_instance_that_was_not_made_is_refused(self):
        with self.assertRaisesRegex(TypeError, "expected Settings"):
            souple.Settings.__new__(souple.Settings).substeps

    def test_what_would_be_lost_is_refused(self):
        for value in (numpy.float32(3.7), 3.7, "3", None):
            with self.assertRaisesRegex(TypeError, "substeps: expected int"):
                souple.World(substeps=value)
        self.assertEqual(souple.World(substeps=numpy.int16(3)).settings().substeps, 3)
        for value in (numpy.complex64(1 + 2j), 1j):
            with self.assertRaisesRegex(TypeError, "drag: expected float"):
                souple.Settings(drag=value)
        for value in (numpy.array([1 + 2j, 0, 0]), bytearray(b"abc")):
            with self.assertRaisesRegex(TypeError, "gravity: expected Tuple"):
                souple.Settings(gravity=value)
        with self.assertRaisesRegex(TypeError, "name: expected str"):
            souple.World().add_cloth(souple.grid(3, 3, 1.0), name=b"flag")
        with self.assertRaisesRegex(TypeError, "transform: expected Transform, found None"):
            souple.World().add_cloth(souple.grid(3, 3, 1.0), transform=None)
        with self.assertRaisesRegex(souple.Error, "uint8"):
            souple.write_png("no.png", numpy.full((2, 2, 4), 0.5))

    def test_steps_of_no_duration_are_refused(self):
        world, _ = full_world()
        for dt in (0, -1, float("nan"), float("inf")):
            with self.assertRaisesRegex(souple.Error, "expected a positive time"):
                world.step(dt)
            self.assertEqual(world.report().outcome, souple.StepOutcome.refused)
        self.assertEqual(world.step(1 / 60).outcome, souple.StepOutcome.done)

    def test_a_solver_that_cannot_take_the_scene_is_refused(self):
        world = souple.World(solver=souple.SolverSettings(kind=souple.SolverKind.dense))
        world.add_cloth(souple.grid(30, 30, 1.0))
        for call in (world.prepare, lambda: world.step(1 / 60)):
            with self.assertRaisesRegex(souple.Error, "the solver dense takes at most"):
                call()
        self.assertFalse(world.report().ok())
        self.assertEqual(world.time(), 0)

    def test_words_that_are_not_utf8(self):
        with self.assertRaisesRegex(souple.Error, "no such file"):
            souple.read_triangle_mesh(b"/no/\xff.obj")
        with self.assertRaisesRegex(souple.Error, "no such file"):
            souple.read_triangle_mesh(pathlib.Path("/no/file.obj"))
        with self.assertRaises((TypeError, ValueError)):
            souple.read_triangle_mesh("/no\0.obj")


class Threads(unittest.TestCase):
    def test_a_mesh_that_changes_while_it_is_read(self):
        for delay in (0.001, 0.01):
            mesh = souple.sphere(5, 1.0)

            def change(mesh=mesh, delay=delay):
                time.sleep(delay)
                mesh.positions, mesh.triangles = numpy.zeros((0, 3)), numpy.zeros((0, 3), int)

            thread = threading.Thread(target=change)
            thread.start()
            self.assertGreater(souple.SignedDistanceField(mesh, 0.1).bytes(), 0)
            thread.join()

    def test_the_program_ends_while_a_daemon_thread_steps(self):
        for line in ("", "world.add_force_field(lambda *a: (0, 0, 0))"):
            program = f"""
import souple, threading, time
world = souple.World(threads=1, substeps=50)
world.add_cloth(souple.grid(60, 60, 1.0))
{line}
def loop():
    while True: world.step(1 / 60)
threading.Thread(target=loop, daemon=True).start()
time.sleep(0.5)
"""
            self.assertEqual(subprocess.run([sys.executable, "-c", program], timeout=60).returncode, 0)

    def test_a_world_that_is_stepping_refuses_other_threads(self):
        world, handles = full_world()
        started, leave = threading.Event(), threading.Event()

        def wait(w):
            started.set()
            leave.wait(20)

        waiting = world.before("broad_phase", wait)
        thread = threading.Thread(target=world.step, args=(1 / 60,))
        thread.start()
        self.assertTrue(started.wait(20))
        try:
            for name, args in (("step", (1 / 60,)), ("positions", handles[:1]), ("hash", ()), ("snapshot", ()), ("report", ()),
                               ("remove", handles[:1]), ("add_cloth", (souple.grid(3, 3, 1.0),)), ("time", ()),
                               ("set_settings", ()), ("ray_cast", ((0, 0, 0), (0, -1, 0)))):
                with self.assertRaisesRegex(souple.Error, "another thread is in step"):
                    getattr(world, name)(*args)
        finally:
            leave.set()
            thread.join()
        world.remove(waiting)
        world.step(1 / 60)

    def test_two_threads_that_step_one_world(self):
        world, _ = full_world()
        raised = []

        def step():
            for _ in range(50):
                try:
                    world.step(1 / 600)
                except souple.Error as error:
                    raised.append(str(error))
                    time.sleep(0.0005)

        threads = [threading.Thread(target=step) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(all("another thread is in step" in words for words in raised))


class Inside(unittest.TestCase):
    def test_callbacks_call_every_function(self):
        numbers = random.Random(3)
        methods = [name for name in dir(souple.World) if not name.startswith("_") and name not in ("add_fluid",)]
        pool = HOSTILE + structs()
        for where in ("stage", "force", "motion", "log", "custom", "target"):
            world, handles = full_world()

            def misuse(*_):
                for _ in range(2):
                    name = numbers.choice(methods)
                    args = [numbers.choice(handles if numbers.random() < 0.5 else pool) for _ in range(numbers.choice([0, 1, 2]))]
                    if name in ("before", "after", "add_force_field", "add_vertex_force_field", "set_log", "step"):
                        args = [1 / 60] if name == "step" else []
                    try:
                        getattr(world, name)(*args)
                    except ALLOWED as error:
                        self.assertTrue(str(error))
                return souple.Transform() if where == "motion" else 0.0 if where == "custom" else (0.0, 0.0, 0.0)

            if where == "stage":
                world.after("solve", misuse)
            elif where == "force":
                world.add_force_field(misuse)
            elif where == "motion":
                world.add_collider(souple.Sphere(center=(0, -9, 0)), motion=souple.ColliderMotion.callback(misuse))
            elif where == "log":
                world.set_log(misuse)
            elif where == "target":
                world.pin(handles[0], souple.vertices([0]), misuse)
            else:
                projector = souple.CustomProjector()
                projector.add([world.particle(handles[0], 7)], misuse)
                world.add_projector(projector)
            for _ in range(10):
                try:
                    world.step(1 / 60)
                except ALLOWED as error:
                    self.assertTrue(str(error))

    def test_an_inner_call_keeps_what_an_outer_one_raises(self):
        world, _ = full_world()
        world.add_force_field(lambda *a: 1 / 0)
        world.after("foam", lambda w: w.time_solve(1e-3, 1))
        with self.assertRaises(ZeroDivisionError):
            world.step(1 / 60)

    def test_a_motion_that_replaces_itself(self):
        emitter = souple.Emitter()

        class Motion:
            def __call__(self, time):
                emitter.motion = souple.ColliderMotion()
                gc.collect()
                raise KeyError("mine")

        emitter.motion = souple.ColliderMotion.callback(Motion())
        with self.assertRaises(KeyError):
            emitter.motion.at(1.0)

    def test_exceptions_outside_steps_keep_their_type(self):
        world, _ = full_world()

        def interrupt(time):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            souple.ColliderMotion.callback(interrupt).at(0)
        with self.assertRaises(ZeroDivisionError):
            world.add_collider(souple.Sphere(), motion=souple.ColliderMotion.callback(lambda time: 1 / 0))
            world.ray_cast((0, 9, 0), (0, -1, 0))
        scene = souple.load_scene(os.environ["SOUPLE_SOURCE"] + "/scenes/flag.json")
        scene["objects"][0] = {"name": "flag", "kind": "cloth", "mesh": {"grid": {"columns": 9, "rows": 9, "size": 1000}}}

        def log(level, words):
            raise LookupError(words)

        with self.assertRaises(LookupError):
            souple.build_world(scene, log)

    def test_a_motion_that_returns_nothing(self):
        world, _ = full_world()
        with self.assertRaisesRegex(TypeError, "motion returned: expected Transform, found None"):
            world.add_collider(souple.Sphere(), motion=souple.ColliderMotion.callback(lambda time: None))
            world.step(1 / 60)

    def test_what_a_function_returns_is_checked(self):
        world, handles = full_world()
        field = world.add_force_field(lambda *a: "up")
        with self.assertRaisesRegex(TypeError, r"force field returned: expected Tuple\[float, float, float\], found 'up'"):
            world.step(1 / 60)
        world.remove(field)
        world.step(1 / 60)


if __name__ == "__main__":
    unittest.main()
