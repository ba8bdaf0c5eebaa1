#include "souple/geometry/measures.h"
#include "tests/physics/elastic_case.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

// Soft bodies released from deformed states, and soft bodies without load.

namespace souple::test_physics_elastic_recovery {

const char* mode_name(Mode mode) {
  return mode == Mode::pbd ? "pbd" : mode == Mode::xpbd ? "xpbd" : "small steps";
}

/// J = V / V0 of the tets: minimum, maximum, and that of the whole body.
struct Volumes {
  double smallest = 1e30, largest = -1e30, whole = 0;
};

Volumes volumes_of(const World& world, ObjectId body, const TetMesh& rest) {
  TetMesh now = rest;
  const auto x = world.positions(body);
  for (std::size_t v = 0; v < x.size(); ++v) now.positions[v] = Vec3d(x[v]);
  const std::vector<double> before = tet_volumes(rest), after = tet_volumes(now);
  Volumes volumes;
  for (std::size_t t = 0; t < before.size(); ++t) {
    volumes.smallest = std::min(volumes.smallest, after[t] / before[t]);
    volumes.largest = std::max(volumes.largest, after[t] / before[t]);
  }
  volumes.whole = tet_volume(now) / tet_volume(rest);
  return volumes;
}

struct Crush {
  const char* name;
  Vec3d (*map)(const Vec3d&);
};
constexpr Crush crushes[] = {
    {"turned inside out",
     [](const Vec3d& x) {
       return Vec3d{-x.x, x.y, x.z};
     }},
    {"crushed flat",
     [](const Vec3d& x) {
       return Vec3d{x.x, 0, x.z};
     }},
    {"crushed flat and inside out",
     [](const Vec3d& x) {
       return Vec3d{x.x, -0.01 * x.y, x.z};
     }},
    {"crushed to a line",
     [](const Vec3d& x) {
       return Vec3d{0, x.y, 0};
     }},
    {"crushed to a point",
     [](const Vec3d&) {
       return Vec3d{0.1, 0.2, 0.3};
     }},
};

const std::string crushed = "crushed tet mesh";

/// Four seconds of a cube of 320 tets after the crush; the curve is the smallest J in the first second.
void expect_recovery(const Crush& crush, Mode mode, float nu, Curves* curves = nullptr) {
  const TetMesh cube = tet_bar(4, 4, 4, {0.4, 0.4, 0.4});
  World world({.substeps = 10, .iterations = mode == Mode::small_steps ? 1 : 3, .mode = mode, .gravity = {}});
  const ObjectId body = world.add_soft_body(
      cube, {.young_modulus = 1e5f, .poisson_ratio = nu, .damping_time = 0.002f, .damping = 2});
  std::vector<Vec3f> x;
  for (const Vec3d& p : cube.positions) x.push_back(Vec3f(crush.map(p)));
  world.set_positions(body, x);
  bool good = true;
  for (int frame = 0; frame < 240 && good; ++frame) {
    if (curves != nullptr && frame <= 60)
      curves->add(crush.name, frame / 60.0, volumes_of(world, body, cube).smallest);
    good = world.step(1.0 / 60).ok();
  }
  EXPECT_TRUE(good) << crush.name << ": " << world.report().message;
  const Volumes volumes = volumes_of(world, body, cube);
  const std::string of = fmt::format(", {}, {}, nu = {:g}", crush.name, mode_name(mode), nu);
  validate(crushed, "volume" + of, volumes.whole, 1, 0.01);
  EXPECT_GT(volumes.smallest, 0) << of;
  validate(crushed, "smallest J" + of, volumes.smallest, 1, 0.01);
}

// Nearly incompressible bodies may unfold in a twisted state. Parts of them are half a turn off, all push and none can
// move: a local minimum of the energy. On this cube it never occurs at nu = 0.3, now and then from 0.4 on, and often at
// 0.45. The volume is then down to 0.78, but never in mode pbd. A volume row that is weaker below J = 0.4 halves that
// rate, but a body squeezed by a load would then collapse. So only 0.3 is promised.
TEST(Recovery, CrushedBodiesComeBack) {
  Curves curves(crushed, "time [s]", "smallest J of a tet, small steps, nu = 0.3");
  curves.add("theory: in the end", {0, 1}, {1, 1});
  for (const Crush& crush : crushes) expect_recovery(crush, Mode::small_steps, 0.3f, &curves);
}
TEST(Recovery, CrushedBodiesComeBackSlow) {
  for (const Crush& crush : crushes)
    for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd})
      for (const float nu : {0.0f, 0.3f})
        if (mode != Mode::small_steps || nu == 0.0f) expect_recovery(crush, mode, nu);
}

/// Largest |J - 1| of any tet without forces, at every sixth of a second.
std::vector<double> left_alone(const TetMesh& mesh, float E, const Settings& settings, double seconds) {
  World world(settings);
  const ObjectId body = world.add_soft_body(mesh, {.young_modulus = E, .poisson_ratio = 0.3f});
  std::vector<double> worst;
  for (int frame = 0; frame < seconds * 60; ++frame) {
    if (!world.step(1.0 / 60).ok()) return {std::nan("")};
    if (frame % 10 != 9) continue;
    const Volumes volumes = volumes_of(world, body, mesh);
    worst.push_back(std::max(std::fabs(volumes.smallest - 1), std::fabs(volumes.largest - 1)));
  }
  return worst;
}

/// Elementwise maximum; a NaN stays.
std::vector<double> larger(std::vector<double> a, const std::vector<double>& b) {
  a.resize(std::max(a.size(), b.size()));
  for (std::size_t i = 0; i < b.size(); ++i)
    if (std::isnan(b[i]) || b[i] > a[i]) a[i] = b[i];
  return a;
}

/// Maximum of all values; NaN if one is.
double largest(const std::vector<double>& values) {
  double most = values.at(0);
  for (const double value : values)
    if (std::isnan(value) || value > most) most = value;
  return most;
}

TetMesh single_tet() {
  return {{{0, 0, 0}, {0.1, 0, 0}, {0.01, 0.1, 0}, {0.02, 0.03, 0.1}}, {{0, 1, 2, 3}}, {}};
}

// Rows that are non-zero at rest and are projected in turn would drift to a J of 0.97 to 1.24, or burst.
void expect_rest(Mode mode, float E, double seconds, Curves* curves = nullptr) {
  const std::string name = "neo-Hookean body left alone";
  const TetMesh tet = single_tet(), bar = tet_bar(4, 1, 1, {0.2, 0.05, 0.05});
  std::vector<double> of_tet, of_bar;  // maximum over the settings
  for (const auto& [substeps, iterations] : {std::pair{1, 1}, {1, 20}, {5, 4}, {20, 1}, {20, 20}}) {
    const Settings settings{.substeps = substeps,
                            .iterations = iterations,
                            .mode = mode,
                            .gravity = {},
                            .measure_residuals = false};
    of_tet = larger(left_alone(tet, E, settings, 10), of_tet);
    of_bar = larger(left_alone(bar, E, settings, seconds), of_bar);
  }
  const std::string of = fmt::format(", E = {:g} Pa, {}, ", E, mode_name(mode));
  validate_below(name, "largest |J - 1| of a tet" + of + "10 s", largest(of_tet), 0.005);
  validate_below(name, fmt::format("largest |J - 1| of a bar{}{:g} s", of, seconds), largest(of_bar), 0.005);
  if (curves == nullptr) return;
  const std::vector<double> worst = larger(of_tet, of_bar);
  for (std::size_t i = 0; i < worst.size(); ++i)
    curves->add(fmt::format("E = {:g} Pa", E), static_cast<double>(i + 1) / 6, worst[i]);
}

TEST(Recovery, LeftAloneNothingMoves) {
  for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd})
    for (const float E : {1e4f, 1e7f}) expect_rest(mode, E, 0.5);
}
TEST(Recovery, LeftAloneNothingMovesSlow) {
  Curves curves("neo-Hookean body left alone", "time [s]",
                "largest |J - 1| of tet and bar, small steps (log)");
  curves.add("bound", {0, 10}, {0.005, 0.005});
  for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd})
    for (const float E : {1e4f, 1e5f, 1e6f, 1e7f})
      expect_rest(mode, E, 10, mode == Mode::small_steps ? &curves : nullptr);
}

}  // namespace souple::test_physics_elastic_recovery
