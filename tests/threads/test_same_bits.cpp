// Every instruction set that this processor has gives the same bits with any number of threads. Golden scenes say the same
// of what they show (tests/golden). Here is what they lack: vertex balls, sleeping, all kernels of fluids, vorticity, coarse
// triangles on colliders of each shape, and the meshes of fluids.
#include "souple/math/fnv1a.h"
#include "souple/souple.h"
#include "souple/surface/fluid_surface.h"
#include "souple/surface/splat_shapes.h"
#include "souple/threads/threads.h"
#include "tests/instruction_sets.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace souple::test_threads_same_bits {

ObjectOptions at(const Vec3d& place, SelfCollision self_collision = SelfCollision::off, int layer = 0) {
  ObjectOptions options;
  options.transform.translation = place;
  options.self_collision = self_collision;
  options.layer = layer;
  return options;
}

/// A cloth that folds over itself on a turning ring, soft bodies, a rope that coils and grains on it.
void add_crowd(World& world) {
  const auto above = [](double x, double y, double z) { return at({x, y, z}, SelfCollision::surfaces); };
  const auto turning = ColliderMotion::callback([](double t) {
    return Transform{.rotation = Quatd::from_axis_angle({0, 1, 0}, 2 * t)};
  });
  world.add_obstacle(torus(0.25, 0.08, 24, 12), {.thickness = 0.01f}, {.pose = turning});
  world.add_cloth(grid(20, 20, 0.9), {.thickness = 0.012f}, above(0.05, 0.1, 0));
  world.add_cloth(grid(10, 10, 0.4), {.thickness = 0.01f}, above(-0.1, 0.12, 0.1));
  world.add_soft_body(tet_ball(1, 2, 0.08), {.thickness = 0.01f}, above(0.1, 0.2, 0));
  world.add_soft_body(tet_bar(3, 3, 3, {0.12, 0.12, 0.12}), {.thickness = 0.01f}, above(-0.12, 0.2, 0.05));
  world.add_soft_body(box({0.1, 0.1, 0.1}), {.model = SoftBodyModel::shape_matching}, {.cells = 60},
                      above(0, 0.2, -0.15));
  std::vector<Vec3d> line, centers;
  for (int k = 0; k <= 24; ++k) {
    const double angle = 2 * pi * k / 8;
    line.push_back({0.06 * std::cos(angle), 0.12 + 0.015 * k, 0.25 + 0.06 * std::sin(angle)});
  }
  world.add_rope(line, 72, {.radius = 0.006f}, above(0, 0, 0));
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = 0; z < 5; ++z) centers.push_back({0.025 * x + 1e-3 * y, 0.025 * y, 0.025 * z + 1e-3 * x});
  world.add_grains(centers, {.radius = 0.01f}, above(-0.2, 0.12, -0.25));
}

/// Coarse triangles that lie on a shape of each kind.
void add_coarse_cloths(World& world) {
  const Shape shapes[] = {Sphere{{}, 0.1f}, Box{{}, {0.1f, 0.1f, 0.1f}}, Capsule{{}, 0.1f, 0.1f},
                          Cylinder{{}, 0.1f, 0.1f}, SignedDistanceField(sphere(2, 0.1), 0.02)};
  for (double x = 2; const Shape& shape : shapes) {
    const double top = std::holds_alternative<Capsule>(shape) ? 0.2 : 0.1;
    world.add_collider(shape, {.motion = ColliderMotion::fixed({.translation = {x, 0, 0}})});
    world.add_cloth(grid(3, 3, 0.5), {.bending_stiffness = 0.1f, .thickness = 0.02f},
                    at({x + 0.03, top + 0.015, 0.02}));
    x += 1;
  }
}

/// Rigid bodies joined and tied, two layers in the wrong order, vertex balls that meet, and a box that falls asleep.
void add_rest(World& world) {
  for (int i = 0; i < 6; ++i)
    world.add_rigid_body(i % 2 == 0 ? Shape(Box{{}, {0.1f, 0.05f, 0.1f}}) : Shape(Capsule{{}, 0.06f, 0.1f}),
                         {}, at({-3 + 0.02 * i, 0.12 * i, 0.01 * i}));
  const ObjectId post = world.add_rigid_body(Box{{}, {0.02f, 0.2f, 0.02f}}, {}, at({-4, 0.3, 0})),
                 door = world.add_rigid_body(Box{{}, {0.2f, 0.2f, 0.02f}}, {}, at({-3.75, 0.3, 0}));
  world.add_joint(post, door, joint::Hinge{}, {.point = {-3.97, 0.3, 0}, .axis = {0, 1, 0}});
  const ObjectId hung = world.add_cloth(grid(8, 8, 0.4), {}, at({-4, 1, 0}));
  world.pin(hung, vertices({0, 7}));
  world.add_tie(SurfacePoint{hung, {60}}, door, {.point = {-3.75, 0.5, 0}});
  world.add_cloth(grid(10, 10, 0.4), {}, at({0, 1.5, 0}, SelfCollision::surfaces, 2));
  world.add_cloth(grid(9, 9, 0.36), {}, at({0.01, 1.507, 0.02}, SelfCollision::surfaces, 1));
  ObjectOptions upright = at({0, 0.4, 2}, SelfCollision::particles);
  upright.transform.rotation = Quatd::from_axis_angle({0, 0, 1}, 1.48);
  world.add_cloth(grid(24, 24, 0.8), {.thickness = 0.02f}, upright);
  world.add_rigid_body(Box{{}, {0.05f, 0.05f, 0.05f}}, {}, at({0, -0.1, 4}));
}

/// Water with everything, thrown through cloth at grains, by one of the kernels.
World splash(SmoothingShape kernel, int threads) {
  constexpr double d = 0.04;
  Settings settings{.substeps = 6, .threads = threads};
  settings.fluid = {.kernel = kernel, .artificial_pressure = 100};
  World world(settings);
  for (const auto& [normal, offset] : {std::pair(Vec3f{0, 1, 0}, 0.0f),
                                       {Vec3f{1, 0, 0}, -0.6f},
                                       {Vec3f{-1, 0, 0}, -0.6f},
                                       {Vec3f{0, 0, 1}, -0.2f},
                                       {Vec3f{0, 0, -1}, -0.2f}})
    world.add_collider(Plane{normal, offset});
  const ObjectId water = world.add_fluid(fill(Vec3d{-0.6, 0, -0.2}, Vec3d{-0.2, 0.4, 0.2}, d),
                                         {.spacing = float(d),
                                          .viscosity = 0.5f,
                                          .surface_tension = 0.05f,
                                          .vorticity = 0.2f,
                                          .air_drag = 0.47f,
                                          .foam = 1},
                                         {.velocity = {4, 0, 0}, .max_particles = 1200});
  world.add_emitter(water, {.position = {0.4f, 0.6f, 0}, .radius = 0.08f, .speed = 2});
  world.add_drain({.shape = Sphere{{0.5f, 0, 0}, 0.1f}});
  const ObjectId veil = world.add_cloth(grid(9, 9, 0.4), {}, at({0, 0.3, 0}));
  world.pin(veil, vertices({0, 8}));
  world.add_soft_body(box({0.12, 0.12, 0.12}), {.density = 500}, {.cells = 60}, at({0.2, 0.1, 0}));
  world.add_grains(fill(Vec3d{0.3, 0, -0.1}, Vec3d{0.4, 0.2, 0.1}, 0.04),
                   {.radius = 0.015f, .density = 2000});
  return world;
}

template <class T>
std::uint64_t hash_of(std::span<T> values, std::uint64_t hash) {
  return fnv1a64(std::as_bytes(values), hash);
}

std::uint64_t hash_of_solids(int threads) {
  Settings settings{.substeps = 5, .sleeping = {.enabled = true, .seconds = 0.05f}, .threads = threads};
  World world(settings);
  add_crowd(world), add_coarse_cloths(world), add_rest(world);
  world.add_collider(Plane{.offset = -0.15f});
  std::size_t contacts = 0, asleep = 0;
  for (int frame = 0; frame < 20; ++frame) {
    if (frame == 12)  // wakes the box that sleeps
      world.add_grains(std::vector<Vec3d>{{0, 0, 4}}, {.radius = 0.02f}, {.velocity = {0, -2, 0}});
    const StepReport& report = world.step(1.0 / 60);
    EXPECT_TRUE(report.ok()) << report.message;
    contacts = std::max(contacts, report.contacts), asleep = std::max(asleep, report.asleep);
  }
  EXPECT_GT(contacts, 500u);
  EXPECT_GT(asleep, 0u);
  return world.hash();
}

std::uint64_t hash_of_fluids(int threads) {
  const auto pool = make_threads(Threading::automatic, threads);
  std::uint64_t hash = fnv1a64_start;
  for (const SmoothingShape kernel : {SmoothingShape::wendland, SmoothingShape::poly6_spiky,
                                      SmoothingShape::cubic_spline, SmoothingShape::wide_wendland}) {
    World world = splash(kernel, threads);
    for (int frame = 0; frame < 8; ++frame) EXPECT_TRUE(world.step(1.0 / 60).ok()) << world.report().message;
    EXPECT_GT(world.foam().positions.size(), 10u);
    const std::uint64_t state = world.hash();
    hash = hash_of(std::span(&state, 1), hash_of(world.foam().positions, hash));
    if (kernel != SmoothingShape::wendland) continue;
    const auto water = world.positions(world.find_object("fluid"));
    SplatShapes splats(0.04f);
    splats.build(water, *pool);
    hash = hash_of(splats.axes(), hash);
    for (const SurfaceMethod method : {SurfaceMethod::anisotropic, SurfaceMethod::isotropic}) {
      FluidSurface surface({.method = method, .spacing = 0.04f, .smoothing_passes = 2});
      hash = hash_of(std::span(surface.build(water, *pool).positions), hash);
    }
  }
  return hash;
}

std::string bits(int threads) {
  return fmt::format("bits {:016x} {:016x}", hash_of_solids(threads), hash_of_fluids(threads));
}

/// Runs in a process of its own: an instruction set is chosen once in a process.
TEST(SameBits, DISABLED_ArePrinted) {
  std::puts(bits(0).c_str());
}

TEST(SameBits, OnEveryInstructionSetWithAnyNumberOfThreads) {
  const std::string alone = bits(1), program = std::filesystem::read_symlink("/proc/self/exe").string();
  for (int threads = 8; const InstructionSet set : all_sets()) {
    const std::string command = fmt::format(
        "env -u GTEST_TOTAL_SHARDS -u GTEST_SHARD_INDEX SOUPLE_SIMD={} SOUPLE_THREADS={} '{}' "
        "--gtest_also_run_disabled_tests --gtest_filter=SameBits.DISABLED_ArePrinted 2>&1",
        simd_name(set), threads, program);
    std::string said;
    std::FILE* const pipe = popen(command.c_str(), "r");
    std::array<char, 4096> piece{};
    for (std::size_t n = 0; (n = fread(piece.data(), 1, piece.size(), pipe)) > 0;)
      said.append(piece.data(), n);
    pclose(pipe);
    if (said.find("which this build and this processor support") != std::string::npos) continue;
    EXPECT_NE(said.find(alone), std::string::npos)
        << simd_name(set) << ", " << threads << " threads: " << said;
    threads = threads == 8 ? 2 : threads + 1;
  }
}

}  // namespace souple::test_threads_same_bits
