"""Constraints of one's own: a function of Python, and arrays of a kind of the catalogue."""

import numpy

import souple

world = souple.World(substeps=10)
cloth = world.add_cloth(souple.grid(9, 9, 1.0), souple.material.cotton)
world.pin(cloth, souple.vertices([0, 8]))
corners = world.particles(cloth, [72, 80])


def stays_above(x, gradient):
    """C = y + 0.6 m of one particle, satisfied while C >= 0."""
    gradient[0, 1] = 1
    return x[0, 1] + 0.6


floor = souple.CustomProjector()
for particle in corners:
    floor.add([particle], stays_above, name="floor", sense=souple.Sense.non_negative)
world.add_projector(floor)

# A rigid rod between the two free corners, at the speed of C++.
world.add_projector(souple.SetProjector("distance", [corners], {"rest_length": 0.5}))

for _ in range(180):
    world.step(1 / 60)
x = world.positions(cloth)[[72, 80]]
print(f"lowest corner {x[:, 1].min():.3f} m, rod {numpy.linalg.norm(x[0] - x[1]):.4f} m")
assert x[:, 1].min() > -0.61
assert abs(numpy.linalg.norm(x[0] - x[1]) - 0.5) < 0.005
