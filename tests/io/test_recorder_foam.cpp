#include "io_test.h"
#include "souple/geometry/fill.h"
#include "souple/io/manifest.h"
#include "souple/io/playback.h"
#include "souple/io/recorder.h"
#include "souple/world/world.h"

#include <algorithm>

namespace souple::test::test_io_recorder_foam {

constexpr double dt = 1.0 / 60;

class RecordedFoamTest : public FolderTest {
 protected:
  /// Water thrown at a wall.
  static World splash(float foam = 1) {
    World world({.substeps = 4});
    world.add_collider(Plane{});
    world.add_collider(Plane{{-1, 0, 0}, -0.3f});
    world.add_fluid(fill({-0.25, 0, -0.15}, {0.15, 0.2, 0.15}, 0.05), {.spacing = 0.05f, .foam = foam},
                    {.name = "water", .velocity = {4, 0, 0}});
    return world;
  }
  static void run(World& world, Recorder& recorder, int frames) {
    for (int frame = 0; frame < frames; ++frame) world.step(dt), recorder.capture();
  }
};

TEST_F(RecordedFoamTest, IsReadBackFrameByFrame) {
  World world = splash();
  std::vector<std::vector<Vec3f>> foam;
  std::vector<std::vector<std::uint8_t>> kinds;
  {
    Recorder recorder(world, folder / "out", {.frames = 12});
    for (int frame = 0; frame < 12; ++frame) {
      world.step(dt);
      recorder.capture();
      foam.emplace_back(world.foam().positions.begin(), world.foam().positions.end());
      kinds.emplace_back();
      for (const FoamKind kind : world.foam().kinds) kinds.back().push_back(static_cast<std::uint8_t>(kind));
    }
  }
  EXPECT_GT(foam.back().size(), 20);
  EXPECT_NE(kinds.back(), std::vector<std::uint8_t>(kinds.back().size(), 0));
  EXPECT_TRUE(has("out/foam_0001.ply"));
  const RunManifest manifest = read_manifest(folder / "out");
  ASSERT_EQ(manifest.objects.size(), 2);
  EXPECT_EQ(manifest.objects[1].kind, "foam");
  EXPECT_EQ(manifest.objects[1].files, (std::vector<ManifestFile>{{"ply", "foam_0001.ply", 12}}));
  Playback playback(folder / "out");
  for (const std::uint64_t frame : {12u, 1u, 7u}) {
    playback.read(frame);
    EXPECT_EQ(playback.objects()[1].kind, "foam");
    EXPECT_EQ(playback.objects()[1].positions, foam[frame - 1]);
    EXPECT_EQ(playback.objects()[1].velocities.size(), foam[frame - 1].size());
    EXPECT_EQ(playback.objects()[1].foam_kinds, kinds[frame - 1]);
  }
}

TEST_F(RecordedFoamTest, WhereThereIsNoneNoFileIsWritten) {
  World world = splash(0);
  {
    Recorder recorder(world, folder / "out");
    run(world, recorder, 3);
  }
  EXPECT_EQ(read_manifest(folder / "out").objects.size(), 1);
  EXPECT_FALSE(has("out/foam_0001.ply"));
}

// Switched on in the middle of a run, its files have the run's numbers.
TEST_F(RecordedFoamTest, MayBeginLater) {
  World world = splash(0);
  {
    Recorder recorder(world, folder / "out");
    run(world, recorder, 2);
    world.set_material(world.find_object("water"), FluidMaterial{.spacing = 0.05f, .foam = 1});
    run(world, recorder, 4);
  }
  EXPECT_FALSE(has("out/foam_0002.ply"));
  EXPECT_TRUE(has("out/foam_0003.ply"));
  Playback playback(folder / "out");
  playback.read(2);
  EXPECT_TRUE(playback.objects()[1].positions.empty());
  playback.read(6);
  EXPECT_EQ(playback.objects()[1].positions.size(), world.foam().positions.size());
}

TEST_F(RecordedFoamTest, GoesOnWithAResumedRun) {
  World straight = splash();
  {
    Recorder recorder(straight, folder / "a", {.frames = 9});
    run(straight, recorder, 9);
  }
  World first = splash();
  {
    Recorder recorder(first, folder / "b", {.frames = 9});
    run(first, recorder, 5);
  }
  World second = splash();
  second.restore(first.snapshot());
  {
    Recorder recorder(second, folder / "b", {.frames = 9, .resume_from = 5});
    run(second, recorder, 4);
  }
  for (const char* name : {"foam_0001.ply", "foam_0005.ply", "foam_0006.ply", "foam_0009.ply"})
    EXPECT_EQ(get(std::string("a/") + name), get(std::string("b/") + name)) << name;
  const RunManifest manifest = read_manifest(folder / "b");
  EXPECT_EQ(manifest.objects, read_manifest(folder / "a").objects);
}

}  // namespace souple::test::test_io_recorder_foam
