#include "souple/contacts/ball_cells.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/contacts/packed_collider.h"
#include "souple/geometry/builders.h"
#include "souple/simd/instruction_set.h"
#include "souple/state/columns.h"
#include "souple/state/particles.h"
#include "tests/collision/random.h"
#include "tests/instruction_sets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_contacts_kernels {

// Searches for the deepest point of elements, compared with sampling in double.

constexpr float particle_radius = 0.001f;  // m, of particles
constexpr float clearance_part = 0.25f;    // of it: clearance

/// Triangles in a frame, and the results of a search.
struct Triangles {
  std::vector<Vec4f> from, to;
  std::vector<std::uint32_t> corner[3];
  std::vector<float> radii;
  std::vector<float> out[9], search[4];
  std::vector<std::uint32_t> list;

  void add(const Vec3d (&x)[3], const Vec3d& motion) {
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k].push_back(static_cast<std::uint32_t>(4 * from.size()));
      const Vec3d end = x[k] + motion;
      from.push_back({float(x[k].x), float(x[k].y), float(x[k].z), 0});
      to.push_back({float(end.x), float(end.y), float(end.z), 0});
    }
    radii.push_back(particle_radius);
  }
  std::size_t size() const { return radii.size(); }
  Vec3d at(std::size_t t, std::size_t k, double time) const {
    const std::size_t i = corner[k][t] / 4;
    return Vec3d(from[i].xyz()) * (1 - time) + Vec3d(to[i].xyz()) * time;
  }
  kernels::ColliderFrameRecords records() { return {&from[0].x, &to[0].x}; }
  kernels::ColliderElements elements(std::size_t a = 0, std::size_t b = 1, std::size_t c = 2) const {
    return {{corner[a].data(), corner[b].data(), corner[c].data()}, radii.data(), clearance_part};
  }
  kernels::ColliderElementTouches touches() {
    for (auto& column : out) column.assign(size(), 0);
    return {out[0].data(),
            {out[1].data(), out[2].data(), out[3].data()},
            out[4].data(),
            {out[5].data(), out[6].data(), out[7].data()},
            out[8].data()};
  }
  kernels::ColliderFieldSearch field_search() {
    for (auto& column : search) column.assign(size(), 1);
    list.resize(size());
    std::iota(list.begin(), list.end(), 0u);
    return {search[0].data(), search[1].data(), search[2].data(), search[3].data(), 8, 0.01f};
  }
};

/// Triangles near a surface, of edges of `size`.
Triangles near_surface(const Shape& shape, double size, std::size_t count, double motion) {
  test::Random random(7);
  Triangles result;
  const BoundingBall ball = bounding_ball(shape);
  while (result.size() < count) {
    Vec3d middle = ball.center + random.point(-ball.radius, ball.radius);
    const SurfaceDistance below = surface_distance(shape, middle);
    middle = middle - below.normal * (below.distance - random.uniform(0, 0.3 * size));
    Vec3d x[3];
    for (Vec3d& corner : x) corner = middle + random.point(-0.6 * size, 0.6 * size);
    result.add(x, random.point(-motion, motion));
  }
  return result;
}

double lowest_of(const Shape& shape, const Triangles& triangles, std::size_t t, double time, bool inside) {
  constexpr int n = 60;
  double lowest = 1e9;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      if (!inside && i != 0 && j != 0 && i + j != n) continue;
      const double u = double(i) / n, v = double(j) / n;
      const Vec3d p = triangles.at(t, 0, time) * (1 - u - v) + triangles.at(t, 1, time) * u +
                      triangles.at(t, 2, time) * v;
      lowest = std::min(lowest, surface_distance(shape, p).distance);
    }
  return lowest;
}

kernels::ColliderBody body_of(const Shape& shape) {
  kernels::ColliderBody body;
  body.shape = packed_shape(shape);
  return body;
}

const Shape convex_shapes[] = {Sphere{{}, 0.1f}, Box{{}, {0.1f, 0.05f, 0.2f}}, Capsule{{}, 0.05f, 0.1f},
                               Cylinder{{}, 0.1f, 0.06f}};

/// Per triangle: the smallest start distance that its three edges and its inside found.
std::vector<double> start_distances(const kernels::ColliderElementKernels& kernels, const Shape& shape,
                                    Triangles& triangles) {
  const kernels::ColliderBody body = body_of(shape);
  std::vector<double> found(triangles.size(), 1e9);
  const auto add = [&](const kernels::ColliderElements& elements, auto kernel) {
    const auto out = triangles.touches();
    kernel(body, triangles.records(), elements, 0, triangles.size(), out);
    for (std::size_t t = 0; t < found.size(); ++t)
      found[t] = std::min(found[t], double(out.start_distance[t]));
  };
  add(triangles.elements(0, 1, 1), kernels.find_edges);
  add(triangles.elements(1, 2, 2), kernels.find_edges);
  add(triangles.elements(2, 0, 0), kernels.find_edges);
  for (std::size_t t = 0; t < found.size(); ++t) found[t] = std::max(found[t], double(-1e9));
  const auto out = triangles.touches();
  kernels.find_triangles(body, triangles.records(), triangles.elements(), 0, triangles.size(), out);
  for (std::size_t t = 0; t < found.size(); ++t)  // the radius where nothing is inside
    if (double(out.start_distance[t]) != double(particle_radius))
      found[t] = std::min(found[t], double(out.start_distance[t]));
  return found;
}

// Outside of a shape, edges and insides together find the deepest point of a triangle to a tenth of the radius.
TEST(ColliderElementKernels, FindTheDeepestPointOfATriangle) {
  const auto& kernels = kernels::find_collider_element_kernels(instruction_set());
  for (const Shape& shape : convex_shapes) {
    Triangles triangles = near_surface(shape, 0.08, 600, 0);
    const std::vector<double> found = start_distances(kernels, shape, triangles);
    int touching = 0;
    for (std::size_t t = 0; t < found.size(); ++t) {
      const double lowest = lowest_of(shape, triangles, t, 0, true);
      if (lowest > double(particle_radius)) {
        EXPECT_GT(found[t], 0.9 * double(particle_radius)) << shape_name(shape) << ' ' << t;
      } else if (lowest > 0) {
        ++touching;
        EXPECT_LT(found[t], lowest + 0.11 * double(particle_radius)) << shape_name(shape) << ' ' << t;
        EXPECT_GT(found[t], lowest - 0.001) << shape_name(shape) << ' ' << t;  // samples are 1.3 mm apart
      } else {
        EXPECT_LT(found[t], 0.11 * double(particle_radius)) << shape_name(shape) << ' ' << t;
      }
    }
    EXPECT_GT(touching, 5) << shape_name(shape);
  }
}

// A triangle that ends up inside has touched: with the plane of the touch, its deepest point would stay outside.
TEST(ColliderElementKernels, NoFastElementPasses) {
  const auto& kernels = kernels::find_collider_element_kernels(instruction_set());
  for (const Shape& shape : convex_shapes) {
    const kernels::ColliderBody body = body_of(shape);
    Triangles all = near_surface(shape, 0.08, 2000, 0.06), moving;
    for (std::size_t t = 0; t < all.size(); ++t) {
      if (lowest_of(shape, all, t, 0, true) < 2 * double(particle_radius)) continue;
      const Vec3d x[3] = {all.at(t, 0, 0), all.at(t, 1, 0), all.at(t, 2, 0)};
      moving.add(x, all.at(t, 0, 1) - x[0]);
    }
    std::vector<float> touched(moving.size());
    const auto search = [&](const kernels::ColliderElements& elements, auto kernel) {
      const auto out = moving.touches();
      kernel(body, moving.records(), elements, 0, moving.size(), out);
      for (std::size_t t = 0; t < touched.size(); ++t) touched[t] = std::max(touched[t], out.touches[t]);
    };
    search(moving.elements(0, 1, 1), kernels.find_edges);
    search(moving.elements(1, 2, 2), kernels.find_edges);
    search(moving.elements(2, 0, 0), kernels.find_edges);
    search(moving.elements(), kernels.find_triangles);
    int passed = 0, entered = 0;
    for (std::size_t t = 0; t < moving.size(); ++t) {
      double lowest = 1e9, corners = 1e9;
      for (int s = 0; s <= 40; ++s) {
        lowest = std::min(lowest, lowest_of(shape, moving, t, s / 40.0, true));
        for (std::size_t k = 0; k < 3; ++k)
          corners = std::min(corners, surface_distance(shape, moving.at(t, k, s / 40.0)).distance);
      }
      if (!(lowest < -0.002) || corners < lowest + 0.002) continue;  // corners have contacts of their own
      ++entered;
      if (corners > double(particle_radius) && touched[t] == 0) ++passed;
    }
    EXPECT_GT(entered, 50) << shape_name(shape);
    EXPECT_EQ(passed, 0) << shape_name(shape);
  }
}

TEST(ColliderElementKernels, FindDipsOfAField) {
  TriangleMesh mesh = sphere(4, 0.2);
  for (Vec3d& x : mesh.positions)
    x = x * (1 + 0.1 * std::sin(20 * x.x) * std::sin(20 * x.y) * std::sin(20 * x.z));
  const Shape shape = SignedDistanceField(mesh, 0.01);
  const auto& kernels = kernels::find_collider_element_kernels(instruction_set());
  Triangles triangles = near_surface(shape, 0.06, 500, 0);
  const auto out = triangles.touches();
  const auto search = triangles.field_search();
  kernels.sample_field_elements(body_of(shape), triangles.records(), triangles.elements(), search,
                                triangles.list.data(), 0, triangles.size());
  kernels.find_in_field(body_of(shape), triangles.records(), triangles.elements(), search,
                        triangles.list.data(), 0, triangles.size(), out);
  int near = 0, wrong = 0;
  double worst = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const double lowest = lowest_of(shape, triangles, t, 0, true);
    if (lowest > 0.5 * double(particle_radius)) continue;
    ++near;
    const double above = double(out.start_distance[t]) - lowest;
    worst = std::max(worst, above);
    if (above > double(particle_radius)) ++wrong;
  }
  EXPECT_GT(near, 100);
  EXPECT_LT(worst, 0.005);  // half a cell
  EXPECT_LE(wrong, near / 50);
}

using kernels::ElementPairKernels;

Vec4f record(const Vec3d& x, float w) {
  return {float(x.x), float(x.y), float(x.z), w};
}

/// Particles in a small box, with small motions, and pairs of them. Every fifth particle cannot move.
struct Crowd {
  std::vector<Vec4f> position, moving, start, moved;
  std::vector<std::array<std::uint32_t, 4>> pairs;
  std::vector<float> thickness, distance_bound, contact_margin;

  explicit Crowd(std::size_t count) {
    test::Random random(count);
    const std::size_t particles = 4 * count;
    for (std::size_t i = 0; i < particles; ++i) {
      const float w = i % 5 == 0 ? 0.0f : float(random.uniform(0.5, 2));
      const Vec3d x = random.point(0, 0.1), d = random.point(-0.01, 0.01);
      start.push_back({});
      moving.push_back(record(d, 0));
      position.push_back(record(x, w));
      moved.push_back({});
      moved[i].set_xyz(moving[i].xyz() - start[i].xyz());
      contact_margin.push_back(i % 3 == 0 ? float(random.uniform(0, 0.01)) : 0.0f);
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      pairs.push_back({4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3});
      thickness.push_back(float(random.uniform(0.005, 0.04)));
      distance_bound.push_back(float(random.uniform(0, 0.1)));
    }
  }
  const std::uint32_t (*quads() const)[4] {
    return reinterpret_cast<const std::uint32_t(*)[4]>(pairs.data());
  }
  kernels::ParticleRecords records() {
    kernels::ParticleRecords result;
    result.moving = &moving[0].x;
    result.position = &position[0].x;
    result.corrected = result.moving;
    result.start = &start[0].x;
    result.moved = &moved[0].x;
    result.contact_margin = contact_margin.data();
    return result;
  }
};

// A vertex and a triangle that approach each other. The range has the radii of the vertex and of the thickest corner,
// the fastest corner's relative velocity, and the margins of both.
TEST(ElementPairKernels, ARangeIsThicknessAndMotionAndMargins) {
  const std::vector<Vec4f> velocity{{1, 0, 0, 0}, {1, 0, 0, 0}, {-2, 0, 0, 0}, {1, 4, 0, 0}};
  const std::vector<float> radius{0.1f, 0.2f, 0.3f, 0.1f}, margin{0.01f, 0.02f, 0.02f, 0.05f},
      contact_margin{0, 0.003f, 0, 0.001f};
  const std::uint32_t pair[1][4] = {{0, 1, 2, 3}};
  kernels::ParticleRecords records;
  records.moved = &velocity[0].x;
  records.contact_margin = contact_margin.data();
  const kernels::PredictionMargins margins{radius.data(), margin.data(), 1, 1e-5f, 0.5f};
  for (const InstructionSet set : all_sets()) {
    const ElementPairKernels& kernels = kernels::find_element_pair_kernels(set);
    float thickness = 0, range = 0;
    kernels.ranges[0](records, margins, 0.1f, pair, 0, 1, &thickness, &range);
    EXPECT_FLOAT_EQ(thickness, 0.4f);
    EXPECT_FLOAT_EQ(range, 1.5f * 0.4f + 0.003f + 0.1f * 4 + 0.06f);
    kernels.ranges[1](records, margins, 0.1f, pair, 0, 1, &thickness, &range);
    EXPECT_FLOAT_EQ(thickness, 0.2f + 0.3f);
    EXPECT_FLOAT_EQ(range, 1.5f * 0.5f + 0.003f + 0.1f * 4 + 0.07f);
  }
}

/// Projects the only pair of a crowd, 3 cm thick, without friction.
void project_one(const ElementPairKernels& kernels, Crowd& crowd, int kind) {
  crowd.thickness[0] = crowd.distance_bound[0] = 0.03f;
  const kernels::ElementPairColumns columns{crowd.quads(), crowd.thickness.data(),
                                            crowd.distance_bound.data()};
  const std::uint32_t found = 0;
  const float part = 1;
  ColumnStore<kernels::ContactColumns> arrays;
  arrays.resize(1);
  const kernels::ContactColumns contacts = arrays.columns();
  contacts.slop[0] = 0;
  kernels.describe[kind](crowd.records(), columns, &found, &part, 0, 1, contacts);
  contacts.static_friction[0] = contacts.kinetic_friction[0] = 0;
  kernels.project(crowd.records(), contacts, 0, 1);
}

// Two overlapping elements move apart in proportion to their inverse masses. Momentum is conserved, and a
// corner that cannot move stays.
TEST(ElementPairKernels, AProjectionKeepsMomentumAndTheDistance) {
  for (const InstructionSet set : all_sets()) {
    const ElementPairKernels& kernels = kernels::find_element_pair_kernels(set);
    Crowd crowd(1);
    crowd.position = {record({0.3, 0.01, 0.2}, 2), record({0, 0, 0}, 1), record({0, 0, 1}, 1),
                      record({1, 0, 0}, 0)};
    crowd.moving = crowd.start = crowd.moved = std::vector<Vec4f>(4);
    project_one(kernels, crowd, 0);
    const auto moved = [&](std::size_t i) { return Vec3d(crowd.moving[i].xyz()); };
    EXPECT_EQ(moved(3), Vec3d{});
    // Weights of the triangle's corners where the vertex is above it: 0.5, 0.2, 0.3.
    EXPECT_NEAR(0.01 + moved(0).y - 0.5 * moved(1).y - 0.2 * moved(2).y, 0.03, 1e-7);
    // The third corner has infinite mass and absorbs its part of the momentum.
    EXPECT_NEAR(moved(1).y / moved(0).y, -0.5 / 2, 1e-5);
    EXPECT_NEAR(moved(2).y / moved(0).y, -0.2 / 2, 1e-5);
  }
}

// A ball and an edge; the ball is an edge from its particle to itself. Its correction counts exactly once.
TEST(ElementPairKernels, ABallIsPushedOffAnEdge) {
  for (const InstructionSet set : all_sets()) {
    const ElementPairKernels& kernels = kernels::find_element_pair_kernels(set);
    Crowd crowd(1);
    crowd.pairs[0] = {0, 0, 2, 3};
    crowd.position = {record({0.25, 0.01, 0}, 2), record({}, 1), record({0, 0, 0}, 1), record({1, 0, 0}, 1)};
    crowd.moving = crowd.start = crowd.moved = std::vector<Vec4f>(4);
    project_one(kernels, crowd, 1);
    const auto moved = [&](std::size_t i) { return Vec3d(crowd.moving[i].xyz()); };
    EXPECT_NEAR(0.01 + moved(0).y - 0.75 * moved(2).y - 0.25 * moved(3).y, 0.03, 1e-7) << simd_name(set);
    EXPECT_NEAR(moved(0).y / 2 + moved(2).y + moved(3).y, 0, 1e-8);
    EXPECT_NEAR(moved(2).y / moved(3).y, 3, 1e-4);
  }
}

// Pairs of balls at vertices are those that a loop over all finds, with every instruction set.

using test::Random;

/// Balls at random in a box of 1 m, at random elsewhere at rest.
struct Balls {
  std::vector<Vec3f> place, rest;
  std::vector<float> radius, margin;

  Balls(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    const auto between = [&](double lo, double hi) { return static_cast<float>(random.uniform(lo, hi)); };
    for (std::size_t m = 0; m < count; ++m) {
      place.push_back({between(-0.5, 0.5), between(-0.5, 0.5), between(-0.5, 0.5)});
      rest.push_back({between(-1, 1), between(-1, 1), between(-1, 1)});
      radius.push_back(between(0.02, 0.05));
      margin.push_back(between(0, 0.02));
    }
  }
  SearchedBalls searched() const { return {place, rest, radius, margin}; }
};

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

Pairs pairs_of(const Balls& balls, const kernels::VertexBallKernels& kernels, float rest_part) {
  BallCells cells;
  cells.sort(balls.searched(), 2 * 0.07f);
  cells.gather(balls.searched(), 0, balls.place.size());
  BallCells::Search search;
  Pairs pairs;
  for (std::size_t slot = 0; slot < cells.size(); ++slot)
    for (const std::uint32_t other : cells.find_near(slot, rest_part, kernels, search))
      pairs.push_back(
          {std::min(cells.ball(slot), cells.ball(other)), std::max(cells.ball(slot), cells.ball(other))});
  return pairs;
}

TEST(VertexBallKernels, FindThePairsThatALoopOverAllFinds) {
  constexpr float rest_part = 0.1f;
  const Balls balls(700, 3);
  Pairs expected;
  for (std::uint32_t i = 0; i < balls.place.size(); ++i)
    for (std::uint32_t j = i + 1; j < balls.place.size(); ++j) {
      const float sum = balls.radius[i] + balls.radius[j];
      if (length(balls.place[i] - balls.place[j]) < sum + balls.margin[i] + balls.margin[j] &&
          rest_part * length(balls.rest[i] - balls.rest[j]) >= sum)
        expected.push_back({i, j});
    }
  ASSERT_GT(expected.size(), 200u);
  for (const InstructionSet set : all_sets()) {
    Pairs pairs = pairs_of(balls, kernels::find_vertex_ball_kernels(set), rest_part);
    std::sort(pairs.begin(), pairs.end());
    EXPECT_EQ(pairs, expected) << simd_name(set);
  }
}

// The law of friction of all contacts.

constexpr float mu_s = 0.5f, mu_k = 0.3f;

TEST(ContactLaw, FrictionHoldsUpToItsLimitAndSlidesBeyond) {
  const Vec3f direction = normalized(Vec3f{3, 0, 4});
  const Vec3f held = direction * 0.09f, pulled = direction * 0.11f;
  EXPECT_EQ(within_friction(held, mu_s, mu_k, 0.2f), held);
  const Vec3f slides = within_friction(pulled, mu_s, mu_k, 0.2f);
  EXPECT_NEAR(length(slides - direction * 0.06f), 0, 1e-7f);
  EXPECT_EQ(within_friction(pulled, mu_s, mu_k, 0.0f), Vec3f{});
}

// Whatever a solver does between two projections: contacts never pull, friction stays within its cone and tangential, and
// the corrections add up to the sums.
TEST(ContactLaw, SumsStayInTheCone) {
  Random random(3);
  for (int contact = 0; contact < 100; ++contact) {
    const Vec3f n = normalized(Vec3f(random.point(-1, 1)));
    ContactSums<float> sums{};
    Vec3f corrected;
    for (int sweep = 0; sweep < 20; ++sweep) {
      const auto C = static_cast<float>(random.uniform(-0.02, 0.02));
      const Vec3f motion(random.point(-0.02, 0.02));
      corrected += solve_contact(sums, C, 0.0f, n, motion, mu_s, mu_k);
      ASSERT_GE(sums.normal_sum, 0);
      ASSERT_LE(length(sums.tangent_sum), mu_s * sums.normal_sum * 1.0001f);
      ASSERT_NEAR(dot(n, sums.tangent_sum), 0, 1e-7f);
      ASSERT_NEAR(length(corrected - n * sums.normal_sum - sums.tangent_sum), 0, 1e-6f);
    }
  }
}

// Where both stick, one solution of the block leaves neither slip nor relative rotation.
TEST(ContactLaw, RollingSticksAtOnce) {
  const RollingResponse<float> response{2.6f, 0.7f, 1.9f};
  const Vec3f n{0, 1, 0}, slip{0.02f, 0, -0.01f}, roll{-0.01f, 0.004f, 0.03f};
  const auto [friction, moment] = solve_rolling<float>({}, response, n, slip, roll, 10, 10, 10, 1);
  const Vec3f in_plane = moment - n * dot(n, moment);
  EXPECT_NEAR(length(slip + friction * response.A + in_plane * response.c), 0, 1e-6f);
  EXPECT_NEAR(length(roll + friction * response.c + moment * response.B), 0, 1e-6f);
}

}  // namespace souple::test_contacts_kernels
