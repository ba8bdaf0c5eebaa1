"""Blender's cloth with self-collision on the sheet of benchmarks/folded_sheet.cpp. Blender runs this file:

    blender -b --factory-startup -t THREADS --python benchmarks/blender_sheet.py -- START.obj OUT.f32 [OPTION...]

START.obj is what `folded_sheet start` prints (Y up). Writes the vertices of each frame to OUT.f32, as folded_sheet reads
them, and prints a line RESULT with JSON: the milliseconds of each frame, wall clock and processor time, without reading the
vertices.

Units, measured in Blender 3.4 with free fall and a hanging sheet: whatever the frame rate, cloth advances by
sqrt(1/1000) s a frame times `time_scale`; `mass` is of one vertex; a spring of an edge has a stiffness of
1000 tension_stiffness / (mean edge length) N/m. Not measured, but read in Blender's source: bending (see souples_material),
and that the self-collision distance belongs to each side, as half of Souple's thickness; layers are pushed 16/9 of it apart.
"""
import argparse
import array
import json
import math
import sys
import time

import bpy

FRAME = 1 / 60  # s
UNIT = math.sqrt(1e-3)  # s a frame
# Souple's default cloth: kg/m^2, N/m, N m; and the side of the sheet in m.
AREAL_DENSITY, MEMBRANE, BENDING, FRICTION, SIDE = 0.15, 4000, 1e-5, 0.4, 2.0


def read_obj(path):
    """Vertices with Z up, and triangles."""
    vertices, faces = [], []
    for line in open(path):
        words = line.split()
        if words and words[0] == "v":
            x, y, z = map(float, words[1:4])
            vertices.append((x, -z, y))
        elif words and words[0] == "f":
            faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return vertices, faces


def add_mesh(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.update()
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def souples_material(settings, mesh):
    """Mass and stiffness of Souple's default cloth; Blender's damping of edges, in proportion to the mass."""
    points = [vertex.co for vertex in mesh.vertices]
    lengths = [(points[a] - points[b]).length for a, b in (edge.vertices for edge in mesh.edges)]
    mass = AREAL_DENSITY * SIDE**2 / len(points)
    damping = mass / settings.mass
    settings.mass = mass
    for kind in ("tension", "compression", "shear"):
        setattr(settings, kind + "_stiffness", MEMBRANE * sum(lengths) / len(lengths) / 1000)
        setattr(settings, kind + "_damping", damping * getattr(settings, kind + "_damping"))
    # In Blender each vertex opposite an edge is pushed by 100 bending_stiffness (edge length) / 3 newtons a radian; the
    # isometric model has a moment of 3 D a radian about edges along rows and columns.
    settings.bending_stiffness = 9 * BENDING / (100 * min(lengths) ** 2)
    settings.bending_damping *= damping


def without_air(cloth, floor):
    """No drag, and Souple's default friction of 0.4."""
    cloth.settings.air_damping = 0
    floor.collision.cloth_friction = cloth.collision_settings.self_friction = 100 * FRICTION


def build(options):
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    floor = add_mesh("floor", [(-10, -10, 0), (10, -10, 0), (10, 10, 0), (-10, 10, 0)], [(0, 1, 2, 3)])
    floor.modifiers.new("collision", "COLLISION")
    floor.collision.thickness_outer = 0.001  # the least
    sheet = add_mesh("sheet", *read_obj(options.start))
    cloth = sheet.modifiers.new("cloth", "CLOTH")
    cloth.settings.quality = options.quality
    cloth.settings.time_scale = FRAME / UNIT
    if options.material != "defaults":
        without_air(cloth, floor)
    if options.material == "souple":
        souples_material(cloth.settings, sheet.data)
    collisions = cloth.collision_settings
    collisions.use_self_collision = True
    collisions.collision_quality = options.collision_quality
    half = 0.5 * 0.35 * SIDE / round(math.sqrt(len(sheet.data.vertices)))  # of the thickness in folded_sheet
    collisions.distance_min = half
    collisions.self_distance_min = half * options.distance
    cloth.point_cache.frame_start, cloth.point_cache.frame_end = 1, options.frames + 1
    return sheet


def positions(sheet):
    """x y z of all vertices, Y up."""
    mesh = sheet.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flat = array.array("f", bytes(12 * len(mesh.vertices)))
    mesh.vertices.foreach_get("co", flat)
    flat[1::3], flat[2::3] = flat[2::3], array.array("f", (-y for y in flat[1::3]))
    return flat


def main(options):
    sheet, scene = build(options), bpy.context.scene
    scene.frame_start, scene.frame_end = 1, options.frames + 1
    scene.frame_set(1)
    times, processor_times = [], []
    with open(options.out, "wb") as out:
        for frame in range(2, options.frames + 2):
            begin, processor_begin = time.perf_counter(), time.process_time()
            scene.frame_set(frame)
            times.append(1000 * (time.perf_counter() - begin))
            processor_times.append(1000 * (time.process_time() - processor_begin))
            positions(sheet).tofile(out)
            if sum(times) > 1000 * options.longest:
                break
    print("RESULT " + json.dumps({"ms": times, "processor_ms": processor_times, "version": bpy.app.version_string}))


def parsed(words):
    parser = argparse.ArgumentParser(prog="blender_sheet.py")
    parser.add_argument("start")
    parser.add_argument("out")
    parser.add_argument("--frames", type=int, default=120)
    parser.add_argument("--quality", type=int, default=5, help="steps a frame")
    parser.add_argument("--collision-quality", type=int, default=2, help="rounds of collisions a step")
    parser.add_argument("--distance", type=float, default=1, help="self-collision distance in units of Souple's half thickness")
    parser.add_argument("--material", choices=["defaults", "no_air", "souple"], default="no_air")
    parser.add_argument("--longest", type=float, default=1e9, help="seconds after which it stops early")
    return parser.parse_args(words)


if __name__ == "__main__":
    main(parsed(sys.argv[sys.argv.index("--") + 1:]))
