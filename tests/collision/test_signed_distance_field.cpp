// Signed distance fields: right distances, the right side, and messages for meshes without an inside.
#include "revolved.h"
#include "souple/collision/mesh_tree.h"
#include "souple/contacts/collider_queries.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/measures.h"
#include "tests/collision/random.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace souple::test_collision_signed_distance_field {

using test::Random;

double to_box(const Vec3d& p, const Vec3d& half) {
  return surface_distance(Box{{}, Vec3f(half)}, p).distance;
}

double to_torus(const Vec3d& p, double major, double minor) {
  const double ring = std::sqrt(p.x * p.x + p.z * p.z) - major;
  return std::sqrt(ring * ring + p.y * p.y) - minor;
}

TriangleMesh both(TriangleMesh a, const TriangleMesh& b, const Vec3d& shift) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  for (const Vec3d& x : b.positions) a.positions.push_back(x + shift);
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

void turn_inside_out(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
}

struct Errors {
  double largest = 0;
  int wrong_sides = 0;
};
/// Largest error at points of a cube whose exact distance is at most `band`.
template <class Exact>
Errors errors(const SignedDistanceField& field, double half_size, double band, const Exact& exact) {
  Random random(3);
  Errors result;
  for (int k = 0; k < 20000; ++k) {
    const Vec3d p = random.point(-half_size, half_size);
    const double d = exact(p);
    if (std::abs(d) > band) continue;
    const double error = std::abs(field.at(p).distance - d);
    result.largest = std::max(result.largest, error);
    result.wrong_sides += (field.at(p).distance < 0) != (d < 0) && std::abs(d) > error;
  }
  return result;
}

// Interpolation with spacing h has an error of h^2 / 8 times the sum of second derivatives, which is 2 / r
// for the distance to a sphere. The mesh itself is inside the sphere by about edge^2 / (8 R).
TEST(SignedDistanceField, OfASphereIsRightToTheSquareOfTheSpacing) {
  const TriangleMesh mesh = sphere(4, 1);
  double coarse = 0;
  for (const double h : {0.1, 0.05}) {
    const SignedDistanceField field(mesh, h);
    const double band = 4 * h;
    const Errors found = errors(field, 1.5, band, [](const Vec3d& p) { return length(p) - 1; });
    EXPECT_LT(found.largest, h * h / 8 * 2 / (1 - band) + 1.4e-3) << h;
    EXPECT_EQ(found.wrong_sides, 0);
    if (coarse > 0) {
      EXPECT_LT(found.largest, 0.6 * coarse);
    }
    coarse = found.largest;
  }
}

TEST(SignedDistanceField, OfATorusKnowsItsHole) {
  const double h = 0.04;
  const SignedDistanceField field(torus(1, 0.3, 120, 48), h);
  const Errors found = errors(field, 1.6, 4 * h, [](const Vec3d& p) { return to_torus(p, 1, 0.3); });
  EXPECT_LT(found.largest, h * h / 8 * 3 / 0.14 + 2e-3);
  EXPECT_NEAR(field.at({0, 0, 0}).distance, 0.7, 0.25);  // equally far from all of the surface

  EXPECT_LT(field.at({1, 0, 0}).distance, -0.25);
}

TEST(SignedDistanceField, OfABoxIsExactOffItsEdges) {
  const Vec3d half{0.5, 0.3, 0.2};
  const double h = 0.03;
  const SignedDistanceField field(box(half * 2.0), h);
  Random random(5);
  double at_edges = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3d p = random.point(-0.6, 0.6);
    const double d = to_box(p, half), error = std::abs(field.at(p).distance - d);
    if (std::abs(d) > 4 * h) continue;
    double first = -1, second = -1;  // of the distances beyond the faces
    for (int a = 0; a < 3; ++a) {
      const double beyond = std::abs(p[a]) - half[a];
      second = std::max(second, std::min(first, beyond));
      first = std::max(first, beyond);
    }
    if (second < -h && first - second > 2.1 * h) {
      ASSERT_LT(error, 1e-6) << p.x << " " << p.y << " " << p.z;
    } else {
      at_edges = std::max(at_edges, error);
    }
  }
  EXPECT_LT(at_edges, 0.4 * h);
  EXPECT_GT(at_edges, 0.01 * h);
}

// Two boxes that overlap make an L. Outside, the distance is the smaller of the two.
TEST(SignedDistanceField, OfPiecesThatOverlapHasAConcaveCorner) {
  const Vec3d floor{0.6, 0.1, 0.4}, wall{0.1, 0.5, 0.4}, up{-0.5, 0.4, 0};
  const double h = 0.025;
  const SignedDistanceField field(both(box(floor * 2.0), box(wall * 2.0), up), h);
  Random random(9);
  int outside = 0, inside = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3d p = random.point(-1, 1);
    const double d = min(to_box(p, floor), to_box(p - up, wall));
    if (d > 0 && d < 4 * h) {
      ++outside;
      ASSERT_NEAR(field.at(p).distance, d, 0.4 * h);
    }
    if (d < -0.5 * h) {
      ++inside;
      ASSERT_LT(field.at(p).distance, 0);
    }
  }
  EXPECT_GT(outside, 500);
  EXPECT_GT(inside, 500);
  const SurfaceDistance corner = field.at({-0.35, 0.15, 0});  // both walls 5 cm away
  EXPECT_NEAR(corner.distance, 0.05, 0.1 * h);
}

TEST(SignedDistanceField, ThinPartsAndCavitiesKeepTheirSides) {
  const double h = 0.03;
  const SignedDistanceField plate(box({1, 2.2 * h, 1}), h);
  const SignedDistanceField shell(
      [] {
        TriangleMesh hole = sphere(4, 0.4);
        turn_inside_out(hole);
        return both(sphere(4, 0.5), hole, {});
      }(),
      h);
  Random random(13);
  for (int k = 0; k < 5000; ++k) {
    const Vec3d p = random.point(-0.45, 0.45);
    EXPECT_LT(plate.at({p.x, 0, p.z}).distance, -0.5 * h);
    EXPECT_GT(plate.at({p.x, 1.6 * h, p.z}).distance, 0.4 * h);
    const double r = length(p);
    if (std::abs(r - 0.4) > h && std::abs(r - 0.5) > h) {
      EXPECT_EQ(shell.at(p).distance<0, r> 0.4 && r < 0.5) << r;
    }
  }
}

TEST(SignedDistanceField, IsTheSameForAMeshWoundInward) {
  TriangleMesh mesh = torus(1, 0.3, 40, 20);
  const SignedDistanceField right(mesh, 0.1);
  turn_inside_out(mesh);
  const SignedDistanceField wrong(mesh, 0.1);
  Random random(17);
  for (int k = 0; k < 2000; ++k) {
    const Vec3d p = random.point(-1.4, 1.4);
    EXPECT_NEAR(right.at(p).distance, wrong.at(p).distance, 1e-6);
  }
}

// Large balls have contacts while their center is far away, where the grid has few points or none.
TEST(SignedDistanceField, FarFromTheSurfaceIsRightToAFewPerCent) {
  const double h = 0.04;
  const SignedDistanceField ball(sphere(4, 0.5), h), solid(box({1, 0.6, 0.4}), h);
  Random random(19);
  for (int k = 0; k < 5000; ++k) {
    const Vec3d p = random.point(-3, 3);
    const double to_ball = length(p) - 0.5, to_solid = to_box(p, {0.5, 0.3, 0.2});
    const double bound = h + 0.02 * length(p);
    if (to_ball > 0) {
      ASSERT_NEAR(ball.at(p).distance, to_ball, bound);
    }
    if (to_solid > 0) {
      ASSERT_NEAR(solid.at(p).distance, to_solid, bound);
    }
  }
}

TEST(SignedDistanceField, NormalIsTheGradient) {
  const SignedDistanceField field(torus(1, 0.3, 80, 40), 0.06);
  Random random(23);
  int smooth = 0;
  for (int k = 0; k < 5000; ++k) {
    const Vec3d p = random.point(-1.3, 1.3);
    if (std::abs(to_torus(p, 1, 0.3)) > 0.1) continue;
    const SurfaceDistance here = field.at(p);
    ASSERT_NEAR(length(here.normal), 1, 1e-12);
    constexpr double e = 1e-6;
    Vec3d slope;
    for (int a = 0; a < 3; ++a) {
      Vec3d step;
      step[a] = e;
      slope[a] = (field.at(p + step).distance - field.at(p - step).distance) / (2 * e);
    }
    EXPECT_NEAR(length(slope), 1, 0.12);
    smooth += length(slope / length(slope) - here.normal) < 1e-4;
  }
  EXPECT_GT(smooth, 400);
}

TEST(SignedDistanceField, ARayMeetsItWhereItsDistanceIsZero) {
  const Shape shape = SignedDistanceField(torus(1, 0.3, 60, 24), 0.05);
  EXPECT_EQ(shape_name(shape), "signed_distance_field");
  Random random(29);
  int hits = 0, misses = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vec3d o = random.point(-3, 3), d = normalized(random.point(-1, 1));
    if (to_torus(o, 1, 0.3) < 0.1) continue;
    double nearest = 1e9;
    for (double s = 0; s < 8; s += 0.01) nearest = std::min(nearest, to_torus(o + d * s, 1, 0.3));
    const auto hit = ray_cast(shape, o, d);
    if (nearest < -0.02) {
      ASSERT_TRUE(hit);
    }
    if (nearest > 0.02) {
      ASSERT_FALSE(hit);
    }
    if (!hit) {
      ++misses;
      continue;
    }
    ++hits;
    ASSERT_NEAR(to_torus(hit->point, 1, 0.3), 0, 0.012);
    ASSERT_LT(dot(hit->normal, d), 0.05);
    for (double s = 0; s < hit->distance - 0.05; s += 0.01) ASSERT_GT(to_torus(o + d * s, 1, 0.3), -0.02);
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(misses, 100);
}

TEST(SignedDistanceField, LargeHolesAreNamed) {
  TriangleMesh bowl = sphere(2, 1);
  std::erase_if(bowl.triangles, [&](const Triangle& t) { return bowl.positions[t[0]].y > 0.2; });
  expect_error([&] { SignedDistanceField(bowl, 0.1); },
               {"signed distance field", "closed surface", "1 hole (", "edges are open"});
  expect_error([] { SignedDistanceField(grid(4, 4, 1), 0.1); }, {"12 edges are open"});
  expect_error([] { SignedDistanceField(TriangleMesh{}, 0.1); }, {"no triangles"});
}

TEST(SignedDistanceField, SizesThatCannotBeAreNamed) {
  const TriangleMesh mesh = sphere(3, 1);
  for (const double spacing : {0.0, -1.0, std::nan("")})
    expect_error([&] { SignedDistanceField(mesh, spacing); },
                 {"spacing", "expected a finite length above 0"});
  expect_error([&] { SignedDistanceField(mesh, 1e-4); }, {"0.0001 m", "512 are allowed", "spacing of about"});
  expect_error([&] { SignedDistanceField(mesh, 1e-30); }, {"allowed"});
  expect_error([&] { SignedDistanceField::spacing_of(mesh, 0); }, {"resolution"});
  EXPECT_NEAR(SignedDistanceField::spacing_of(box({1, 3, 2}), 60), 0.05, 1e-12);
  expect_error([] { validate(Shape(SignedDistanceField()), "rock"); }, {"rock", "empty"});
}

TEST(SignedDistanceField, MemoryGoesWithTheSurfaceAndIsShared) {
  const TriangleMesh mesh = sphere(3, 1);
  const SignedDistanceField coarse(mesh, 0.06), fine(mesh, 0.03);
  EXPECT_LT(double(fine.bytes()), 4.6 * double(coarse.bytes()));  // all points: 8
  EXPECT_GT(fine.bytes(), std::size_t{66} * 66 * 6 * sizeof(float));
  const SignedDistanceField copy = fine;  // NOLINT(performance-unnecessary-copy-initialization)
  EXPECT_EQ(copy, fine);
  EXPECT_EQ(&copy.positions(), &fine.positions());
  EXPECT_EQ(SignedDistanceField().bytes(), 0u);
}

TEST(SignedDistanceField, OfTooManyTrianglesIsRefused) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.triangles.resize(SignedDistanceField::max_triangles + 1);
  expect_error([&] { SignedDistanceField(mesh, 0.1); }, {"500001 triangles", "at most 500000"});
}

// Rings of long thin triangles: a hundred times as many of them describe the same capsule.
TEST(SignedDistanceField, LongThinTrianglesTakeLittleMoreTime) {
  const auto seconds_for = [](int divisions) {
    const TriangleMesh mesh = capsule(0.2, 0.3, 32, 8, divisions);
    const std::clock_t start = std::clock();
    const SignedDistanceField field(mesh, SignedDistanceField::spacing_of(mesh, 16));
    EXPECT_NEAR(field.at({0.3, 0.1, 0}).distance, 0.1, 1e-3);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  const double few = seconds_for(10), all = seconds_for(1000);
  EXPECT_LT(all, 8 * few + 0.1);
}

TEST(MeshTree, NearestAndWindingNumberAreThoseOfAllTriangles) {
  // The second one is a capsule of long thin triangles, slanted, and with triangles without area.
  TriangleMesh slanted = capsule(0.4, 1, 5, 2, 100);
  for (Vec3d& x : slanted.positions) x = {x.x + 0.5 * x.y, x.y, x.z - x.y};
  slanted.triangles.push_back({3, 3, 4}), slanted.triangles.push_back({7, 7, 7});
  for (const TriangleMesh& mesh : {torus(1, 0.3, 30, 14), slanted}) {
    const MeshTree tree(mesh.positions, mesh.triangles);
    Random random(31);
    for (int k = 0; k < 500; ++k) {
      const Vec3d p = random.point(-1.5, 1.5);
      double least = 1e9, angle = 0;
      for (const Triangle& t : mesh.triangles) {
        const MeshTree one(mesh.positions, std::span(&t, 1));
        least = std::min(least, one.nearest(p).distance);
        angle += one.winding_number(p);
      }
      ASSERT_NEAR(tree.nearest(p).distance, least, 1e-14);
      ASSERT_EQ(tree.nearest(p, 123).distance, tree.nearest(p).distance);
      ASSERT_LE(tree.nearest(p, 0, 0.01).distance, 1.01 * least);
      ASSERT_NEAR(tree.winding_number(p), std::round(angle), 0.1);
    }
  }
}

}  // namespace souple::test_collision_signed_distance_field
