#include "souple/error.h"
#include "souple/geometry/fill.h"
#include "souple/math/fnv1a.h"
#include "souple/surface/fluid_surface.h"
#include "souple/world/world.h"
#include "tests/collision/random.h"
#include "tests/count_allocations.h"
#include "tests/surface/closed.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_surface_fluid_surface {

constexpr float d = 0.02f;  // m

SurfaceOptions options_of(SurfaceMethod method) {
  SurfaceOptions options;
  options.method = method;
  options.spacing = d;
  return options;
}

SurfaceMesh surface_of(std::span<const Vec3f> points, const SurfaceOptions& options, int threads = 2) {
  const auto pool = make_threads(Threading::pool, threads);
  FluidSurface surface(options);
  return surface.build(points, *pool);
}

/// A lattice with every particle displaced by up to `jitter` spacings along each axis.
std::vector<Vec3f> block(int nx, int ny, int nz, double jitter) {
  test::Random random(9);
  std::vector<Vec3f> points;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        points.push_back(
            Vec3f((Vec3d{i + 0.5, j + 0.5, k + 0.5} + random.point(-jitter, jitter)) * double{d}));
  return points;
}

/// A ball about the origin, radius in spacings.
std::vector<Vec3f> ball(double radius, double jitter) {
  const int n = 2 * static_cast<int>(std::ceil(radius + 1));
  std::vector<Vec3f> points;
  const Vec3f middle = Vec3f{1, 1, 1} * (0.5f * static_cast<float>(n) * d + 0.31f * d);
  for (const Vec3f& x : block(n, n, n, jitter))
    if (double{length(x - middle)} < radius * double{d}) points.push_back(x - middle);
  return points;
}

class Surface : public testing::TestWithParam<SurfaceMethod> {};
INSTANTIATE_TEST_SUITE_P(All, Surface, testing::Values(SurfaceMethod::anisotropic, SurfaceMethod::isotropic),
                         [](const auto& method) {
                           return method.param == SurfaceMethod::anisotropic ? "Anisotropic" : "Isotropic";
                         });

// Requirement: a ball of at least 20 spacings keeps its volume within 3 %, at three resolutions of the grid.
// Its surface is closed, of one piece, without handles.
TEST_P(Surface, OfABallIsASphereOfItsVolume) {
  for (const double jitter : {0.0, 0.15}) {
    const std::vector<Vec3f> points = ball(10, jitter);
    for (const float cell : {1.0f, 0.5f, 0.3f}) {
      SurfaceOptions options = options_of(GetParam());
      options.cell = cell * d;
      const SurfaceMesh mesh = surface_of(points, options);
      const test::Topology topology = test::topology_of(mesh);
      EXPECT_TRUE(topology.is_closed_manifold());
      EXPECT_EQ(topology.euler, 2);
      const double volume = 4 * pi / 3 * std::pow(10 * double{d}, 3);
      EXPECT_NEAR(test::volume_of(mesh) / volume, 1, 0.03) << cell << " " << jitter;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        EXPECT_NEAR(double{length(mesh.normals[v])}, 1, 1e-5);
        EXPECT_GT(dot(mesh.normals[v], normalized(mesh.positions[v])), 0.8f);  // outwards
      }
    }
  }
}

TEST_P(Surface, OfATorusHasOneHandle) {
  std::vector<Vec3f> points;
  for (const Vec3f& x : block(40, 40, 14, 0.1)) {
    const Vec3f c = x - Vec3f{20, 20, 7} * d;
    if (std::hypot(std::hypot(c.x, c.y) - 13 * d, c.z) < 5.5f * d) points.push_back(c);
  }
  const test::Topology topology = test::topology_of(surface_of(points, options_of(GetParam())));
  EXPECT_TRUE(topology.is_closed_manifold());
  EXPECT_EQ(topology.euler, 0);
}

struct Flatness {
  double mean = 0, deviation = 0;  // from half a spacing above the top layer, in spacings
};
/// Heights of the middle of a block's top.
Flatness flatness(const SurfaceMesh& mesh, int nx, int nz) {
  const float lo = 8 * d, hi = static_cast<float>(nx - 8) * d, half = 0.5f * static_cast<float>(nz) * d;
  std::vector<double> heights;
  for (const Vec3f& x : mesh.positions)
    if (x.x > lo && x.x < hi && x.y > lo && x.y < hi && x.z > half)
      heights.push_back(double{x.z} / double{d} - nz);
  Flatness result;
  for (const double h : heights) result.mean += h / static_cast<double>(heights.size());
  for (const double h : heights) result.deviation = std::max(result.deviation, std::abs(h - result.mean));
  return result;
}

// Requirement: deviations up to a tenth of the particles' radius d / 2. The mean height must be right, too.
TEST_P(Surface, OfAPoolIsFlat) {
  for (const double jitter : {0.0, 0.03}) {
    for (const float cell : {0.5f, 0.25f}) {
      SurfaceOptions options = options_of(GetParam());
      options.cell = cell * d;
      const Flatness still = flatness(surface_of(block(30, 30, 10, jitter), options), 30, 10);
      EXPECT_LT(still.deviation, 0.05) << jitter << " " << cell;
      EXPECT_NEAR(still.mean, 0, 0.05);
    }
  }
}

// Particles displaced by up to a fifteenth of a spacing: anisotropic kernels smooth them, balls do so less.
TEST(FluidSurface, IsFlatterWithAnisotropicKernels) {
  const std::vector<Vec3f> points = block(30, 30, 10, 0.066);
  const Flatness stretched = flatness(surface_of(points, options_of(SurfaceMethod::anisotropic)), 30, 10);
  const Flatness balls = flatness(surface_of(points, options_of(SurfaceMethod::isotropic)), 30, 10);
  EXPECT_LT(stretched.deviation, 0.05);
  EXPECT_LT(stretched.deviation, 0.7 * balls.deviation);
  EXPECT_NEAR(stretched.mean, 0, 0.05);
}

// Water at rest between walls, simulated by a world: its own surface is not quite flat.
TEST(FluidSurface, OfAPoolAtRestIsFlat) {
  constexpr double w = 12 * double{d};
  World world({.substeps = 10});
  const ObjectId water =
      world.add_fluid(fill(Vec3d{-w, 0, -w}, Vec3d{w, 8 * double{d}, w}, double{d}), {.spacing = d});
  world.add_collider(Plane{});
  for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
    world.add_collider(Plane{n, static_cast<float>(-w)});
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
  const auto unevenness = [&](SurfaceMethod method) {
    const SurfaceMesh mesh = surface_of(world.positions(water), options_of(method));
    std::vector<float> heights;
    for (const Vec3f& x : mesh.positions)
      if (std::max(std::abs(x.x), std::abs(x.z)) < 6 * d && x.y > 4 * d) heights.push_back(x.y / d);
    const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
    EXPECT_NEAR((*high + *low) / 2, 8, 0.1);
    return (*high - *low) / 2;
  };
  const float stretched = unevenness(SurfaceMethod::anisotropic);
  EXPECT_LT(stretched, 0.05f);
  EXPECT_LT(stretched, 0.6f * unevenness(SurfaceMethod::isotropic));
}

// A sheet of one layer needs stretched kernels: no holes, and about its volume.
TEST(FluidSurface, OfASheetHasNoHoles) {
  for (const double jitter : {0.0, 0.15}) {
    const std::vector<Vec3f> points = block(24, 24, 1, jitter);
    const SurfaceMesh mesh = surface_of(points, options_of(SurfaceMethod::anisotropic));
    EXPECT_EQ(test::topology_of(mesh).euler, 2) << jitter;
    const double volume = static_cast<double>(points.size()) * std::pow(double{d}, 3);
    EXPECT_NEAR(test::volume_of(mesh) / volume, 1, 0.25) << jitter;
  }
}

TEST(FluidSurface, OfOneParticleIsADropOfItsSize) {
  const Vec3f point[] = {{0.013f, -0.021f, 0.007f}};
  SurfaceOptions options = options_of(SurfaceMethod::anisotropic);
  options.cell = d / 8;
  const SurfaceMesh mesh = surface_of(point, options);
  EXPECT_EQ(test::topology_of(mesh).euler, 2);
  EXPECT_NEAR(test::volume_of(mesh) / std::pow(double{d}, 3), 1, 0.15);
}

/// A pool with waves, and spray above it.
std::vector<Vec3f> spray() {
  std::vector<Vec3f> points;
  for (const Vec3f& x : block(40, 40, 16, 0.2))
    if (x.z < (9 + 4 * std::sin(x.x / d / 3) * std::cos(x.y / d / 4)) * d) points.push_back(x);
  test::Random random(4);
  for (int i = 0; i < 1500; ++i) {
    const Vec3d at = random.point(0, 1);
    points.push_back(Vec3f(Vec3d{at.x * 40, at.y * 40, 10 + at.z * 12} * double{d}));
  }
  return points;
}

std::uint64_t hash_of(const SurfaceMesh& mesh) {
  std::uint64_t hash = fnv1a64(std::as_bytes(std::span(mesh.positions)));
  hash = fnv1a64(std::as_bytes(std::span(mesh.normals)), hash);
  return fnv1a64(std::as_bytes(std::span(mesh.triangles)), hash);
}

TEST_P(Surface, OfSprayIsClosedAndManifold) {
  SurfaceOptions options = options_of(GetParam());
  const test::Topology topology = test::topology_of(surface_of(spray(), options));
  EXPECT_TRUE(topology.is_closed_manifold()) << topology.wrong_edges << " " << topology.wrong_corners;
}

// A grid that begins at the fluid's outermost particle would flicker as it moves.
TEST(FluidSurface, DoesNotDependOnParticlesFarAway) {
  std::vector<Vec3f> points = ball(5, 0.1);
  const SurfaceMesh alone = surface_of(points, options_of(SurfaceMethod::anisotropic));
  points.push_back({-300, 17, 4});
  const SurfaceMesh both = surface_of(points, options_of(SurfaceMethod::anisotropic));
  ASSERT_GT(both.positions.size(), alone.positions.size());
  for (const Vec3f& x : alone.positions) EXPECT_LT(std::abs(length(x) - 5 * d), 2 * d);
  EXPECT_EQ(test::topology_of(both).euler, 4);
  std::size_t found = 0;
  for (const Vec3f& x : both.positions)
    if (x.x > -1) ++found;
  EXPECT_EQ(found, alone.positions.size());
}

TEST(FluidSurface, LeavesOutWhatIsNoPlace) {
  std::vector<Vec3f> points = ball(5, 0.1);
  const std::uint64_t expected = hash_of(surface_of(points, options_of(SurfaceMethod::anisotropic)));
  points.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  points.push_back({0, std::numeric_limits<float>::infinity(), 0});
  points.push_back({0, 0, -1e30f});
  EXPECT_EQ(hash_of(surface_of(points, options_of(SurfaceMethod::anisotropic))), expected);
  EXPECT_TRUE(surface_of({}, options_of(SurfaceMethod::anisotropic)).positions.empty());
}

TEST(FluidSurface, AllParticlesInOnePlaceAreADrop) {
  const std::vector<Vec3f> points(100, Vec3f{0.1f, 0.1f, 0.1f});
  const SurfaceMesh mesh = surface_of(points, options_of(SurfaceMethod::anisotropic));
  EXPECT_TRUE(test::topology_of(mesh).is_closed_manifold());
  for (const Vec3f& x : mesh.positions) EXPECT_TRUE(is_finite(x));
}

TEST_P(Surface, AllocatesNothingWhenWarm) {
  const std::vector<Vec3f> points = spray();
  const auto pool = make_threads(Threading::pool, 2);
  SurfaceOptions options = options_of(GetParam());
  options.smoothing_passes = 1;
  FluidSurface surface(options);
  surface.build(points, *pool);
  surface.build(points, *pool);
  const long before = test::allocations();
  surface.build(points, *pool);
  EXPECT_EQ(test::allocations() - before, 0);
}

// Laplacian smoothing removes noise, keeps the mesh's topology, and hardly shrinks it.
TEST(FluidSurface, IsSmoothedWhereThatIsAskedFor) {
  const std::vector<Vec3f> points = block(30, 30, 10, 0.2);
  SurfaceOptions options = options_of(SurfaceMethod::isotropic);
  const SurfaceMesh rough = surface_of(points, options);
  options.smoothing_passes = 10;
  const SurfaceMesh smooth = surface_of(points, options);
  EXPECT_EQ(rough.triangles, smooth.triangles);
  EXPECT_LT(flatness(smooth, 30, 10).deviation, 0.6 * flatness(rough, 30, 10).deviation);
  EXPECT_NEAR(test::volume_of(smooth) / test::volume_of(rough), 1, 0.02);
}

TEST(FluidSurface, SaysWhichOptionIsWrong) {
  SurfaceOptions options;
  EXPECT_THROW(FluidSurface{options}, Error);
  options.spacing = d;
  options.cell = d / 100;
  try {
    FluidSurface surface(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("cell"), std::string::npos);
  }
}

}  // namespace souple::test_surface_fluid_surface
