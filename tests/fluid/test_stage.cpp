#include "souple/contacts/contact_projector.h"
#include "souple/fluid/emission.h"
#include "souple/fluid/emitter_record.h"
#include "souple/fluid/fluid_settings.h"
#include "souple/fluid/stage/fluid_input.h"
#include "souple/fluid/stage/fluids.h"
#include "souple/geometry/fill.h"
#include "souple/objects/object.h"
#include "souple/objects/objects_view.h"
#include "souple/state/warnings.h"
#include "souple/threads/threads.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// The fluids' stage by itself, on the arrays that a world would have.

namespace souple::test_fluid_stage {

constexpr Substep substep{.h = 1.0f / 600};

/// A fluid with the particles at some points.
struct Fluid {
  Particles particles;
  std::vector<std::unique_ptr<Object>> objects;
  std::vector<std::uint32_t> object_of;

  Fluid(const std::vector<Vec3d>& points, float spacing) {
    const float mass = 1000 * spacing * spacing * spacing;
    particles.resize(points.size());
    object_of.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      particles.position[i] = {0, 0, 0, 1 / mass};
      particles.position[i].set_xyz(Vec3f(points[i]));
      particles.mass[i] = mass;
    }
    Object& object = *objects.emplace_back(std::make_unique<Object>());
    object.kind = ObjectKind::fluid;
    object.material = FluidMaterial{.spacing = spacing, .density = 1000};
    object.rest.resize(points.size());
    object.end = object.capacity = static_cast<std::uint32_t>(points.size());
  }
  ObjectsView view() { return {particles, objects, object_of}; }
};

/// A fluid at rest, and a floor that it collides with.
struct Pool : Fluid {
  ContactTables tables;
  FluidSettings settings;
  std::uint32_t flags = 0;
  std::string message;
  Warnings warnings{flags, message};
  std::unique_ptr<Threads> threads = make_threads(Threading::pool, 2);
  Fluids fluids;

  explicit Pool(const std::vector<Vec3d>& points) : Fluid(points, 0.1f) {
    const std::vector<NamedContactMaterial> rows{{"fluid", {}}}, columns{{"floor", {}}};
    tables.colliders.push_back({"floor", Plane{.normal = {0, 1, 0}, .offset = 0}, {}, {}, true});
    tables.against_objects = ContactMaterialTable(rows, rows, {});
    tables.against_colliders = ContactMaterialTable(rows, columns, {});
    fluids.build(input().objects);
  }
  FluidInput input() {
    return {.objects = view(),
            .contacts = tables,
            .emitters = {},
            .settings = settings,
            .threads = *threads,
            .warnings = warnings};
  }
  /// Displacements that restore the fluid's volume.
  void solve() {
    fluids.begin_step(input(), static_cast<double>(substep.h));
    particles.start.assign(particles.size(), {});
    fluids.solve_incompressibility(input(), substep);
  }
};

TEST(FluidStage, ACompressedFluidExpandsAndItsCenterStays) {
  Pool pool(fill(Vec3d{0, 1, 0}, Vec3d{0.5, 1.5, 0.5}, 0.085));
  pool.solve();
  Vec3d sum{}, center{};
  for (const Vec4f& x : pool.particles.position)
    center += Vec3d(x.xyz()) / static_cast<double>(pool.particles.size());
  double outward = 0;
  for (std::size_t i = 0; i < pool.particles.size(); ++i) {
    const Vec3d moved(pool.particles.offset[i].xyz());
    sum += moved;
    outward += dot(moved, Vec3d(pool.particles.position[i].xyz()) - center);
  }
  EXPECT_GT(outward, 0);
  EXPECT_LT(length(sum), 1e-5 * static_cast<double>(pool.particles.size()));
  EXPECT_EQ(pool.fluids.report().particles, pool.particles.size());
  EXPECT_GT(pool.fluids.report().largest_pressure, 0);
  EXPECT_EQ(pool.flags, 0u);
}

TEST(FluidStage, AFluidThatMovesIntoTheFloorStaysAboveItAndPushesIt) {
  Pool pool(fill(Vec3d{0, 0, 0}, Vec3d{0.5, 0.3, 0.5}, 0.1));
  for (Vec4f& offset : pool.particles.offset) offset.y = -0.05f;
  pool.solve();
  for (std::size_t i = 0; i < pool.particles.size(); ++i)
    EXPECT_GT(pool.particles.position[i].y + pool.particles.offset[i].y, 0) << i;
  EXPECT_LT(pool.fluids.force(0).y, 0);
}

TEST(FluidStage, ViscosityAndAirChangeVelocities) {
  Pool pool(fill(Vec3d{0, 1, 0}, Vec3d{0.5, 1.5, 0.5}, 0.1));
  std::get<FluidMaterial>(pool.objects[0]->material).air_drag = 0.5f;
  pool.solve();
  pool.fluids.update_velocities(pool.input(), {.wind = {10, 0, 0}, .density = 1.2f}, substep);
  double carried = 0;
  for (const Vec4f& v : pool.particles.velocity) carried += static_cast<double>(v.x);
  EXPECT_GT(carried, 0);
}

TEST(FluidStage, WithoutFluidsThereIsNothingToDo) {
  Pool pool({});
  pool.fluids.begin_step(pool.input(), static_cast<double>(substep.h));
  EXPECT_TRUE(pool.fluids.none());
}

constexpr double nozzle_spacing = 0.05;
const Emitter nozzle{.position = {0, 2, 0}, .direction = {0, -1, 0}, .radius = 0.1f, .speed = 1};

TEST(Emission, EachLayerLeavesOnceAndFliesOn) {
  EmitterRecord record{{1}, 0, nozzle, 0};
  const std::vector<Drop> first = next_drops(record, {}, nozzle_spacing, 0.0);
  EXPECT_EQ(first.size(), 13u);  // lattice points within two pitches of one of them
  EXPECT_EQ(next_drops(record, {}, nozzle_spacing, 0.02).size(), 0u);
  const std::vector<Drop> second = next_drops(record, {}, nozzle_spacing, 0.06);  // the layer of 0.05 s
  ASSERT_EQ(second.size(), 12u);
  for (const Drop& drop : second) {
    EXPECT_NEAR(drop.position.y, 2 - 0.01, 1e-9);
    EXPECT_NEAR(drop.velocity.y, -1, 1e-9);
  }
  EXPECT_EQ(record.layers, layers_before(nozzle, nozzle_spacing, 0.06));
}

TEST(Emission, AMovingNozzleGivesItsVelocity) {
  Emitter moving = nozzle;
  moving.motion = ColliderMotion::callback([](double t) { return Transform{{3 * t, 0, 0}, {}, 1}; });
  const Nozzle at = nozzle_at(moving, 0.5);
  EXPECT_NEAR(at.position.x, 1.5, 1e-9);
  EXPECT_NEAR(at.velocity.x, 3, 1e-6);
}

TEST(Emission, DropsNearFluidAreBlocked) {
  Fluid fluid({{0, 2, 0}, {1, 2, 0}}, 0.05f);
  const std::vector<Drop> drops{{{0.01, 2, 0}, {}}, {{0.2, 2, 0}, {}}, {{1, 2.04, 0}, {}}};
  EXPECT_EQ(blocked_drops(drops, fluid.view(), nozzle_spacing), (std::vector<std::uint8_t>{1, 0, 0}));
  EXPECT_TRUE(blocked_drops({}, fluid.view(), nozzle_spacing).empty());
}

TEST(Emission, ADrainFindsWhatIsInIt) {
  Fluid fluid({{0, -1, 0}, {0, 1, 0}, {5, -0.1, 0}}, 0.05f);
  const Drain below{.shape = Plane{.normal = {0, 1, 0}, .offset = 0}};
  const auto threads = make_threads(Threading::serial, 1);
  EXPECT_EQ(particles_in(below, *fluid.objects[0], fluid.view(), *threads),
            (std::vector<std::uint32_t>{0, 2}));
}

}  // namespace souple::test_fluid_stage
