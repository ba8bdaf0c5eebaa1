"""A cloth falls on a ball: the example of README."""

import souple

world = souple.World(substeps=10)  # meters, kilograms, seconds; Y up, right-handed
cloth = world.add_cloth(souple.grid(64, 64, 2.0), souple.material.cotton)
world.pin(cloth, souple.vertices([0, 63]))
world.add_collider(souple.Sphere(center=(0, -1, 0), radius=0.5), friction=0.4)

recorder = souple.Recorder(world, "out")  # out/run.json, out/cloth.obj, out/cloth.pc2
for frame in range(240):
    world.step(1 / 60)
    recorder.capture()
