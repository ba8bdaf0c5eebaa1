#include "souple/constraints/distance.h"
#include "souple/constraints/triangle_membrane.h"
#include "souple/multilevel/hierarchical.h"
#include "souple/multilevel/level_cache.h"
#include "souple/solver/gauss_seidel.h"
#include "souple/solver/set_projector.h"
#include "souple/studies/make_solver.h"
#include "tests/solver/body.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <functional>
#include <memory>

#include <gtest/gtest.h>

namespace souple::test_solver_hierarchical {

/// A square cloth, 2 m wide, 0.2 kg/m^2, in the XY plane if `hangs`, else in the XZ plane. It has distances
/// along the edges of its triangles and, if `across`, across interior edges.
struct Sheet {
  int side;
  test::Body body;
  std::vector<Vec4f> velocity;
  SetProjector<Distance> distances;
  std::vector<Projector*> projectors;  ///< empty: the distances

  Sheet(int n, bool hangs, float alpha = 0, bool across = true) : side(n) {
    const double l = 2.0 / (n - 1), mass = 0.8 / (n * n);
    for (int row = 0; row < n; ++row)
      for (int column = 0; column < n; ++column)
        body.add({column * l, hangs ? -row * l : 0, hangs ? 0 : row * l}, static_cast<float>(1 / mass));
    velocity.resize(body.position.size());
    const int steps[6][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 1}, {1, 2}};
    for (int k = 0; k < (across ? 6 : 3); ++k)
      for (int row = 0; row < n; ++row)
        for (int column = 0; column < n; ++column) {
          const int to_column = column + steps[k][0], to_row = row + steps[k][1];
          if (to_column >= n || to_row >= n || to_row < 0) continue;
          distances.add({at(row, column), at(to_row, to_column)},
                        {static_cast<float>(l * std::hypot(steps[k][0], steps[k][1]))}, {alpha});
        }
    distances.prepare(body.position.size());
  }
  std::uint32_t at(int row, int column) const { return static_cast<std::uint32_t>(row * side + column); }
  void pin_first_row() {
    for (int column = 0; column < side; ++column) body.position[at(0, column)].w = 0;
  }
  void scale(float x, float y, float z) {
    for (Vec4f& p : body.position) p = {p.x * x, p.y * y, p.z * z, p.w};
    body.start = body.offset;
  }

  struct Strain {
    double mean = 0, largest = 0;  ///< of |strain|; of extension
  };
  Strain strain() {
    Strain result;
    const ParticleView view = body.view();
    for (std::size_t i = 0; i < distances.size(); ++i) {
      const auto [a, b] = distances.set().indices(i);
      const double s =
          static_cast<double>(length(view.difference(a, b)) / distances.set().params(i).rest_length) - 1;
      result.mean += std::fabs(s) / static_cast<double>(distances.size());
      result.largest = std::max(result.largest, s);
    }
    return result;
  }

  /// Predicts positions, solves, and updates velocities.
  void substep(Solver& solver, const Substep& of, float gravity, Threads& threads) {
    std::vector<Vec4f>& p = body.offset;
    for (std::size_t i = 0; i < p.size(); ++i) {
      body.start[i] = p[i];
      if (body.position[i].w == 0) continue;
      velocity[i].y -= gravity * of.h;
      p[i].set_xyz(p[i].xyz() + velocity[i].xyz() * of.h);
    }
    const std::vector<Projector*> all = projectors.empty() ? std::vector<Projector*>{&distances} : projectors;
    const ParticleView view = body.view();
    for (Projector* projector : all) projector->begin_substep(view, of);
    solver.solve(all, view, of, threads);
    for (std::size_t i = 0; i < p.size(); ++i) {
      velocity[i].set_xyz((p[i].xyz() - body.start[i].xyz()) / of.h);
      const Vec3f x = body.position[i].xyz(), q = p[i].xyz(), moved = x + q;
      body.position[i].set_xyz(moved);
      p[i].set_xyz(q - (moved - x));
    }
  }
  void frame(Solver& solver, int substeps, float gravity, Threads& threads) {
    Substep of{.h = 1.0f / 60 / static_cast<float>(substeps), .count = substeps};
    for (int i = 0; i < substeps; ++i) substep(solver, of, gravity, threads);
  }
  /// Kinetic and potential energy. [J]
  double energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < velocity.size(); ++i)
      if (body.position[i].w > 0)
        sum += body.mass(i) *
               (0.5 * static_cast<double>(dot(velocity[i].xyz(), velocity[i].xyz())) + 9.81 * body.at(i).y);
    return sum;
  }
  double lowest() const {
    double result = 0;
    for (std::size_t i = 0; i < velocity.size(); ++i) result = std::min(result, body.at(i).y);
    return result;
  }
};

std::unique_ptr<Threads> serial() {
  return make_threads(Threading::serial, 1);
}

std::unique_ptr<Hierarchical> prepared(Sheet& sheet) {
  auto solver = std::make_unique<Hierarchical>();
  Projector* const projectors[] = {&sheet.distances};
  sheet.distances.prepare_sweeps(sheet.body.view(), true);
  solver->prepare(projectors, sheet.body.view());
  return solver;
}

/// Number of sweeps over the finest constraints that project as many constraints as one iteration.
double cost(const Hierarchical& solver, const Sheet& sheet) {
  return 1 + static_cast<double>(solver.coarse_projections()) / static_cast<double>(sheet.distances.size());
}

std::vector<Link> links_of(const Sheet& sheet) {
  std::vector<Link> links;
  for (std::size_t i = 0; i < sheet.distances.size(); ++i) {
    const auto [a, b] = sheet.distances.set().indices(i);
    links.push_back({a, b, sheet.distances.set().params(i).rest_length, 1, 1});
  }
  return links;
}

// Thousands of triangles share one edge, as in a damaged file or a thick book.
TEST(HierarchicalLevels, ManyTrianglesAtOneEdgeTakeTimeInProportion) {
  const auto seconds_for = [](std::uint32_t count) {
    std::vector<Link> links{{0, 1, 1, 1, 1}};
    for (std::uint32_t end = 0; end < 2; ++end)
      for (std::uint32_t i = 0; i < count; ++i) links.push_back({end, i + 2, 1.1f, 1, 1});
    const std::vector<float> masses(count + 2, 1.0f);
    const std::clock_t start = std::clock();
    const std::vector<CoarseLevel> levels = build_levels(links, masses, 24, *serial());
    EXPECT_LT(levels.front().finer.size(), masses.size());
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  const double eighth = seconds_for(2500), all = seconds_for(20000);
  EXPECT_LT(all, 24 * eighth + 0.1);  // 8 times if linear, 64 if quadratic
}

TEST(HierarchicalLevels, EveryParticleFollowsCoarseOnesByWeightsOfSumOne) {
  for (const bool across : {false, true}) {
    const Sheet sheet(60, true, 0, across);
    std::vector<float> masses(sheet.body.position.size(), 2.0f);
    for (std::size_t column = 0; column < 60; ++column) masses[column] = 0;
    const std::vector<CoarseLevel> levels = build_levels(links_of(sheet), masses, 24, *serial());
    ASSERT_GE(levels.size(), 3u);
    for (const CoarseLevel& level : levels) {
      EXPECT_LT(level.finer.size(), masses.size() / 2);
      double followed = 0;
      for (std::size_t i = 0; i < masses.size(); ++i) {
        ASSERT_LT(level.parent_begin[i], level.parent_begin[i + 1]) << "particle " << i << " follows none";
        double sum = 0;
        for (std::uint32_t k = level.parent_begin[i]; k < level.parent_begin[i + 1]; ++k) {
          EXPECT_GE(level.weight[k], 0);
          sum += static_cast<double>(level.weight[k]);
          if (level.mass[level.parent[k]] > 0)
            followed += static_cast<double>(level.weight[k]) * static_cast<double>(masses[i]);
          if (masses[i] == 0) {
            EXPECT_EQ(level.mass[level.parent[k]], 0) << "a pinned particle follows a free one";
          }
        }
        EXPECT_NEAR(sum, 1, 1e-6);
      }
      double mass = 0;
      for (std::size_t j = 0; j < level.finer.size(); ++j) {
        mass += static_cast<double>(level.mass[j]);
        double child_weight = 0;
        for (std::uint32_t k = level.child_begin[j]; k < level.child_begin[j + 1]; ++k)
          child_weight += static_cast<double>(level.child_weight[k]);
        EXPECT_NEAR(child_weight, 1, 1e-5);
        EXPECT_EQ(level.mass[j] > 0, masses[level.finer[j]] > 0);
      }
      EXPECT_NEAR(mass, followed, 1e-5 * mass) << "the mass of the followers is not conserved";
      masses = level.mass;
    }
  }
}

TEST(HierarchicalLevels, RestLengthsAreThoseOfTheFlatSheetHoweverItIsCut) {
  // Rest lengths of coarse links follow from finer links alone, across the sheet's triangles.
  const Sheet sheet(60, true, 0, false);
  const std::vector<float> masses(sheet.body.position.size(), 1.0f);
  const std::vector<CoarseLevel> levels = build_levels(links_of(sheet), masses, 24, *serial());
  std::vector<std::uint32_t> particle(masses.size());
  for (std::uint32_t i = 0; i < particle.size(); ++i) particle[i] = i;
  for (const CoarseLevel& level : levels) {
    std::vector<std::uint32_t> coarse;
    for (const std::uint32_t i : level.finer) coarse.push_back(particle[i]);
    double error = 0;
    for (const Link& link : level.links) {
      const double straight = length(sheet.body.at(coarse[link.a]) - sheet.body.at(coarse[link.b]));
      error += (static_cast<double>(link.length) / straight - 1) / static_cast<double>(level.links.size());
    }
    EXPECT_NEAR(error, 0, 0.01) << level.finer.size() << " particles";
    particle = coarse;
  }
  ASSERT_FALSE(levels.empty());
}

TEST(HierarchicalLevels, AUniformStretchIsHandedDownInside) {
  const Sheet sheet(60, true);
  const std::vector<float> masses(sheet.body.position.size(), 1.0f);
  const CoarseLevel level = build_levels(links_of(sheet), masses, 24, *serial()).front();
  double error = 0;
  for (std::uint32_t i = 0; i < masses.size(); ++i) {
    Vec3d position{};
    for (std::uint32_t k = level.parent_begin[i]; k < level.parent_begin[i + 1]; ++k)
      position += sheet.body.at(level.finer[level.parent[k]]) * static_cast<double>(level.weight[k]);
    error += length(position - sheet.body.at(i)) / static_cast<double>(masses.size());
  }
  EXPECT_LT(error, 0.1 * 2 / 59) << "the mean error exceeds a tenth of a cell";
}

/// Links and masses of sheets of n x n particles, one after the other.
struct Sheets {
  std::vector<Link> links;
  std::vector<float> masses;

  void add(int n, float mass) {
    const auto first = static_cast<std::uint32_t>(masses.size());
    std::vector<Link> own = links_of(Sheet(n, false));
    for (Link& link : own)
      link = {std::min(link.a, link.b) + first, std::max(link.a, link.b) + first, link.length, 1, 1};
    std::sort(own.begin(), own.end(),
              [](const Link& p, const Link& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
    links.insert(links.end(), own.begin(), own.end());
    masses.resize(masses.size() + static_cast<std::size_t>(n * n), mass);
    masses[first] = 0;
  }
};

void expect_equal(const std::vector<CoarseLevel>& one, const std::vector<CoarseLevel>& other) {
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t l = 0; l < one.size(); ++l) {
    EXPECT_EQ(one[l].finer, other[l].finer);
    EXPECT_EQ(one[l].links, other[l].links);
    EXPECT_EQ(one[l].path_begin, other[l].path_begin);
    EXPECT_EQ(one[l].path, other[l].path);
    EXPECT_EQ(one[l].parent_begin, other[l].parent_begin);
    EXPECT_EQ(one[l].parent, other[l].parent);
    EXPECT_EQ(one[l].weight, other[l].weight);
    EXPECT_EQ(one[l].child_begin, other[l].child_begin);
    EXPECT_EQ(one[l].child, other[l].child);
    EXPECT_EQ(one[l].child_weight, other[l].child_weight);
    EXPECT_EQ(one[l].mass, other[l].mass);
    EXPECT_EQ(one[l].energy_to, other[l].energy_to);
  }
}

TEST(HierarchicalLevels, DoNotDependOnThreads) {
  const Sheet sheet(80, true);
  std::vector<float> masses(sheet.body.position.size(), 1.0f);
  masses[0] = masses[79] = masses[80 * 40 + 40] = 0;
  expect_equal(build_levels(links_of(sheet), masses, 24, *serial()),
               build_levels(links_of(sheet), masses, 24, *make_threads(Threading::pool, 3)));
}

/// Those whose levels are joined.
Sheets sheets_of(const Sheets& all, const JoinedLevels& joined) {
  Sheets result;
  for (std::size_t b = 0; b < joined.particles.size(); ++b) {
    const auto offset = static_cast<std::uint32_t>(joined.particles[b].begin - result.masses.size());
    for (std::size_t i = joined.particles[b].begin; i < joined.particles[b].end; ++i)
      result.masses.push_back(all.masses[i]);
    for (std::size_t e = joined.links[b].begin; e < joined.links[b].end; ++e) {
      result.links.push_back(all.links[e]);
      result.links.back().a -= offset, result.links.back().b -= offset;
    }
  }
  return result;
}

// Sheets come, go and get heavier; two are alike.
TEST(LevelCache, GivesTheLevelsThatAreBuiltFromScratch) {
  LevelCache cache;
  const auto threads = make_threads(Threading::pool, 3);
  const std::vector<std::vector<std::pair<int, float>>> worlds = {
      {{30, 1.0f}}, {{12, 1.0f}, {30, 1.0f}, {12, 1.0f}}, {{30, 2.0f}, {70, 1.0f}}, {{12, 1.0f}}, {}};
  for (const auto& world : worlds) {
    Sheets sheets;
    for (const auto& [n, mass] : world) sheets.add(n, mass);
    std::size_t found = 0;
    for (const JoinedLevels& joined : cache.build(sheets.links, sheets.masses, 24, *threads)) {
      const Sheets own = sheets_of(sheets, joined);
      std::vector<CoarseLevel> expected = build_levels(own.links, own.masses, 24, *threads);
      ASSERT_GE(expected.size(), joined.levels.size());
      expected.resize(joined.levels.size());
      expect_equal(joined.levels, expected);
      EXPECT_LE(joined.levels.back().mass.size(), 24 * joined.particles.size());
      found += joined.particles.size();
    }
    EXPECT_EQ(found, world.size());
  }
}

/// The particles after some frames: of a solver that was prepared for the sheet that `before` makes, or never saw it.
template <class Change>
std::vector<Vec4f> moved_after(bool is_prepared_before, const Change& before, const Change& after) {
  const auto threads = serial();
  Sheet sheet(40, false);
  sheet.pin_first_row();
  std::unique_ptr<Hierarchical> solver;
  if (is_prepared_before) before(sheet), solver = prepared(sheet);
  after(sheet);
  sheet.distances.prepare_sweeps(sheet.body.view(), true);
  Projector* const projectors[] = {&sheet.distances};
  if (!solver) solver = prepared(sheet);
  solver->prepare(projectors, sheet.body.view());
  for (int frame = 0; frame < 5; ++frame) sheet.frame(*solver, 4, 9.81f, *threads);
  return sheet.body.position;
}

// A cloth that gets heavier, and a vertex that is pinned and freed, have the levels that a solver builds from scratch.
TEST(Hierarchical, AnotherDensityAndPinsThatComeAndGoLeaveNoTrace) {
  using Change = std::function<void(Sheet&)>;
  const Change nothing = [](Sheet&) {};
  const Change heavier = [](Sheet& sheet) {
    for (Vec4f& x : sheet.body.position) x.w *= 0.3f;
  };
  const Change pin = [](Sheet& sheet) { sheet.body.position[20 * 40 + 20].w = 0; };
  const Change free = [](Sheet& sheet) {
    sheet.body.position[20 * 40 + 20].w = sheet.body.position[20 * 40 + 21].w;
  };
  for (const auto& [before, after] : {std::pair{nothing, heavier}, {pin, free}}) {
    const std::vector<Vec4f> once = moved_after(false, before, after),
                             twice = moved_after(true, before, after);
    EXPECT_EQ(std::memcmp(once.data(), twice.data(), once.size() * sizeof(Vec4f)), 0);
  }
}

TEST(Hierarchical, StretchedClothConvergesFiveTimesFaster) {
  // A stretch of 10 % along the cloth, first row pinned, no gravity: the slowest case of Gauss-Seidel.
  Sheet stretched(100, false);
  stretched.pin_first_row();
  stretched.scale(1, 1, 1.1f);
  const auto threads = serial();
  const Substep rest{.h = 1};
  for (const double target : {0.05, 0.01}) {
    Sheet fast = stretched, slow = stretched;
    const auto solver = prepared(fast);
    int cycles = 0;
    for (; fast.strain().mean > target && cycles < 100; ++cycles) {
      std::fill(fast.velocity.begin(), fast.velocity.end(), Vec4f{});
      fast.substep(*solver, rest, 0, *threads);
    }
    ASSERT_LT(cycles, 20) << target;
    GaussSeidel gauss_seidel;
    const int sweeps = static_cast<int>(5 * cycles * cost(*solver, fast));
    for (int i = 0; i < sweeps; ++i) {
      std::fill(slow.velocity.begin(), slow.velocity.end(), Vec4f{});
      slow.substep(gauss_seidel, rest, 0, *threads);
    }
    EXPECT_GT(slow.strain().mean, target) << "Gauss-Seidel after five times as many projections: " << sweeps;
  }
}

TEST(Hierarchical, HangingClothIsStiffAtFourSubsteps) {
  const auto threads = serial();
  Sheet fast(100, true), slow(100, true);
  fast.pin_first_row(), slow.pin_first_row();
  const auto solver = prepared(fast);
  GaussSeidel gauss_seidel;
  for (int i = 0; i < 60; ++i) {
    fast.frame(*solver, 4, 9.81f, *threads);
    slow.frame(gauss_seidel, static_cast<int>(std::ceil(4 * cost(*solver, fast))), 9.81f, *threads);
  }
  EXPECT_LT(fast.strain().largest, 0.02);
  EXPECT_GT(slow.strain().largest, 0.1) << "Gauss-Seidel with as many projections, in more substeps";
}

/// A cloth swings down from horizontal for `seconds`; its energy must not increase.
void expect_no_explosion(int side, int substeps, bool across, double seconds) {
  const auto threads = serial();
  Sheet sheet(side, false, 0, across);
  sheet.pin_first_row();
  const auto solver = prepared(sheet);
  double highest = 0, stretch = 0, lowest = 0;
  for (int frame = 0; frame < static_cast<int>(60 * seconds); ++frame) {
    sheet.frame(*solver, substeps, 9.81f, *threads);
    lowest = std::min(lowest, sheet.lowest());
    if (frame % 10) continue;
    highest = std::max(highest, sheet.energy());
    stretch = std::max(stretch, sheet.strain().mean);
  }
  EXPECT_LT(highest, 0.01 * 0.8 * 9.81) << "J above the initial energy, 1 % of m g times a meter";
  EXPECT_LT(stretch, 0.03);
  EXPECT_LT(lowest, -1.9) << "the cloth did not fall";
  EXPECT_GT(lowest, -2.1);
}

TEST(Hierarchical, SwingingClothsDoNotExplode) {
  expect_no_explosion(50, 4, true, 10);
  expect_no_explosion(50, 2, true, 10);
  expect_no_explosion(50, 10, false, 5);
}
TEST(Hierarchical, SwingingClothOf100DoesNotExplodeSlow) {
  expect_no_explosion(100, 4, true, 10);
  expect_no_explosion(100, 10, false, 10);
}
TEST(Hierarchical, SwingingClothOf200DoesNotExplodeSlow) {
  expect_no_explosion(200, 4, true, 10);
}

TEST(Hierarchical, ASoftClothKeepsItsCompliance) {
  // Mean length over one second of oscillation, compared with Gauss-Seidel at 200 substeps, which is
  // converged.
  const auto mean_drop = [](Solver& solver, Sheet& sheet, int substeps) {
    const auto threads = serial();
    double sum = 0;
    for (int frame = 0; frame < 180; ++frame) {
      sheet.frame(solver, substeps, 9.81f, *threads);
      for (Vec4f& v : sheet.velocity) v = {v.x * 0.9f, v.y * 0.9f, v.z * 0.9f, 0};
      if (frame >= 120) sum -= sheet.lowest() / 60;
    }
    return sum - 2;
  };
  for (const float alpha : {0.01f, 0.05f}) {
    Sheet reference(30, true, alpha);
    reference.pin_first_row();
    GaussSeidel gauss_seidel;
    const double expected = mean_drop(gauss_seidel, reference, 200);
    for (const int substeps : {4, 10, 30}) {
      Sheet sheet(30, true, alpha);
      sheet.pin_first_row();
      const auto solver = prepared(sheet);
      EXPECT_NEAR(mean_drop(*solver, sheet, substeps) / expected, 1, 0.03) << alpha << ", " << substeps;
    }
  }
}

TEST(Hierarchical, AFoldedClothIsLeftAlone) {
  // Folded in three along rows: all edges have their rest length, so no particle may move, although coarse
  // particles are near each other.
  Sheet sheet(60, false, 0, false);
  for (Vec4f& p : sheet.body.position) {
    const float l = 2.0f / 59, z = p.z, third = 20 * l;
    if (z > third) p.z = 2 * third - z, p.y = 0.01f * l;
    if (z > 2 * third) p.z = z - 2 * third, p.y = 0.02f * l;
  }
  sheet.body.start = sheet.body.offset;
  const std::vector<Vec3d> before = sheet.body.all();
  const auto solver = prepared(sheet);
  sheet.substep(*solver, {.h = 0.01f}, 0, *serial());
  double farthest = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    farthest = std::max(farthest, length(sheet.body.at(i) - before[i]));
  EXPECT_LT(farthest, 1e-5);
}

TEST(Hierarchical, AFreeClothKeepsItsMomentum) {
  Sheet sheet(50, false);
  for (std::size_t i = 0; i < sheet.velocity.size(); ++i) sheet.velocity[i].set_xyz(Vec3f(test::scatter3(i)));
  const auto momentum = [&] {
    Vec3d sum{};
    for (std::size_t i = 0; i < sheet.velocity.size(); ++i)
      sum += Vec3d(sheet.velocity[i].xyz()) * sheet.body.mass(i);
    return sum;
  };
  const auto solver = prepared(sheet);
  const Vec3d before = momentum();
  for (int frame = 0; frame < 30; ++frame) sheet.frame(*solver, 4, 0, *serial());
  const double scale = 0.8 * 1;  // kg m/s
  EXPECT_LT(length(momentum() - before), 1e-4 * scale);
}

TEST(Hierarchical, ResultsDoNotDependOnThreads) {
  std::vector<Vec4f> results[2];
  for (const int count : {1, 3}) {
    Sheet sheet(80, false);
    sheet.pin_first_row();
    const auto solver = prepared(sheet);
    const auto threads = make_threads(count > 1 ? Threading::pool : Threading::serial, count);
    for (int frame = 0; frame < 10; ++frame) sheet.frame(*solver, 4, 9.81f, *threads);
    results[count > 1] = sheet.body.position;
  }
  EXPECT_EQ(std::memcmp(results[0].data(), results[1].data(), results[0].size() * sizeof(Vec4f)), 0);
}

TEST(Hierarchical, MembranesAreStiffToo) {
  const auto threads = serial();
  const int n = 60;
  const auto longest_drop = [&](bool hierarchical) {
    Sheet sheet(n, true);
    sheet.pin_first_row();
    SetProjector<TriangleMembrane> membranes;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      const Vec3d x[3] = {sheet.body.at(a), sheet.body.at(b), sheet.body.at(c)};
      membranes.add({a, b, c}, TriangleMembrane::from_rest(x, {1, 0, 0}),
                    TriangleMembrane::compliance(1e6, 1e6, 0.3, 4e5, 2.0 / (n - 1) / (n - 1)));
    };
    for (int row = 0; row + 1 < n; ++row)
      for (int column = 0; column + 1 < n; ++column) {
        add(sheet.at(row, column), sheet.at(row, column + 1), sheet.at(row + 1, column + 1));
        add(sheet.at(row, column), sheet.at(row + 1, column + 1), sheet.at(row + 1, column));
      }
    membranes.prepare(sheet.body.position.size());
    sheet.projectors = {&membranes};
    const std::unique_ptr<Solver> solver =
        make_solver({.kind = hierarchical ? SolverKind::hierarchical : SolverKind::gauss_seidel});
    solver->prepare(sheet.projectors, sheet.body.view());
    for (int frame = 0; frame < 60; ++frame) sheet.frame(*solver, 4, 9.81f, *threads);
    return -sheet.lowest() - 2;
  };
  EXPECT_LT(longest_drop(true), 0.01);
  EXPECT_GT(longest_drop(false), 0.05) << "Gauss-Seidel";
}

TEST(Hierarchical, WithoutLinksItSaysThatItIsGaussSeidel) {
  Hierarchical solver;
  test::Body body;
  body.add({0, 0, 0}, 1);
  solver.prepare({}, body.view());
  EXPECT_NE(solver.diagnostic().find("Gauss-Seidel"), std::string::npos);
  solver.solve({}, body.view(), {.h = 0.01f}, *serial());
  Sheet sheet(10, true);
  EXPECT_EQ(prepared(sheet)->diagnostic(), "");
}

}  // namespace souple::test_solver_hierarchical
