#include "body.h"
#include "souple/error.h"
#include "souple/solver/enclosed_volume.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

namespace souple::test::test_solver_enclosed_volume {

using Triangle = EnclosedVolume::Triangle;

struct Surface {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
};

// A ball of radius 1: an octahedron whose triangles are divided into four `cuts` times.
Surface ball(int cuts) {
  Surface s{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
            {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int cut = 0; cut < cuts; ++cut) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, isnew] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(s.positions.size()));
      if (isnew) s.positions.push_back(normalized(s.positions[a] + s.positions[b]));
      return entry->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : s.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    s.triangles = finer;
  }
  return s;
}

double volume_of(const std::vector<Vec3d>& x, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += dot(x[a], cross(x[b], x[c]));
  return sum / 6;
}

Body body_of(const Surface& s, double size, const Vec3d& far = {}) {
  Body body;
  for (std::size_t i = 0; i < s.positions.size(); ++i)
    body.add(far + (s.positions[i] + scatter3(i) * 0.02) * size, 1.0f + static_cast<float>(i % 2));
  return body;
}

TEST(EnclosedVolume, MeasuresTheVolumeOfABox) {
  // 2 x 3 x 4, corners by binary x y z.
  std::vector<Vec3d> corners;
  corners.reserve(8);
  for (int i = 0; i < 8; ++i) corners.push_back({2.0 * (i & 1), 3.0 * (i >> 1 & 1), 4.0 * (i >> 2 & 1)});
  const std::vector<Triangle> triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                           {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  Body body;
  for (const Vec3d& x : corners) body.add(x + Vec3d{100, 0, 0}, 1);
  EnclosedVolume projector;
  projector.add(triangles, 24);
  projector.prepare(8);
  EXPECT_NEAR(projector.volume(0, body.view()), 24, 1e-5);
}

TEST(EnclosedVolume, HoldsItsVolumeAtEverySize) {
  const Surface s = ball(2);
  for (const double size : {1e-3, 1.0, 100.0})
    for (const double factor : {0.5, 1.0, 3.0}) {
      Body body = body_of(s, size);
      const double rest = volume_of(s.positions, s.triangles) * size * size * size;
      EnclosedVolume projector;
      projector.add(s.triangles, rest, {.keep_volume = true, .volume_factor = static_cast<float>(factor)});
      projector.prepare(s.positions.size());
      for (int i = 0; i < 30; ++i) solve(projector, body, {.h = 0.01f});
      EXPECT_NEAR(volume_of(body.all(), s.triangles) / rest, factor, 1e-5 * factor) << size;
    }
}

TEST(EnclosedVolume, KeepsMomentaFarFromTheOrigin) {
  const Surface s = ball(2);
  for (const bool keep_volume : {true, false}) {
    Body body = body_of(s, 1, {1000, 1000, -1000});
    const auto before = body.all();
    EnclosedVolume projector;
    projector.add(s.triangles, 6, {.pressure = keep_volume ? 0.0f : 1e3f, .keep_volume = keep_volume});
    projector.prepare(s.positions.size());
    solve(projector, body, {.h = 0.01f});
    const Momentum m = momentum_of(body, before);
    EXPECT_GT(m.linear_scale, 0.1);
    EXPECT_LT(length(m.linear), 1e-6 * m.linear_scale);
    EXPECT_LT(length(m.angular), 1e-6 * m.angular_scale);
  }
}

// The gradient is dV/dx: a small correction dx changes the volume by grad V . dx.
TEST(EnclosedVolume, GradientIsThatOfTheVolume) {
  const Surface s = ball(1);
  Body body = body_of(s, 1);
  const double before = volume_of(body.all(), s.triangles);
  EnclosedVolume projector;
  projector.add(s.triangles, before + 1e-4, {.keep_volume = true});
  projector.prepare(s.positions.size());
  solve(projector, body, {.h = 0.01f});
  EXPECT_NEAR(volume_of(body.all(), s.triangles) - before, 1e-4, 1e-7);
}

// The force on half a ball is P pi r^2, whatever the iterations, mode and winding.
TEST(EnclosedVolume, PressureIsAForce) {
  Surface s = ball(4);
  const double P = 200, h = 0.01;
  for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd})
    for (const bool inside_out : {false, true}) {
      if (inside_out)
        for (Triangle& t : s.triangles) std::swap(t[0], t[1]);
      Body body;
      for (const Vec3d& x : s.positions) body.add(x, 2);
      const auto before = body.all();
      EnclosedVolume projector;
      projector.add(s.triangles, volume_of(before, s.triangles),
                    {.pressure = static_cast<float>(P), .stiffness = 0.1f});
      projector.prepare(s.positions.size());
      solve(projector, body, {.h = static_cast<float>(h), .iterations = 5, .mode = mode});
      double force = 0;
      for (std::size_t i = 0; i < before.size(); ++i)
        force += body.mass(i) * (body.at(i) - before[i]).z / (h * h) * (before[i].z > 1e-9 ? 1.0 : 0.0);
      // The ring at the equator, whose load belongs half to the upper half, is pushed outward only.
      EXPECT_NEAR(force, P * pi, 0.02 * P * pi);
      if (inside_out)
        for (Triangle& t : s.triangles) std::swap(t[0], t[1]);
    }
}

// alpha = dV/dP: with multipliers, C = -alpha~ lambda after any number of iterations.
TEST(EnclosedVolume, ComplianceDoesNotDependOnIterations) {
  const Surface s = ball(2);
  std::vector<double> residuals;
  for (const int iterations : {2, 5, 20}) {
    Body body = body_of(s, 1);
    EnclosedVolume projector;
    const double rest = 1.02 * volume_of(body.all(), s.triangles);
    projector.add(s.triangles, rest, {.keep_volume = true, .compliance = 1e-3f});
    projector.prepare(s.positions.size());
    solve(projector, body, {.h = 0.01f, .iterations = iterations, .mode = Mode::xpbd});
    residuals.push_back(projector.residual(body.view()).largest);
  }
  EXPECT_GT(residuals[0], 0.01);
  EXPECT_NEAR(residuals[1] / residuals[0], 1, 1e-3);
  EXPECT_NEAR(residuals[2] / residuals[0], 1, 1e-3);
}

TEST(EnclosedVolume, PinnedParticlesStayAndCollapsedSurfacesStayCalm) {
  const Surface s = ball(2);
  Body body;
  for (std::size_t i = 0; i < s.positions.size(); ++i)
    body.add(s.positions[i] * (1e-4 * (1 + 0.1 * scatter(i))), 1);
  body.position[3].w = 0;
  const auto before = body.all();
  EnclosedVolume projector;
  projector.add(s.triangles, 4, {.keep_volume = true});
  projector.prepare(s.positions.size());
  for (int i = 0; i < 3; ++i) solve(projector, body, {.h = 0.01f});
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_LT(length(body.at(i)), 1.0);
  EXPECT_EQ(body.at(3), before[3]);
  for (Vec4f& x : body.position) x.set_xyz({});
  for (Vec4f& x : body.offset) x.set_xyz({});
  solve(projector, body, {.h = 0.01f});
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(body.at(i), Vec3d{});  // no gradient: no motion, no NaN
}

TEST(EnclosedVolume, ErasingAnotherObjectRenumbers) {
  const Surface s = ball(1);
  EnclosedVolume projector;
  std::vector<Triangle> second = s.triangles;
  const auto n = static_cast<std::uint32_t>(s.positions.size());
  for (Triangle& t : second)
    for (std::uint32_t& i : t) i += n;
  projector.add(s.triangles, 1, {.keep_volume = true});
  projector.add(second, 2, {.keep_volume = true});
  projector.erase_particles(0, n);
  projector.prepare(n);
  ASSERT_EQ(projector.size(), 1u);
  Body body = body_of(s, 1);
  for (int i = 0; i < 20; ++i) solve(projector, body, {.h = 0.01f});
  EXPECT_NEAR(volume_of(body.all(), s.triangles), 2, 1e-4);
}

TEST(EnclosedVolume, RefusesOpenSurfacesAndBadNumbers) {
  const Surface s = ball(1);
  EnclosedVolume projector;
  std::vector<Triangle> open(s.triangles.begin() + 1, s.triangles.end());
  EXPECT_THROW(projector.add(open, 1), Error);
  std::vector<Triangle> flipped = s.triangles;
  std::swap(flipped[0][0], flipped[0][1]);
  EXPECT_THROW(projector.add(flipped, 1), Error);
  EXPECT_THROW(projector.add({}, 1), Error);
  EXPECT_THROW(projector.add(s.triangles, NAN), Error);
  EXPECT_THROW(projector.add(s.triangles, 1, {.pressure = INFINITY}), Error);
  EXPECT_THROW(projector.add(s.triangles, 1, {.compliance = -1}), Error);
  EXPECT_EQ(projector.size(), 0u);
}

}  // namespace souple::test::test_solver_enclosed_volume
