#include "souple/constraints/attachment.h"
#include "souple/multilevel/distance_trees.h"
#include "tests/solver/solver_scene.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace souple::test_solver_tree_elimination {

// --- which links are trees -----------------------------------------------------------------------

std::vector<TreeLink> links_of(const std::vector<std::array<std::uint32_t, 2>>& ends) {
  std::vector<TreeLink> links;
  for (std::uint32_t e = 0; e < ends.size(); ++e) links.push_back({ends[e][0], ends[e][1], 0, e});
  return links;
}

/// Links of all trees. Checks that children precede parents and that each link joins its node to the parent.
std::set<std::uint32_t> links_in(const DistanceTrees& trees, const std::vector<TreeLink>& links) {
  std::set<std::uint32_t> result;
  for (std::uint32_t k = 0; k < trees.nodes.size(); ++k) {
    const TreeNode& node = trees.nodes[k];
    if (node.parent == k) continue;
    EXPECT_GT(node.parent, k);
    const TreeLink& link = links[node.constraint];
    const std::set<std::uint32_t> expected{link.a, link.b},
        ends{node.particle, trees.nodes[node.parent].particle};
    EXPECT_EQ(ends, expected);
    EXPECT_TRUE(result.insert(node.constraint).second);
  }
  return result;
}

TEST(DistanceTrees, AreRopesAndWhatHangsOnThem) {
  auto links = links_of({{0, 1}, {1, 2}, {2, 3}, {1, 4}, {4, 5}, {7, 8}, {9, 10}});
  links[6].has_length = false;
  const DistanceTrees trees = find_trees(links, 11);
  EXPECT_EQ(trees.size(), 2u);
  EXPECT_EQ(links_in(trees, links), (std::set<std::uint32_t>{0, 1, 2, 3, 4, 5}));  // a tie alone is none
  EXPECT_EQ(trees.nodes[trees.begin[1] - 1].particle, 0u);
}

// A cloth of 4 x 4 with one diagonal per cell has none. Ropes hang on it: one by an end, one by both.
TEST(DistanceTrees, EndAtACloth) {
  std::vector<std::array<std::uint32_t, 2>> ends;
  for (std::uint32_t i = 0; i < 4; ++i)
    for (std::uint32_t j = 0; j < 4; ++j) {
      const std::uint32_t at = 4 * i + j;
      if (j < 3) ends.push_back({at, at + 1});
      if (i < 3) ends.push_back({at, at + 4});
      if (i < 3 && j < 3) ends.push_back({at, at + 5});
    }
  const auto cloth = static_cast<std::uint32_t>(ends.size());
  EXPECT_EQ(find_trees(links_of(ends), 16).size(), 0u);
  for (const auto& link : {std::array<std::uint32_t, 2>{5, 16}, {16, 17}, {17, 18}}) ends.push_back(link);
  for (const auto& link : {std::array<std::uint32_t, 2>{0, 19}, {19, 20}, {20, 21}, {21, 15}})
    ends.push_back(link);
  const auto links = links_of(ends);
  const DistanceTrees trees = find_trees(links, 22);
  EXPECT_EQ(trees.size(), 2u);
  std::set<std::uint32_t> expected;
  for (std::uint32_t e = cloth; e < links.size(); ++e) expected.insert(e);
  EXPECT_EQ(links_in(trees, links), expected);
}

TEST(DistanceTrees, CutLargeRingsAtOneLink) {
  for (const std::uint32_t n : {3u, 5u, 8u, 20u}) {
    std::vector<std::array<std::uint32_t, 2>> ends{{0, 0}};  // a link to itself is ignored
    for (std::uint32_t i = 0; i < n; ++i) ends.push_back({i, (i + 1) % n});
    const auto links = links_of(ends);
    EXPECT_EQ(links_in(find_trees(links, n), links).size(), n < 8 ? 0u : n - 1);
  }
}

// --- what they solve -----------------------------------------------------------------------------

/// A branched tree of compliant links, one end fixed, with a coincident pair and an attachment.
test::SolverScene branched(bool more = true) {
  test::SolverScene scene;
  scene.add({0, 0, 0}, 0);
  for (int i = 1; i < 12; ++i)
    scene.add({0.1 * i, 0.03 * (i % 3), 0.02 * (i % 4)}, i == 7 ? 30 : 0.01 * (1 + i % 5));
  auto& distances = scene.add<Distance>();
  for (const auto& [a, b] : {std::pair<std::uint32_t, std::uint32_t>{0, 1},
                             {1, 2},
                             {3, 2},
                             {2, 4},
                             {4, 5},
                             {5, 6},
                             {7, 6},
                             {2, 8},
                             {8, 9},
                             {9, 10}}) {
    const double l = length(Vec3d(scene.body.position[a].xyz()) - Vec3d(scene.body.position[b].xyz()));
    distances.add({a, b}, {static_cast<float>(0.98 * l)}, {1e-3f});
  }
  if (more) {
    scene.add<Distance>().add({10, 11}, {0}, {2e-3f});
    scene.add<Attachment>().add({9}, {Vec3f(scene.body.position[9].xyz()) + Vec3f{0, 0.05f, 0}}, {1e-3f});
  }
  return scene;
}

void displace(test::SolverScene& scene, double pull = 0.01) {
  scene.body.start = scene.body.offset;
  for (std::uint32_t i = 1; i < scene.body.offset.size(); ++i)
    scene.body.offset[i].set_xyz({static_cast<float>(pull * std::sin(i)),
                                  static_cast<float>(pull * std::cos(2 * i)),
                                  static_cast<float>(pull * std::sin(3 * i + 1))});
}

Vec3d at(const test::SolverScene& scene, const std::vector<Vec4f>& offset, std::size_t i) {
  return Vec3d(scene.body.position[i].xyz()) + Vec3d(offset[i].xyz());
}

/// Direction of the force of a link whose ends differ by `d`, at the start by `d0` and predicted by `predicted`. Weights
/// as in tree_elimination.cpp.
Vec3d force_direction(const Vec3d& d, const Vec3d& d0, const Vec3d& predicted) {
  const Vec3d g = normalized(d), g0 = normalized(d0), before = normalized(d0 * 2 - predicted);
  const double calm = std::clamp((0.004 - length(cross(g0, g + before))) / 0.002, 0.0, 1.0);
  const double a = 0.5 - 0.18 * calm, b = 0.5 - 0.05 * calm;
  return g * a + g0 * b + before * (1 - a - b);
}

/// The largest imbalance M (x - y) - sum_j f_j lambda_j, lambda_j = -C_j / alpha~_j, relative to the largest force.
double imbalance(const test::SolverScene& scene, const std::vector<Vec4f>& predicted) {
  const double h2 = static_cast<double>(scene.substep.h) * static_cast<double>(scene.substep.h);
  const auto& start = scene.body.start;
  const auto& end = scene.body.offset;
  std::vector<Vec3d> force(end.size());
  double largest = 0;
  for (const auto& projector : scene.projectors) {
    if (const auto* set = dynamic_cast<const SetProjector<Distance>*>(projector.get())) {
      for (std::size_t e = 0; e < set->size(); ++e) {
        const auto [a, b] = set->set().indices(e);
        const Vec3d d = at(scene, end, a) - at(scene, end, b), d0 = at(scene, start, a) - at(scene, start, b);
        const double alpha = static_cast<double>(set->set().compliance(e)[0]) / h2;
        const double rest = static_cast<double>(set->set().params(e).rest_length);
        const Vec3d p = at(scene, predicted, a) - at(scene, predicted, b);
        const Vec3d f = rest > 0 ? force_direction(d, d0, p) : normalized(d);
        const Vec3d on_a = f * ((rest - length(d)) / alpha);
        force[a] += on_a, force[b] -= on_a;
        largest = std::max(largest, length(on_a));
      }
    }
    if (const auto* set = dynamic_cast<const SetProjector<Attachment>*>(projector.get()))
      for (std::size_t e = 0; e < set->size(); ++e) {
        const std::uint32_t i = set->set().indices(e)[0];
        force[i] += (Vec3d(set->set().params(e).target) - at(scene, end, i)) *
                    (h2 / static_cast<double>(set->set().compliance(e)[0]));
      }
  }
  double worst = 0;
  for (std::size_t i = 0; i < end.size(); ++i) {
    if (scene.body.position[i].w == 0) continue;
    const Vec3d moved = at(scene, end, i) - at(scene, predicted, i);
    worst = std::max(worst, length(moved * (1 / static_cast<double>(scene.body.position[i].w)) - force[i]));
  }
  return worst / largest;
}

TEST(TreeElimination, BalancesForcesAndInertia) {
  for (const double pull : {0.01, 0.0001}) {  // links are jerked, and calm
    test::SolverScene scene = branched();
    scene.use({});
    displace(scene, pull);
    const std::vector<Vec4f> predicted = scene.body.offset;
    scene.solve_from_start();
    EXPECT_LT(imbalance(scene, predicted), 1e-3) << pull;  // Gauss-Seidel: 0.6
    for (std::size_t i = 1; i < predicted.size(); ++i)     // and it did something
      EXPECT_GT(length(Vec3d(scene.body.offset[i].xyz()) - Vec3d(predicted[i].xyz())),
                (i == 7 ? 1e-5 : 0.1) * pull)
          << i;
  }
}

// Further iterations start where the last ended, with the multipliers found there.
TEST(TreeElimination, IterationsChangeNothing) {
  for (const int iterations : {2, 5}) {
    test::SolverScene scene = branched();
    scene.use({});
    scene.substep.iterations = iterations;
    displace(scene);
    const std::vector<Vec4f> predicted = scene.body.offset;
    scene.solve_from_start();
    EXPECT_LT(imbalance(scene, predicted), 1e-3) << iterations;
  }
}

// Links without compliance keep their lengths exactly, up to what turning leaves.
TEST(TreeElimination, RigidLinksKeepTheirLength) {
  test::SolverScene scene = branched(false);
  auto& set = dynamic_cast<SetProjector<Distance>&>(*scene.projectors[0]);
  for (std::size_t e = 0; e < set.size(); ++e) set.set().compliances[0].set(e, 0);
  scene.use({});
  displace(scene);
  scene.solve_from_start();
  for (std::size_t e = 0; e < set.size(); ++e) {
    const auto [a, b] = set.set().indices(e);
    const double l = length(at(scene, scene.body.offset, a) - at(scene, scene.body.offset, b));
    const auto rest = static_cast<double>(set.set().params(e).rest_length);
    EXPECT_NEAR(l / rest, 1, 1e-4) << e;
  }
}

// Momentum of a free tree is kept.
TEST(TreeElimination, KeepsMomentum) {
  test::SolverScene scene = branched(false);
  scene.body.position[0].w = 20;
  scene.use({});
  displace(scene);
  const std::vector<Vec4f> predicted = scene.body.offset;
  scene.solve_from_start();
  Vec3d sum{};
  double all = 0;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const Vec3d m = (Vec3d(scene.body.offset[i].xyz()) - Vec3d(predicted[i].xyz())) *
                    (1 / static_cast<double>(scene.body.position[i].w));
    sum += m, all += length(m);
  }
  EXPECT_LT(length(sum), 1e-5 * all);
}

// Coincident particles, crumpled links and positions far beyond a link's length stay finite and come back.
TEST(TreeElimination, RecoversFromAnyState) {
  for (const float size : {0.0f, 1e-12f, 0.05f, 5.0f}) {
    test::SolverScene scene = branched();
    for (std::size_t i = 1; i < scene.body.position.size(); ++i)
      scene.body.position[i].set_xyz(
          {size * static_cast<float>(std::sin(7 * i)), size * static_cast<float>(i % 2), 0});
    scene.damping = 0.9f;
    scene.use({});
    for (int k = 0; k < 3000; ++k) scene.step();
    const auto& set = dynamic_cast<const SetProjector<Distance>&>(*scene.projectors[0]);
    for (std::size_t e = 0; e < set.size(); ++e) {
      const auto [a, b] = set.set().indices(e);
      const double l = length(at(scene, scene.body.offset, a) - at(scene, scene.body.offset, b));
      ASSERT_TRUE(std::isfinite(l));
      if (size > 0) {
        EXPECT_LT(l, 1.2 * static_cast<double>(set.set().params(e).rest_length)) << size << ' ' << e;
      }
    }
  }
}

TEST(TreeElimination, HasEqualBitsOnAnyNumberOfThreads) {
  std::vector<std::vector<Vec4f>> results;
  for (const int threads : {1, 2, 3}) {
    test::SolverScene scene;
    auto& distances = scene.add<Distance>();
    for (std::uint32_t rope = 0; rope < 40; ++rope)
      for (std::uint32_t i = 0; i < 5 + rope; ++i) {
        scene.add({0.1 * i, 0, 1.0 * rope}, i == 0 ? 0 : 0.01 * (1 + (i + rope) % 7));
        const auto last = static_cast<std::uint32_t>(scene.body.position.size() - 1);
        if (i > 0) distances.add({last - 1, last}, {0.1f}, {1e-6f});
      }
    scene.gravity = {0, -9.81f, 0};
    scene.threads = make_threads(Threading::pool, threads);
    scene.use({});
    for (int k = 0; k < 30; ++k) scene.step();
    results.push_back(scene.body.position);
    for (std::size_t i = 0; i < results[0].size(); ++i)
      ASSERT_EQ(results.back()[i].xyz(), results[0][i].xyz());
  }
}

}  // namespace souple::test_solver_tree_elimination
