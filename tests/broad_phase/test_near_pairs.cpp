#include "souple/broad_phase/near_pairs.h"
#include "souple/error.h"
#include "tests/broad_phase/surface_scene.h"
#include "tests/count_allocations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_broad_phase_near_pairs {

using test::Random;
using test::SurfaceScene;
using Quad = std::array<std::uint32_t, 4>;

// Particles in an order that does not depend on which edge comes first: each pair has one form.
Quad as_vertex_triangle(const NearPair& pair) {
  Quad q{pair.particle[0], pair.particle[1], pair.particle[2], pair.particle[3]};
  std::sort(q.begin() + 1, q.end());
  return q;
}

Quad as_edge_edge(const NearPair& pair) {
  std::array<std::uint32_t, 2> a{pair.particle[0], pair.particle[1]}, b{pair.particle[2], pair.particle[3]};
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  if (b < a) std::swap(a, b);
  return {a[0], a[1], b[0], b[1]};
}

template <class Form>
std::vector<Quad> in_one_form(const std::vector<NearPair>& pairs, const Form& form) {
  std::vector<Quad> quads;
  quads.reserve(pairs.size());
  for (const NearPair& pair : pairs) quads.push_back(form(pair));
  std::sort(quads.begin(), quads.end());
  return quads;
}

Bounds around(const SurfaceScene& scene, std::span<const std::uint32_t> particles) {
  Bounds box = scene.boxes[particles[0]];
  for (const std::uint32_t i : particles) box = united(box, scene.boxes[i]);
  return box;
}

// Whether a pair of elements must be found, according to the header's documentation alone.
bool counts(const SurfaceScene& scene, std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
            std::uint32_t object_a, std::uint32_t object_b) {
  bool moves = false, shared = false, finite = true;
  for (const auto group : {a, b})
    for (const std::uint32_t i : group) {
      moves = moves || scene.position_w[i].w > 0;
      finite = finite && is_finite(scene.boxes[i].lo) && is_finite(scene.boxes[i].hi);
    }
  for (const std::uint32_t i : a) shared = shared || std::find(b.begin(), b.end(), i) != b.end();
  return moves && !shared && finite && scene.compared.contains(object_a, object_b) &&
         overlap(around(scene, a), around(scene, b));
}

// Compares all elements with all others.
NearPairs brute_force(const SurfaceScene& scene) {
  NearPairs pairs;
  const SurfaceElements& all = scene.elements;
  for (std::size_t v = 0; v < all.vertices().size(); ++v)
    for (const SurfaceElement& triangle : all.elements()) {
      const std::uint32_t p = all.vertices()[v];
      const auto& [a, b, c] = triangle.particle;
      if (triangle.corners == 3 &&
          counts(scene, std::array{p}, triangle.particle, all.vertex_objects()[v], triangle.object))
        pairs.vertex_triangle.push_back({{p, a, b, c}});
    }
  for (const SurfaceElement& vertex : all.elements())
    for (const SurfaceElement& edge : all.elements()) {
      const std::uint32_t v = vertex.particle[0];
      const std::array<std::uint32_t, 2> e{edge.particle[0], edge.particle[1]};
      if (vertex.corners == 1 && edge.corners == 2 &&
          counts(scene, std::array{v}, e, vertex.object, edge.object))
        pairs.edge_edge.push_back({{v, v, e[0], e[1]}});
    }
  for (std::size_t e = 0; e < all.edges().size(); ++e)
    for (std::size_t f = e + 1; f < all.edges().size(); ++f) {
      const Edge &a = all.edges()[e], &b = all.edges()[f];
      if (counts(scene, a, b, all.edge_objects()[e], all.edge_objects()[f]))
        pairs.edge_edge.push_back({{a[0], a[1], b[0], b[1]}});
    }
  return pairs;
}

std::vector<NearPair> find_both(const SurfaceScene& scene, int threads, std::vector<NearPair>& edge_edge) {
  NearPairFinder finder;
  NearPairs pairs;
  const auto pool = make_threads(Threading::pool, threads);
  finder.find(scene.elements, scene.boxes, scene.compared, scene.position_w, pairs, *pool);
  edge_edge = pairs.edge_edge;
  return pairs.vertex_triangle;
}

bool same(const std::vector<NearPair>& a, const std::vector<NearPair>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const NearPair& p, const NearPair& q) {
    return std::equal(p.particle, p.particle + 4, q.particle);
  });
}

// Exactly the pairs of brute force, each once, and the same lists for any number of threads.
void expect_all_pairs(const SurfaceScene& scene, std::size_t at_least) {
  const NearPairs expected = brute_force(scene);
  EXPECT_GE(expected.vertex_triangle.size() + expected.edge_edge.size(), at_least);
  std::vector<NearPair> edge_edge;
  const std::vector<NearPair> vertex_triangle = find_both(scene, 1, edge_edge);
  EXPECT_EQ(in_one_form(vertex_triangle, as_vertex_triangle),
            in_one_form(expected.vertex_triangle, as_vertex_triangle));
  EXPECT_EQ(in_one_form(edge_edge, as_edge_edge), in_one_form(expected.edge_edge, as_edge_edge));
  for (const int threads : {2, 3, 8}) {
    std::vector<NearPair> other_edges;
    EXPECT_TRUE(same(find_both(scene, threads, other_edges), vertex_triangle));
    EXPECT_TRUE(same(other_edges, edge_edge));
  }
}

SurfaceScene mixture(std::uint64_t seed) {
  SurfaceScene scene;
  Random random(seed);
  scene.add_random_triangles(300, 1, 0.1, 0.02, random);
  scene.add_cloth(16, 1.5, 0.01, [](double x, double z) { return Vec3d{x, 0.1 * std::sin(9 * x), z}; });
  for (int rope = 0; rope < 4; ++rope)
    scene.add_rope(40, random.point(-1, 1), random.point(-1, 1), random.uniform(0.01, 0.03));
  scene.add_grains(300, 1, 0.03, random);
  scene.all_collide();
  return scene;
}

TEST(NearPairs, RandomTriangles) {
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    Random random(seed);
    SurfaceScene scene;
    scene.add_random_triangles(500, 1, random.uniform(0.02, 0.3), random.uniform(0, 0.05), random);
    scene.all_collide();
    expect_all_pairs(scene, 100);
  }
}

TEST(NearPairs, ClothOverCloth) {
  SurfaceScene scene;
  scene.add_cloth(24, 1, 0.01, [](double x, double z) { return Vec3d{x, 0, z}; });
  scene.add_cloth(20, 1, 0.01, [](double x, double z) { return Vec3d{z, 0.015, x}; });
  scene.all_collide();
  expect_all_pairs(scene, 1000);
}

// A spiral sheet: its layers are 1 cm apart.
TEST(NearPairs, AFoldedSheetMeetsItself) {
  SurfaceScene scene;
  scene.add_cloth(40, 1, 0.006, [](double x, double z) {
    const double angle = 6 * pi * (x + 0.5), radius = 0.03 + 0.01 * angle / (2 * pi);
    return Vec3d{radius * std::cos(angle), z, radius * std::sin(angle)};
  });
  scene.all_collide();
  expect_all_pairs(scene, 5000);
}

TEST(NearPairs, MixturesOfEverything) {
  for (std::uint64_t seed = 1; seed < 4; ++seed) expect_all_pairs(mixture(seed), 1000);
}

TEST(NearPairs, OnlyObjectsThatMeet) {
  SurfaceScene scene = mixture(5);
  scene.compared.clear();
  scene.compared.add(0, 0);
  scene.compared.add(0, 3);
  scene.compared.add(1, scene.objects - 1);
  expect_all_pairs(scene, 200);
}

TEST(NearPairs, OnlyWhatCanMove) {
  SurfaceScene scene = mixture(6);
  for (std::size_t i = 0; i < scene.position_w.size(); ++i) scene.position_w[i].w = i % 5 == 0 ? 1.0f : 0.0f;
  expect_all_pairs(scene, 1000);
  for (Vec4f& particle : scene.position_w) particle.w = 0;
  std::vector<NearPair> edge_edge;
  EXPECT_TRUE(find_both(scene, 1, edge_edge).empty());
  EXPECT_TRUE(edge_edge.empty());
}

TEST(NearPairs, OneTriangleAThousandTimesLarger) {
  SurfaceScene scene = mixture(7);
  Random random(3);
  scene.add_random_triangles(1, 0.1, 100, 0.1, random);
  scene.all_collide();
  expect_all_pairs(scene, 1000);
}

// Fast particles of grains, a rope and a sheet among small triangles: their boxes are swept over meters.
TEST(NearPairs, SomethingFastAmongSlowThings) {
  SurfaceScene scene = mixture(8);
  for (std::size_t i = 0; i < scene.boxes.size(); i += 37) scene.boxes[i].hi += Vec3f{0.9f, 1.7f, 0.4f};
  for (std::size_t i = 5; i < scene.boxes.size(); i += 190) scene.boxes[i].lo -= Vec3f{30, 50, 20};
  expect_all_pairs(scene, 1000);
}

TEST(NearPairs, AllSizesAtOnce) {
  SurfaceScene scene;
  Random random(11);
  double size = 1e-4;
  for (int step = 0; step < 9; ++step, size *= 5) {
    scene.add_random_triangles(40, 3 * size, size, 0.1 * size, random);
    scene.add_grains(20, 3 * size, size * random.uniform(0.1, 2), random);
    scene.add_rope(10, random.point(-size, size), random.point(-size, size), 0.05 * size);
  }
  scene.all_collide();
  expect_all_pairs(scene, 1000);
}

TEST(NearPairs, CoincidentPoints) {
  SurfaceScene scene;
  Random random(9);
  for (int copy = 0; copy < 3; ++copy)
    scene.add_cloth(8, 1, 0, [](double x, double z) { return Vec3d{x, 0, z}; });
  scene.add_random_triangles(30, 0, 0, 0, random);
  scene.add_grains(30, 0, 0, random);
  scene.all_collide();
  expect_all_pairs(scene, 1000);
}

TEST(NearPairs, EverythingInOnePoint) {
  SurfaceScene scene;
  Random random(1);
  scene.add_random_triangles(40, 0, 0, 0, random);
  scene.all_collide();
  expect_all_pairs(scene, 1000);
}

TEST(NearPairs, AnywhereInSpace) {
  for (const Vec3d& by : {Vec3d{-50, -60, -70}, Vec3d{1024, -2048, 5e3}, Vec3d{-1e5, 1e5, 1e5},
                          Vec3d{1e8, 0, -1e8}, Vec3d{1e30, 1e30, 0}}) {
    SurfaceScene scene = mixture(12);
    scene.move(by);
    expect_all_pairs(scene, 500);
  }
}

TEST(NearPairs, OneStrayFarAway) {
  SurfaceScene scene = mixture(13);
  Random random(2);
  for (const double far : {1e3, 1e6, 1e12, 1e30}) {
    const std::uint32_t first = scene.size();
    scene.add_random_triangles(2, 0, 0.1, 0.02, random);
    for (std::uint32_t i = first; i < scene.size(); ++i)
      scene.boxes[i] = {scene.boxes[i].lo + Vec3f{float(far), 0, 0},
                        scene.boxes[i].hi + Vec3f{float(far), 0, 0}};
  }
  scene.all_collide();
  expect_all_pairs(scene, 1000);
}

TEST(NearPairs, WhatIsNotFiniteIsLeftOutAndCounted) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                  infinity = std::numeric_limits<float>::infinity();
  SurfaceScene scene;
  Random random(14);
  scene.add_random_triangles(200, 0.5, 0.1, 0.02, random);
  scene.all_collide();
  scene.boxes[7].lo.y = nan;
  scene.boxes[33].hi.z = infinity;
  scene.boxes[72].lo = {nan, nan, nan};
  scene.boxes[73].hi.x = nan;
  expect_all_pairs(scene, 1000);
  NearPairFinder finder;
  NearPairs pairs;
  finder.find(scene.elements, scene.boxes, scene.compared, scene.position_w, pairs,
              *make_threads(Threading::serial, 1));
  EXPECT_EQ(finder.left_out(), 4u + 3u + 7u);  // vertices, triangles, edges: 72 and 73 are of one triangle
}

TEST(NearPairs, NothingGivesNothing) {
  SurfaceScene scene;
  scene.all_collide();
  expect_all_pairs(scene, 0);
  Random random(1);
  scene.add_grains(10, 0, 1, random);
  scene.all_collide();
  expect_all_pairs(scene, 0);
}

TEST(NearPairs, AWarmFindAllocatesNothing) {
  SurfaceScene scene = mixture(15);
  const auto pool = make_threads(Threading::pool, 2);
  NearPairFinder finder;
  NearPairs pairs;
  for (int step = 0; step < 3; ++step)
    finder.find(scene.elements, scene.boxes, scene.compared, scene.position_w, pairs, *pool);
  for (Bounds& box : scene.boxes) box.lo.x += 1e-3f * (box.hi.x - box.lo.x);
  const long before = test::allocations();
  finder.find(scene.elements, scene.boxes, scene.compared, scene.position_w, pairs, *pool);
  EXPECT_EQ(test::allocations() - before, 0);
  EXPECT_GT(pairs.edge_edge.size(), 100u);
}

// After some particles have moved: exactly those of the brute-force pairs that contain such a particle.
TEST(NearPairs, WhatMovedIsFoundAgainAlone) {
  for (const std::size_t stride : {1u, 7u, 90u}) {
    SurfaceScene scene = mixture(17 + stride);
    scene.elements.index_particles();
    const auto pool = make_threads(Threading::pool, 2);
    NearPairFinder finder;
    NearPairs pairs;
    finder.find(scene.elements, scene.boxes, scene.compared, scene.position_w, pairs, *pool);
    Random random(stride);
    std::vector<std::uint32_t> moved;
    for (std::uint32_t i = 3; i < scene.boxes.size(); i += static_cast<std::uint32_t>(stride)) {
      const Vec3f by(random.point(-0.2, 0.2));
      scene.boxes[i] = {scene.boxes[i].lo + by, scene.boxes[i].hi + by};
      moved.push_back(i);
    }
    finder.find_moved(moved, scene.boxes, scene.compared, scene.position_w, pairs, *pool);
    NearPairs expected = brute_force(scene);
    for (std::vector<NearPair>* list : {&expected.vertex_triangle, &expected.edge_edge})
      std::erase_if(*list, [&](const NearPair& pair) {
        return std::none_of(std::begin(pair.particle), std::end(pair.particle), [&](std::uint32_t i) {
          return std::binary_search(moved.begin(), moved.end(), i);
        });
      });
    EXPECT_GT(expected.edge_edge.size(), 10u);
    EXPECT_EQ(in_one_form(pairs.vertex_triangle, as_vertex_triangle),
              in_one_form(expected.vertex_triangle, as_vertex_triangle));
    EXPECT_EQ(in_one_form(pairs.edge_edge, as_edge_edge), in_one_form(expected.edge_edge, as_edge_edge));
  }
}

TEST(NearPairs, TooFewBoxesAreAnError) {
  SurfaceScene scene = mixture(16);
  NearPairFinder finder;
  NearPairs pairs;
  const auto threads = make_threads(Threading::serial, 1);
  const std::span<const Bounds> few = std::span<const Bounds>(scene.boxes).first(100);
  EXPECT_THROW(finder.find(scene.elements, few, scene.compared, scene.position_w, pairs, *threads), Error);
}

}  // namespace souple::test_broad_phase_near_pairs
