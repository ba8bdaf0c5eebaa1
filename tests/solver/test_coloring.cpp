#include "souple/constraints/distance.h"
#include "souple/solver/coloring.h"
#include "souple/solver/set_projector.h"
#include "souple/world/world.h"
#include "tests/solver/meshes_to_color.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_solver_coloring {

using test::color_case;
using test::ColorCase;

std::size_t color_count(const Coloring& coloring) {
  return coloring.color_begin.size() - 1;
}

std::span<const std::uint32_t> color(const Coloring& coloring, std::size_t c) {
  return std::span(coloring.order)
      .subspan(coloring.color_begin[c], coloring.color_begin[c + 1] - coloring.color_begin[c]);
}

// Each constraint occurs once, no color is empty, and no particle occurs twice in a color.
void expect_valid(const ColorCase& of, const Coloring& coloring) {
  SCOPED_TRACE(of.name);
  ASSERT_EQ(coloring.order.size(), of.count());
  ASSERT_EQ(coloring.color_begin.front(), 0u);
  ASSERT_EQ(coloring.color_begin.back(), of.count());
  std::vector<int> seen(of.count());
  for (const std::uint32_t i : coloring.order) ++seen.at(i);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(of.count()));
  std::vector<std::size_t> last_color(of.particles, 0);
  for (std::size_t c = 0; c < color_count(coloring); ++c) {
    EXPECT_FALSE(color(coloring, c).empty());
    for (const std::uint32_t i : color(coloring, c))
      for (const std::uint32_t particle : of.constraint(i)) {
        ASSERT_NE(last_color[particle], c + 1) << "color " << c << " has particle " << particle << " twice";
        last_color[particle] = c + 1;
      }
  }
}

Coloring coloring_of(const ColorCase& of) {
  return color_constraints(of.indices, of.arity, of.particles);
}

TEST(Coloring, MeshesTakeFewColorsAndNoneIsTiny) {
  for (const ColorCase& of : test::meshes_to_color(200)) {
    const Coloring coloring = coloring_of(of);
    expect_valid(of, coloring);
    EXPECT_LE(color_count(coloring), of.max_colors) << of.name;
    const std::size_t mean = of.count() / color_count(coloring);
    for (std::size_t c = 0; c < color_count(coloring); ++c)
      EXPECT_GE(color(coloring, c).size(), std::min<std::size_t>(512, mean / 2)) << of.name;
  }
}

TEST(Coloring, NeighborsInAColorAreNeighborsInMemory) {
  for (const ColorCase& of : test::meshes_to_color(200)) {
    const Coloring coloring = coloring_of(of);
    for (std::size_t c = 0; c < color_count(coloring); ++c) {
      std::uint32_t before = 0;
      for (const std::uint32_t i : color(coloring, c)) {
        const auto own = of.constraint(i);
        const std::uint32_t lowest = *std::min_element(own.begin(), own.end());
        ASSERT_GE(lowest, before) << of.name;
        before = lowest;
      }
    }
  }
}

TEST(Coloring, ChainTakesTwoColors) {
  std::vector<Edge> chain;
  for (std::uint32_t i = 0; i < 100; ++i) chain.push_back({i, i + 1});
  const ColorCase of = color_case("chain", chain, 101, 2);
  const Coloring coloring = coloring_of(of);
  expect_valid(of, coloring);
  EXPECT_EQ(color_count(coloring), 2u);
}

TEST(Coloring, StarsTakeAColorForEachRay) {
  for (const std::uint32_t rays : {1u, 63u, 64u, 65u, 128u, 200u, 10000u}) {
    const ColorCase of = test::star(rays);
    const Coloring coloring = coloring_of(of);
    expect_valid(of, coloring);
    EXPECT_EQ(color_count(coloring), rays);
  }
}

// A hub connected to many vertices of a cloth does not make the cloth's colors smaller.
TEST(Coloring, HubInACloth) {
  const TriangleMesh cloth = grid(100, 100, 2);
  ColorCase of = color_case("hub", test::springs(cloth), cloth.positions.size(), 1020);
  for (std::uint32_t i = 1; i <= 1000; ++i) of.indices.insert(of.indices.end(), {0, 9 * i});
  const Coloring coloring = coloring_of(of);
  expect_valid(of, coloring);
  EXPECT_LE(color_count(coloring), of.max_colors);
  for (std::size_t c = 0; c < 16; ++c) EXPECT_GE(color(coloring, c).size(), 512u);
}

TEST(Coloring, ConstraintThatNamesAParticleTwice) {
  const ColorCase of =
      color_case("triangles", std::vector<Triangle>{{0, 0, 1}, {1, 1, 1}, {1, 2, 0}, {2, 2, 3}}, 4, 4);
  EXPECT_EQ(coloring_of(of).order.size(), 4u);
}

TEST(Coloring, Nothing) {
  const Coloring coloring = color_constraints({}, 4, 10);
  EXPECT_TRUE(coloring.order.empty());
  EXPECT_EQ(coloring.color_begin, std::vector<std::uint32_t>{0});
}

// The order of Gauss-Seidel determines stability: a rigid cloth whose constraints are solved vertex by vertex
// explodes within frames. With the colors of color_constraints it must come to rest.

struct Strain {
  double end = 0, ever = 0;
};

// A cloth of n x n vertices, 2 m wide, with rigid edges and rigid distances across them, one row pinned. It
// starts horizontal, swings down and hangs. 10 s, drag 0.1/s, ten substeps of one iteration.
Strain hang(int n) {
  World world({.substeps = 10, .drag = 0.1f});
  const ObjectId cloth =
      world.add_cloth(grid(n, n, 2), ClothMaterial{.membrane_stiffness = 0, .bending_stiffness = 0});
  std::vector<std::uint32_t> row;
  for (std::uint32_t column = 0; column < static_cast<std::uint32_t>(n); ++column) row.push_back(column);
  world.pin(cloth, vertices(row));
  const TriangleMesh mesh = world.mesh(cloth);
  auto links = std::make_unique<SetProjector<Distance>>();
  const auto link = [&](std::uint32_t a, std::uint32_t b) {
    links->add({world.particle(cloth, a), world.particle(cloth, b)},
               {static_cast<float>(length(mesh.positions[a] - mesh.positions[b]))});
  };
  for (const Edge& edge : test::springs(mesh)) link(edge[0], edge[1]);
  world.add_projector(std::move(links));
  Strain strain;
  for (int frame = 0; frame < 600; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    EXPECT_TRUE(report.ok()) << "frame " << frame;
    strain.end = report.largest_strain;
    strain.ever = std::max(strain.ever, strain.end);
  }
  return strain;
}

void expect_bounded(int n, double end, double ever) {
  const Strain strain = hang(n);
  std::printf("strain of %d x %d: %.3f in the end, %.3f ever\n", n, n, strain.end, strain.ever);
  EXPECT_LT(strain.end, end);
  EXPECT_LT(strain.ever, ever);
}

TEST(ColorOrder, RigidClothOf50HangsStill) {
  expect_bounded(50, 0.08, 0.25);
}

TEST(ColorOrder, RigidClothOf100HangsStillSlow) {
  expect_bounded(100, 0.3, 1.2);
}

TEST(ColorOrder, RigidClothOf200HangsStillSlow) {
  expect_bounded(200, 1.5, 4);
}

}  // namespace souple::test_solver_coloring
