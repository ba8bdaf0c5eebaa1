#include "souple/solver/colouring.h"
#include "tests/solver/meshes_to_colour.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple {
namespace {

using test::colour_case;
using test::ColourCase;

std::size_t colour_count(const Colouring& colouring) {
  return colouring.colour_begin.size() - 1;
}

std::span<const std::uint32_t> colour(const Colouring& colouring, std::size_t c) {
  return std::span(colouring.order)
      .subspan(colouring.colour_begin[c], colouring.colour_begin[c + 1] - colouring.colour_begin[c]);
}

// Every constraint once, no colour empty, no particle twice in a colour.
void expect_valid(const ColourCase& of, const Colouring& colouring) {
  SCOPED_TRACE(of.name);
  ASSERT_EQ(colouring.order.size(), of.count());
  ASSERT_EQ(colouring.colour_begin.front(), 0u);
  ASSERT_EQ(colouring.colour_begin.back(), of.count());
  std::vector<int> seen(of.count());
  for (const std::uint32_t i : colouring.order) ++seen.at(i);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(of.count()));
  std::vector<std::size_t> last_colour(of.particles, 0);
  for (std::size_t c = 0; c < colour_count(colouring); ++c) {
    EXPECT_FALSE(colour(colouring, c).empty());
    for (const std::uint32_t i : colour(colouring, c))
      for (const std::uint32_t particle : of.constraint(i)) {
        ASSERT_NE(last_colour[particle], c + 1) << "colour " << c << " has particle " << particle << " twice";
        last_colour[particle] = c + 1;
      }
  }
}

Colouring colouring_of(const ColourCase& of) {
  return colour_constraints(of.indices, of.arity, of.particles);
}

TEST(Colouring, MeshesTakeFewColoursAndNoneIsTiny) {
  for (const ColourCase& of : test::meshes_to_colour(200)) {
    const Colouring colouring = colouring_of(of);
    expect_valid(of, colouring);
    EXPECT_LE(colour_count(colouring), of.most_colours) << of.name;
    const std::size_t mean = of.count() / colour_count(colouring);
    for (std::size_t c = 0; c < colour_count(colouring); ++c)
      EXPECT_GE(colour(colouring, c).size(), std::min<std::size_t>(512, mean / 2)) << of.name;
  }
}

TEST(Colouring, NeighboursInAColourAreNeighboursInMemory) {
  for (const ColourCase& of : test::meshes_to_colour(200)) {
    const Colouring colouring = colouring_of(of);
    for (std::size_t c = 0; c < colour_count(colouring); ++c) {
      std::uint32_t before = 0;
      for (const std::uint32_t i : colour(colouring, c)) {
        const auto own = of.constraint(i);
        const std::uint32_t lowest = *std::min_element(own.begin(), own.end());
        ASSERT_GE(lowest, before) << of.name;
        before = lowest;
      }
    }
  }
}

TEST(Colouring, TheSameTwice) {
  for (const ColourCase& of : test::meshes_to_colour(200)) {
    const Colouring one = colouring_of(of), other = colouring_of(of);
    EXPECT_EQ(one.order, other.order) << of.name;
    EXPECT_EQ(one.colour_begin, other.colour_begin) << of.name;
  }
}

TEST(Colouring, ChainTakesTwoColours) {
  std::vector<Edge> chain;
  for (std::uint32_t i = 0; i < 100; ++i) chain.push_back({i, i + 1});
  const ColourCase of = colour_case("chain", chain, 101, 2);
  const Colouring colouring = colouring_of(of);
  expect_valid(of, colouring);
  EXPECT_EQ(colour_count(colouring), 2u);
}

TEST(Colouring, StarsTakeAColourForEachRay) {
  for (const std::uint32_t rays : {1u, 63u, 64u, 65u, 128u, 200u, 10000u}) {
    const ColourCase of = test::star(rays);
    const Colouring colouring = colouring_of(of);
    expect_valid(of, colouring);
    EXPECT_EQ(colour_count(colouring), rays);
  }
}

// A hub tied to many vertices of a cloth leaves the cloth's own colours as large as they were.
TEST(Colouring, HubInACloth) {
  const TriangleMesh cloth = grid(100, 100, 2);
  ColourCase of = colour_case("hub", test::springs(cloth), cloth.positions.size(), 1020);
  for (std::uint32_t i = 1; i <= 1000; ++i) of.indices.insert(of.indices.end(), {0, 9 * i});
  const Colouring colouring = colouring_of(of);
  expect_valid(of, colouring);
  EXPECT_LE(colour_count(colouring), of.most_colours);
  for (std::size_t c = 0; c < 16; ++c) EXPECT_GE(colour(colouring, c).size(), 512u);
}

TEST(Colouring, ConstraintThatNamesAParticleTwice) {
  const ColourCase of =
      colour_case("triangles", std::vector<Triangle>{{0, 0, 1}, {1, 1, 1}, {1, 2, 0}, {2, 2, 3}}, 4, 4);
  EXPECT_EQ(colouring_of(of).order.size(), 4u);
}

TEST(Colouring, Nothing) {
  const Colouring colouring = colour_constraints({}, 4, 10);
  EXPECT_TRUE(colouring.order.empty());
  EXPECT_EQ(colouring.colour_begin, std::vector<std::uint32_t>{0});
}

}  // namespace
}  // namespace souple
