#!/usr/bin/env python3
"""Makes wave.obj and wave.pc2: a mat through which waves run, one second long, for scenes/everything_together.json."""
import math
import pathlib
import struct

COLUMNS, ROWS = 25, 13
LENGTH, WIDTH, HEIGHT, WAVE = 0.8, 0.7, 0.05, 0.4  # m
FRAMES = 20

here = pathlib.Path(__file__).resolve().parent


def points(phase):
    for j in range(ROWS):
        for i in range(COLUMNS):
            x = (i / (COLUMNS - 1) - 0.5) * LENGTH
            fade = math.sin(math.pi * i / (COLUMNS - 1))  # the ends lie on the floor
            yield x, HEIGHT * fade * (1 + math.sin(2 * math.pi * (x / WAVE - phase))), (j / (ROWS - 1) - 0.5) * WIDTH


lines = ["# A mat with waves. Made by make_wave.py.", "o wave"]
lines += ["v %.5f %.5f %.5f" % p for p in points(0)]
for j in range(ROWS - 1):
    for i in range(COLUMNS - 1):
        a = j * COLUMNS + i + 1
        lines.append(f"f {a} {a + COLUMNS} {a + COLUMNS + 1} {a + 1}")
(here / "wave.obj").write_text("\n".join(lines) + "\n")
frames = [list(points(k % FRAMES / FRAMES)) for k in range(FRAMES + 1)]
data = struct.pack("<12siiffi", b"POINTCACHE2\0", 1, COLUMNS * ROWS, 0, 1, len(frames))
(here / "wave.pc2").write_bytes(data + b"".join(struct.pack("<3f", *p) for frame in frames for p in frame))
