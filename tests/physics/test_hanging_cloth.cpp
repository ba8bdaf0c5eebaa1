#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"
#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace souple::test_physics_hanging_cloth {

// Rigid constraints along the edges of a grid of n x n vertices in both directions, and along both diagonals
// of each square.
void add_rigid_sheet(World& world, ObjectId cloth, int n) {
  auto links = std::make_unique<SetProjector<Distance>>();
  const auto at = [n](int row, int column) { return static_cast<std::uint32_t>(row * n + column); };
  const auto rest = world.mesh(cloth).positions;
  const auto link = [&](std::uint32_t a, std::uint32_t b) {
    links->add({world.particle(cloth, a), world.particle(cloth, b)},
               {static_cast<float>(length(rest[a] - rest[b]))});
  };
  // By kind, so that greedy coloring gives two colors for each kind.
  for (int r = 0; r < n; ++r)
    for (int c = 0; c + 1 < n; ++c) link(at(r, c), at(r, c + 1));
  for (int r = 0; r + 1 < n; ++r)
    for (int c = 0; c < n; ++c) link(at(r, c), at(r + 1, c));
  for (int r = 0; r + 1 < n; ++r)
    for (int c = 0; c + 1 < n; ++c) link(at(r, c), at(r + 1, c + 1));
  for (int r = 0; r + 1 < n; ++r)
    for (int c = 0; c + 1 < n; ++c) link(at(r, c + 1), at(r + 1, c));
  world.add_projector(std::move(links));
}

struct Strain {
  double end = 0, ever = 0;
};

// 2 m wide, initially horizontal, one edge pinned; it swings down and hangs. 600 frames of 1/60 s, drag
// 0.1/s.
Strain hang(int n, const Settings& settings, Curves& curves, const std::string& series) {
  Settings with_drag = settings;
  with_drag.drag = 0.1f;
  World world(with_drag);
  const ClothMaterial bare{.membrane_stiffness = 0, .bending_stiffness = 0};
  const ObjectId cloth = world.add_cloth(grid(n, n, 2), bare);
  std::vector<std::uint32_t> edge(static_cast<std::size_t>(n));
  std::iota(edge.begin(), edge.end(), 0u);
  world.pin(cloth, vertices(edge));
  add_rigid_sheet(world, cloth, n);
  Strain strain;
  for (int frame = 1; frame <= 600; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    if (!report.ok()) return {std::nan(""), std::nan("")};
    strain.end = report.largest_strain;
    strain.ever = std::max(strain.ever, strain.end);
    if (frame % 5 == 0) curves.add(series, frame / 60.0, 100 * strain.end);
  }
  return strain;
}

void check(int n, int substeps, double end, double ever) {
  const std::string name = "rigid " + std::to_string(n) + " x " + std::to_string(n) + " cloth, hanging";
  Curves curves(name, "time [s]", "largest strain [%]");
  curves.add("bound", {0, 10}, {100 * ever, 100 * ever});
  const std::string at = "small steps";
  const Strain strain = hang(n, {.substeps = substeps}, curves, at);
  validate_below(name, at + ": final largest strain", strain.end, end);
  validate_below(name, at + ": largest strain of all frames", strain.ever, ever);
}

TEST(HangingCloth, FiftyByFiftyIsStable) {
  check(50, 10, 0.08, 0.25);
}

TEST(HangingCloth, HundredByHundredIsStableSlow) {
  check(100, 20, 0.10, 0.35);
}

}  // namespace souple::test_physics_hanging_cloth
