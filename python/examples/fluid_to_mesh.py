"""A drop of water falls into a box; its surface as a PLY file, and a picture where the build has a renderer."""

import pathlib

import souple

spacing = 0.04
world = souple.World(substeps=4)
water = world.add_fluid(souple.fill((-0.2, 0.1, -0.2), (0.2, 0.5, 0.2), spacing), souple.material.water.replace(spacing=spacing))
for normal in ((0, 1, 0), (1, 0, 0), (-1, 0, 0), (0, 0, 1), (0, 0, -1)):
    world.add_collider(souple.Plane(normal=normal, offset=0 if normal[1] else -0.4))
for _ in range(40):
    world.step(1 / 60)

surface = souple.FluidSurface(spacing=spacing)
mesh = surface.build(world.positions(water))
pathlib.Path("water.ply").write_bytes(souple.ply_bytes(mesh.positions, mesh.normals, mesh.triangles))
print(f"{len(world.positions(water))} particles, {len(mesh.triangles)} triangles in water.ply")
try:
    souple.write_png("water.png", souple.render(world, 320, 180, samples=4))
    print("wrote water.png")
except souple.Error as error:
    print(error)
