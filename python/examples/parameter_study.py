"""How far a strip of cloth hangs down for each bending stiffness; a plot where matplotlib is installed."""

import sys

import numpy

import souple


def sag(stiffness):
    """Depth of the free end of a strip of 0.5 m that is clamped at one end, after two seconds [m]."""
    world = souple.World(substeps=10, drag=2, threads=1)
    material = souple.material.cotton.replace(bending_stiffness=stiffness)
    strip = world.add_cloth(souple.grid(21, 5, 0.5), material)
    world.pin(strip, souple.in_box((-0.26, -1, -1), (-0.22, 1, 1)))
    for _ in range(120):
        world.step(1 / 60)
    return -float(world.positions(strip)[:, 1].min())


stiffnesses = numpy.logspace(-4, 0, 9)
depths = [sag(float(stiffness)) for stiffness in stiffnesses]
for stiffness, depth in zip(stiffnesses, depths):
    print(f"{stiffness:8.1e} N m  {depth:.3f} m")

try:
    import matplotlib
except ImportError:
    print("no plot: matplotlib is not installed (Debian: python3-matplotlib)")
    sys.exit()
matplotlib.use("Agg")
import matplotlib.pyplot as plot  # noqa: E402

figure, axes = plot.subplots()
axes.semilogx(stiffnesses, depths, "o-")
axes.set_xlabel("bending stiffness [N m]")
axes.set_ylabel("depth of the free end [m]")
figure.savefig("parameter_study.png", dpi=100)
print("wrote parameter_study.png")
