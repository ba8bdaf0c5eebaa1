#include "souple/scene/scene.h"
#include "souple/souple.h"
#include "tests/paths.h"
#include "validation.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_scenes {

bool has_fluid(const SceneDescription& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [](const AnyObjectDescription& object) {
    return std::holds_alternative<FluidDescription>(object);
  });
}

std::vector<std::filesystem::path> scenes_with_fluids() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("scenes")))
    if (entry.path().extension() == ".json" && has_fluid(load_scene(entry.path())))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

class FluidScene : public ::testing::TestWithParam<std::filesystem::path> {};

// All shipped scenes: the compression of a fluid is at most a percent, averaged over its particles and
// frames.
TEST_P(FluidScene, KeepsDensitySlow) {
  const SceneDescription scene = load_scene(GetParam());
  World world = build_world(scene);
  double mean = 0, worst_frame = 0, largest = 0, step = 0;
  for (std::uint32_t frame = 0; frame < scene.frames; ++frame) {
    const StepReport& report = world.step(1 / scene.frame_rate);
    ASSERT_TRUE(report.ok()) << report.message;
    mean += report.fluid.mean_density_error / scene.frames;
    worst_frame = std::max(worst_frame, report.fluid.mean_density_error);
    largest = std::max(largest, report.fluid.largest_density_error);
    step = std::max(step, report.fluid.largest_step);
  }
  const std::string name = "density error in the shipped scenes", of = GetParam().stem().string() + ": ";
  validate_below(name, of + "mean", mean, 0.01);
  state(name, of + "mean in the worst frame", worst_frame);
  state(name, of + "largest, of one particle", largest);
  state(name, of + "longest step, should be below 0.33", step);
}

INSTANTIATE_TEST_SUITE_P(Shipped, FluidScene, ::testing::ValuesIn(scenes_with_fluids()),
                         [](const auto& test) { return test.param.stem().string(); });

}  // namespace souple::test_physics_fluid_scenes
