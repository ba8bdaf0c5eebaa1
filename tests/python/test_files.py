"""Scenes as dicts, recorder, playback, fluid surfaces and pictures."""

import json
import os
import pathlib
import tempfile
import unittest

import numpy

import souple

SOURCE = pathlib.Path(os.environ["SOUPLE_SOURCE"])


class Scenes(unittest.TestCase):
    def test_every_shipped_scene_survives_a_round_trip(self):
        with tempfile.TemporaryDirectory() as folder:
            for file in sorted((SOURCE / "scenes").glob("*.json")):
                scene = souple.load_scene(file)
                copy = pathlib.Path(folder) / file.name
                souple.save_scene(scene, copy)
                again = souple.parse_scene(copy.read_text(), folder=scene.folder)
                self.assertEqual(dict(again), dict(scene), file.name)

    def test_a_dict_is_built_and_changed(self):
        scene = souple.Scene({"souple": 1, "objects": [{"kind": "cloth", "name": "flag", "mesh": {"grid": {"columns": 5, "rows": 5, "size": 1}}}]})
        scene["objects"][0]["material"] = {"friction": numpy.float32(0.25)}
        world = souple.build_world(scene)
        flag = world.find_object("flag")
        self.assertAlmostEqual(world.cloth_material(flag).friction, 0.25)
        scene["objects"].append({"kind": "rope", "name": "line", "points": [[0, 0, 0], [1, 0, 0]]})
        souple.add_to_world(scene, 1, world)
        self.assertEqual([world.name(o) for o in world.objects()], ["flag", "line"])

    def test_overrides_are_a_dict_or_texts(self):
        file = SOURCE / "scenes/flag.json"
        for overrides in ({"substeps": 7, "objects.flag.material.friction": 0.3}, ["substeps=7", "objects.flag.material.friction=0.3"]):
            scene = souple.load_scene(file, overrides)
            self.assertEqual(scene["substeps"], 7)
            world = souple.build_world(scene)
            self.assertAlmostEqual(world.cloth_material(world.find_object("flag")).friction, 0.3, 6)

    def test_mistakes_have_their_path(self):
        scene = souple.load_scene(SOURCE / "scenes/flag.json")
        scene["objects"][0]["materials"] = {}
        with self.assertRaisesRegex(souple.Error, r"objects\[0\].*material"):
            souple.build_world(scene)
        with self.assertRaises(souple.Error):
            souple.load_scene("no such file.json")
        with self.assertRaises(souple.Error):
            souple.build_world({"souple": 1, "objects": [object()]})
        with self.assertRaises(TypeError):
            souple.build_world(5)
        self.assertIn("$defs", json.loads(souple.scene_schema()))


class Recordings(unittest.TestCase):
    def test_a_recording_plays_back(self):
        world = souple.World(threads=1)
        cloth = world.add_cloth(souple.grid(8, 8, 1.0), name="sheet")
        with tempfile.TemporaryDirectory() as folder:
            with souple.Recorder(world, folder, frames=3) as recorder:
                for _ in range(3):
                    world.step(1 / 60)
                    recorder.capture()
                self.assertEqual(recorder.frames(), 3)
            playback = souple.Playback(folder)
            self.assertEqual(playback.frames(), 3)
            (sheet,) = playback.read(3)
            self.assertEqual((sheet.name, sheet.kind), ("sheet", "cloth"))
            numpy.testing.assert_array_equal(sheet.positions, world.positions(cloth))
            self.assertAlmostEqual(playback.time(3), 0.05, 6)
            for frame in (0, 4):
                with self.assertRaises(souple.Error):
                    playback.read(frame)
                with self.assertRaises(souple.Error):
                    playback.time(frame)

    def test_a_recorder_keeps_its_world(self):
        def record(folder):
            world = souple.World(threads=1)
            world.add_rope([(0, 0, 0), (1, 0, 0)], 5)
            return souple.Recorder(world, folder)

        with tempfile.TemporaryDirectory() as folder:
            recorder = record(folder)
            recorder.capture()
            recorder.finish()
            with self.assertRaises(souple.Error):
                recorder.capture()

    def test_a_folder_has_one_recorder_at_a_time(self):
        world = souple.World(threads=1)
        world.add_cloth(souple.grid(4, 4, 1.0))
        with tempfile.TemporaryDirectory() as folder:
            with souple.Recorder(world, folder):
                with self.assertRaisesRegex(souple.Error, "another souple is writing there"):
                    souple.Recorder(world, folder)
            with souple.Recorder(world, folder):
                pass

    def test_meshes_are_read(self):
        with tempfile.TemporaryDirectory() as folder:
            mesh = souple.sphere(1, 0.5)
            file = pathlib.Path(folder) / "ball.obj"
            file.write_text(souple.obj_text(mesh.positions, mesh.positions, mesh.triangles))
            again = souple.read_triangle_mesh(str(file), scale=2)
            numpy.testing.assert_allclose(again.positions, 2 * mesh.positions, atol=1e-6)
            self.assertTrue(souple.inspect(again).is_closed)


class Surfaces(unittest.TestCase):
    def test_the_surface_of_a_ball_encloses_its_volume(self):
        spacing, radius = 0.05, 0.4
        grid = numpy.mgrid[-12:13, -12:13, -12:13].reshape(3, -1).T * spacing
        particles = grid[numpy.linalg.norm(grid, axis=1) < radius]
        mesh = souple.FluidSurface(spacing=spacing).build(particles)
        a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(float) for k in range(3))
        volume = numpy.einsum("ij,ij->i", a, numpy.cross(b, c)).sum() / 6
        self.assertAlmostEqual(volume / (len(particles) * spacing**3), 1, delta=0.1)
        with self.assertRaises(souple.Error):
            souple.FluidSurface()


class Pictures(unittest.TestCase):
    def test_a_picture_shows_the_object(self):
        world = souple.World(threads=1)
        world.add_cloth(souple.grid(8, 8, 1.0))
        try:
            empty = souple.render(souple.World(threads=1), 160, 90, camera_from=(1, 1, 2), camera_to=(0, 0, 0), samples=1)
        except souple.Error as error:
            self.skipTest(str(error))
        pixels = souple.render(world, 160, 90, camera_from=(1, 1, 2), camera_to=(0, 0, 0), samples=1)
        self.assertEqual((pixels.shape, pixels.dtype), ((90, 160, 4), numpy.uint8))
        different = (pixels != empty).any(axis=2)
        self.assertGreater(different.mean(), 0.05)
        self.assertTrue(different[30:60, 60:100].any())
        with tempfile.TemporaryDirectory() as folder:
            souple.write_png(f"{folder}/picture.png", pixels)
            self.assertTrue(pathlib.Path(f"{folder}/picture.png").read_bytes().startswith(b"\x89PNG"))
        for wrong in ({"width": 0}, {"samples": 0}, {"fov": 200.0}, {"camera_from": (0, 0, 0), "camera_to": (0, 0, 0)}):
            with self.assertRaises(souple.Error):
                souple.render(world, **wrong)


if __name__ == "__main__":
    unittest.main()
