#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>

namespace souple::test_physics_contact {

constexpr double g = 9.81f;

struct Slide {
  double traveled = 0;      // m in 2 s
  double acceleration = 0;  // m/s^2, over the second second
};

// A grain released on a plane inclined by `angle`.
Slide slide(double angle, double mu, const Settings& settings, Curves* curves = nullptr,
            const std::string& series = {}) {
  World world(settings);
  const auto sine = static_cast<float>(std::sin(angle)), cosine = static_cast<float>(std::cos(angle));
  world.add_collider(Plane{.normal = {sine, cosine, 0}}, {.friction = static_cast<float>(mu)});
  GrainsMaterial stone = grain_of_mass(1, 0.05f);
  stone.friction = static_cast<float>(mu);
  stone.rolling_friction = 10;  // slides and does not roll: see test_rolling.cpp
  const Vec3d start[] = {{0.05 * static_cast<double>(sine), 0.05 * static_cast<double>(cosine), 0}};
  const ObjectId body = world.add_grains(start, stone);
  const Vec3d down{static_cast<double>(cosine), -static_cast<double>(sine), 0};
  double speed_at_one = 0;
  for (int frame = 1; frame <= 120; ++frame) {
    EXPECT_TRUE(world.step(1.0 / 60).ok());
    if (frame == 60) speed_at_one = dot(world.momentum(body), down);
    if (curves != nullptr)
      curves->add(series, frame / 60.0, dot(world.center_of_mass(body) - start[0], down));
  }
  const double mass = world.total_mass(body);
  return {dot(world.center_of_mass(body) - start[0], down),
          (dot(world.momentum(body), down) - speed_at_one) / mass};
}

TEST(InclinedPlane, SticksBelowTheFrictionAngleAndSlidesAbove) {
  const std::string name = "inclined plane";
  Curves curves(name, "time [s]", "way down the slope [m]");
  for (const double mu : {0.2, 0.5, 1.0}) {
    const double steep = std::atan(1.2 * mu), steeper = std::atan(2 * mu), gentle = std::atan(0.95 * mu);
    for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd}) {
      const Settings settings{.substeps = 10, .iterations = mode == Mode::small_steps ? 1 : 4, .mode = mode};
      const bool drawn = mode == Mode::small_steps && mu == 0.5;
      const std::string at = std::string("mu = ") +
                             (mu == 0.2   ? "0.2"
                              : mu == 0.5 ? "0.5"
                                          : "1") +
                             ", " + mode_name(mode) + ": ";
      const Slide stuck = slide(gentle, mu, settings, drawn ? &curves : nullptr, "tan = 0.95 mu");
      validate_below(name, at + "creep at tan = 0.95 mu in 2 s [m]", std::fabs(stuck.traveled), 1e-3);
      for (const double angle : {steep, steeper}) {
        const double expected = g * (std::sin(angle) - mu * std::cos(angle));
        const std::string slope = angle == steep ? "tan = 1.2 mu" : "tan = 2 mu";
        const Slide slides = slide(angle, mu, settings, drawn ? &curves : nullptr, slope);
        validate_relative(name, at + "acceleration at " + slope + " [m/s^2]", slides.acceleration, expected,
                          0.02);
        if (drawn)
          for (int k = 0; k <= 40; ++k) curves.add("theory: " + slope, k / 20.0, expected / 2 * k * k / 400);
      }
    }
  }
}

// A grain dropped from 1 m: height of its first bounce over the height of the drop.
double bounce(double e, const Settings& settings, Curves* curves = nullptr, const std::string& series = {}) {
  World world(settings);
  world.add_collider(Plane{}, {.restitution = static_cast<float>(e)});
  const Vec3d start[] = {{0, 1.05, 0}};
  const ObjectId ball = world.add_grains(start, grain_of_mass(1, 0.05f));
  double top = 0;
  for (int frame = 1; frame <= 120; ++frame) {
    EXPECT_TRUE(world.step(1.0 / 60).ok());
    const double y = world.center_of_mass(ball).y - 0.05;
    const double v = world.momentum(ball).y / world.total_mass(ball);
    if (curves != nullptr) curves->add(series, frame / 60.0, y);
    // The frames miss the apex: from its current position the ball still rises by v^2 / 2g.
    if (v > 0) top = std::max(top, y + v * v / (2 * g));
  }
  return top;
}

TEST(Bounce, HeightIsTheSquareOfTheRestitution) {
  const std::string name = "bounce, 1 m drop, 20 substeps";
  Curves curves(name, "time [s]", "height [m]");
  for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd})
    for (const double e : {0.0, 0.5, 0.9}) {
      const Settings settings{.substeps = 20, .iterations = mode == Mode::small_steps ? 1 : 4, .mode = mode};
      const bool drawn = mode == Mode::small_steps;
      const std::string series = e == 0.0 ? "e = 0" : e == 0.5 ? "e = 0.5" : "e = 0.9";
      const double ratio = bounce(e, settings, drawn ? &curves : nullptr, series);
      const std::string quantity = series + ", " + mode_name(mode) + ": height ratio";
      if (e > 0) validate_relative(name, quantity, ratio, e * e, 0.02);
      if (e == 0) validate_below(name, quantity, ratio, 0.01);
      if (!drawn || e == 0) continue;
      const double fallen = std::sqrt(2 / g), up = e * g * fallen;  // s, m/s
      for (int i = 0; i <= 50; ++i) {
        const double t = 2 * up / g * i / 50;
        curves.add("theory: first bounce", fallen + t, up * t - g / 2 * t * t);
      }
      curves.lift("theory: first bounce");
    }
}

}  // namespace souple::test_physics_contact
