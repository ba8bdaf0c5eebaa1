#include "body.h"
#include "souple/error.h"
#include "souple/math/mat3.h"
#include "souple/math/quaternion.h"
#include "souple/solver/enclosed_volume.h"
#include "souple/solver/shape_matching.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

namespace souple::test::test_solver_groups {

const Mat3d turn = rotation_matrix(Quatd::from_axis_angle(normalized(Vec3d{1, -2, 0.5}), 2.0));
const Vec3d shift{0.3, -1, 2};

// `before`: positions from which a projection has moved the body.
void expect_momenta_kept(const Body& body, const std::vector<Vec3d>& before) {
  const Momentum m = momentum_of(body, before);
  EXPECT_GT(m.linear_scale, 0.1);
  EXPECT_LT(length(m.linear), 1e-6 * m.linear_scale);
  EXPECT_LT(length(m.angular), 1e-6 * m.angular_scale);
}

// Particles on a grid, 0.5 `size` apart: 3 x 3 x 3 form a box of edge `size`, fewer a flat or straight part.
std::vector<Vec3d> lattice(int nx, int ny, int nz, double size) {
  std::vector<Vec3d> result;
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y)
      for (int z = 0; z < nz; ++z) result.push_back(Vec3d{x * 0.5, y * 0.5, z * 0.5} * size);
  return result;
}

Body moved(const std::vector<Vec3d>& rest, double size, double noise, const Vec3d& far = {}) {
  Body body;
  for (std::size_t i = 0; i < rest.size(); ++i)
    body.add(far + turn * rest[i] + (shift + scatter3(i) * noise) * size,
             1.0f + 0.5f * static_cast<float>(i % 3));
  return body;
}

double largest_edge_error(const Body& body, const std::vector<Vec3d>& rest) {
  double largest = 0;
  for (std::size_t i = 0; i < rest.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      largest = std::fmax(largest, std::fabs(length(body.at(i) - body.at(j)) - length(rest[i] - rest[j])));
  return largest;
}

/// One region of all particles.
ShapeMatching matching(const std::vector<Vec3d>& rest, const ShapeMatchingOptions& options = {}) {
  ShapeMatching result;
  result.add(first(rest.size()), rest, options);
  result.prepare(rest.size());
  return result;
}

struct Extent {
  int x, y, z;
};
constexpr Extent extents[] = {{3, 3, 3}, {3, 3, 1}, {1, 3, 1}, {1, 1, 1}};

TEST(ShapeMatching, RestoresShapesOfEveryDimensionAndSize) {
  for (const Extent& e : extents)
    for (const float linear : {0.0f, 0.5f})
      for (const double size : {1e-3, 1.0, 100.0}) {
        const auto rest = lattice(e.x, e.y, e.z, size);
        Body body = moved(rest, size, 0.2);
        ShapeMatching projector = matching(rest, {.linear = linear});
        for (int i = 0; i < 60; ++i) solve(projector, body, {.h = 0.01f});
        // The linear part leaves a strain that each projection halves.
        EXPECT_LT(largest_edge_error(body, rest), 3e-6 * size)
            << e.x << e.y << e.z << " " << linear << " " << size;
      }
}

TEST(ShapeMatching, RestFarFromTheOriginIsNotMoved) {
  const auto rest = lattice(3, 3, 3, 1);
  const Vec3d far{1000, -2000, 500};
  Body body = moved(rest, 1, 0, far);
  const auto before = body.all();
  std::vector<Vec3d> far_rest = rest;
  for (Vec3d& q : far_rest) q += far;
  ShapeMatching projector = matching(far_rest);
  for (int i = 0; i < 1000; ++i) solve(projector, body, {.h = 0.001f});
  for (std::size_t i = 0; i < rest.size(); ++i) EXPECT_LT(length(body.at(i) - before[i]), 1e-6);
}

TEST(ShapeMatching, KeepsMomenta) {
  const auto rest = lattice(3, 3, 3, 1);
  for (const float linear : {0.0f, 0.7f, 1.0f})
    for (const float compliance : {0.0f, 1e-4f}) {
      Body body = moved(rest, 1, 0.3);
      const auto before = body.all();
      ShapeMatching projector =
          matching(rest, {.linear = linear, .compliance = compliance, .damping_time = compliance});
      solve(projector, body, {.h = 0.01f});
      expect_momenta_kept(body, before);
    }
}

// Linear regions stretch freely: with beta = 1, a box stretched to three times its length keeps its
// proportions and returns to the rest volume.
TEST(ShapeMatching, LinearKeepsVolumeAndAllowsStretch) {
  const auto rest = lattice(3, 3, 3, 1);
  Body body;
  for (const Vec3d& q : rest) body.add({3 * q.x, q.y, q.z}, 1);
  ShapeMatching projector = matching(rest, {.linear = 1});
  solve(projector, body, {.h = 0.01f});
  const Vec3d a = body.at(9) - body.at(0), b = body.at(3) - body.at(0), c = body.at(1) - body.at(0);
  EXPECT_NEAR(length(a) / length(b), 3, 1e-5);
  EXPECT_NEAR(dot(a, cross(b, c)), 0.125, 1e-6);
}

// A flat region in a rotated plane keeps its proportions and returns to the rest area.
TEST(ShapeMatching, FlatLinearKeepsAreaAndAllowsStretch) {
  const auto rest = lattice(3, 3, 1, 1);
  Body body;
  for (const Vec3d& q : rest) body.add(turn * Vec3d{3 * q.x, q.y, q.z}, 1);
  ShapeMatching projector = matching(rest, {.linear = 1});
  solve(projector, body, {.h = 0.01f});
  const Vec3d a = body.at(3) - body.at(0), b = body.at(1) - body.at(0);
  EXPECT_NEAR(length(a) / length(b), 3, 1e-5);
  EXPECT_NEAR(length(cross(a, b)), 0.25, 1e-6);
}

TEST(ShapeMatching, CrushedAndInvertedBodiesComeBack) {
  const auto rest = lattice(3, 3, 3, 1);
  const Mat3d cases[] = {Mat3d::diagonal({1, 0, 1}), Mat3d::diagonal({0, 0, 1}), Mat3d{},
                         Mat3d::diagonal({1, -1, 1}), Mat3d::diagonal({-1, -1, -1})};
  for (const Mat3d& crush : cases)
    for (const float linear : {0.0f, 1.0f}) {
      Body body;
      for (const Vec3d& q : rest) body.add(crush * q, 1);
      ShapeMatching projector = matching(rest, {.linear = linear});
      for (int i = 0; i < 5; ++i) solve(projector, body, {.h = 0.01f});
      const Vec3d a = body.at(9) - body.at(0), b = body.at(3) - body.at(0), c = body.at(1) - body.at(0);
      EXPECT_NEAR(dot(a, cross(b, c)), 0.125, 1e-5);
    }
}

TEST(ShapeMatching, FollowsItsPins) {
  const auto rest = lattice(3, 3, 3, 1);
  for (const float linear : {0.0f, 0.5f})
    for (const std::size_t pins : {1u, 2u, 27u}) {
      Body body = moved(rest, 1, 0);
      for (std::size_t i = 0; i < pins; ++i) body.position[i].w = 0;
      if (pins < 27)
        for (std::size_t i = 0; i < pins; ++i) body.position[i].x += 0.5f;
      const auto before = body.all();
      ShapeMatching projector = matching(rest, {.linear = linear});
      for (int i = 0; i < 60; ++i) solve(projector, body, {.h = 0.01f});
      for (std::size_t i = 0; i < pins; ++i) EXPECT_EQ(body.at(i), before[i]);
      EXPECT_LT(largest_edge_error(body, rest), 1e-5);
    }
}

// alpha lambda = -C: a region of compliance a, stretched by C0, converges to C = C0 a~ / (a~ + 1/M).
TEST(ShapeMatching, ComplianceIsThatOfTheWholeRegionAtAnyIterations) {
  const std::vector<Vec3d> rest = {{0, 0, 0}, {1, 0, 0}};
  for (const int iterations : {1, 5, 20}) {
    Body body;
    body.add({0, 0, 0}, 0.5f);
    body.add({1.2, 0, 0}, 0.5f);  // each 0.1 m from its goal, M = 4 kg
    ShapeMatching projector = matching(rest, {.compliance = 1e-4f});
    solve(projector, body, {.h = 0.01f, .iterations = iterations, .mode = Mode::xpbd});
    const double expected = 0.1 * 1 / (1 + 0.25);  // a~ = 1
    EXPECT_NEAR(projector.residual(body.view()).largest, expected, 1e-6);
  }
}

TEST(ShapeMatching, StiffnessDoesNotDependOnIterationsInPbd) {
  for (const int iterations : {1, 5, 20}) {
    Body body;
    body.add({0, 0, 0}, 0.5f);
    body.add({1.2, 0, 0}, 0.5f);
    const std::vector<Vec3d> rest = {{0, 0, 0}, {1, 0, 0}};
    ShapeMatching projector = matching(rest, {.compliance = 1, .stiffness = 0.75f});
    solve(projector, body, {.h = 0.01f, .iterations = iterations, .mode = Mode::pbd});
    EXPECT_NEAR(projector.residual(body.view()).largest, 0.025, 1e-6);
  }
}

// Damping opposes changes of shape and leaves rigid motion alone. The body turns by h rad/s (1, 2, 3) and moves, with
// velocities (p - x) / h of a substep. A rigid region that shrinks to its goal at a rate stops doing so; one of
// compliance alpha keeps alpha~ / (alpha~ + gamma / M) of the rate.
TEST(ShapeMatching, DampingLeavesRigidMotion) {
  const auto rest = lattice(3, 3, 3, 1);
  const double M = 27, h = 0.01, gamma = 10;
  const Vec3d spin{1, 2, 3};
  const Quatd back = Quatd::from_axis_angle(normalized(spin), -length(spin) * h);
  Vec3d center;
  for (const Vec3d& q : rest) center += q / M;
  const auto threads = make_threads(Threading::serial, 1);
  for (const double alpha : {0.0, 1e-5}) {
    Body body;
    for (const Vec3d& q : rest) body.add(center + (q - center) * 1.1, 1);
    ShapeMatching projector = matching(
        rest, {.compliance = static_cast<float>(alpha), .damping_time = static_cast<float>(gamma * h)});
    const Substep substep{.h = static_cast<float>(h)};
    projector.begin_substep(body.view(), substep);
    std::vector<Vec4f> rigid(rest.size()), shrinking(rest.size());
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const Vec3d before = rotate(back, body.at(i));
      rigid[i].set_xyz(Vec3f((body.at(i) - before) / h + Vec3d{4, 5, 6}));
      shrinking[i].set_xyz(Vec3f(center - body.at(i)));
    }
    const std::vector<Vec4f> rigid_before = rigid, before = shrinking;
    projector.damp(body.view(), rigid, substep, *threads);
    projector.damp(body.view(), shrinking, substep, *threads);
    const double kept = alpha / (h * h) / (alpha / (h * h) + gamma / M);
    for (std::size_t i = 0; i < rest.size(); ++i) {
      EXPECT_LT(length(rigid[i].xyz() - rigid_before[i].xyz()), 1e-5f);
      EXPECT_LT(length(shrinking[i].xyz() - before[i].xyz() * static_cast<float>(kept)), 1e-5f);
    }
  }
}

TEST(ShapeMatching, OverlappingRegionsGetDifferentColors) {
  const auto rest = lattice(3, 3, 3, 1);
  ShapeMatching projector;
  const std::vector<std::uint32_t> regions[] = {{0, 1, 2, 3}, {3, 4, 5, 6, 7}, {7, 8}, {20, 21, 22}};
  for (const auto& region : regions) {
    std::vector<Vec3d> part;
    part.reserve(region.size());
    for (const std::uint32_t i : region) part.push_back(rest[i]);
    projector.add(region, part);
  }
  projector.prepare(rest.size());
  EXPECT_EQ(projector.color_count(), 2);
  Body body = moved(rest, 1, 0.1);
  for (int i = 0; i < 100; ++i) solve(projector, body, {.h = 0.01f});
  EXPECT_LT(projector.residual(body.view()).largest, 1e-5);

  projector.erase_particles(4, 5);  // removes the second region, renumbers the last two
  projector.prepare(26);
  EXPECT_EQ(projector.size(), 3u);
  EXPECT_EQ(projector.color_count(), 1);
  Body fewer;
  for (std::size_t i = 0; i < 27; ++i)
    if (i != 4) fewer.add(turn * rest[i], 1);
  solve(projector, fewer, {.h = 0.01f});
  EXPECT_LT(projector.residual(fewer.view()).largest, 1e-6);
}

TEST(ShapeMatching, RefusesBadInput) {
  ShapeMatching projector;
  const auto rest = lattice(1, 3, 1, 1);
  EXPECT_THROW(projector.add(std::vector<std::uint32_t>{0, 1}, rest), Error);
  EXPECT_THROW(projector.add(std::vector<std::uint32_t>{0, 1, 1}, rest), Error);
  EXPECT_THROW(projector.add({}, {}), Error);
  EXPECT_THROW(projector.add(first(3), rest, {.linear = 2}), Error);
  EXPECT_THROW(projector.add(first(3), rest, {.compliance = NAN}), Error);
  EXPECT_EQ(projector.size(), 0u);
  projector.add(first(3), rest);
  EXPECT_THROW(projector.prepare(2), Error);
}

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

EnclosedVolume enclosing(const Surface& s, double rest, const EnclosedVolumeOptions& options) {
  EnclosedVolume result;
  result.add(s.triangles, rest, options);
  result.prepare(s.positions.size());
  return result;
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
      EnclosedVolume projector =
          enclosing(s, rest, {.keep_volume = true, .volume_factor = static_cast<float>(factor)});
      for (int i = 0; i < 30; ++i) solve(projector, body, {.h = 0.01f});
      EXPECT_NEAR(volume_of(body.all(), s.triangles) / rest, factor, 1e-5 * factor) << size;
    }
}

TEST(EnclosedVolume, KeepsMomentaFarFromTheOrigin) {
  const Surface s = ball(2);
  for (const bool keep_volume : {true, false}) {
    Body body = body_of(s, 1, {1000, 1000, -1000});
    const auto before = body.all();
    EnclosedVolume projector =
        enclosing(s, 6, {.pressure = keep_volume ? 0.0f : 1e3f, .keep_volume = keep_volume});
    solve(projector, body, {.h = 0.01f});
    expect_momenta_kept(body, before);
  }
}

// The gradient is dV/dx: a small correction dx changes the volume by grad V . dx.
TEST(EnclosedVolume, GradientIsThatOfTheVolume) {
  const Surface s = ball(1);
  Body body = body_of(s, 1);
  const double before = volume_of(body.all(), s.triangles);
  EnclosedVolume projector = enclosing(s, before + 1e-4, {.keep_volume = true});
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
      EnclosedVolume projector = enclosing(s, volume_of(before, s.triangles),
                                           {.pressure = static_cast<float>(P), .stiffness = 0.1f});
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
    const double rest = 1.02 * volume_of(body.all(), s.triangles);
    EnclosedVolume projector = enclosing(s, rest, {.keep_volume = true, .compliance = 1e-3f});
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
  EnclosedVolume projector = enclosing(s, 4, {.keep_volume = true});
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

}  // namespace souple::test::test_solver_groups
