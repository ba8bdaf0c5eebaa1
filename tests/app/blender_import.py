"""Runs inside Blender: blender --background --factory-startup --python blender_import.py -- JOBS RESULTS.

JOBS is a JSON list. Each job imports an OBJ, PLY or GLB file and says what Blender then shows. It gives the coordinates
of its vertices, in the object's own axes and in the world's, at each frame of a cache."""

import array
import base64
import json
import sys

import bpy



def clear():
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    for mesh in list(bpy.data.meshes):
        bpy.data.meshes.remove(mesh)


def packed(floats):
    return base64.b64encode(array.array("f", floats).tobytes()).decode()


def shown(obj, frame):
    """The evaluated vertices at a frame."""
    bpy.context.scene.frame_set(frame)
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    local = array.array("f", [0.0]) * (3 * len(evaluated.data.vertices))
    evaluated.data.vertices.foreach_get("co", local)
    world = [c for v in evaluated.data.vertices for c in evaluated.matrix_world @ v.co]
    return {"local": packed(local), "world": packed(world)}


def import_file(job):
    clear()
    importer = job["importer"]
    if importer == "obj":
        bpy.ops.wm.obj_import(filepath=job["file"])
    elif importer == "legacy obj":
        bpy.ops.import_scene.obj(filepath=job["file"], use_split_objects=False, use_split_groups=False, split_mode="OFF")
    elif importer == "ply":
        bpy.ops.import_mesh.ply(filepath=job["file"])
    else:
        raise ValueError(importer)
    objects = list(bpy.context.scene.objects)
    if len(objects) != 1:
        raise RuntimeError(f"{len(objects)} objects instead of one")
    return objects[0]


def original(job):
    """An object as an artist made it, exported as OBJ with Blender's default axes; it stays in the scene."""
    clear()
    bpy.ops.mesh.primitive_monkey_add(size=0.5)
    obj = bpy.context.object
    bpy.ops.wm.obj_export(filepath=job["file"])
    return obj


def add_cache(obj, job):
    modifier = obj.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format = job["format"]
    modifier.filepath = job["cache"]
    modifier.frame_start = job.get("frame_start", 1)
    for key, value in job.get("settings", {}).items():
        setattr(modifier, key, value)


def put_below_parent(job, objects):
    """Below an empty that is moved, turned and scaled; returns its matrix."""
    parent = bpy.data.objects.new("parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.location, parent.rotation_euler, parent.scale = job["location"], job["rotation"], job["scale"]
    for obj in objects:
        obj.parent = parent
    bpy.context.view_layer.update()
    return [list(row) for row in parent.matrix_world]


def import_glb(job):
    """All objects of a .glb by name, below an empty; the scene has the job's frame rate."""
    import numpy
    numpy.bool = bool  # Debian 12 pairs Blender 3.4, whose importer uses the name, with a numpy that removed it
    clear()
    bpy.context.scene.render.fps = job["fps"]
    bpy.ops.import_scene.gltf(filepath=job["file"])
    objects = [o for o in bpy.context.scene.objects if o.type == "MESH"]
    matrix = put_below_parent(job, objects)
    return {"matrix": matrix,
            "objects": {o.name: {"frames": [shown(o, frame) for frame in job["frames"]],
                                 "edges": len(o.data.edges), "polygons": len(o.data.polygons),
                                 "materials": [m.name for m in o.data.materials],
                                 "uvs": len(o.data.uv_layers)} for o in objects}}


def perform(job):
    if job["kind"] == "glb":
        return import_glb(job)
    if job["kind"] == "script":
        clear()
        exec(job["script"], {"bpy": bpy})
        return {}
    if job["kind"] == "scripted":  # its last object, with a cache
        clear()
        exec(job["script"], {"bpy": bpy})
        obj = bpy.context.object
        obj.animation_data_clear()
        obj.location = obj.rotation_euler = (0, 0, 0)
        add_cache(obj, job)
        return {"frames": [shown(obj, frame) for frame in job["frames"]]}
    if job["kind"] == "original":
        obj = original(job)
        if not job.get("cache"):
            return {}
        obj.location = obj.rotation_euler = (0, 0, 0)
    else:
        obj = import_file(job)
    mesh = obj.data
    result = {"vertices": len(mesh.vertices), "edges": len(mesh.edges), "polygons": len(mesh.polygons),
              "materials": [m.name for m in mesh.materials], "material_of": [p.material_index for p in mesh.polygons],
              "smooth": [p.use_smooth for p in mesh.polygons], "custom_normals": mesh.has_custom_normals,
              "sharp": sum(e.use_edge_sharp for e in mesh.edges)}
    if job.get("normals"):
        mesh.calc_normals_split()
        result["normals"] = [list(loop.normal) for loop in mesh.loops]
    if job.get("cache"):
        add_cache(obj, job)
    if job.get("location"):
        bpy.context.scene.render.fps = job["fps"]
        result["matrix"] = put_below_parent(job, [obj])
    result["frames"] = [shown(obj, frame) for frame in job.get("frames", [1])]
    return result


def main():
    jobs_file, results_file = sys.argv[sys.argv.index("--") + 1:]
    with open(jobs_file) as file:
        jobs = json.load(file)
    results = []
    for job in jobs:
        try:
            results.append(perform(job))
        except Exception as error:
            results.append({"error": f"{type(error).__name__}: {error}"})
    with open(results_file, "w") as file:
        json.dump(results, file)


main()
