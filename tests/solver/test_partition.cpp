#include "souple/constraints/distance.h"
#include "souple/constraints/neo_hookean.h"
#include "souple/solver/set_projector.h"
#include "souple/studies/make_solver.h"
#include "souple/studies/partition.h"
#include "souple/world/world.h"
#include "tests/solver/body.h"
#include "tests/solver/meshes_to_color.h"

#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>

namespace souple::test_solver_partition {

using test::Body;
using test::ColorCase;

/// Constraints of a mesh, colored and sorted by color.
struct Colored {
  ColorCase of;
  std::vector<std::uint32_t> color_begin;

  explicit Colored(const ColorCase& given) : of(given) {
    const Coloring coloring = color_constraints(given.indices, given.arity, given.particles);
    color_begin = coloring.color_begin;
    of.indices.clear();
    for (const std::uint32_t i : coloring.order)
      of.indices.insert(of.indices.end(), given.constraint(i).begin(), given.constraint(i).end());
  }
  Partition partition(int colors) const {
    return partition_constraints(of.indices, of.arity, of.particles, color_begin, colors,
                                 static_cast<std::uint32_t>(of.particles));
  }
};

std::vector<Colored> meshes() {
  std::vector<Colored> result;
  for (const ColorCase& of : test::meshes_to_color(60)) result.emplace_back(of);
  return result;
}

std::size_t color_count(const Partition& partition) {
  return partition.coloring.color_begin.size() - 1;
}

// Each constraint occurs once and has its particles or their phantoms; none occurs twice in a color.
void expect_valid(const ColorCase& of, const Partition& partition) {
  SCOPED_TRACE(of.name);
  const auto width = static_cast<std::size_t>(of.arity);
  ASSERT_EQ(partition.coloring.order.size(), of.count());
  ASSERT_EQ(partition.coloring.color_begin.back(), of.count());
  ASSERT_EQ(partition.indices.size(), of.indices.size());
  std::vector<int> seen(of.count());
  std::vector<std::size_t> last_color(of.particles + partition.phantom_of.size());
  for (std::size_t c = 0; c < color_count(partition); ++c) {
    EXPECT_LT(partition.coloring.color_begin[c], partition.coloring.color_begin[c + 1]);
    for (std::size_t k = partition.coloring.color_begin[c]; k < partition.coloring.color_begin[c + 1]; ++k) {
      const std::uint32_t i = partition.coloring.order[k];
      ++seen.at(i);
      for (std::size_t corner = 0; corner < width; ++corner) {
        const std::uint32_t index = partition.indices[k * width + corner];
        const std::uint32_t particle =
            index < of.particles ? index : partition.phantom_of.at(index - of.particles);
        ASSERT_EQ(particle, of.constraint(i)[corner]);
        ASSERT_NE(last_color[index], c + 1) << "color " << c << " has " << index << " twice";
        last_color[index] = c + 1;
      }
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(of.count()));
}

// A split particle has two or more phantoms, whose numbers of constraints differ by at most one, and no
// constraint itself.
void expect_balanced(const ColorCase& of, const Partition& partition) {
  const std::vector<std::uint32_t>& phantom_of = partition.phantom_of;
  EXPECT_TRUE(std::is_sorted(phantom_of.begin(), phantom_of.end()));
  std::vector<int> constraint_count(of.particles + phantom_of.size());
  for (const std::uint32_t index : partition.indices) ++constraint_count[index];
  for (std::size_t begin = 0, end = 0; begin < phantom_of.size(); begin = end) {
    while (end < phantom_of.size() && phantom_of[end] == phantom_of[begin]) ++end;
    EXPECT_GE(end - begin, 2u);
    EXPECT_EQ(constraint_count[phantom_of[begin]], 0);
    const auto first = constraint_count.begin() + static_cast<std::ptrdiff_t>(of.particles);
    const auto [least, most] = std::minmax_element(first + static_cast<std::ptrdiff_t>(begin),
                                                   first + static_cast<std::ptrdiff_t>(end));
    EXPECT_GE(*least, 1);
    EXPECT_LE(*most - *least, 1);
  }
}

TEST(Partition, AsManyColorsAsAskedFor) {
  for (const Colored& mesh : meshes())
    for (int colors = 1; colors <= 8; ++colors) {
      const Partition partition = mesh.partition(colors);
      EXPECT_EQ(color_count(partition),
                std::min(mesh.color_begin.size() - 1, static_cast<std::size_t>(colors)));
      expect_valid(mesh.of, partition);
      expect_balanced(mesh.of, partition);
    }
}

// A particle with n constraints needs n / colors copies, rounded up, and seldom gets more.
TEST(Partition, FewPhantoms) {
  for (const Colored& mesh : meshes())
    for (const std::size_t colors : {2u, 4u, 6u}) {
      std::vector<std::size_t> degree(mesh.of.particles);
      for (const std::uint32_t particle : mesh.of.indices) ++degree[particle];
      std::size_t min_phantoms = 0;
      for (const std::size_t n : degree) min_phantoms += n > colors ? (n + colors - 1) / colors : 0;
      const Partition partition = mesh.partition(static_cast<int>(colors));
      EXPECT_LE(partition.phantom_of.size(), 3 * min_phantoms / 2 + mesh.of.particles * 5 / 4)
          << mesh.of.name << ", " << colors;
    }
}

TEST(Partition, NothingIsSplitWhereColorsSuffice) {
  for (const Colored& mesh : meshes()) {
    const Partition partition = mesh.partition(static_cast<int>(mesh.color_begin.size() - 1));
    EXPECT_TRUE(partition.phantom_of.empty());
    EXPECT_EQ(partition.indices, mesh.of.indices);
    EXPECT_EQ(partition.coloring.color_begin, mesh.color_begin);
  }
}

TEST(Partition, Stars) {
  for (const std::uint32_t rays : {5u, 64u, 200u, 20000u}) {
    const Colored star(test::star(rays));
    const Partition partition = star.partition(4);
    EXPECT_EQ(color_count(partition), 4u);
    EXPECT_EQ(partition.phantom_of.size(), (rays + 3) / 4);
    expect_valid(star.of, partition);
    expect_balanced(star.of, partition);
  }
}

TEST(Partition, Nothing) {
  const std::vector<std::uint32_t> no_color{0};
  const Partition partition = partition_constraints({}, 2, 5, no_color, 3, 5);
  EXPECT_EQ(partition.coloring.color_begin, no_color);
  EXPECT_TRUE(partition.phantom_of.empty());
}

/// Divides every range into parts of three and calls them last to first.
class BackwardThreads final : public Threads {
 public:
  int count() const override { return 3; }
  void for_each(std::size_t n, std::size_t, RangeFunction f) override {
    for (std::size_t begin = n - n % 3; n > 0; begin -= 3) {
      if (begin < n) f(begin, std::min(begin + 3, n));
      if (begin == 0) break;
    }
  }
};

// A bar of tets with springs on all its edges. Masses are uneven, positions perturbed.
struct Wobbly {
  Body body;
  SetProjector<NeoHookean> tets;
  SetProjector<Distance> links;
  std::vector<Projector*> projectors{&links, &tets};

  // `bent`: maximum perturbation along each axis [m].
  Wobbly(float compliance, double bent) {
    const TetMesh bar = tet_bar(8, 3, 3, {1.6, 0.6, 0.6});
    for (std::size_t i = 0; i < bar.positions.size(); ++i)
      body.add(bar.positions[i] + test::scatter3(i) * bent, static_cast<float>(2 + test::scatter(1000 + i)));
    for (const Edge& edge : unique_edges(bar.tets))
      links.add(edge, {static_cast<float>(length(bar.positions[edge[0]] - bar.positions[edge[1]]))},
                {compliance});
    for (const Tet& tet : bar.tets) {
      const Vec3d x[4] = {bar.positions[tet[0]], bar.positions[tet[1]], bar.positions[tet[2]],
                          bar.positions[tet[3]]};
      tets.add(tet, NeoHookean::from_rest(x), NeoHookean::compliance(1e5, 0.3, 0.001));
    }
    for (Projector* projector : projectors) projector->prepare(body.position.size());
  }

  void solve(const SolverSettings& settings, const Substep& substep, Threads& threads) {
    const std::unique_ptr<Solver> solver = make_solver(settings);
    solver->prepare(projectors, body.view());
    for (Projector* projector : projectors) projector->begin_substep(body.view(), substep);
    solver->solve(projectors, body.view(), substep, threads);
  }
  void solve(const SolverSettings& settings, const Substep& substep) {
    const std::unique_ptr<Threads> serial = make_threads(Threading::serial, 1);
    solve(settings, substep, *serial);
  }
};

double farthest(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  double result = 0;
  for (std::size_t i = 0; i < a.size(); ++i) result = std::max(result, length(a[i] - b[i]));
  return result;
}

Substep substep_of(int iterations) {
  return {.h = 1.0f / 600, .iterations = iterations, .mode = Mode::xpbd};
}

TEST(PartitionedGaussSeidel, KeepsMomentum) {
  for (const int colors : {1, 2, 3, 5, 8}) {
    Wobbly wobbly(1e-6f, 0.02);
    const std::vector<Vec3d> before = wobbly.body.all();
    wobbly.solve({.colors = colors}, substep_of(4));
    const test::Momentum momentum = test::momentum_of(wobbly.body, before);
    EXPECT_GT(momentum.linear_scale, 0.01);
    EXPECT_LT(length(momentum.linear), 1e-5 * momentum.linear_scale) << colors;
  }
}

// Multipliers accumulate along the gradients of each iteration. While gradients hardly rotate, the solution
// of a substep is unique, and phantoms do not change it. With perturbations of 1e-3 m on edges of 0.2 m,
// solutions agree within 2e-3 of the displacement.
TEST(PartitionedGaussSeidel, ConvergesToTheSameShape) {
  for (const float compliance : {0.0f, 1e-4f}) {
    const auto solved = [&](int colors) {
      Wobbly wobbly(compliance, 1e-3);
      wobbly.projectors = {&wobbly.links};
      wobbly.solve({.colors = colors}, substep_of(3000));
      return wobbly.body.all();
    };
    const std::vector<Vec3d> before = Wobbly(compliance, 1e-3).body.all(), whole = solved(0);
    const double moved = farthest(whole, before);
    EXPECT_GT(moved, 3e-4);
    for (const int colors : {1, 2, 3, 5, 8})
      EXPECT_LT(farthest(solved(colors), whole), 2e-3 * moved) << colors;
  }
}

template <class A, class B>
bool same_bits(const std::vector<A>& a, const std::vector<B>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(A)) == 0;
}

TEST(PartitionedGaussSeidel, ManyColorsAreGaussSeidel) {
  Wobbly whole(1e-6f, 0.02), split(1e-6f, 0.02);
  whole.solve({}, substep_of(3));
  split.solve({.colors = 64}, substep_of(3));
  EXPECT_TRUE(same_bits(whole.body.offset, split.body.offset));
}

TEST(PartitionedGaussSeidel, AnyThreadsAnyOrderOfParts) {
  for (const int colors : {1, 2, 5}) {
    Wobbly one(1e-6f, 0.02), other(1e-6f, 0.02);
    BackwardThreads threads;
    one.solve({.colors = colors}, substep_of(3));
    other.solve({.colors = colors}, substep_of(3), threads);
    EXPECT_TRUE(same_bits(one.body.offset, other.body.offset)) << colors;
  }
}

TEST(PartitionedGaussSeidel, PinnedParticlesStayAndMassesDo) {
  Wobbly wobbly(0, 0.02);
  for (const std::size_t i : {0u, 10u, 50u}) wobbly.body.position[i].w = 0;
  wobbly.body.start = wobbly.body.offset;
  const std::vector<Vec3d> before = wobbly.body.all();
  const std::vector<Vec4f> position = wobbly.body.position;
  wobbly.solve({.colors = 3}, substep_of(20));
  for (const std::size_t i : {0u, 10u, 50u}) EXPECT_EQ(length(wobbly.body.at(i) - before[i]), 0);
  for (std::size_t i = 0; i < position.size(); ++i) EXPECT_EQ(wobbly.body.position[i].w, position[i].w);
}

// Residuals and visitors name particles, never phantoms; the split of a set can be undone.
TEST(PartitionedGaussSeidel, SetsAreSplitAndMadeWhole) {
  Wobbly wobbly(1e-6f, 0.02);
  const int colors = wobbly.links.color_count();
  const std::vector<std::uint32_t> first = wobbly.links.set().records[0];
  const double before = wobbly.links.residual(wobbly.body.view()).sum;
  const auto count = static_cast<std::uint32_t>(wobbly.body.position.size());
  EXPECT_FALSE(split(wobbly.links, 3, count).empty());
  EXPECT_EQ(wobbly.links.color_count(), 3);
  EXPECT_NEAR(wobbly.links.residual(wobbly.body.view()).sum, before, 1e-6 * before);
  wobbly.links.visit(wobbly.body.view(), [&](const ConstraintState& state) {
    for (const std::uint32_t particle : state.particles) EXPECT_LT(particle, count);
  });
  wobbly.links.restore();
  EXPECT_EQ(wobbly.links.color_count(), colors);
  EXPECT_EQ(wobbly.links.set().records[0], first);
}

// A soft cloth, pinned by a row, that has swung down and come to rest, 7 % longer than before.
std::vector<Vec3d> hung(const SolverSettings& solver) {
  World world({.substeps = 5, .iterations = 10, .drag = 3, .solver = solver});
  const ObjectId cloth = world.add_cloth(grid(12, 12, 1), {.membrane_stiffness = 20});
  world.pin(cloth, in_box({-1, -1, -0.51f}, {1, 1, -0.49f}));
  for (int frame = 0; frame < 240; ++frame) world.step(1.0 / 60);
  return {world.positions(cloth).begin(), world.positions(cloth).end()};
}

TEST(PartitionedGaussSeidel, HangingClothComesToTheSameRest) {
  const std::vector<Vec3d> whole = hung({});
  double lowest = 0;
  for (const Vec3d& x : whole) lowest = std::min(lowest, x.y);
  EXPECT_NEAR(lowest, -1.04, 0.03);
  for (const int colors : {2, 6}) EXPECT_LT(farthest(hung({.colors = colors}), whole), 1e-3) << colors;
}

// `colors` changes during a run with contacts.
TEST(PartitionedGaussSeidel, IsTurnedOnAndOff) {
  World world({.substeps = 10});
  const ObjectId cloth = world.add_cloth(grid(20, 20, 1), ClothMaterial{});
  world.pin(cloth, in_box({-1, -1, -0.51f}, {1, 1, -0.49f}));
  world.add_collider(Sphere{.center = {0, -0.3f, 0}, .radius = 0.2f});
  for (const int colors : {0, 3, 7, 2, 0, 1}) {
    Settings settings = world.settings();
    settings.solver.colors = colors;
    world.set_settings(settings);
    for (int frame = 0; frame < 20; ++frame) {
      const StepReport& report = world.step(1.0 / 60);
      EXPECT_TRUE(report.ok());
      EXPECT_LT(report.largest_strain, 0.5) << colors;
    }
  }
}

}  // namespace souple::test_solver_partition
