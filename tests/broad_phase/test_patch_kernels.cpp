#include "souple/broad_phase/kernels/find_kernels.h"
#include "tests/collision/random.h"
#include "tests/instruction_sets.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace souple {
namespace {

using kernels::BoxColumns;
using kernels::BoxGroup;
using kernels::PatchKernels;

/// Boxes in a unit cube, and their particles: many items share a particle.
struct Items {
  std::array<std::vector<float>, 3> lo, hi;
  std::array<std::vector<std::uint32_t>, 3> particle;

  Items(std::size_t count, test::Random& random) {
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        lo[k].push_back(float(random.uniform(0, 1)));
        hi[k].push_back(lo[k].back() + float(random.uniform(-0.1, 0.6)));
        particle[k].push_back(std::uint32_t(random.uniform(0, 40)));
      }
  }
  BoxColumns columns() const {
    return {{lo[0].data(), lo[1].data(), lo[2].data()},
            {hi[0].data(), hi[1].data(), hi[2].data()},
            {particle[0].data(), particle[1].data(), particle[2].data()}};
  }
};

std::vector<const PatchKernels*> all_kernels() {
  std::vector<const PatchKernels*> result;
  for (const InstructionSet set : all_sets()) result.push_back(&kernels::find_patch_kernels(set));
  return result;
}

BoxGroup random_group(std::uint32_t most, test::Random& random) {
  BoxGroup group{std::uint32_t(random.uniform(0, 100)), std::uint32_t(random.uniform(0, most + 1)), {}};
  for (std::size_t k = 0; k < 3; ++k) {
    group.box[k] = float(random.uniform(0, 0.6));
    group.box[3 + k] = group.box[k] + float(random.uniform(0, 0.8));
  }
  return group;
}

// Groups of any size and position: the same pairs in the same order.
TEST(PatchKernels, EveryInstructionSetFindsTheSame) {
  test::Random random(1);
  const Items a(200, random), b(200, random);
  std::vector<std::array<std::uint32_t, 4>> storage(std::size_t{BoxGroup::max_items} * BoxGroup::max_items);
  auto* const pairs = reinterpret_cast<kernels::Quad*>(storage.data());
  std::size_t sum = 0;
  for (int round = 0; round < 2000; ++round) {
    const BoxGroup p = random_group(BoxGroup::max_items, random);
    const BoxGroup q = round % 3 == 0 ? p : random_group(BoxGroup::max_items, random);
    std::vector<std::vector<std::array<std::uint32_t, 4>>> found;
    for (const PatchKernels* kernels : all_kernels()) {
      auto& list = found.emplace_back();
      const auto keep = [&](std::size_t n) {
        list.insert(list.end(), storage.begin(), storage.begin() + std::ptrdiff_t(n));
      };
      keep(kernels->edges_edges(a.columns(), p, q, pairs));
      keep(kernels->vertices_triangles(a.columns(), p, b.columns(), q, pairs));
      keep(kernels->vertices_edges(a.columns(), p, b.columns(), q, pairs));
      std::vector<std::uint32_t> keys(300), some(300);
      for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = std::uint32_t(i * 2654435769u);
      const std::size_t n =
          kernels->overlapping(b.columns(), p.begin, p.count, q.box, keys.data(), 3, some.data());
      for (std::size_t i = 0; i < n; ++i) list.push_back({some[i], 0, 0, 0});
    }
    for (const auto& list : found) ASSERT_EQ(list, found[0]);
    sum += found[0].size();
  }
  EXPECT_GT(sum, 10000u);
}

}  // namespace
}  // namespace souple
