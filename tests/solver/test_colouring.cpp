#include "souple/solver/colouring.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace souple {
namespace {

void expect_valid(const std::vector<std::uint32_t>& indices, int arity, std::size_t particles) {
  const Colouring colouring = colour_constraints(indices, arity, particles);
  const std::size_t count = indices.size() / static_cast<std::size_t>(arity);
  ASSERT_EQ(colouring.order.size(), count);
  EXPECT_EQ(std::set<std::uint32_t>(colouring.order.begin(), colouring.order.end()).size(), count);
  EXPECT_EQ(colouring.colour_begin.back(), count);
  for (std::size_t c = 0; c + 1 < colouring.colour_begin.size(); ++c) {
    std::set<std::uint32_t> seen;
    for (std::size_t k = colouring.colour_begin[c]; k < colouring.colour_begin[c + 1]; ++k)
      for (int i = 0; i < arity; ++i)
        EXPECT_TRUE(seen.insert(indices[colouring.order[k] * static_cast<std::size_t>(arity) +
                                        static_cast<std::size_t>(i)])
                        .second)
            << "colour " << c << " uses a particle twice";
  }
}

TEST(Colouring, ChainTakesTwoColours) {
  std::vector<std::uint32_t> chain;
  for (std::uint32_t i = 0; i < 100; ++i) chain.insert(chain.end(), {i, i + 1});
  expect_valid(chain, 2, 101);
  EXPECT_EQ(colour_constraints(chain, 2, 101).colour_begin.size(), 3u);
}

TEST(Colouring, StarLargerThanOneRoundOfColours) {
  std::vector<std::uint32_t> star;
  for (std::uint32_t i = 1; i <= 200; ++i) star.insert(star.end(), {0, i});
  expect_valid(star, 2, 201);
  EXPECT_EQ(colour_constraints(star, 2, 201).colour_begin.size(), 201u);
}

TEST(Colouring, Nothing) {
  const Colouring colouring = colour_constraints({}, 4, 10);
  EXPECT_TRUE(colouring.order.empty());
  EXPECT_EQ(colouring.colour_begin, std::vector<std::uint32_t>{0});
}

}  // namespace
}  // namespace souple
