#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>

namespace souple::test_physics_rotation {

// --- spin ----------------------------------------------------------------------------------------

// Best fit of the angular velocity about z: sum m (r x v) / sum m r^2.
double spin_of(const World& world, ObjectId body) {
  const Vec3d center = world.center_of_mass(body);
  const auto x = world.positions(body), v = world.velocities(body);
  Vec3d mean;
  for (const Vec3f& velocity : v) mean += Vec3d(velocity) / static_cast<double>(v.size());
  double momentum = 0, inertia = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3d r = Vec3d(x[i]) - center, u = Vec3d(v[i]) - mean;
    momentum += r.x * u.y - r.y * u.x;
    inertia += r.x * r.x + r.y * r.y;
  }
  return momentum / inertia;
}

enum class Body { shape_matching, links };

ObjectId add_body(World& world, Body kind, const Vec3f& velocity) {
  const ObjectOptions thrown{.velocity = velocity, .angular_velocity = {0, 0, static_cast<float>(2 * pi)}};
  if (kind == Body::shape_matching)
    return world.add_soft_body(
        tet_bar(3, 3, 3, {0.3, 0.3, 0.3}),
        {.young_modulus = 1e12f, .poisson_ratio = 0.3f, .model = SoftBodyModel::shape_matching}, thrown);
  const Vec3d corners[] = {{0.2, 0, 0}, {-0.1, 0.1 * std::sqrt(3.0), 0}, {-0.1, -0.1 * std::sqrt(3.0), 0}};
  const ObjectId body = world.add_grains(corners, grain_of_mass(1), thrown);
  world.connect(
      std::vector<std::pair<VertexRef, VertexRef>>{
          {{body, 0}, {body, 1}}, {{body, 1}, {body, 2}}, {{body, 2}, {body, 0}}},
      -1);
  return body;
}

// A particle moves straight for h and is then pulled back radially. So it loses 1/2 (omega h)^2 of its angular
// velocity: d omega / dt = -omega^3 h, and omega = omega0 / sqrt(1 + 2 omega0^2 h t).
TEST(Spin, FallsByTheLawOfTheScheme) {
  const std::string name = "free rigid-like body spinning at 2 pi rad/s";
  Curves curves(name, "time [s]", "angular velocity [rad/s]");
  for (const Body kind : {Body::shape_matching, Body::links})
    for (const int substeps : {10, 50}) {
      const Vec3d velocity{0.6, 0.8, 0};
      World world({.substeps = substeps, .gravity = {}});
      const ObjectId body = add_body(world, kind, Vec3f(velocity));
      const Vec3d start = world.center_of_mass(body);
      const double h = 1.0 / 60 / substeps;
      const std::string at = std::string(kind == Body::links ? "rigid links, " : "shape matching, ") +
                             std::to_string(substeps) + " substeps";
      double worst = 0, astray = 0;
      for (int frame = 1; frame <= 600; ++frame) {
        EXPECT_TRUE(world.step(1.0 / 60).ok());
        const double t = frame / 60.0;
        const double law = 2 * pi / std::sqrt(1 + 8 * pi * pi * h * t);
        const double spin = spin_of(world, body);
        worst = std::max(worst, std::fabs(spin / law - 1));
        astray = std::max(astray, length(world.center_of_mass(body) - start - velocity * t));
        if (frame % 10 != 0) continue;
        curves.add(at, t, spin);
        if (kind == Body::links) curves.add("theory: " + std::to_string(substeps) + " substeps", t, law);
      }
      validate_below(name, at + ": relative error of angular velocity", worst, 0.02);
      validate_below(name, at + ": distance of the center of mass from its line [m]", astray, 1e-3);
    }
}

// --- energy --------------------------------------------------------------------------------------

// A cube of 0.2 m, stretched by 10 % along x and released. Its energy relative to the start at each frame of
// 2 s.
std::vector<double> ring(SoftBodyModel model, const Settings& settings) {
  World world(settings);
  const ObjectId body =
      world.add_soft_body(tet_bar(4, 4, 4, {0.2, 0.2, 0.2}),
                          {.young_modulus = 2e3f, .poisson_ratio = 0.3f, .density = 1000, .model = model});
  std::vector<Vec3f> x(world.positions(body).begin(), world.positions(body).end());
  for (Vec3f& p : x) p.x *= 1.1f;
  world.set_positions(body, x);
  const double start = world.elastic_energy();
  std::vector<double> energy;
  for (int frame = 1; frame <= 60; ++frame) {
    if (!world.step(1.0 / 60).ok()) return {std::nan("")};
    energy.push_back((world.kinetic_energy(body) + world.elastic_energy()) / start);
  }
  return energy;
}

TEST(ElasticBody, NeverGainsEnergyAndLosesLessInSmallerSteps) {
  const std::string name = "unforced elastic body";
  Curves curves(name, "time [s]", "energy / its start");
  for (const SoftBodyModel model : {SoftBodyModel::neo_hookean, SoftBodyModel::springs})
    for (const Mode mode : {Mode::small_steps, Mode::xpbd}) {
      const std::string what = std::string(model == SoftBodyModel::springs ? "springs, " : "neo-Hookean, ") +
                               mode_name(mode) + ", ";
      double before = 2;
      for (const int substeps : {5, 20, 80}) {
        if (mode == Mode::xpbd && substeps > 20) continue;
        const int iterations = mode == Mode::xpbd ? 4 : 1;
        const std::vector<double> energy =
            ring(model, {.substeps = substeps, .iterations = iterations, .mode = mode, .gravity = {}});
        const std::string at = what + std::to_string(substeps) + " substeps";
        validate_below(name, at + ": largest energy", *std::max_element(energy.begin(), energy.end()), 1.01);
        // Loss over the first quarter second; later, little energy remains.
        const double lost = 1 - energy[14];
        state(name, at + ": lost in 0.25 s", lost);
        // A quarter of the step: the loss must vanish with it.
        if (before < 2) {
          validate_below(name, at + ": loss / loss at four times the step", lost / before, 0.6);
        }
        before = lost;
        if (mode == Mode::small_steps)
          for (std::size_t i = 0; i < energy.size(); ++i)
            curves.add(at, static_cast<double>(i + 1) / 60, energy[i]);
      }
    }
}

}  // namespace souple::test_physics_rotation
