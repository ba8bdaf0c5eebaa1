#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"

#include <cstring>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_threads_independence {

// Contracts a chain of 200 links, stretched to twice its length, by 50 colored sweeps.
std::vector<Vec4f> contract_chain() {
  constexpr std::uint32_t particles = 201;
  std::vector<Vec4f> position(particles);
  for (std::uint32_t i = 0; i < particles; ++i)
    position[i] = {0.02f * static_cast<float>(i), 0, 0, i == 0 ? 0.0f : 1.0f};
  std::vector<Vec4f> moving(particles);
  const std::vector<Vec4f> start = moving;
  SetProjector<Distance> links;
  for (std::uint32_t i = 0; i + 1 < particles; ++i) links.add({i, i + 1}, {0.01f});
  links.prepare(particles);
  const ParticleView view{position, moving, start};
  const Substep substep{.h = 0.01f};
  links.begin_substep(view, substep);
  for (int sweep = 0; sweep < 50; ++sweep)
    for (int color = 0; color < links.color_count(); ++color) links.project(color, view, substep);
  for (std::uint32_t i = 0; i < particles; ++i) position[i].x += moving[i].x;
  return position;
}

// There is no global state: solvers on different threads share no data (checked by the thread sanitizer). Each gives
// the bits of a solver that runs alone.
TEST(Threads, SolversAreIndependent) {
  const std::vector<Vec4f> alone = contract_chain();
  ASSERT_LT(alone.back().x, 3.99f);
  std::vector<std::vector<Vec4f>> together(4);
  std::vector<std::thread> threads;
  threads.reserve(together.size());
  for (std::vector<Vec4f>& result : together) threads.emplace_back([&result] { result = contract_chain(); });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<Vec4f>& result : together)
    EXPECT_EQ(std::memcmp(result.data(), alone.data(), alone.size() * sizeof(Vec4f)), 0);
}

}  // namespace souple::test_threads_independence
