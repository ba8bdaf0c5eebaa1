#!/usr/bin/env python3
"""Tests of `souple render` and `souple run --picture`: test_render.py PROGRAM SOURCE_FOLDER [unittest's arguments]."""

import json
import re
import shlex
import shutil
import struct
import subprocess
import sys
import time
import unittest
import zlib

from cli_case import EXPLODING, PROGRAM, SMALL, SOURCE, Case, png_size

QUICK = ["--size", "160x90", "--samples", "1"]
SCENE = dict(SMALL, camera={"from": [1, 1.5, 3], "to": [0, 1, 0]})


def png_pixels(path):
    """Rows of (r, g, b) of an 8 bit PNG in true color, with or without alpha."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colors, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert depth == 8 and colors in (2, 6) and not interlaced
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    step = 3 if colors == 2 else 4
    raw, rows, before = zlib.decompress(packed), [], bytes(width * step)
    for y in range(height):
        start = y * (width * step + 1)
        how, row = raw[start], bytearray(raw[start + 1:start + 1 + width * step])
        for i in range(len(row)):
            a, b, c = (row[i - step] if i >= step else 0), before[i], (before[i - step] if i >= step else 0)
            nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            row[i] = (row[i] + [0, a, b, (a + b) // 2, nearest][how]) & 255
        rows.append([tuple(row[x:x + 3]) for x in range(0, len(row), step)])
        before = row
    return rows


def png(rows):
    """The bytes of a PNG with these rows of (r, g, b)."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    packed = zlib.compress(b"".join(b"\0" + bytes(v for pixel in row for v in pixel) for row in rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", packed) + chunk(b"IEND", b"")


def hdr(radiance, width=16, height=8):
    """A panorama in the Radiance format, the same from all sides: three bytes for (r, g, b), 128 is 1."""
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + bytes([*radiance, 129]) * (width * height)


def difference(one, other):
    """Fraction of pixels that differ by more than a small tolerance."""
    a, b = png_pixels(one), png_pixels(other)
    pairs = [(p, q) for row, other_row in zip(a, b) for p, q in zip(row, other_row)]
    return sum(max(abs(i - j) for i, j in zip(p, q)) > 8 for p, q in pairs) / len(pairs)


def probe(path):
    """(width, height, pictures a second, pictures)"""
    said = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v", "-show_entries",
                           "stream=width,height,r_frame_rate,nb_read_frames", "-of", "csv=p=0", str(path)],
                          capture_output=True, text=True, check=True).stdout
    width, height, rate, frames = said.strip().split(",")
    above, below = rate.split("/")
    return int(width), int(height), int(above) / int(below), int(frames)


def built_in():
    said = subprocess.run([PROGRAM, "info"], capture_output=True, text=True, check=True).stdout
    return "pictures: yes" in said


class RenderCase(Case):
    def setUp(self):
        if not built_in():
            self.skipTest("built without pictures")
        super().setUp()

    def render(self, *arguments, code=0):
        return self.souple("render", *arguments, *QUICK, code=code)

    def needs_ffmpeg(self):
        if not shutil.which("ffmpeg") or not shutil.which("ffprobe"):
            self.skipTest("ffmpeg is not installed")


class Pictures(RenderCase):
    def test_the_last_frame_by_default(self):
        done = self.render(self.scene(SCENE))
        self.assert_one_line(done.stdout)
        self.assertRegex(done.stdout, r"^small: frame 20 of 160x90 in [\d.]+ s, in out/small.png; "
                                      r"the subject fills \d+ % of the width, \d+ % of the height\n$")
        self.assertEqual(done.stderr, "")
        self.assertEqual(png_size(self.folder / "out/small.png"), (160, 90))
        self.assertEqual(self.names(), ["out", "out/small.png", "small.json"])
        self.assertGreater(len({pixel for row in png_pixels(self.folder / "out/small.png") for pixel in row}), 200)

    def test_a_frame_alone_is_the_frame_of_many(self):
        scene = self.scene(SCENE)
        self.assertEqual(self.render(scene, "--out", "a.png", "--frames", "15", "--quiet").stdout, "")
        done = self.render(scene, "--out", "pictures", "--frames", "5-last/5")
        self.assertIn("4 pictures of 160x90", done.stdout)
        self.assertNotIn("\r", done.stdout + done.stderr)  # progress only on a terminal
        names = [n for n in self.names() if n.startswith("pictures/")]
        self.assertEqual(names, [f"pictures/small_{n:04}.png" for n in (5, 10, 15, 20)])
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "pictures/small_0015.png").read_bytes())

    def pictures(self, scene, variants):
        """The picture of frame 10 with each of these options: {options: bytes}."""
        made = {}
        for options in variants:
            self.souple("render", scene, "--out", "a.png", "--frames", "10", "--size", "96x54", "--samples", "2",
                        *shlex.split(options))
            made[options] = (self.folder / "a.png").read_bytes()
        return made

    def test_options_change_the_picture(self):
        said = self.souple("render", "--help").stdout
        displays = re.search(r"displays: +(.*)", said).group(1).split(", ")
        constraints = re.search(r"constraints: +(.*)", said).group(1).split(", ")
        self.assertEqual((len(displays), len(constraints)), (9, 5))
        scene = self.scene(SCENE)
        made = self.pictures(scene, [
            "", "--set objects.flag.transform.translate=[0.4,1.2,0]", "--focus 1 --aperture 0.3", "--shutter 1", "--colors 9",
            "--camera 'fov 15'", "--camera auto", "--display speed", "--display contacts", "--constraints kind"])
        self.assertEqual(len(set(made.values())), len(made), "two of them look alike")
        self.assertLess(len(made["--colors 9"]), 0.7 * len(made[""]))
        same = self.pictures(scene, ["", f"--display {displays[0]}", f"--constraints {constraints[0]}"])
        self.assertEqual(set(same.values()), {made[""]})
        for option, names in ("--display", displays), ("--constraints", constraints):
            refused = self.render(scene, option, "nothing", code=2).stderr
            for name in names:
                self.assertIn(name, refused)

    def test_options_of_liquids_change_the_picture(self):
        pool = {"name": "pool", "kind": "fluid", "box": {"lo": [-0.3, 0, -0.3], "hi": [0.3, 0.1, 0.3]},
                "material": {"preset": "water", "spacing": 0.03}}
        scene = {"souple": 1, "frames": 10, "objects": [pool], "colliders": [{"name": "floor", "shape": {"plane": {}}}],
                 "camera": {"from": [0, 0.6, 0.9], "to": [0, 0.05, 0]}}
        made = self.pictures(self.scene(scene), [
            "", "--liquid-filter none", "--liquid-filter curvature-flow", "--liquid-filter curvature-flow --liquid-steps 2",
            "--liquid-splats spheres", "--caustics"])
        self.assertEqual(len(set(made.values())), len(made), "two of them look alike")
        same = self.pictures(self.scene(scene), ["--liquid-filter narrow-range", "--liquid-splats ellipsoids"])
        self.assertEqual(set(same.values()), {made[""]})
        marked = self.pictures(self.scene(dict(scene, objects=[dict(pool, caustics=True)]), "marked.json"), [""])
        self.assertEqual(marked[""], made["--caustics"])

    def printed(self, pattern, **cloth):
        """A scene with a square cloth that stands still and fills the picture, under an even light."""
        (self.folder / "even.hdr").write_bytes(hdr((115, 115, 115)))
        square = dict({"name": "square", "kind": "cloth", "mesh": {"grid": {"columns": 5, "rows": 5, "size": 1}},
                       "pattern": pattern, "pins": [{"all": True}]}, **cloth)
        return self.scene({"souple": 1, "frames": 1, "objects": [square], "sky": {"file": "even.hdr"},
                           "camera": {"from": [0, 2, 0.001], "to": [0, 0, 0], "fov": 40}})

    def test_a_picture_on_a_cloth_is_where_the_uvs_say(self):
        red, green, blue, white = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255)
        (self.folder / "pictures").mkdir()
        (self.folder / "pictures/four.png").write_bytes(png([[red] * 4 + [green] * 4] * 4 + [[blue] * 4 + [white] * 4] * 4))
        scene = self.printed("pictures/four.png")
        self.assertIn("valid", self.souple("check", scene).stdout)
        self.souple("render", scene, "--out", "a.png", "--size", "80x80", "--samples", "1")
        rows = png_pixels(self.folder / "a.png")
        seen = [[tuple(255 * (v > 128) for v in rows[y][x]) for x in (30, 50)] for y in (30, 50)]
        # U goes along X, to the right, and V from the far edge to the near one.
        self.assertEqual(seen, [[blue, white], [red, green]])
        # From another folder.
        self.souple("render", str((self.folder / scene).resolve()), "--out", "b.png", "--size", "80x80", "--samples", "1", "--quiet")
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())

    def test_a_picture_that_cannot_be_printed_is_an_error(self):
        (self.folder / "text.png").write_text("no picture")
        (self.folder / "half.png").write_bytes(png([[(1, 2, 3)] * 50] * 50)[:-40])
        (self.folder / "wide.png").write_bytes(png([[(0, 0, 0)] * 4097]))
        (self.folder / "good.png").write_bytes(png([[(0, 0, 0)]]))
        (self.folder / "bare.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n")
        for pattern, words in (("missing.png", ["objects[0].pattern", "missing.png", "not found"]),
                               ("text.png", ["text.png", "not a PNG"]), ("half.png", ["half.png", "damaged"]),
                               ("wide.png", ["wide.png", "4097 x 1", "at most 4096"]),
                               ("text.jpg", ["objects[0].pattern", "text.jpg", ".png"]), ("spots", ["spots", "dots"])):
            done = self.souple("check", self.printed(pattern), code=2)
            self.assert_one_line(done.stderr)
            for word in words:
                self.assertIn(word, done.stderr, pattern)
        scene = self.printed("good.png", mesh={"file": "bare.obj"})
        for command in "check", "render":
            done = self.souple(command, scene, code=2)
            self.assert_one_line(done.stderr)
            self.assertIn("objects[0]: pattern: the mesh has no UVs", done.stderr)

    def test_a_panorama_lights_the_scene(self):
        (self.folder / "red.hdr").write_bytes(hdr((128, 8, 8)))
        (self.folder / "dim.hdr").write_bytes(hdr((8, 8, 8)))
        (self.folder / "bad.hdr").write_bytes(hdr((8, 8, 8))[:-3])
        scene = self.scene(dict(SCENE, sky={"file": "red.hdr"}))
        self.assertIn("valid", self.souple("check", scene).stdout)
        self.render(scene, "--out", "red.png")
        self.render(scene, "--out", "dim.png", "--sky", "dim.hdr")
        light = {}
        for name in "red", "dim":
            pixels = [p for row in png_pixels(self.folder / (name + ".png")) for p in row]
            light[name] = [sum(p[c] for p in pixels) / len(pixels) for c in range(3)]
        self.assertGreater(light["red"][0], 2 * light["red"][1])
        self.assertGreater(light["red"][0], 2 * light["dim"][0])
        bad = self.scene(dict(SCENE, sky={"file": "bad.hdr"}), "bad.json")
        for arguments in ("check", bad), ("render", bad), ("render", scene, "--sky", "bad.hdr"), ("render", scene, "--sky", "no.hdr"):
            done = self.souple(*arguments, code=2)
            self.assert_one_line(done.stderr)
            self.assertIn("no.hdr" if arguments[-1] == "no.hdr" else "bad.hdr", done.stderr)

    def test_without_a_camera_the_objects_fill_the_picture(self):
        far = json.loads(json.dumps(SMALL))
        far["objects"] = [dict(far["objects"][0], transform={"translate": [70, 30, -50]})]
        far["colliders"], far["wind"] = [], {}
        for name, scene in ("far.png", far), ("empty.png", dict(far, objects=[])):
            self.render(self.scene(scene), "--out", name, "--frames", "1", "--camera",
                        "auto" if scene is far else "from 71,31,-47 to 70,30,-50")
        self.render(self.scene(far), "--out", "default.png", "--frames", "1")
        self.assertEqual((self.folder / "far.png").read_bytes(), (self.folder / "default.png").read_bytes())
        self.assertGreater(difference(self.folder / "far.png", self.folder / "empty.png"), 0.05)

    def test_several_pictures_without_a_camera_show_what_the_run_covers(self):
        falling = {"souple": 1, "frames": 60, "substeps": 2, "objects": [
            {"name": "sheet", "kind": "cloth", "mesh": {"grid": {"columns": 5, "rows": 5, "size": 0.8}}}]}
        scene = self.scene(falling)
        self.souple("run", scene, "--out", "run")
        self.render(self.scene(dict(falling, objects=[]), "empty.json"), "--out", "empty", "--frames", "1-60/59")
        background = {pixel for path in (self.folder / "empty").iterdir() for row in png_pixels(path) for pixel in row}
        for source in scene, "run":
            shutil.rmtree(self.folder / "all", ignore_errors=True)
            self.render(source, "--out", "all", "--frames", "1-60/59", "--camera", "auto")
            name = "small" if source == scene else "run"
            first, last = (self.folder / f"all/{name}_{frame:04}.png" for frame in (1, 60))
            self.assertGreater(difference(first, last), 0.0005, "the sheet is in neither picture, or does not move")
            # Fallen by 4.9 m it is still in the picture: the colors are not those of a background alone.
            for path in first, last:
                self.assertGreater(len({pixel for row in png_pixels(path) for pixel in row} - background), 3, path)

    def test_a_long_film_says_how_long_it_takes(self):
        scene = self.scene(dict(SCENE, frames=20000))
        running = self.start("render", scene, "--out", "all", "--frames", "1-20000")
        said = running.stdout.readline()
        self.stop(running)
        self.assertRegex(said, r"small: 20000 pictures of 1280x720 at 4 samples, about \d+ (min|h) \d\d (s|min)")

    def test_sheet(self):
        done = self.souple("render", self.scene(SCENE), "--sheet", "4x3", "--size", "120x80", "--samples", "1")
        self.assertIn("12 pictures of 120x80", done.stdout)
        width, height = png_size(self.folder / "out/small.png")
        self.assertTrue(4 * 120 <= width <= 4 * 120 + 40 and 3 * 80 <= height <= 3 * 80 + 40, (width, height))
        # Every cell has a label: its lower left corner differs from that of the frame alone.
        self.souple("render", self.scene(SCENE), "--out", "last.png", "--size", "120x80", "--samples", "1")
        page, last = png_pixels(self.folder / "out/small.png"), png_pixels(self.folder / "last.png")
        cell = [row[width - 120:] for row in page[height - 80:]]
        changed = [(x, y) for y in range(80) for x in range(120) if cell[y][x] != last[y][x]]
        self.assertTrue(changed)
        self.assertTrue(all(y > 55 for _, y in changed), "the label lies at the bottom, the rest is the frame")


class Runs(RenderCase):
    """The picture of a run's folder equals that of its scene."""

    def test_folder_and_scene_are_the_same_picture(self):
        moving = dict(SCENE, colliders=SCENE["colliders"] + [
            {"name": "ball", "shape": {"sphere": {"radius": 0.3}},
             "keyframes": [{"time": 0, "translate": [-1, 0.5, 0]}, {"time": 0.5, "translate": [1, 0.5, 0]}]}])
        scene = self.scene(moving)
        self.souple("run", scene, "--out", "run", "--write", "mdd")
        for frame, source in ("12", "run"), ("last", "run/run.json"):
            self.render(scene, "--out", frame + ".png", "--frames", frame)
            self.render(source, "--out", "b.png", "--frames", frame)
            self.assertEqual((self.folder / (frame + ".png")).read_bytes(), (self.folder / "b.png").read_bytes())
        self.assertNotEqual((self.folder / "12.png").read_bytes(), (self.folder / "last.png").read_bytes())

    def test_speed_comes_from_two_frames(self):
        scene = self.scene(SCENE)
        self.souple("run", scene, "--out", "run")
        for source, name in (scene, "a.png"), ("run", "b.png"):
            self.render(source, "--out", name, "--frames", "15", "--display", "speed")
        self.render(scene, "--out", "c.png", "--frames", "15")
        self.assertGreater(difference(self.folder / "a.png", self.folder / "c.png"), 0.03)
        self.assertLess(difference(self.folder / "a.png", self.folder / "b.png"), 0.02)

    def test_a_run_whose_meshes_are_gone(self):
        (self.folder / "cloth.obj").write_text("v 0 1 0\nv 1 1 0\nv 0 1 1\nf 1 2 3\n")
        scene = json.loads(json.dumps(SCENE))
        scene["objects"][0] = {"name": "flag", "kind": "cloth", "mesh": {"file": "cloth.obj"}}
        self.souple("run", self.scene(scene), "--out", "run")
        (self.folder / "cloth.obj").unlink()
        self.render("run", "--out", "a.png")
        self.assertTrue((self.folder / "a.png").is_file())

    def test_what_a_folder_cannot_show(self):
        self.souple("run", self.scene(SCENE), "--out", "run")
        for arguments in (["--display", "lattice"], ["--display", "contacts"], ["--constraints", "kind"]):
            said = self.render("run", *arguments, code=2).stderr
            self.assertIn(" ".join(arguments) + ": run holds positions only", said)
            self.assert_one_line(said)
        self.assertIn("--set is for scenes", self.render("run", "--set", "substeps=3", code=2).stderr)

    def test_run_with_picture(self):
        scene = self.scene(SCENE)
        done = self.souple("run", scene, "--out", "run", "--picture", "pictures/end.png")
        self.assertIn("small: picture of the last frame: pictures/end.png\n", done.stdout)
        self.assertEqual(png_size(self.folder / "pictures/end.png"), (1280, 720))
        self.souple("render", scene, "--out", "end.png")
        self.assertEqual((self.folder / "pictures/end.png").read_bytes(), (self.folder / "end.png").read_bytes())
        for name in "end.jpg", "end", "end.mp4":
            said = self.souple("run", scene, "--out", "other", "--picture", name, code=2).stderr
            self.assertIn(".png", said)
        self.assertFalse((self.folder / "other").exists())


class Sweeps(RenderCase):
    def test_sheet_of_a_sweep(self):
        sweep = [self.scene(SMALL), "--set", "drag=1,2", "--set", "substeps=1,2,3", "--frames", 1]
        self.souple("sweep", *sweep, "--out", "out", "--only", 2)
        self.assertEqual(png_size(self.folder / "out/0002/picture.png"), (480, 270))
        said = self.souple("sweep", *sweep, "--out", "out", "--table").stdout
        self.assertIn("6 runs, 5 missing, in out/table.csv and sheet.png", said)
        width, height = png_size(self.folder / "out/sheet.png")
        self.assertEqual((width // 480, height // 270), (3, 2))


class Films(RenderCase):
    """The formats themselves are tested by tests/render/test_film.cpp."""

    def test_length_and_rate(self):
        self.needs_ffmpeg()
        scene = self.scene(SCENE)
        done = self.souple("render", scene, "--out", "a.mp4", "--frames", "1-last/5", "--size", "161x91", "--samples", "1")
        self.assertIn("4 pictures of 161x91", done.stdout)
        self.assertEqual(probe(self.folder / "a.mp4"), (162, 92, 12, 4))  # every fifth frame keeps the speed
        self.render(scene, "--out", "b.mp4", "--film-rate", "15", "--frames", "1-last/2")
        self.assertEqual(probe(self.folder / "b.mp4"), (160, 90, 15, 10))
        self.souple("run", scene, "--out", "run")
        self.render("run", "--out", "c.gif")
        self.assertEqual(probe(self.folder / "c.gif")[3], 10)  # 60 per second are too many for a .gif: 30
        self.assertEqual([n for n in self.names() if "run" not in n], ["a.mp4", "b.mp4", "c.gif", "small.json"])

    def test_webp_fits_into_its_bytes(self):
        self.needs_ffmpeg()
        scene = self.scene(SCENE)
        done = self.souple("render", scene, "--out", "a.webp", "--frames", "1-last/4", "--samples", "1")
        self.assertIn("5 pictures of 640x360", done.stdout)
        most = (self.folder / "a.webp").stat().st_size // 2
        self.render(scene, "--out", "b.webp", "--film-rate", "8", "--film-bytes", str(most))
        self.assertLessEqual((self.folder / "b.webp").stat().st_size, most)
        said = self.render(scene, "--out", "c.webp", "--film-bytes", "300", code=1).stderr
        self.assert_one_line(said)
        self.assertIn("more than the 300 allowed", said)
        self.assertEqual(self.names(), ["a.webp", "b.webp", "small.json"])

    def test_without_ffmpeg_or_with_one_that_fails(self):
        scene = self.scene(SCENE)
        self.environment["PATH"] = ""
        said = self.render(scene, "--out", "films/a.mp4", code=2).stderr
        self.assertIn("Debian package ffmpeg", said)
        self.assert_one_line(said)
        self.assertEqual(self.names(), ["small.json"])
        self.render(scene, "--out", "a.png")  # a picture needs no ffmpeg
        self.assertIn("films: no", self.souple("info").stdout)
        (self.folder / "bin").mkdir()
        (self.folder / "bin/ffmpeg").write_text("#!/bin/sh\necho 'no space left' >&2\nexit 1\n")
        (self.folder / "bin/ffmpeg").chmod(0o755)
        self.environment["PATH"] = str(self.folder / "bin")
        done = self.render(scene, "--out", "a.mp4", code=1)
        self.assert_one_line(done.stderr)
        self.assertIn("a.mp4: ffmpeg failed: no space left", done.stderr)
        self.assertEqual(self.names(), ["a.png", "bin", "bin/ffmpeg", "small.json"])


class Refused(RenderCase):
    def refused(self, *arguments, said):
        before = self.names()
        done = self.souple("render", *arguments, code=2)
        self.assertEqual(self.names(), before, "something was left behind")
        self.assertEqual(done.stdout, "")
        self.assert_one_line(done.stderr)
        self.assertIn(said, done.stderr)

    def test_options(self):
        scene = self.scene(SCENE)
        for size in "0x7", "7", "8193x1", "4 x 5":
            self.refused(scene, "--size=" + size, said=f'--size "{size}": expected WIDTHxHEIGHT')
        for sheet in "0x3", "4", "99x1":
            self.refused(scene, "--sheet", sheet, said=f'--sheet "{sheet}": expected COLUMNSxROWS')
        self.refused(scene, "--sheet", "64x64", said="--size")
        for frames in "0", "1-", "3/2", "1-5/0":
            self.refused(scene, "--frames", frames, said=f'--frames "{frames}": expected N, A-B')
        self.refused(scene, "--frames", "21", said="from 1 to 20")
        self.refused(scene, "--frames", "5-2", said="not after the last")
        for camera in "from 1,2", "fov 180", "to nan,0,0", "from 1,2,3 from 1,2,3":
            self.refused(scene, "--camera", camera, said=f'--camera "{camera}": expected')
        self.refused(scene, "--samples", "0", said="--samples 0: expected 1 to 1024")
        self.refused(scene, "--liquid-filter", "blur", said='--liquid-filter "blur": expected one of none, curvature-flow, n')
        self.refused(scene, "--liquid-splats", "cubes", said='--liquid-splats "cubes": expected one of spheres, ellipsoids')
        self.refused(scene, "--liquid-steps", "0", said="--liquid-steps 0: expected 1 to 500")
        for option, bad in ("--focus", "0"), ("--focus", "-1"), ("--aperture", "0"), ("--shutter", "1.5"), ("--shutter", "nan"):
            self.refused(scene, f"{option}={bad}", said=f"{option} {bad}: expected a number above 0 and at most")
        self.refused(scene, "--colors", "1", said="--colors 1: expected 2 to 256")
        self.refused(scene, "--colors", "9", "--out", "a.mp4", said="--colors 9: is for pictures")
        self.refused(scene, "--samples", "x", said="expected a whole number")
        self.refused(scene, "--aperture", "x", said="--aperture = x: expected a number;")
        self.refused(scene, "--film-rate", "10", said="--film-rate 10: is for a film")
        self.refused(scene, "--out", "a.webp", "--film-rate", "61", said="--film-rate 61: expected 0.1 to 60 pictures")
        self.refused(scene, "--out", "a.gif", "--film-rate", "0", said="--film-rate 0: expected 0.1 to 50 pictures")
        self.refused(scene, "--out", "a.mp4", "--film-bytes", "9", said="--film-bytes 9: is for a film .webp")
        self.refused(scene, "--out", "a.webp", "--film-bytes", "0", said="--film-bytes 0: expected at least 1")

    def test_outputs(self):
        scene = self.scene(SCENE)
        for name in "a.jpg", "a.webm", "a.AVI":
            self.refused(scene, "--out", name, said=f"--out {name}: expected a picture .png")
        self.refused(scene, "--out", "a.png", "--frames", "1-3", said="3 frames do not fit into one picture")
        self.refused(scene, "--out", "a.mp4", "--sheet", "2x2", said="--sheet makes one page")
        (self.folder / "file").write_text("mine")
        for name in "file/a.png", "file/a.mp4", "file/folder":
            self.refused(scene, "--out", name, said="file")
        (self.folder / "folder.png").mkdir()
        self.refused(scene, "--out", "folder.png", said="is a folder")

    def test_outputs_that_cannot_be_written(self):
        """Exit code 1, before the first picture."""
        self.souple("run", self.scene(SCENE), "--out", "out")
        (self.folder / "loop").symlink_to("loop")
        films = ["loop/a.mp4", "m" * 252 + ".mp4"] if shutil.which("ffmpeg") else []
        for name in ["loop/a.png", "loop/inner", "loop", "n" * 252 + ".png", "n" * 256, *films]:
            said = self.render("out", "--out", name, code=1).stderr
            self.assert_one_line(said)
            self.assertIn(name.split(".")[0].split("/")[0], said)
        self.assertIn("loop", self.souple("run", self.scene(SCENE), "--picture", "loop/a.png", code=1).stderr)

    def test_sources(self):
        self.refused("flga", said='did you mean "flag"')
        self.refused("no/such.json", said="no such file")
        (self.folder / "empty").mkdir()
        self.refused("empty", said="has no run.json")
        (self.folder / "broken").mkdir()
        (self.folder / "broken/run.json").write_text("{")
        self.refused("broken", said="run.json")
        done = self.souple("render", code=2)
        self.assertIn("SOURCE", done.stderr)

    def test_a_run_without_frames(self):
        self.souple("run", self.scene(SCENE), "--out", "run", "--frames", "1")
        manifest = json.loads((self.folder / "run/run.json").read_text())
        manifest["frames"] = 0
        manifest["reports"] = []
        for item in manifest["objects"]:
            item["files"] = [f for f in item["files"] if not f["frames"]]
        (self.folder / "run/run.json").write_text(json.dumps(manifest))
        self.refused("run", said="frame")

    def test_without_egl(self):
        self.environment["__EGL_VENDOR_LIBRARY_FILENAMES"] = "/nonexistent"
        self.refused(self.scene(SCENE), "--out", "new/a.png", said="libegl-mesa0")
        said = self.souple("run", self.scene(SCENE), "--picture", "new/a.png", code=2).stderr
        self.assertIn("libegl-mesa0", said)
        self.assertEqual(self.names(), ["small.json"])

    def test_without_libraries_of_opengl(self):
        broken = self.folder / "broken"
        broken.mkdir()
        self.environment["LD_LIBRARY_PATH"] = str(broken)
        for library, package in (("libGLESv2.so.2", "libgles2"), ("libEGL.so.1", "libegl1")):
            (broken / library).write_text("no library")
            self.refused(self.scene(SCENE), "--out", "new/a.png", said=package)
            (broken / library).unlink()


class Trouble(RenderCase):
    def test_a_simulation_that_goes_bad(self):
        self.needs_ffmpeg()
        scene = self.scene(EXPLODING)
        said = self.souple("run", scene, "--out", "run", code=3).stderr
        bad = int(re.search(r"diverged in frame (\d+)", said).group(1))
        self.assertGreater(bad, 1)
        done = self.render(scene, "--out", "a.png", code=3)
        self.assertRegex(done.stderr, rf"diverged in frame {bad}: object .*; a.png shows the last valid frame, {bad - 1}\.")
        self.assert_one_line(done.stderr)
        self.assertEqual(png_size(self.folder / "a.png"), (160, 90))
        done = self.render(scene, "--out", "a.mp4", code=3)
        self.assertIn(f"a.mp4 shows {bad - 1} frame", done.stderr)
        self.assertEqual(probe(self.folder / "a.mp4")[3], bad - 1)
        self.render(scene, "--sheet", "2x2", "--frames", "1-60", "--out", "sheet.png", code=3)
        self.assertTrue((self.folder / "sheet.png").is_file())
        self.souple("run", scene, "--out", "run", "--picture", "b.png", code=3)
        self.assertTrue((self.folder / "b.png").is_file())

    def test_limits_of_memory_end_in_one_line(self):
        scene = self.scene(dict(SCENE, frames=1))
        self.skip_sanitizers("its shadow memory exceeds any limit")
        # Where Mesa's driver finds no room, it crashes.
        codes = [self.limited(m, "render", scene, "--out", "a.png", *QUICK) for m in (200, 340, 440, 700, 4096)]
        for done in codes:
            self.assertIn(done.returncode, (0, 2), done.stderr)
            if done.returncode == 2:  # a line of Mesa's may come before
                self.assertRegex(done.stderr, "(^|\n)souple: [^\n]+\n$")
        self.assertEqual(codes[0].returncode, 2)
        self.assertEqual(codes[-1].returncode, 0, codes[-1].stderr)

    def interrupted(self, *arguments, wait_for):
        run = self.start("render", *arguments)
        self.wait_for(wait_for, run)
        error = self.stop(run)[1]
        self.assert_one_line(error)
        self.assertFalse([n for n in self.names() if ".part" in n], self.names())
        return error

    def test_interrupt_while_a_film_grows(self):
        self.needs_ffmpeg()
        scene = self.scene(dict(SCENE, frames=100000))
        part = self.folder / "a.part.mp4"
        said = self.interrupted(scene, "--out", "a.mp4", *QUICK,
                                wait_for=lambda: part.exists() and time.sleep(1) is None)
        pictures = int(re.search(r"interrupted after frame \d+; a.mp4 holds (\d+) pictures?", said).group(1))
        self.assertEqual(probe(self.folder / "a.mp4")[3], pictures)

    def test_interrupt_between_pictures(self):
        scene = self.scene(dict(SCENE, frames=100000))
        self.interrupted(scene, "--out", "all", *QUICK,
                         wait_for=lambda: (self.folder / "all/small_0003.png").exists())
        pictures = sorted((self.folder / "all").iterdir())
        self.assertGreaterEqual(len(pictures), 3)
        for picture in pictures:
            self.assertEqual(png_size(picture), (160, 90))

    def test_interrupt_before_there_is_a_picture(self):
        scene = self.scene(dict(SCENE, frames=1000000))
        started = time.time()
        said = self.interrupted(scene, "--out", "new/a.png", *QUICK, wait_for=lambda: time.time() > started + 1.5)
        self.assertIn("nothing was written", said)
        self.assertFalse([n for n in self.names() if n.endswith(".png")])


class Documents(RenderCase):
    def test_the_page_names_every_option_and_display(self):
        said = self.souple("render", "--help").stdout
        page = (SOURCE / "docs/rendering.md").read_text()
        for option in re.findall(r"^  (--[a-z]+)", said, re.M):
            self.assertIn(f"`{option}", page)
        for line in re.findall(r"^(?:displays|constraints): +(.*)", said, re.M):
            for name in line.split(", "):
                self.assertIn(f"`{name}`", page)
        for option in set(re.findall(r"`(--[a-z]+)", page)):
            self.assertIn(option, said + self.souple("run", "--help").stdout)


class Absent(Case):
    def test_a_program_without_pictures_says_so(self):
        if built_in():
            self.skipTest("built with pictures")
        for arguments in (["render", "flag"], ["run", "flag", "--picture", "a.png"]):
            done = self.souple(*arguments, code=2)
            self.assert_one_line(done.stderr)
            self.assertIn("libepoxy-dev", done.stderr)
        self.assertEqual(self.names(), [])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
