#!/usr/bin/env python3
"""Writes the small meshes of the shipped scenes beside itself: duck.obj, star.obj, beam.msh.

Surfaces are level sets of smooth bodies, cut by marching tetrahedra on a grid. Each cube has six tets, all along the
same diagonal, so that neighbors agree. So surfaces are closed, manifold and wound outward by construction. A level-set
mesh has slivers where it passes near a grid point. So near points are snapped to one vertex first, and the rest is
smoothed.
"""
import math
import pathlib

here = pathlib.Path(__file__).parent

# A cube's corners, bit by bit (x = 1, y = 2, z = 4), and its six tets about the diagonal 0-7.
TETS = [(0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7)]


def ellipsoid(p, center, radii, tilt=0.0):
    """About the distance to an ellipsoid, turned by tilt (degrees) about z; negative inside."""
    x, y, z = (a - b for a, b in zip(p, center))
    c, s = math.cos(math.radians(tilt)), math.sin(math.radians(tilt))
    q = ((c * x + s * y) / radii[0], (c * y - s * x) / radii[1], z / radii[2])
    length = math.hypot(*q)
    gradient = math.hypot(*(a / r for a, r in zip(q, radii)))
    return -min(radii) if length < 1e-9 else length * (length - 1.0) / gradient


def smooth_union(a, b, k):
    """min(a, b) with a fillet of size k."""
    h = max(k - abs(a - b), 0.0) / k
    return min(a, b) - h * h * k * 0.25


FLOOR = 6.0  # of the body is cut off, so that the duck stands


def duck_parts(p):
    """The duck looks along +x, stands in y = 0, 100 units from beak to tail."""
    p = (p[0], p[1] + FLOOR, abs(p[2]))
    body = smooth_union(ellipsoid(p, (-4, 22, 0), (39, 22, 27)), ellipsoid(p, (-38, 36, 0), (17, 8, 11), -38), 12)
    wing = ellipsoid(p, (-9, 26, 24), (22, 12, 6), -12)
    body = smooth_union(body, wing, 4)
    head = smooth_union(ellipsoid(p, (22, 64, 0), (19, 19, 18)), ellipsoid(p, (18, 44, 0), (13, 16, 13)), 8)
    beak = smooth_union(ellipsoid(p, (43, 62, 0), (12, 4.0, 10), 10), ellipsoid(p, (41, 58, 0), (9, 3.5, 8), -12), 2)
    return {"body": body, "head": head, "beak": beak}


def duck(p):
    parts = duck_parts(p)
    whole = smooth_union(smooth_union(parts["body"], parts["head"], 9), parts["beak"], 3)
    return -smooth_union(-whole, p[1], 3)  # cut off flat below


def star_parts(p):
    """A cushion with five arms in the plane z = 0, tip to tip about 100 units."""
    parts = {"core": ellipsoid(p, (0, 0, 0), (26, 26, 15))}
    for arm in range(5):
        angle = 90.0 + 72.0 * arm
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        parts[f"arm{arm + 1}"] = ellipsoid(p, (28 * c, 28 * s, 0), (26, 10, 9), angle)
    return parts


def star(p):
    distance = 1e9
    for part in star_parts(p).values():
        distance = smooth_union(distance, part, 8)
    return distance


def marching_tets(field, low, high, cell):
    """Vertices and triangles of field = 0, triangles counter-clockwise from outside (field > 0)."""
    counts = [int(math.ceil((h - l) / cell)) + 1 for l, h in zip(low, high)]
    point = lambda i: tuple(l + cell * n for l, n in zip(low, i))
    values = {}
    for i in range(counts[0]):
        for j in range(counts[1]):
            for k in range(counts[2]):
                value = field(point((i, j, k)))
                # No zero exactly on a grid point: every crossing lies inside an edge.
                values[i, j, k] = value if value != 0.0 else 1e-9
    vertices, triangles, known = [], [], {}

    def crossing(a, b):
        key = (a, b) if a < b else (b, a)
        if key not in known:
            u, v = values[key[0]], values[key[1]]
            t = min(max(u / (u - v), 0.2), 0.8)  # away from grid points, where slivers are born
            known[key] = len(vertices)
            vertices.append([x + t * (y - x) for x, y in zip(point(key[0]), point(key[1]))])
        return known[key]

    def outward(inside, outside, corners):
        a, b, c = (vertices[i] for i in corners)
        normal = cross(sub(b, a), sub(c, a))
        away = sub(mean([point(i) for i in outside]), mean([point(i) for i in inside]))
        return corners if dot(normal, away) > 0 else (corners[0], corners[2], corners[1])

    for i in range(counts[0] - 1):
        for j in range(counts[1] - 1):
            for k in range(counts[2] - 1):
                cube = [(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2 & 1)) for n in range(8)]
                for tet in TETS:
                    corners = [cube[n] for n in tet]
                    inside = [c for c in corners if values[c] < 0]
                    outside = [c for c in corners if values[c] > 0]
                    if len(inside) in (1, 3):
                        lone, rest = (inside[0], outside) if len(inside) == 1 else (outside[0], inside)
                        triangles.append(outward(inside, outside, tuple(crossing(lone, r) for r in rest)))
                    elif len(inside) == 2:
                        quad = [crossing(inside[0], outside[0]), crossing(inside[0], outside[1]),
                                crossing(inside[1], outside[1]), crossing(inside[1], outside[0])]
                        triangles.append(outward(inside, outside, (quad[0], quad[1], quad[2])))
                        triangles.append(outward(inside, outside, (quad[0], quad[2], quad[3])))
    return vertices, triangles


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def mean(points):
    return [sum(x) / len(points) for x in zip(*points)]


def collapse_short_edges(vertices, triangles, shortest):
    """Joins the ends of short edges, shortest first, wherever the surface stays manifold and unfolded."""
    faces_of = [set() for _ in vertices]
    for n, t in enumerate(triangles):
        for v in t:
            faces_of[v].add(n)
    triangles = list(triangles)
    neighbors = lambda v: {w for n in faces_of[v] for w in triangles[n]} - {v}
    normal = lambda t: cross(sub(vertices[t[1]], vertices[t[0]]), sub(vertices[t[2]], vertices[t[0]]))
    again = True
    while again:
        again = False
        edges = sorted((math.dist(vertices[a], vertices[b]), a, b) for a in range(len(vertices)) for b in neighbors(a) if a < b)
        for _, a, b in edges:
            # Earlier collapses of this round moved or removed ends.
            if not faces_of[a] or not faces_of[b] or b not in neighbors(a):
                continue
            if math.dist(vertices[a], vertices[b]) >= shortest or len(neighbors(a) & neighbors(b)) != 2:
                continue
            kept = (faces_of[a] | faces_of[b]) - (faces_of[a] & faces_of[b])
            before = {n: normal(triangles[n]) for n in kept}
            old_a, old_b = vertices[a], vertices[b]
            vertices[a] = vertices[b] = mean([old_a, old_b])
            if any(dot(before[n], normal(triangles[n])) <= 0.2 * math.hypot(*before[n]) * math.hypot(*normal(triangles[n])) for n in kept):
                vertices[a], vertices[b] = old_a, old_b
                continue
            for n in faces_of[a] & faces_of[b]:
                for v in triangles[n]:
                    faces_of[v].discard(n)
            for n in list(faces_of[b]):
                triangles[n] = tuple(a if v == b else v for v in triangles[n])
                faces_of[a].add(n)
            faces_of[b].clear()
            again = True
    used = sorted(v for v in range(len(vertices)) if faces_of[v])
    place = {v: i for i, v in enumerate(used)}
    alive = sorted({n for v in used for n in faces_of[v]})
    return [vertices[v] for v in used], [tuple(place[v] for v in triangles[n]) for n in alive]


def smooth(field, vertices, triangles, rounds):
    """Moves vertices half-way to the mean of their neighbors, then back to the level set."""
    neighbors = [set() for _ in vertices]
    for t in triangles:
        for i in range(3):
            neighbors[t[i]].update((t[i - 1], t[i - 2]))
    for _ in range(rounds):
        moved = [mean([v, mean([vertices[n] for n in sorted(neighbors[i])])]) for i, v in enumerate(vertices)]
        vertices[:] = [project(field, v) for v in moved]


def project(field, p, step=0.01):
    for _ in range(2):
        value = field(p)
        gradient = [(field([a + step * (i == n) for i, a in enumerate(p)]) - value) / step for n in range(3)]
        square = max(dot(gradient, gradient), 0.25)
        p = [a - max(-2.0, min(2.0, value / square * g)) if square > 0 else a for a, g in zip(p, gradient)]
    return p


def check(name, vertices, triangles):
    edges = {}
    for t in triangles:
        for i in range(3):
            edge = (t[i], t[(i + 1) % 3])
            assert edge not in edges, f"{name}: an edge twice in one direction"
            edges[edge] = True
    assert all((b, a) in edges for a, b in edges), f"{name}: an open edge"
    volume = sum(dot(vertices[a], cross(vertices[b], vertices[c])) for a, b, c in triangles) / 6.0
    assert volume > 0, f"{name}: inside out"
    euler = len(vertices) - len(edges) // 2 + len(triangles)
    assert euler == 2, f"{name}: Euler characteristic {euler}, not a sphere's"
    size = [max(x) - min(x) for x in zip(*vertices)]
    print(f"{name}: {len(vertices)} vertices, {len(triangles)} triangles, volume {volume:.0f}, size " +
          " x ".join(f"{s:.1f}" for s in size))


def write_surface(name, about, field, parts, low, high, cell):
    vertices, triangles = marching_tets(field, low, high, cell)
    smooth(field, vertices, triangles, 2)
    vertices, triangles = collapse_short_edges(vertices, triangles, 0.75 * cell)
    smooth(field, vertices, triangles, 6)
    check(name, vertices, triangles)
    groups = {}
    for t in triangles:
        distances = parts(mean([vertices[v] for v in t]))
        groups.setdefault(min(distances, key=distances.get), []).append(t)
    lines = [f"# {about} Made by make_meshes.py.", f"o {name}"]
    lines += ["v " + " ".join(f"{x + 0.0:.4g}" if abs(x) >= 0.05 else f"{x:.3f}" for x in v) for v in vertices]
    for group in sorted(groups):
        lines.append(f"g {group}")
        lines += ["f " + " ".join(str(v + 1) for v in t) for t in groups[group]]
    (here / f"{name}.obj").write_text("\n".join(lines) + "\n")


def write_beam(columns=8, rows=2, layers=2, cell=0.1):
    """A bar along x, 0.8 x 0.2 x 0.2 m, as Gmsh would save it: physical groups "bar", "left" and "right"."""
    counts = (columns + 1, rows + 1, layers + 1)
    tag = lambda i, j, k: 1 + i + counts[0] * (j + counts[1] * k)
    nodes = [(tag(i, j, k), i * cell, (j - rows / 2) * cell, (k - layers / 2) * cell)
             for k in range(counts[2]) for j in range(counts[1]) for i in range(counts[0])]
    ends, tets = [], []
    for k in range(layers):
        for j in range(rows):
            for i, group in ((0, 1), (columns, 2)):
                a, b, c, d = tag(i, j, k), tag(i, j + 1, k), tag(i, j + 1, k + 1), tag(i, j, k + 1)
                # The diagonal that the tets beside it have.
                ends += [(2, group, (a, b, c)), (2, group, (a, c, d))]
            for i in range(columns):
                cube = [tag(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2 & 1)) for n in range(8)]
                tets += [(4, 3, tuple(cube[n] for n in tet)) for tet in TETS]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "3", '2 1 "left"', '2 2 "right"', '3 3 "bar"',
             "$EndPhysicalNames", "$Nodes", str(len(nodes))]
    lines += [f"{t} {x:.6g} {y:.6g} {z:.6g}" for t, x, y, z in nodes]
    lines += ["$EndNodes", "$Elements", str(len(ends) + len(tets))]
    lines += [f"{n + 1} {kind} 2 {group} {group} " + " ".join(map(str, corners))
              for n, (kind, group, corners) in enumerate(ends + tets)]
    (here / "beam.msh").write_text("\n".join(lines + ["$EndElements"]) + "\n")
    print(f"beam: {len(nodes)} nodes, {len(tets)} tets")


if __name__ == "__main__":
    write_surface("duck", "A duck, 100 units long; scale 0.01 makes it a meter.", duck, duck_parts,
                  (-62, -6, -40), (62, 90, 40), 4.4)
    write_surface("star", "A star cushion, 100 units wide.", star, star_parts, (-60, -56, -20), (60, 62, 20), 5.0)
    write_beam()
