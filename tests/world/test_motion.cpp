#include "souple/simd/instruction_set.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/motion.h"
#include "souple/souple.h"
#include "souple/state/particles.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

// Prediction and velocity update, as SIMD kernels and as scalar code.

namespace souple::test_world_motion {

World hanging_cloth(const Settings& settings) {
  World world(settings);
  const ObjectId cloth = world.add_cloth(grid(9, 6, 1), {.damping = 3});
  world.pin(cloth, vertices({0, 4}));
  ObjectOptions beside;
  beside.transform.translation = {2, 0, 0};
  world.add_cloth(grid(3, 3, 0.3), {}, beside);  // 63 particles in total: the last do not fill a register
  return world;
}

// With users' force fields the world uses scalar code: a field without force must give the bits of the SIMD
// kernels.
TEST(Motion, AFieldWithoutForceChangesNoBit) {
  for (const float wind : {0.0f, 8.0f}) {
    Settings settings;
    settings.wind.velocity = {wind, 0, 0.5f * wind};
    World packed = hanging_cloth(settings), one_by_one = hanging_cloth(settings);
    one_by_one.add_force_field([](const Vec3f&, const Vec3f&, float, double) { return Vec3f{}; });
    for (int i = 0; i < 30; ++i) packed.step(1.0 / 60), one_by_one.step(1.0 / 60);
    EXPECT_EQ(packed.hash(), one_by_one.hash());
    const Vec3f before = hanging_cloth(settings).positions(packed.objects()[0])[49];
    EXPECT_GT(length(packed.positions(packed.objects()[0])[49] - before), 0.1f);
  }
}

struct Bodies {
  std::vector<Vec4f> position, offset, start, velocity;

  explicit Bodies(std::size_t count) : position(count), offset(count), start(count), velocity(count) {
    float number = 0.37f;
    const auto next = [&number] { return number = std::fmod(number * 7.13f + 0.61f, 3.7f); };
    for (std::size_t i = 0; i < count; ++i) {
      position[i] = {next(), -next(), next() - 1, i % 5 == 2 ? 0.0f : next()};
      offset[i] = {1e-8f * next(), -1e-8f * next(), 0, 0};
      velocity[i] = {next(), next() - 2, -next(), 0};
    }
  }
  kernels::MotionArrays arrays() {
    return {&position[0].x, &offset[0].x, &start[0].x, &velocity[0].x, nullptr};
  }
};

constexpr float gravity[3] = {0.5f, -9.81f, 0};
constexpr float h = 1.0f / 600;

// Predicts, moves one particle as a solver would, and finishes.
Bodies advance(const kernels::MotionKernels& kernels) {
  Bodies bodies(23);
  const kernels::MotionArrays arrays = bodies.arrays();
  EXPECT_TRUE(kernels.predict(arrays, 0, 23, gravity, h));
  arrays.moving[4 * 9 + 1] += 0.01f;
  EXPECT_TRUE(kernels.finish(arrays, 0, 23, h));
  return bodies;
}

std::vector<const kernels::MotionKernels*> all_kernels() {
  std::vector<const kernels::MotionKernels*> result;
#if defined(__x86_64__)
  result.push_back(find_motion_kernels(InstructionSet::sse));
  if (__builtin_cpu_supports("avx2")) result.push_back(find_motion_kernels(InstructionSet::avx2));
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
    result.push_back(find_motion_kernels(InstructionSet::avx512));
#elif defined(__aarch64__)
  result.push_back(find_motion_kernels(InstructionSet::neon));
#endif
  return result;
}

// A free particle falls as the scheme says, a pinned one stays, and both keep their inverse masses.
TEST(Motion, PinnedParticlesStay) {
  for (const kernels::MotionKernels* kernels : all_kernels()) {
    const Bodies before(23), after = advance(*kernels);
    for (std::size_t i = 0; i < 23; ++i) {
      EXPECT_EQ(after.position[i].w, before.position[i].w);
      if (i == 9) continue;
      const bool pinned = before.position[i].w == 0;
      const float v = before.velocity[i].y - 9.81f * h;
      EXPECT_NEAR(after.velocity[i].y, pinned ? 0 : v, 1e-6) << i;
      EXPECT_NEAR(after.position[i].y, before.position[i].y + (pinned ? 0 : v * h), 1e-6) << i;
    }
  }
}

TEST(Motion, BadNumbersAreSeen) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const kernels::MotionKernels* kernels : all_kernels())
    for (const float bad : {infinity, -infinity, std::nanf(""), 3e38f})
      for (const std::size_t i : {0u, 13u, 22u}) {
        Bodies bodies(23);
        bodies.velocity[i].z = bad;
        EXPECT_FALSE(kernels->predict(bodies.arrays(), 0, 23, gravity, h));
        bodies = Bodies(23);
        bodies.offset[i].x = bad;
        EXPECT_FALSE(kernels->finish(bodies.arrays(), 0, 23, h));
      }
}

}  // namespace souple::test_world_motion
