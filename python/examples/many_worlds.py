"""A loop as learning has it: 64 small worlds on all cores, an action for each of them in each step.

Each world moves one corner of a cloth; random search finds the velocity that brings the free corner to a target.
"""

import concurrent.futures
import os

import numpy

import souple

WORLDS, STEPS, SIZE = 64, 60, 12
TARGET = numpy.array([0.3, -0.4, 0.3])


def make_world():
    world = souple.World(substeps=5, threads=1, measure_residuals=False)  # one thread each: the pool has the others
    cloth = world.add_cloth(souple.grid(SIZE, SIZE, 0.5), souple.material.cotton)
    world.pin(cloth, souple.vertices([0]))
    return world, cloth, world.snapshot()


def rollout(job):
    """Distance of the free corner from the target, after a second at this velocity of the held one [m]."""
    (world, cloth, start), velocity = job
    world.restore(start)
    corner = world.positions(cloth)[0].astype(float)
    for step in range(STEPS):
        corner = corner + velocity / 60
        world.move_pins(cloth, [0], [corner])
        world.step(1 / 60)
    return numpy.linalg.norm(world.positions(cloth)[-1] - TARGET)


random = numpy.random.default_rng(1)
worlds = [make_world() for _ in range(WORLDS)]
best, best_distance = numpy.zeros(3), numpy.inf
with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    for generation in range(4):
        actions = best + random.normal(scale=0.4 * 0.6**generation, size=(WORLDS, 3))
        distances = list(pool.map(rollout, zip(worlds, actions)))
        winner = int(numpy.argmin(distances))
        if distances[winner] < best_distance:
            best, best_distance = actions[winner], distances[winner]
        print(f"generation {generation}: {best_distance:.3f} m from the target at velocity {best.round(2)} m/s")
assert best_distance < 0.2
