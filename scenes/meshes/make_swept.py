#!/usr/bin/env python3
"""Writes the meshes of the shipped scenes that are swept along a circle or a curve, beside itself. These are glass.obj,
tube.obj, knot_left.obj, knot_right.obj, torso.obj, shirt.obj, coat.obj, water_balloon.obj, bag_left.obj, bag_right.obj.
Meters."""
import math
import pathlib

here = pathlib.Path(__file__).parent


def write(name, about, vertices, triangles, groups=None):
    lines = [f"# {about} Made by make_swept.py.", f"o {name}"]
    lines += ["v " + " ".join(f"{x + 0.0:.5g}" if abs(x) >= 5e-6 else "0" for x in v) for v in vertices]
    lines += ["f " + " ".join(str(v + 1) for v in t) for t in triangles]
    for group, members in (groups or {}).items():
        lines += [f"g {group}", "p " + " ".join(str(v + 1) for v in members)]
    (here / f"{name}.obj").write_text("\n".join(lines) + "\n")
    print(f"{name}: {len(vertices)} vertices, {len(triangles)} triangles")


def quads(rows, columns, closed):
    """Two triangles for each cell of a grid whose rows are closed or open, their diagonals in turn."""
    triangles = []
    for row in range(rows - 1):
        for column in range(columns if closed else columns - 1):
            a, b = row * columns + column, row * columns + (column + 1) % columns
            c, d = a + columns, b + columns
            triangles += [(a, c, d), (a, d, b)] if (row + column) % 2 == 0 else [(a, c, b), (b, c, d)]
    return triangles


def circle(radius, height, segments):
    angles = (2 * math.pi * s / segments for s in range(segments))
    return [(radius * math.cos(a), height, radius * math.sin(a)) for a in angles]


def glass(radius, height, wall, segments=32, parts=5):
    """A cup with thick walls that stands in y = 0: its outside from below, then its inside from above."""
    outer = radius + wall
    profile = [(outer / 2, 0), (outer, 0)] + [(outer, (height + wall) * k / parts) for k in range(1, parts + 1)]
    profile += [(radius, wall + height * (parts - k) / parts) for k in range(parts + 1)] + [(radius / 2, wall)]
    vertices = [v for r, y in profile for v in circle(r, y, segments)] + [(0, 0, 0), (0, wall, 0)]
    triangles = quads(len(profile), segments, True)
    low, high, last = len(vertices) - 2, len(vertices) - 1, (len(profile) - 1) * segments
    for s in range(segments):
        t = (s + 1) % segments
        triangles += [(low, s, t), (high, last + t, last + s)]
    write("glass", "A glass, closed, with thick walls.", vertices, triangles)


def tube(radius, length, around):
    along = round(length / (2 * math.pi * radius / around))
    vertices = [v for k in range(along + 1) for v in circle(radius, length * k / along, around)]
    write("tube", "An open tube that stands in y = 0.", vertices, quads(along + 1, around, True))


# Half widths of a torso by height, from the hips to the neck; it is less deep than wide.
TORSO = [(0, 0.17), (0.1, 0.16), (0.2, 0.145), (0.32, 0.155), (0.42, 0.165), (0.48, 0.158), (0.52, 0.138), (0.55, 0.1),
         (0.57, 0.06), (0.66, 0.052)]
DEPTH = 0.7


def outline(lowest, highest, rows):
    """Points of the torso's outline at equal steps along it, each with the normal there; straight below the hips."""
    points = ([(lowest, TORSO[0][1] + 0.15 * -lowest)] if lowest < 0 else []) + TORSO
    dense = [[p + (q - p) * s / 50 for p, q in zip(a, b)] for a, b in zip(points, points[1:]) for s in range(50)]
    dense = [p for p in dense if lowest <= p[0] <= highest]
    ways = [0]
    for p, q in zip(dense, dense[1:]):
        ways.append(ways[-1] + math.dist(p, q))
    rows_of = [min(range(len(ways)), key=lambda k: abs(ways[k] - ways[-1] * row / (rows - 1))) for row in range(rows)]
    for k in rows_of:
        (y0, r0), (y1, r1) = dense[max(k - 20, 0)], dense[min(k + 20, len(dense) - 1)]
        size = math.hypot(y1 - y0, r1 - r0)
        yield *dense[k], (r0 - r1) / size, (y1 - y0) / size


def garment(name, about, lowest, highest, rows, segments, offset):
    """The torso's outline all around, moved along its normal by offset(angle, part of the way down)."""
    vertices = []
    for row, (y, r, up, out) in enumerate(outline(lowest, highest, rows)):
        for a in (2 * math.pi * s / segments for s in range(segments)):
            d = offset(a, 1 - row / (rows - 1))
            vertices.append(((r + d * out) * math.cos(a), y + d * up, (DEPTH * r + d * out) * math.sin(a)))
    write(name, about, vertices, quads(rows, segments, True))


def torso(segments=40, rows=28):
    rings = [(r, y) for y, r, _, _ in outline(0, 0.66, rows)]
    vertices = [(x, y, DEPTH * z) for r, h in rings for x, y, z in circle(r, h, segments)]
    triangles, low, high = quads(rows, segments, True), len(vertices), len(vertices) + 1
    for s in range(segments):
        t = (s + 1) % segments
        triangles += [(low, s, t), (high, (rows - 1) * segments + t, (rows - 1) * segments + s)]
    write("torso", "A torso, closed.", vertices + [(0, 0, 0), (0, 0.66, 0)], triangles)


def smooth(points, step):
    """Points at equal steps along the Catmull-Rom curve through `points`."""
    dense = []
    for k in range(len(points) - 1):
        a, b, c, d = (points[min(max(i, 0), len(points) - 1)] for i in range(k - 1, k + 3))
        for s in (i / 100 for i in range(100)):
            dense.append([(2 * q + (r - p) * s + (2 * p - 5 * q + 4 * r - t) * s ** 2 + (3 * q - p - 3 * r + t) * s ** 3) / 2
                          for p, q, r, t in zip(a, b, c, d)])
    dense.append(list(points[-1]))
    ways = [math.dist(p, q) for p, q in zip(dense, dense[1:])]
    each, since, even = sum(ways) / round(sum(ways) / step), 0, [dense[0]]
    for before, after, way in zip(dense, dense[1:], ways):
        since += way
        while since >= each * (1 - 1e-9):
            since -= each
            even.append([q + (p - q) * since / way for p, q in zip(before, after)])
    return even


def strip(name, half, across=5, width=0.08):
    """Half of a curve, and its mirror image in z; a strip on edge along it."""
    curve = smooth(half + [(x, y, -z) for x, y, z in reversed(half[:-1])], width / (across - 1))
    vertices = [(x, y + width * (k / (across - 1) - 0.5), z) for x, y, z in curve for k in range(across)]
    write(name, "One strip of a reef knot.", vertices, quads(len(curve), across, False))


def zipped(below, above):
    """Triangles between two rows of vertices of different numbers, always across the shorter diagonal."""
    triangles, i, j = [], 0, 0
    while i + 1 < len(below) or j + 1 < len(above):
        if j + 1 == len(above) or (i + 1 < len(below) and (i + 1) * max(len(above) - 1, 1) <= (j + 1) * max(len(below) - 1, 1)):
            triangles.append((below[i], above[j], below[i + 1]))
            i += 1
        else:
            triangles.append((below[i], above[j], above[j + 1]))
            j += 1
    return triangles


def water_balloon(radius, neck, height, edge=0.02, gores=4, gap=0.0006):
    """A balloon of separate gores around y, each a hair from the next; of every seam both sides are a group."""
    profile = [(-radius * math.cos(a), radius * math.sin(a), 0) for a in (math.pi * k / 24 for k in range(17))]
    profile += [(0.82 * height, 1.15 * neck, 0), (height, neck, 0)]
    vertices, triangles, groups = [], [], {"knot": []}
    rings = smooth(profile, edge)
    for gore in range(gores):
        rows = []
        for y, r, _ in rings:
            r = max(r, gap)
            columns = max(1, round(2 * math.pi * r / gores / edge)) if r > gap else 0
            margin = gap / 2 / r if columns else math.pi / gores
            lo, hi = 2 * math.pi * gore / gores + margin, 2 * math.pi * (gore + 1) / gores - margin
            rows.append(range(len(vertices), len(vertices) + columns + 1))
            for c in range(columns + 1):
                a = lo + (hi - lo) * c / max(columns, 1)
                vertices.append((r * math.cos(a), y, r * math.sin(a)))
        for below, above in zip(rows, rows[1:]):
            triangles += zipped(below, above)
        groups[f"seam{(gore - 1) % gores + 1}_b"] = [row[0] for row in rows]
        groups[f"seam{gore + 1}_a"] = [row[-1] for row in rows]
        groups["knot"] += rows[-1]
    write("water_balloon", "A balloon with a neck, of four gores that hang together nowhere.", vertices, triangles, groups)


def bag(radius, neck, height, edge=0.03):
    """Both halves of a bag that is sewn in the plane x = 0; the seam's vertices of both lie at the same points."""
    profile = [(-radius * math.cos(a), radius * math.sin(a), 0) for a in (math.pi * k / 24 for k in range(15))]
    profile += [(0.8 * height, 1.3 * neck, 0), (height, neck, 0)]
    rings = smooth(profile, edge)
    for name, start in ("bag_right", -math.pi / 2), ("bag_left", math.pi / 2):
        vertices, triangles, rows = [], [], []
        for y, r, _ in rings:
            columns = max(2, round(math.pi * r / edge)) if r > 1e-6 else 0
            rows.append(range(len(vertices), len(vertices) + columns + 1))
            for c in range(columns + 1):
                a = start + math.pi * c / max(columns, 1)
                vertices.append((r * math.cos(a), y, r * math.sin(a)))
        for below, above in zip(rows, rows[1:]):
            triangles += zipped(below, above)
        seam = [row[0] for row in rows] + [row[-1] for row in rows[1:]]
        write(name, "Half of a bag.", vertices, triangles, {"seam": seam, "neck": list(rows[-1])})


if __name__ == "__main__":
    glass(0.16, 0.4, 0.03)
    tube(0.06, 1.3, 12)
    h = 0.12
    strip("knot_left", [(-1.3, 0, 0.32), (-1, 0, 0.32), (-0.4, 0, 0.32), (0, 0, 0.32), (0.2, 0, 0.25), (0.31, 0, 0)])
    strip("knot_right", [(1.3, h, 0.14), (1, h, 0.14), (0.5, h, 0.14), (0.28, h, 0.15), (0.1, 0, 0.2), (-0.05, -h, 0.28),
                         (-0.15, -h, 0.36), (-0.3, -0.7 * h, 0.5), (-0.48, 0, 0.53), (-0.64, 0.8 * h, 0.46),
                         (-0.74, 1.1 * h, 0.32), (-0.78, 1.1 * h, 0)])
    torso()
    garment("shirt", "A shirt without sleeves, open below and at the neck.", -0.12, 0.56, 30, 48, lambda a, down: 0.012)
    garment("coat", "A coat that is half sunk into the shirt.", 0.06, 0.548, 22, 44,
            lambda a, down: 0.02 + min(4 * down, 1) * (0.009 * math.cos(3 * a + 1) - 0.007))
    water_balloon(0.15, 0.02, 0.26)
    bag(0.2, 0.03, 0.36)
