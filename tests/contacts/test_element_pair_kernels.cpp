#include "souple/contacts/kernels/find_kernels.h"
#include "souple/state/columns.h"
#include "souple/state/particles.h"
#include "tests/collision/random.h"
#include "tests/instruction_sets.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_contacts_element_pair_kernels {

using kernels::ElementPairKernels;

Vec4f record(const Vec3d& x, float w) {
  return {float(x.x), float(x.y), float(x.z), w};
}

/// Particles in a small box, with small motions, and pairs of them. Every fifth particle cannot move.
struct Crowd {
  std::vector<Vec4f> position, moving, start, moved;
  std::vector<std::array<std::uint32_t, 4>> pairs;
  std::vector<float> thickness, distance_bound, contact_margin;

  explicit Crowd(std::size_t count) {
    test::Random random(count);
    const std::size_t particles = 4 * count;
    for (std::size_t i = 0; i < particles; ++i) {
      const float w = i % 5 == 0 ? 0.0f : float(random.uniform(0.5, 2));
      const Vec3d x = random.point(0, 0.1), d = random.point(-0.01, 0.01);
      start.push_back({});
      moving.push_back(record(d, 0));
      position.push_back(record(x, w));
      moved.push_back({});
      moved[i].set_xyz(moving[i].xyz() - start[i].xyz());
      contact_margin.push_back(i % 3 == 0 ? float(random.uniform(0, 0.01)) : 0.0f);
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      pairs.push_back({4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3});
      thickness.push_back(float(random.uniform(0.005, 0.04)));
      distance_bound.push_back(float(random.uniform(0, 0.1)));
    }
  }
  const std::uint32_t (*quads() const)[4] {
    return reinterpret_cast<const std::uint32_t(*)[4]>(pairs.data());
  }
  kernels::ParticleRecords records() {
    kernels::ParticleRecords result;
    result.moving = &moving[0].x;
    result.position = &position[0].x;
    result.corrected = result.moving;
    result.start = &start[0].x;
    result.moved = &moved[0].x;
    result.contact_margin = contact_margin.data();
    return result;
  }
};

// A vertex and a triangle that approach each other. The range has the radii of the vertex and of the thickest corner,
// the fastest corner's relative velocity, and the margins of both.
TEST(ElementPairKernels, ARangeIsThicknessAndMotionAndMargins) {
  const std::vector<Vec4f> velocity{{1, 0, 0, 0}, {1, 0, 0, 0}, {-2, 0, 0, 0}, {1, 4, 0, 0}};
  const std::vector<float> radius{0.1f, 0.2f, 0.3f, 0.1f}, margin{0.01f, 0.02f, 0.02f, 0.05f},
      contact_margin{0, 0.003f, 0, 0.001f};
  const std::uint32_t pair[1][4] = {{0, 1, 2, 3}};
  kernels::ParticleRecords records;
  records.moved = &velocity[0].x;
  records.contact_margin = contact_margin.data();
  const kernels::PredictionMargins margins{radius.data(), margin.data(), 1, 1e-5f, 0.5f};
  for (const InstructionSet set : all_sets()) {
    const ElementPairKernels& kernels = kernels::find_element_pair_kernels(set);
    float thickness = 0, range = 0;
    kernels.ranges[0](records, margins, 0.1f, pair, 0, 1, &thickness, &range);
    EXPECT_FLOAT_EQ(thickness, 0.4f);
    EXPECT_FLOAT_EQ(range, 1.5f * 0.4f + 0.003f + 0.1f * 4 + 0.06f);
    kernels.ranges[1](records, margins, 0.1f, pair, 0, 1, &thickness, &range);
    EXPECT_FLOAT_EQ(thickness, 0.2f + 0.3f);
    EXPECT_FLOAT_EQ(range, 1.5f * 0.5f + 0.003f + 0.1f * 4 + 0.07f);
  }
}

/// Projects the only pair of a crowd, 3 cm thick, without friction.
void project_one(const ElementPairKernels& kernels, Crowd& crowd, int kind) {
  crowd.thickness[0] = crowd.distance_bound[0] = 0.03f;
  const kernels::ElementPairColumns columns{crowd.quads(), crowd.thickness.data(),
                                            crowd.distance_bound.data()};
  const std::uint32_t found = 0;
  const float part = 1;
  ColumnStore<kernels::ContactColumns> arrays;
  arrays.resize(1);
  const kernels::ContactColumns contacts = arrays.columns();
  contacts.slop[0] = 0;
  kernels.describe[kind](crowd.records(), columns, &found, &part, 0, 1, contacts);
  contacts.static_friction[0] = contacts.kinetic_friction[0] = 0;
  kernels.project(crowd.records(), contacts, 0, 1);
}

// Two overlapping elements move apart in proportion to their inverse masses. Momentum is conserved, and a
// corner that cannot move stays.
TEST(ElementPairKernels, AProjectionKeepsMomentumAndTheDistance) {
  for (const InstructionSet set : all_sets()) {
    const ElementPairKernels& kernels = kernels::find_element_pair_kernels(set);
    Crowd crowd(1);
    crowd.position = {record({0.3, 0.01, 0.2}, 2), record({0, 0, 0}, 1), record({0, 0, 1}, 1),
                      record({1, 0, 0}, 0)};
    crowd.moving = crowd.start = crowd.moved = std::vector<Vec4f>(4);
    project_one(kernels, crowd, 0);
    const auto moved = [&](std::size_t i) { return Vec3d(crowd.moving[i].xyz()); };
    EXPECT_EQ(moved(3), Vec3d{});
    // Weights of the triangle's corners where the vertex is above it: 0.5, 0.2, 0.3.
    EXPECT_NEAR(0.01 + moved(0).y - 0.5 * moved(1).y - 0.2 * moved(2).y, 0.03, 1e-7);
    // The third corner has infinite mass and absorbs its part of the momentum.
    EXPECT_NEAR(moved(1).y / moved(0).y, -0.5 / 2, 1e-5);
    EXPECT_NEAR(moved(2).y / moved(0).y, -0.2 / 2, 1e-5);
  }
}

// A ball and an edge; the ball is an edge from its particle to itself. Its correction counts exactly once.
TEST(ElementPairKernels, ABallIsPushedOffAnEdge) {
  for (const InstructionSet set : all_sets()) {
    const ElementPairKernels& kernels = kernels::find_element_pair_kernels(set);
    Crowd crowd(1);
    crowd.pairs[0] = {0, 0, 2, 3};
    crowd.position = {record({0.25, 0.01, 0}, 2), record({}, 1), record({0, 0, 0}, 1), record({1, 0, 0}, 1)};
    crowd.moving = crowd.start = crowd.moved = std::vector<Vec4f>(4);
    project_one(kernels, crowd, 1);
    const auto moved = [&](std::size_t i) { return Vec3d(crowd.moving[i].xyz()); };
    EXPECT_NEAR(0.01 + moved(0).y - 0.75 * moved(2).y - 0.25 * moved(3).y, 0.03, 1e-7) << simd_name(set);
    EXPECT_NEAR(moved(0).y / 2 + moved(2).y + moved(3).y, 0, 1e-8);
    EXPECT_NEAR(moved(2).y / moved(3).y, 3, 1e-4);
  }
}

}  // namespace souple::test_contacts_element_pair_kernels
