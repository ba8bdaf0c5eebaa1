#include "souple/fluid/emission.h"
#include "souple/fluid/emitter_record.h"
#include "souple/objects/object.h"
#include "souple/objects/objects_view.h"
#include "souple/threads/threads.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_fluid_emission {

constexpr double d = 0.05;
const Emitter nozzle{.position = {0, 2, 0}, .direction = {0, -1, 0}, .radius = 0.1f, .speed = 1};

/// A fluid with the particles at some points.
struct Fluid {
  Particles particles;
  std::vector<std::unique_ptr<Object>> objects;
  std::vector<std::uint32_t> object_of;

  explicit Fluid(const std::vector<Vec3f>& points) {
    particles.resize(points.size());
    object_of.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) particles.position[i].set_xyz(points[i]);
    Object& object = *objects.emplace_back(std::make_unique<Object>());
    object.kind = ObjectKind::fluid;
    object.material = FluidMaterial{.spacing = 0.05f};
    object.rest.resize(points.size());
    object.end = object.capacity = static_cast<std::uint32_t>(points.size());
  }
  ObjectsView view() { return {particles, objects, object_of}; }
};

TEST(Emission, EachLayerLeavesOnceAndFliesOn) {
  EmitterRecord record{{1}, 0, nozzle, 0};
  const std::vector<Drop> first = next_drops(record, {}, d, 0.0);
  EXPECT_EQ(first.size(), 13u);  // lattice points within two pitches of one of them
  EXPECT_EQ(next_drops(record, {}, d, 0.02).size(), 0u);
  const std::vector<Drop> second = next_drops(record, {}, d, 0.06);  // the layer of 0.05 s
  ASSERT_EQ(second.size(), 12u);
  for (const Drop& drop : second) {
    EXPECT_NEAR(drop.position.y, 2 - 0.01, 1e-9);
    EXPECT_NEAR(drop.velocity.y, -1, 1e-9);
  }
  EXPECT_EQ(record.layers, layers_before(nozzle, d, 0.06));
}

TEST(Emission, AMovingNozzleGivesItsVelocity) {
  Emitter moving = nozzle;
  moving.motion = ColliderMotion::callback([](double t) { return Transform{{3 * t, 0, 0}, {}, 1}; });
  const Nozzle at = nozzle_at(moving, 0.5);
  EXPECT_NEAR(at.position.x, 1.5, 1e-9);
  EXPECT_NEAR(at.velocity.x, 3, 1e-6);
}

TEST(Emission, DropsNearFluidAreBlocked) {
  Fluid fluid({{0, 2, 0}, {1, 2, 0}});
  const std::vector<Drop> drops{{{0.01, 2, 0}, {}}, {{0.2, 2, 0}, {}}, {{1, 2.04, 0}, {}}};
  EXPECT_EQ(blocked_drops(drops, fluid.view(), d), (std::vector<std::uint8_t>{1, 0, 0}));
  EXPECT_TRUE(blocked_drops({}, fluid.view(), d).empty());
}

TEST(Emission, ADrainFindsWhatIsInIt) {
  Fluid fluid({{0, -1, 0}, {0, 1, 0}, {5, -0.1f, 0}});
  const Drain below{.shape = Plane{.normal = {0, 1, 0}, .offset = 0}};
  const auto threads = make_threads(Threading::serial, 1);
  EXPECT_EQ(particles_in(below, *fluid.objects[0], fluid.view(), *threads),
            (std::vector<std::uint32_t>{0, 2}));
}

}  // namespace souple::test_fluid_emission
